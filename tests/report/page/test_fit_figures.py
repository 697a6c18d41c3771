"""Comparison, residuals and the searched surface: what is computed for their figures, and what is drawn of what."""
import math
import re
import unittest
from statistics import NormalDist

import numpy as np

from synthetic import calibration, estimated
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
FIGURES = ["comparison", "residual_map", "residual_sweep", "residual_line", "residual_histogram", "surface_contour",
           "surface_3d"]


def table(columns: str, rows) -> dict:
    return {"columns": columns.split(), "units": ["mm"] * len(columns.split()), "rows": rows}


def normal_counts(total: float, limit: float = 4.0, bins: int = 32, sigma: float = 1.0) -> dict:
    """As so many normal residuals would fall, on average."""
    edges = np.linspace(-limit, limit, bins + 1)
    share = np.array([NormalDist(0, sigma).cdf(edge) for edge in edges])
    return {"from": -limit, "to": limit, "unit": "sigma", "counts": list(total * np.diff(share)),
            "below": total * share[0], "above": total * (1 - share[-1])}


def target(name: str, **changes) -> dict:
    """Two columns of cells, three profiles."""
    return {"name": name, "lags": [0.0, 1.0, 2.0, 4.0], "correlation": [1.0, 0.5, 0.2, 0.0], "correlation_length": 2.6,
            "correlation_dies_out": True, "sigma": 0.05, "histogram": normal_counts(1000.0),
            "cells": table("alpha_from alpha_to z_from z_to residual points",
                           [[0.0, 0.1, -50, 0, 0.01, 100], [0.1, 0.2, -50, 0, -0.02, 300], [0.0, 0.2, 0, 50, 0.03, 50]]),
            "sweep": table("alpha residual u", [[0.05, 0.01, 0.004], [0.10, -0.01, 0.004], [0.15, 0.002, 0.004]]),
            "sweep_correlation": table("lag correlation", [[0, 1.0], [1, -0.2], [2, 0.1]])} | changes


def scanned(count: int = 2, **changes):
    names = [f"plate {k}" for k in range(count)]
    summaries = [{"name": name, "points": 1000, "missing": 0, "set_aside": 0, "rms": 0.05 + 0.001 * k}
                 for k, name in enumerate(names)]
    return calibration(targets=summaries, residuals={"targets": [target(name) for name in names]}, **changes)


def bowl(M: np.ndarray, N: np.ndarray, scale: float = 1.0) -> dict:
    return table("M N S", [[m, n, 0.05 + scale * 1e-3 * ((m - 123) ** 2 + (n - 409) ** 2)] for m in M for n in N])


def searched(**changes):
    surfaces = {"search": bowl(np.arange(110, 131.0), np.arange(395, 426.0)),
                "near": bowl(np.linspace(122.9, 123.1, 11), np.linspace(408.9, 409.1, 11))}
    return calibration(surface=surfaces | changes)


def row(method: str, note: str = "", **cells) -> dict:
    """A cell is a value, or value and u."""
    pairs = {column: cell if isinstance(cell, tuple) else (cell, None) for column, cell in cells.items()}
    return {"method": method, "note": note, "cells": [{"column": column, "value": value, "u": u}
                                                      for column, (value, u) in pairs.items()]}


def turntable_row(method: str, M, N, step=None, tilt=0.0, **more) -> dict:
    u = [cell[1] if isinstance(cell, tuple) else None for cell in (M, N)]
    return row(method, **{"M/mm": M, "N/mm": N, "tilt_x/mrad": tilt, "u(M)/um": u[0] and 1000 * u[0],
                          "u(N)/um": u[1] and 1000 * u[1], "step/√12/um": step and 1000 * step / math.sqrt(12), **more})


