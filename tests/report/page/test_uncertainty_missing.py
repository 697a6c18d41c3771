"""Sections of the uncertainty and the scene: of much, of little, of nothing, and of numbers without sense."""
import re
import unittest

from synthetic import text_of
from uncertainty_scenes import FIGURES, whole
import figures
import style
from language import Language

EN, DE = Language("en"), Language("de")


class WhatIsMissingTest(unittest.TestCase):
    def test_every_figure_is_drawn_of_a_whole_calibration(self):
        for number in (1, 60):
            c = whole(number)
            for name in FIGURES:
                drawing = figures.draw(name, c, EN)
                if name == "correlation" and number <= 2:
                    self.assertIsNone(drawing)
                    continue
                svg = style.to_svg(drawing, name, name, EN)
                self.assertLess(len(svg), 400_000, f"{name} of {number}")
                self.assertLess(drawing.get_size_inches()[1], 10, f"{name} of {number}: fits on A4")

    def test_the_same_calibration_gives_the_same_figures(self):
        for name in FIGURES:
            one, other = (style.to_svg(figures.draw(name, whole(3), EN), name, name, EN) for _ in range(2))
            self.assertEqual(one, other)

    def test_a_key_may_be_missing_or_empty(self):
        sections = {"budget": "budget", "correlation": "correlation", "condition": "correlation",
                    "weakest": "correlation", "jackknife": "leave_one_out", "covariance": "leave_one_out",
                    "joint": "leave_one_out", "montecarlo": "monte_carlo", "scene": "scene",
                    "volume": "volume"}
        for key, section in sections.items():
            for number in (2,):
                for changes in (lambda c: c.pop(key), lambda c: c.update({key: None}),
                                lambda c: c.update({key: type(c[key])()})):
                    c = whole(number)
                    changes(c)
                    with self.subTest(key=key, number=number):
                        words = text_of(section, c)
                        if key in ("budget", "jackknife", "montecarlo", "scene", "volume"):
                            self.assertEqual(words, "")

    def test_a_number_may_be_unknown(self):
        for key in ("u", "U", "dof", "value"):
            c = whole(2)
            c["parameters"][0][key] = None
            for name in [name for name in FIGURES if (name, key) != ("monte_carlo", "value")]:
                with self.subTest(key=key, section=name):
                    text_of(name, c)

    def test_a_result_that_knows_nothing_is_drawn(self):
        """U far larger than the search box and everything else."""
        c = whole(2)
        for p in c["parameters"]:
            p |= {"u": 1e7, "U": 2e7}
        c["covariance"] = [[1e14, 9.9e13], [9.9e13, 1e14]]
        for name in FIGURES:
            text_of(name, c)

    def test_german_has_decimal_commas(self):
        for name in FIGURES:
            svg = style.to_svg(figures.draw(name, whole(3), DE), name, name, DE)
            self.assertEqual(re.findall(r">[^<]*\d\.\d[^<]*<", svg), [], name)


if __name__ == "__main__":
    unittest.main()
