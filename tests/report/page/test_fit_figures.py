"""Comparison, residuals and the searched surface: what is drawn, and what is not."""
import math
import re
import unittest

from fit_scenes import METHODS, row, scanned, searched, table
from synthetic import calibration, estimated
import figures
import style
from language import Language

EN, DE = Language("en"), Language("de")
FIGURES = ["comparison", "residual_map", "residual_sweep", "residual_time", "residual_line",
           "residual_histogram", "surface_contour"]


class DrawingTest(unittest.TestCase):
    def tearDown(self):
        style.pyplot.close("all")

    def whole(self):
        return scanned(surface=searched()["surface"], compare=[METHODS[0], METHODS[2]])

    def test_all_in_both_languages(self):
        for language in (EN, DE):
            for name in FIGURES:
                svg = style.to_svg(figures.draw(name, self.whole(), language), name, name, language)
                self.assertNotIn("None", svg, name)
                language(f"figure.{name}.caption", **figures.caption(name, self.whole(), language))
                ticks = [text for text in _texts(svg) if text.strip("−0123456789") in (".", ",")]
                self.assertEqual([text for text in ticks if language("decimal_sign") not in text], [], name)

    def test_nothing_of_nothing(self):
        for absent in (None, [], {}):
            c = self.whole()
            for key in ("compare", "residuals", "surface", "joint", "grid", "targets", "covariance"):
                c[key] = absent
            for name in FIGURES:
                self.assertIsNone(figures.draw(name, c, EN), f"{name} of {absent}")

    def test_a_table_without_rows_is_none(self):
        c = self.whole()
        for each in c["residuals"]["targets"]:
            for key in ("cells", "sweep", "time", "sweep_correlation"):
                each[key]["rows"] = []
            each |= {"histogram": {"counts": [], "from": 0, "to": 0}, "lags": [], "correlation": []}
        for name in FIGURES[1:6]:
            self.assertIsNone(figures.draw(name, c, EN), name)

    def test_balls_are_drawn_elsewhere(self):
        c = self.whole()
        c["residuals"]["targets"][0]["balls"] = table("pose x y z", [[0, 0.1, 0.2, 0.3]])
        for name in FIGURES[1:6]:
            self.assertIsNone(figures.draw(name, c, EN), name)

    def test_many_targets_are_thinned_out_and_it_is_said(self):
        c = scanned(100)
        figure = figures.draw("residual_map", c, EN)
        titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
        self.assertEqual(titles, [f"plate {k}" for k in range(88, 100)])  # the worst
        self.assertIn("Of 100 targets the 12", figures.caption("residual_map", c, EN)["notes"])
        self.assertEqual(figures.caption("residual_map", scanned(12), EN)["notes"], "")

    def test_ten_thousand_cells_are_a_picture(self):
        c = scanned(1)
        cells = c["residuals"]["targets"][0]["cells"]
        cells["rows"] = [[a, a + 1, z, z + 1, 0.01 * math.sin(a * z), 5] for a in range(99)
                         for z in range(99)]
        self.assertLess(len(style.to_svg(figures.draw("residual_map", c, EN), "map", "map", EN)), 300_000)

    def test_nulls_within(self):
        c = self.whole()
        for key, column in (("cells", 4), ("sweep", 1), ("sweep", 2), ("time", 1), ("time", 2), ("sweep_correlation", 1)):
            c["residuals"]["targets"][0][key]["rows"][0][column] = None
        c["residuals"]["targets"][0] |= {"correlation": [1.0, None, 0.2, 0.0], "correlation_length": None}
        c["surface"]["search"]["rows"][5][2] = None
        c["targets"][0]["rms"] = None
        c["parameters"][0] |= {"u": None, "U": None, "k": None}
        for name in FIGURES:
            texts = _texts(style.to_svg(figures.draw(name, c, EN), name, name, EN))
            self.assertNotIn("nan", " ".join(texts), name)

    def test_a_robot_has_errors_instead(self):
        rows = [row("nominal robot, first hand-eye", **{"max/mm": 0.5, "1": -0.5, "2": 0.0}),
                row("joint refinement", **{"max/mm": 0.01, "1": 0.01, "2": -0.002})]
        c = calibration(model="robot-ball", compare=rows, parameters=[estimated("a_1", 0.1, 0.01)])
        texts = _texts(style.to_svg(figures.draw("comparison", c, EN), "c", "c", EN))
        self.assertIn("nominal robot, first hand-eye", texts)
        self.assertIn("0.01", texts)


def _texts(svg: str) -> list[str]:
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg)


if __name__ == "__main__":
    unittest.main()
