"""As found and as left: E_n, and what makes the comparison doubtful."""
import itertools
import math
import tomllib
import unittest

import numpy as np

from synthetic import CERTIFICATE, calibration, estimated, text_of
import as_found
import page
from language import TEXTS, Language


def keys(found, left) -> list[str]:
    return [doubt.key for doubt in as_found.doubts(found, left)]


def earlier(**changes):
    """Of the same instrument, from measurements of its own, with its own plate."""
    c = calibration(inputs=[{"file": "left.csv", "sha256": "3" * 64}], name="plate, last year", **changes)
    c["budget"] = c["budget"][:1]
    c.sha256 = "e" * 64
    return c


def with_parameter(c, k: int, **changes):
    c["parameters"][k] = c["parameters"][k] | changes
    return c


class ChangesTest(unittest.TestCase):
    def test_e_n(self):
        found = with_parameter(earlier(), 0, value=123.0, U=0.03)
        left = with_parameter(calibration(), 0, value=123.1, U=0.04)
        change = as_found.changes(found, left)[0]
        self.assertAlmostEqual(change.change, 0.1, 12)
        self.assertAlmostEqual(change.e_n, 0.1 / 0.05, 12)  # 3-4-5

    def test_its_sign_is_that_of_the_change(self):
        found = with_parameter(earlier(), 0, value=124.0)
        self.assertLess(as_found.changes(found, calibration())[0].e_n, 0)
        self.assertGreater(as_found.changes(calibration(), found)[0].e_n, 0)

    def test_each_parameter_that_both_have_estimated(self):
        found = earlier(parameters=[estimated("N", 409.0, 0.01), estimated("shear", 0.0, 1e-4, "rad")])
        self.assertEqual([change.left["name"] for change in as_found.changes(found, calibration())], ["N"])

    def test_without_an_uncertainty_no_e_n(self):
        found = with_parameter(earlier(), 0, U=None)
        change = as_found.changes(found, calibration())[0]
        self.assertIsNone(change.e_n)
        self.assertIsNotNone(change.change)
        self.assertIsNone(as_found.changes(with_parameter(earlier(), 0, value=None), calibration())[0].change)


def turned(v, covariance, u=None, **changes):
    """A calibration with an orientation; v: its rotation vector."""
    u = np.sqrt(np.diag(covariance)) if u is None else u
    parameters = [estimated(f"hand_eye_r{axis}", v[k], u[k], "rad") | {"U": 2 * u[k]}
                  for k, axis in enumerate("xyz")]
    return earlier(parameters=parameters, covariance=np.asarray(covariance).tolist(), **changes)


class OrientationTest(unittest.TestCase):
    """Compared as the rotation between both."""
    covariance = np.array([[4.0, 1.0, 0.5], [1.0, 9.0, -2.0], [0.5, -2.0, 1.0]]) * 1e-8

    def test_vectors_on_either_side_of_half_a_turn_are_neighbours(self):
        for axis in itertools.product((-1, 1), (-0.4, 0.4), (-0.2, 0.2)):
            axis = np.array(axis) / np.linalg.norm(axis)
            found, left = (math.pi - 1e-4) * axis, -(math.pi - 2e-4) * axis
            changes = as_found.changes(turned(found, self.covariance), turned(left, self.covariance))
            self.assertAlmostEqual(np.linalg.norm([c.change for c in changes]), 3e-4, 9)

    def test_exactly_half_a_turn(self):
        v = np.array([0.0, math.pi, 0.0])
        for sign in (1, -1):
            changes = as_found.changes(turned(v, self.covariance), turned(sign * v, self.covariance))
            self.assertLess(np.linalg.norm([c.change for c in changes]), 1e-9)

    def test_its_u_is_that_of_many_draws(self):
        rng = np.random.default_rng(1)
        v = np.array([1.2, -2.1, 0.7])
        reference = as_found._rotation(v)
        draws = rng.multivariate_normal(v, self.covariance, 20000)
        scatter = np.std([as_found._vector(as_found._rotation(draw) @ reference.T) for draw in draws], axis=0)
        changes = as_found.changes(turned(v, self.covariance), turned(v, self.covariance))
        np.testing.assert_allclose([c.u for c in changes], math.sqrt(2) * scatter, rtol=0.03)

    def test_rotations_there_and_back(self):
        for v in ([0.1, 0.2, -0.3], [1e-9, 0, 0], [2.0, -1.0, 2.0], [0.0, 0.0, math.pi]):
            np.testing.assert_allclose(np.abs(as_found._vector(as_found._rotation(np.array(v)))), np.abs(v), atol=1e-9)


