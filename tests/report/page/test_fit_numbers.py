"""Comparison, residuals and the searched surface: what is computed for their tables and figures."""
import math
import unittest
from statistics import NormalDist

import numpy as np

from fit_scenes import METHODS, bowl, normal_counts, row, searched, table, target, turntable_row
from synthetic import calibration, said
import comparison
import ellipse
import figures
import residuals
import style
import surface
from calibration import Table
from figures import comparison as comparison_figure
from figures import residual_map, surface_contour
from language import Language
from sections import comparison as comparison_section

EN, DE = Language("en"), Language("de")


class HistogramTest(unittest.TestCase):
    def test_normal_residuals_lie_on_the_line(self):
        normal, found = residuals.Histogram([target("left")]).quantiles()
        self.assertEqual(len(found), 33)  # all edges: there are residuals beyond both
        np.testing.assert_allclose(normal, found, atol=1e-9)

    def test_wider_ones_on_a_steeper_line(self):
        wider = target("left", histogram=normal_counts(1000.0, sigma=2.0))
        normal, found = residuals.Histogram([wider]).quantiles()
        np.testing.assert_allclose(2 * normal, found, atol=1e-9)

    def test_what_lies_beyond_counts(self):
        counts = {"from": -1, "to": 1, "counts": [3, 3], "below": 2, "above": 2}
        histogram = residuals.Histogram([target("left", histogram=counts)])
        self.assertEqual(histogram.total, 10)
        normal, found = histogram.quantiles()
        np.testing.assert_allclose(found, [-1, 0, 1])
        np.testing.assert_allclose(normal, [NormalDist().inv_cdf(p) for p in (0.2, 0.5, 0.8)], atol=1e-12)
        np.testing.assert_allclose(histogram.density, [0.3, 0.3])

    def test_empty_bins_add_no_points(self):
        counts = {"from": -4, "to": 4, "counts": [1, 0, 0, 9, 9, 0, 0, 1], "below": 0, "above": 0}
        normal, found = residuals.Histogram([target("left", histogram=counts)]).quantiles()
        np.testing.assert_allclose(found, [-3, 0, 3])  # not -2, -1: nothing lies between
        np.testing.assert_allclose(normal[[0, 2]], [NormalDist().inv_cdf(0.05), NormalDist().inv_cdf(0.95)])

    def test_targets_are_pooled(self):
        histograms = [normal_counts(1000.0), normal_counts(3000.0), None, {"counts": []}]
        pooled = residuals.Histogram([target("any", histogram=each) for each in histograms])
        self.assertAlmostEqual(pooled.total, 4000)


class ResidualsTest(unittest.TestCase):
    def test_mean_along_the_line_is_that_of_the_points(self):
        z, mean, points = residuals.along_the_line(Table(target("left")["cells"]), bins=2)
        np.testing.assert_allclose(z, [-25, 25])
        np.testing.assert_allclose(mean, [(100 * 0.01 - 300 * 0.02) / 400, 0.03])
        np.testing.assert_allclose(points, [400, 50])

    def test_noise_of_a_mean_of_correlated_points(self):
        """Of simulated lines: autoregressive noise of one pole."""
        random, pole = np.random.default_rng(2), 0.6
        lines = np.empty((3000, 300))
        lines[:, 0] = random.standard_normal(3000)
        for k in range(1, 300):
            lines[:, k] = pole * lines[:, k - 1] + math.sqrt(1 - pole**2) * random.standard_normal(3000)
        correlated = {"sigma": 1.0, "correlation_length": (1 + pole) / (1 - pole)}
        found = lines.mean(axis=1).std()
        self.assertAlmostEqual(residuals.noise_of_mean(correlated, 300) / found, 1, delta=0.05)

    def test_places_without_cells_are_left_out(self):
        cells = target("left")["cells"]
        cells["rows"] += [[0.0, 0.1, 500, 550, None, 10], [0.0, 0.1, 900, 1000, 0.5, 7]]
        z, mean, _ = residuals.along_the_line(Table(cells), bins=24)
        np.testing.assert_allclose(z, [-25, 25, 950])
        self.assertEqual(mean[-1], 0.5)

    def test_band_of_white_noise(self):
        random = np.random.default_rng(1)
        noise = random.standard_normal((4000, 100))
        lag_1 = (noise[:, :-1] * noise[:, 1:]).sum(axis=1) / (noise**2).sum(axis=1)
        self.assertAlmostEqual(np.mean(np.abs(lag_1) < residuals.white_noise_band(100)), 0.95, delta=0.012)

    def test_worst_stay_in_their_order(self):
        found = [{"rms": rms} for rms in (0.1, 0.4, None, 0.3, 0.2)]
        self.assertEqual([each["rms"] for each in residuals.worst(found, 3)], [0.4, 0.3, 0.2])

    def test_few_cells_far_off_do_not_take_the_colours(self):
        usual, far = np.linspace(-1, 1, 1000), np.array([50.0, -40.0, np.nan])
        self.assertEqual(residual_map._limit(usual), (1.0, False))
        limit, saturated = residual_map._limit(np.concatenate([usual, far]))
        self.assertTrue(saturated)
        self.assertLess(limit, 1.0)
        self.assertEqual(residual_map._limit(np.array([np.nan])), (1e-3, False))