class HistogramTest(unittest.TestCase):
    def test_normal_residuals_lie_on_the_line(self):
        normal, found = residuals.Histogram([target("left")]).quantiles()
        self.assertEqual(len(found), 33)  # all edges: there are residuals beyond both
        np.testing.assert_allclose(normal, found, atol=1e-9)

    def test_wider_ones_on_a_steeper_line(self):
        normal, found = residuals.Histogram([target("left", histogram=normal_counts(1000.0, sigma=2.0))]).quantiles()
        np.testing.assert_allclose(2 * normal, found, atol=1e-9)

    def test_what_lies_beyond_counts(self):
        histogram = residuals.Histogram([target("left", histogram={"from": -1, "to": 1, "counts": [3, 3], "below": 2,
                                                                   "above": 2})])
        self.assertEqual(histogram.total, 10)
        normal, found = histogram.quantiles()
        np.testing.assert_allclose(found, [-1, 0, 1])
        np.testing.assert_allclose(normal, [NormalDist().inv_cdf(0.2), 0, NormalDist().inv_cdf(0.8)], atol=1e-12)
        np.testing.assert_allclose(histogram.density, [0.3, 0.3])

    def test_empty_bins_add_no_points(self):
        counts = {"from": -4, "to": 4, "counts": [1, 0, 0, 9, 9, 0, 0, 1], "below": 0, "above": 0}
        normal, found = residuals.Histogram([target("left", histogram=counts)]).quantiles()
        np.testing.assert_allclose(found, [-3, 0, 3])  # not -2, -1: nothing lies between
        np.testing.assert_allclose(normal[[0, 2]], [NormalDist().inv_cdf(0.05), NormalDist().inv_cdf(0.95)])

    def test_targets_are_pooled(self):
        pooled = residuals.Histogram([target("left"), target("right", histogram=normal_counts(3000.0)),
                                      target("none", histogram=None), target("empty", histogram={"counts": []})])
        self.assertAlmostEqual(pooled.total, 4000)


class ResidualsTest(unittest.TestCase):
    def test_mean_along_the_line_is_that_of_the_points(self):
        z, mean = residuals.along_the_line(Table(target("left")["cells"]), bins=2)
        np.testing.assert_allclose(z, [-25, 25])
        np.testing.assert_allclose(mean, [(100 * 0.01 - 300 * 0.02) / 400, 0.03])

    def test_places_without_cells_are_left_out(self):
        cells = target("left")["cells"]
        cells["rows"] += [[0.0, 0.1, 500, 550, None, 10], [0.0, 0.1, 900, 1000, 0.5, 7]]
        z, mean = residuals.along_the_line(Table(cells), bins=24)
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
        for c, expected in ((searched(), set()),
                            (searched(near=bowl(np.linspace(113, 133, 11), np.linspace(399, 419, 11))), {"too_small"}),
                            (searched(near=bowl(np.linspace(122.99, 123.01, 5), np.linspace(408.9, 409, 5))), {"too_large"}),
                            (searched(search=bowl(np.arange(110, 120.0), np.arange(395, 426.0))), {"outside"})):
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
    ROWS = [turntable_row("grid, as published, step 1", 123.0, 409.0, step=1.0),
            row("grid, as published, step 0.01", note="left out: 6e+06 nodes"),
            turntable_row("joint, depth, weighted", (123.002, 0.005), (408.988, 0.013))]

    def tables(self, rows, language=EN, model="turntable"):
        return comparison_section.content(calibration(compare=rows, model=model), None, language)

    def test_every_column_that_says_something_once(self):
        found = self.tables(self.ROWS)
        columns = [column for each in found["tables"] for column in each["columns"]]
        self.assertEqual([column.replace("\u00a0", " ") for column in columns], ["M / mm", "N / mm", "step/√12 / µm"])
        self.assertEqual(found["tables"][0]["rows"][2]["cells"], ["123.0020(50)", "408.988(13)"])
        self.assertEqual(found["tables"][0]["rows"][0]["cells"], ["123.000", "409.000"])
        tilted = self.ROWS + [turntable_row("joint, depth, weighted, tilts", 123.0, 409.0, tilt=-0.2)]
        self.assertIn("tilt_x / mrad", [column for each in self.tables(tilted)["tables"] for column in each["columns"]])

    def test_a_method_that_was_left_out_is_there_with_its_note(self):
        found = self.tables(self.ROWS, DE)
        self.assertEqual(found["tables"][0]["rows"][1], {"method": "Gitter, veröffentlicht, Schritt 0,01", "note": 1,
                                                         "cells": ["–", "–"]})
        self.assertEqual([str(note) for note in found["notes"]], ["weggelassen: 6e+06 Knoten"])
        self.assertEqual(len(found["tables"][1]["rows"]), 2)

    def test_many_lengths_take_more_than_one_table(self):
        rows = [row(method, **{"max/mm": 0.5} | {str(k): 0.12345 for k in range(1, 13)} | {"rms of balls/mm": 0.2})
                for method in ("nominal robot, first hand-eye", "joint refinement")]
        columns = [each["columns"] for each in self.tables(rows, model="robot-ball")["tables"]]
        self.assertEqual(columns[0], ["largest / mm", "rms of balls / mm"])
        self.assertEqual(sum(columns[1:], []), [str(k) for k in range(1, 13)])
        self.assertGreater(len(columns), 2)

    def test_no_methods_no_section(self):
        self.assertEqual(self.tables(None)["tables"], [])
        self.assertEqual(self.tables([])["tables"], [])

    def test_bars_are_half_a_step_or_U(self):
        rows = [self.ROWS[0], self.ROWS[2]]
        offsets = comparison_figure._Offsets("M", calibration(), rows)
        np.testing.assert_allclose(offsets.apart, [-0.002, 0], atol=1e-12)
        self.assertAlmostEqual(offsets.half_step[0], 0.5)
        self.assertAlmostEqual(offsets.U[1], 2.04 * 0.005)
        self.assertTrue(offsets.are_far)
        self.assertFalse(comparison_figure._Offsets("N", calibration(), rows[1:] * 2).are_far)