class DoubtsTest(unittest.TestCase):
    def test_none_about_two_good_ones(self):
        self.assertEqual(keys(earlier(), calibration()), [])

    def test_the_same_file(self):
        self.assertIn("same_file", keys(calibration(), calibration()))

    def test_common_measurements_by_content(self):
        found = earlier()
        found["inputs"] = [{"file": "old name.csv", "sha256": "2" * 64},
                           {"file": "dataset.yaml", "sha256": "d" * 64}]
        self.assertEqual(as_found.doubts(found, calibration()), [as_found.Doubt("inputs", ("right.csv",))])

    def test_common_systematic_influences(self):
        found = earlier()
        found["budget"] = calibration()["budget"]
        self.assertEqual(as_found.doubts(found, calibration()), [as_found.Doubt("influences", ("scale_y",))])

    def test_other_models_residuals_and_items(self):
        self.assertIn("model", keys(earlier(model="robot-ball"), calibration()))
        self.assertIn("residual", keys(earlier(residual="plane"), calibration()))
        items = [{"item": {"identifications": [{"issuer": "manufacturer", "value": number}]}}
                 for number in ("7", "8")]
        self.assertIn("item", keys(earlier(certificate=items[0]), calibration(certificate=items[1])))
        self.assertEqual(keys(earlier(certificate=items[0]), calibration(certificate=items[0])), [])
        for nothing in ("none", {}, {"item": {"name": "x"}}):  # nobody knows that it is the same
            told = as_found.doubts(earlier(certificate=items[0]), calibration(certificate=nothing))
            self.assertEqual(told, [as_found.Doubt("item_of_one", ("7",))])

    def test_unreliable_ones(self):
        self.assertEqual(keys(earlier(status="unreliable"), calibration()), ["found_unreliable"])
        self.assertEqual(keys(earlier(), calibration(status="unreliable")), ["left_unreliable"])

    def test_other_roles_values_and_parameters(self):
        held = with_parameter(earlier(), 2, role="hold", value=0.0)
        self.assertEqual(as_found.doubts(held, calibration()), [as_found.Doubt("roles", ("tilt_x",))])
        elsewhere = with_parameter(earlier(), 3, value=0.001)
        self.assertEqual(as_found.doubts(elsewhere, calibration()), [as_found.Doubt("values", ("tilt_y",))])
        nothing = with_parameter(earlier(), 3, value=None)  # at 0, as the other one says in a number
        self.assertEqual(as_found.doubts(nothing, calibration()), [])
        considered = with_parameter(earlier(), 3, role="consider", u=1e-4)
        self.assertEqual(as_found.doubts(considered, calibration()), [as_found.Doubt("considered", ("tilt_y",))])
        fewer = earlier(parameters=calibration()["parameters"][:4])
        self.assertEqual(as_found.doubts(fewer, calibration()), [as_found.Doubt("missing", ("scale_y",))])
        other = with_parameter(earlier(), 0, nominal=120.0)
        self.assertEqual(as_found.doubts(other, calibration()), [as_found.Doubt("nominal", ("M",))])


class WordsTest(unittest.TestCase):
    def test_both_values_change_and_meaning(self):
        found = with_parameter(earlier(), 0, value=122.9, u=0.0054)
        shown = text_of("result", calibration(), found)
        self.assertIn("As found plate, last year – – – As left plate – – –", shown)
        self.assertIn("M / mm 122.900 ± 0.011 123.002 ± 0.011 0.1021 6.6 changed", shown)
        self.assertIn("N / mm 408.988 ± 0.027 408.988 ± 0.027 0.000 0.0 no change shown", shown)

    def test_every_doubt_has_words_in_every_language(self):
        found = earlier(model="flange-ball", residual="plane", status="unreliable",
                        certificate={"item": {"identifications": [{"value": 1}]}})
        held = {"name": "N", "unit": "mm", "role": "hold", "value": 409.0}
        found["parameters"] = [estimated("M", 1.0, 0.1, nominal=5.0), *calibration()["parameters"][3:], held]
        found["parameters"][1] = found["parameters"][1] | {"value": 7.0}
        found["inputs"], found["budget"] = calibration()["inputs"], calibration()["budget"]
        left = calibration(status="unreliable", certificate={"item": {"identifications": [{"value": 2}]}})
        found.sha256 = left.sha256
        words = tomllib.loads((TEXTS / "en" / "result.toml").read_text(encoding="utf-8"))["as_found"]["doubt"]
        self.assertEqual(keys(found, left), [key for key in words if key not in ("item_of_one", "considered")])
        for key in ("item_of_one", "considered"):
            self.assertIn("{names}", words[key])
        for language, about in (("en", "is doubtful"), ("de", "zweifelhaft")):
            shown = text_of("result", left, found, language)
            self.assertIn(about, shown)
            self.assertIn("turntable", shown)

    def test_dates_and_certificates_of_both(self):
        found = earlier(certificate={"identification": "K-1", "performed": {"begin": "2025-10-01"},
                                     "item": {"identifications": [{"value": "007"}]}})
        shown = text_of("result", calibration(certificate=CERTIFICATE), found)
        self.assertIn("As found plate, last year K-1 2025-10-01 007 As left plate K-2026-0815 2026-11-02 to 2026-11-03 "
                      "007", shown)

    def test_a_line_of_it_on_the_first_page(self):
        def line(found, left=None, language="en"):
            left = left or calibration()
            return page.sections.content("head", left, found, Language(language, left, found))["as_found"]
        self.assertEqual(line(earlier()), "As found: no change beyond the expanded uncertainties.")
        self.assertEqual(line(with_parameter(earlier(), 0, value=122.9)),
                         "Against as found 1 of 3 quantities have changed, most of all M (E_n\u00a0=\u00a06.6).")
        self.assertIn("doubtful", line(calibration()))
        self.assertIn("cannot be said", line(earlier(status="unreliable")))

    def test_of_an_unreliable_one_no_E_n_and_no_U(self):
        shown = text_of("result", calibration(), earlier(status="unreliable"))
        table = shown.split("Meaning")[1].split("E_n")[0]
        self.assertIn("M / mm 123.002", table)
        self.assertNotRegex(table, "±|changed|no change")

    def test_many_names_are_cut(self):
        found = earlier()
        found["inputs"] = [{"file": f"{k}.csv", "sha256": f"{k:064}"} for k in range(20)]
        self.assertIn("7.csv and 12 more", text_of("result", calibration(inputs=found["inputs"]), found))

    def test_nothing_in_common(self):
        shown = text_of("result", calibration(), earlier(parameters=[estimated("ball_x", 1.0, 0.1)]))
        self.assertIn("no estimated parameter in common", shown)


if __name__ == "__main__":
    unittest.main()