class EllipseTest(unittest.TestCase):
    COVARIANCE = np.array([[4.0, 3.0], [3.0, 9.0]])

    def test_outline(self):
        lines = ellipse.outline(np.array([10.0, -5.0]), self.COVARIANCE, 2.5, points=721)
        apart = lines - [[10.0], [-5.0]]
        distance = np.einsum("ik,ij,jk->k", apart, np.linalg.inv(self.COVARIANCE), apart)
        np.testing.assert_allclose(distance, 2.5**2)
        np.testing.assert_allclose(apart.max(axis=1), 2.5 * np.sqrt([4.0, 9.0]), rtol=1e-4)
        self.assertGreater(np.prod(apart[:, np.argmax(apart[1])]), 0)  # it leans as the two are correlated

    def test_axes(self):
        lengths, directions = ellipse.semi_axes(self.COVARIANCE, 2.0)
        self.assertGreater(lengths[0], lengths[1])
        for length, direction in zip(lengths, directions.T):
            np.testing.assert_allclose(self.COVARIANCE @ direction, (length / 2) ** 2 * direction)

    def test_k_of_two_holds_95_percent(self):
        samples = np.random.default_rng(1).multivariate_normal([0, 0], self.COVARIANCE, 40000).T
        lengths, directions = ellipse.semi_axes(self.COVARIANCE, math.sqrt(-2 * math.log(0.05)))
        inside = ((directions.T @ samples / lengths[:, None]) ** 2).sum(axis=0) < 1
        self.assertAlmostEqual(inside.mean(), 0.95, delta=0.004)


class SurfaceTest(unittest.TestCase):
    def test_nodes_find_their_place(self):
        rows = [[1, 10, 0.1], [1, 20, 0.2], [1, 30, 0.3], [2, 10, 0.4], [2, 30, 0.6]]
        shown = surface.Surface(Table(table("M N S", rows[::-1])))
        np.testing.assert_array_equal(shown.S, [[0.1, 0.2, 0.3], [0.4, np.nan, 0.6]])
        self.assertTrue(shown)

    def test_a_line_or_nothing_is_no_surface(self):
        for rows in ([], [[1, 10, 0.1], [1, 20, 0.2]], [[m, n, None] for m in (1, 2) for n in (1, 2)]):
            self.assertFalse(surface.Surface(Table(table("M N S", rows))))
        self.assertFalse(surface.Surface(Table(None)))

    def test_levels_hold_all_of_S(self):
        for scale in (1.0, 1000.0):
            shown = surface.Surface(Table(bowl(np.arange(110, 131.0), np.arange(395, 426.0), scale)))
            levels, _ = shown.levels()
            self.assertEqual(shown.is_logarithmic, scale > 1)
            self.assertTrue((np.diff(levels) > 0).all())
            np.testing.assert_allclose(levels[[0, -1]], [shown.S.min(), shown.S.max()])

    def test_ellipse_is_of_M_and_N_wherever_they_stand(self):
        c = searched()
        order = [2, 1, 0]  # tilt_x, N, M
        c["parameters"][:3] = [c["parameters"][k] for k in order]
        c["covariance"] = [[c["covariance"][i][j] for j in order] for i in order]
        covariance, k = surface_contour.joint_region(c)
        np.testing.assert_allclose(covariance, [[2.916e-05, -3.1e-06], [-3.1e-06, 1.7161e-04]])
        self.assertEqual(k, 2.93)

    def test_what_cannot_be_seen_is_said(self):
        words = {key: EN(f"figure.surface_contour.{key}") for key in ("too_small", "too_large", "outside")}
        wide = bowl(np.arange(113, 134.0), np.arange(399, 420.0))
        narrow = bowl(np.linspace(122.99, 123.01, 5), np.linspace(408.9, 409, 5))
        aside = bowl(np.arange(110, 120.0), np.arange(395, 426.0))
        for c, expected in ((searched(), set()), (searched(near=wide), {"too_small"}),
                            (searched(near=narrow), {"too_large"}),
                            (searched(search=aside), {"outside"})):
            notes = figures.caption("surface_contour", c, EN)["notes"]
            self.assertEqual({key for key, text in words.items() if text in notes}, expected)

    def test_without_uncertainty_there_is_no_ellipse(self):
        for changes in ({"covariance": None}, {"joint": {"k": None}}, {"covariance": [[None] * 3] * 3}):
            c = searched()
            c.update(changes)
            self.assertIsNone(surface_contour.joint_region(c))
            self.assertIsNotNone(figures.draw("surface_contour", c, EN))
            style.pyplot.close("all")