class DrawingTest(unittest.TestCase):
    """What is asked for is drawn; what is not in the file is not."""

    def tearDown(self):
        style.pyplot.close("all")

    def whole(self):
        return scanned(surface=searched()["surface"], compare=[ComparisonTest.ROWS[0], ComparisonTest.ROWS[2]])

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
            for key in ("cells", "sweep", "sweep_correlation"):
                each[key]["rows"] = []
            each |= {"histogram": {"counts": [], "from": 0, "to": 0}, "lags": [], "correlation": []}
        for name in FIGURES[1:5]:
            self.assertIsNone(figures.draw(name, c, EN), name)

    def test_balls_are_drawn_elsewhere(self):
        c = self.whole()
        c["residuals"]["targets"][0]["balls"] = table("pose x y z", [[0, 0.1, 0.2, 0.3]])
        for name in FIGURES[1:5]:
            self.assertIsNone(figures.draw(name, c, EN), name)

    def test_many_targets_are_thinned_out_and_it_is_said(self):
        c = scanned(100)
        figure = figures.draw("residual_map", c, EN)
        titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
        self.assertEqual(titles, [f"plate {k}" for k in range(88, 100)])  # the worst
        self.assertIn("Of 100 targets the 12", figures.caption("residual_map", c, EN)["notes"])
        self.assertEqual(figures.caption("residual_map", scanned(12), EN)["notes"], "")

    def test_a_hundred_thousand_cells_are_a_picture(self):
        c = scanned(1)
        cells = c["residuals"]["targets"][0]["cells"]
        cells["rows"] = [[a, a + 1, z, z + 1, 0.01 * math.sin(a * z), 5] for a in range(100) for z in range(100)]
        self.assertLess(len(style.to_svg(figures.draw("residual_map", c, EN), "map", "map", EN)), 300_000)

    def test_nulls_within(self):
        c = self.whole()
        for key, column in (("cells", 4), ("sweep", 1), ("sweep", 2), ("sweep_correlation", 1)):
            c["residuals"]["targets"][0][key]["rows"][0][column] = None
        c["residuals"]["targets"][0] |= {"correlation": [1.0, None, 0.2, 0.0], "correlation_length": None}
        c["surface"]["search"]["rows"][5][2] = None
        c["targets"][0]["rms"] = None
        c["parameters"][0] |= {"u": None, "U": None, "k": None}
        for name in FIGURES:
            self.assertNotIn("nan", " ".join(_texts(style.to_svg(figures.draw(name, c, EN), name, name, EN))), name)

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