class ComparisonTest(unittest.TestCase):
    def tables(self, rows, language=EN, model="turntable"):
        return comparison_section.content(calibration(compare=rows, model=model), None, language)

    def columns(self, found):
        return [column.replace("\u00a0", " ") for each in found["tables"] for column in each["columns"]]

    def test_millimetres_where_micrometres_would_be_thousands(self):
        rows = [turntable_row("two", 25.0, -300.0), turntable_row("one", (70.7, 6.7), (-60.0, 13.0))]
        for each, S in zip(rows, (4454.0, 11631.0)):
            each["cells"].append({"column": "S/um", "value": S, "u": None})
        found = comparison_section.content(calibration(compare=rows, grid=None), None, EN)
        values, others = found["tables"]
        self.assertEqual(others["columns"], ["S\u00a0/\u00a0mm"])
        self.assertEqual([each["cells"] for each in others["rows"]], [["4.45"], ["11.6"]])
        self.assertEqual(values["rows"][0]["cells"][:2], ["25.0", "\u2212300"])  # no digit that the reference has not

    def test_every_column_that_says_something_once(self):
        found = self.tables(METHODS)
        self.assertEqual(self.columns(found), ["M / mm", "N / mm"])  # the step is in the method's name
        self.assertEqual(found["tables"][0]["rows"][2]["cells"], ["123.0020(50)", "408.988(13)"])
        self.assertEqual(found["tables"][0]["rows"][0]["cells"], ["123.000", "409.000"])
        tilted = METHODS + [turntable_row("joint, depth, weighted, tilts", 123.0, 409.0, tilt=-0.2)]
        self.assertIn("tilt_x / mrad", self.columns(self.tables(tilted)))

    def test_a_method_that_was_left_out_is_there_with_its_note(self):
        left_out = METHODS[1]
        german = Language("de", calibration(messages=[
            said(left_out["method"], "Gitter, veröffentlicht, Schritt 0,01"),
            said(left_out["note"], "weggelassen: 6e+06 Knoten")]))
        found = self.tables(METHODS, german)
        self.assertEqual(found["tables"][0]["rows"][1],
                         {"method": "Gitter, veröffentlicht, Schritt 0,01", "note": "a", "cells": ["–", "–"]})
        self.assertEqual(found["notes"], [("a", "weggelassen: 6 × 10⁶ Knoten")])

    def test_single_lengths_stand_with_the_known_lengths_alone(self):
        lengths = {str(k): 0.12345 for k in range(1, 13)}
        rows = [row(method, **{"max/mm": 0.5} | lengths | {"rms of balls/mm": 0.2})
                for method in ("nominal robot, first hand-eye", "joint refinement")]
        columns = [each["columns"] for each in self.tables(rows, model="robot-ball")["tables"]]
        self.assertEqual(columns, [["largest / mm", "rms of balls / mm"]])

    def test_what_all_say_alike_is_a_sentence(self):
        def of(*S):
            return [row(f"method {k}", **{"M/mm": 123.0 + k, "S/um": each}) for k, each in enumerate(S)]
        found = self.tables(of(46.0, 46.1, 46.1), model="robot-ball")
        self.assertEqual(self.columns(found), ["M / mm"])
        self.assertIn("S 46.0 to 46.1\u00a0µm", found["alike"])
        found = self.tables(of(46.0, 47.1), model="robot-ball")
        self.assertEqual((self.columns(found), found["alike"]), (["M / mm", "S / µm"], ""))

    def test_no_methods_no_section(self):
        self.assertEqual(self.tables(None)["tables"], [])
        self.assertEqual(self.tables([])["tables"], [])

    def test_the_search_that_was_run_is_among_them(self):
        rows = [METHODS[0], METHODS[2]]
        grid = {"step": 10.0, "S": 0.05, "nodes": 12, "M": 120.0, "N": 410.0}
        first = comparison.methods(calibration(compare=rows, grid=grid))[0]
        self.assertEqual(comparison.method_name(first, EN), "grid, orthogonal, step 10")
        self.assertEqual(comparison.method_name(first, DE), "Gitter, orthogonal, Schritt 10")
        self.assertAlmostEqual(comparison.value(first, "ΔM/u"), (120 - 123.002) / 0.005)
        self.assertEqual(comparison.methods(calibration(compare=rows)), rows)  # its step is among the others

    def test_bars_are_half_a_step_or_U(self):
        rows = [METHODS[0], METHODS[2]]
        offsets = comparison_figure._Offsets("M", calibration(), rows)
        np.testing.assert_allclose(offsets.apart, [-0.002, 0], atol=1e-12)
        self.assertAlmostEqual(offsets.half_step[0], 0.5)
        self.assertAlmostEqual(offsets.U[1], 2.04 * 0.005)
        self.assertTrue(offsets.are_far)
        self.assertFalse(comparison_figure._Offsets("N", calibration(), rows[1:] * 2).are_far)


if __name__ == "__main__":
    unittest.main()
