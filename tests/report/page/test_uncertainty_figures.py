"""Budget, correlation, leaving one out, Monte Carlo: what is computed for them, and what is drawn of what."""
import math
import unittest

import numpy as np

from synthetic import text_of
from uncertainty_scenes import line, trials, with_parameters, without
import figures
import style
import uncertainty
from figures import budget as budget_figure
from figures import leave_one_out as leave_one_out_figure
from figures import monte_carlo as monte_carlo_figure
from language import Language
from notation import MINUS

EN, DE = Language("en"), Language("de")


def texts(drawing) -> list[str]:
    return [text.get_text() for axes in drawing.axes for text in axes.texts]


class StudentTest(unittest.TestCase):
    def test_the_density_integrates_to_one(self):
        t = np.linspace(-4000, 4000, 2_000_001)
        for dof in [1.5, 2, 3.7, 10, 300, 1e5, 1e9, math.inf]:
            whole = np.trapz(uncertainty.student_t_density(t, dof), t)
            self.assertAlmostEqual(whole, 1, delta=3e-5, msg=f"{dof}")

    def test_its_quantiles_are_those_of_the_tables(self):
        """GUM, table G.2, 95 %: to the digits that are printed there."""
        for dof, k in [(1, 12.71), (2, 4.30), (5, 2.57), (10, 2.23), (30, 2.04), (100, 1.984),
                       (math.inf, 1.960)]:
            t = np.linspace(-k, k, 200_001)
            inside = np.trapz(uncertainty.student_t_density(t, dof), t)
            density = float(uncertainty.student_t_density(np.array([k]), dof)[0])
            printed = 0.005 if k > 2 else 0.0005
            self.assertAlmostEqual(inside, 0.95, delta=2.1 * density * printed, msg=f"{dof}")

    def test_many_degrees_of_freedom_join_the_normal_density(self):
        t = np.linspace(-6, 6, 1001)
        below, normal = (uncertainty.student_t_density(t, dof) for dof in (0.99e6, 1e6))
        np.testing.assert_allclose(below, normal, rtol=1e-3)

    def test_value_and_U_hold_95_percent_of_the_density_of_a_parameter(self):
        parameter = {"value": 123.0, "u": 0.02, "dof": 5.0}
        x = np.linspace(123 - 2.5706 * 0.02, 123 + 2.5706 * 0.02, 100_001)
        self.assertAlmostEqual(np.trapz(uncertainty.gum_density(x, parameter), x), 0.95, places=4)

    def test_infinite_degrees_of_freedom_are_null_in_the_file(self):
        x = np.array([0.5])
        self.assertEqual(uncertainty.gum_density(x, {"value": 0.0, "u": 1.0, "dof": None})[0],
                         uncertainty.student_t_density(x, math.inf)[0])


class LeaveOneOutTest(unittest.TestCase):
    def test_moves_are_from_the_result_and_in_u(self):
        c = with_parameters(2)
        c["jackknife"] = without(c, [[0.02, -0.01], [0.0, 0.005]])
        names, by = uncertainty.moves_in_u(c)
        self.assertEqual(names, ["plate 0", "plate 1"])
        np.testing.assert_allclose(by, [[2, -1], [0, 0.5]], atol=1e-9)

    def test_no_u_is_no_move_in_u(self):
        for u in (0.0, None):
            c = with_parameters(2)
            c["parameters"][0]["u"] = u
            c["jackknife"] = without(c, [[0.02, -0.01]])
            self.assertTrue(np.isnan(uncertainty.moves_in_u(c)[1][0, 0]))
            self.assertAlmostEqual(uncertainty.moves_in_u(c)[1][0, 1], -1)
            self.assertIsNotNone(figures.draw("leave_one_out", c, EN))

    def test_an_arrow_ends_at_the_value_without_the_target(self):
        c = with_parameters(2)
        c["jackknife"] = without(c, [[0.02, -0.01], [-0.03, 0.004]])
        axes = figures.draw("leave_one_out", c, EN).axes[0]
        ends = [text.xy for text in axes.texts if text.arrow_patch and not text.get_text()]
        for tip in [(0.02, -10.0), (-0.03, 4.0)]:  # mm, mrad
            self.assertTrue(any(np.allclose(tip, end) for end in ends), f"{tip} not in {ends}")

    def test_the_region_has_the_k_of_both(self):
        c = with_parameters(2)
        c |= {"joint": {"k": 2.5, "dof": 30.0}}
        scale = np.array([1.0, 1000.0])
        region = leave_one_out_figure._region(c, scale) / scale
        distance = np.sqrt(np.einsum("ni,ij,nj->n", region, np.linalg.inv(c.covariance), region))
        np.testing.assert_allclose(distance, 2.5, rtol=1e-9)

    def test_names_of_the_targets_that_move_it_most_are_drawn(self):
        c = with_parameters(2)
        rng = np.random.default_rng(2)
        moves = 0.001 * rng.normal(size=(400, 2))
        moves[137] = [0.03, 0.02]
        c["jackknife"] = without(c, moves.tolist())
        drawing = figures.draw("leave_one_out", c, EN)
        self.assertIn("plate 137", texts(drawing))
        self.assertLess(len(style.to_svg(drawing, "x", "x", EN)), 200_000)
        self.assertIn("400", figures.caption("leave_one_out", c, EN)["left_out"])

    def test_of_many_parameters_each_names_its_worst_target(self):
        c = with_parameters(5)
        moves = np.full((4, 5), 0.001)
        moves[[0, 1, 2, 3, 0], range(5)] = [0.03, -0.02, 0.01, -0.01, 0.05]
        c["jackknife"] = without(c, moves.tolist())
        self.assertEqual(texts(figures.draw("leave_one_out", c, EN)),
                         ["plate 0", "plate 1", "plate 2", "plate 3", "plate 0"])
        self.assertIn(f"p2 {MINUS}2.00 plate 1", text_of("leave_one_out", c))

    def test_the_table_says_what_it_leaves_out(self):
        c = with_parameters(2)
        c["jackknife"] = without(c, [[0.001 * k, 0.0] for k in range(60)])
        words = text_of("leave_one_out", c)
        self.assertNotIn("plate 0 ", words)
        self.assertIn("plate 59 +0.059 +5.90 0 0.00", words)
        self.assertIn("40 of 60", words)


class BudgetTest(unittest.TestCase):
    def test_shares_of_every_parameter_add_up_however_many_sources_are_drawn_as_one(self):
        rng = np.random.default_rng(4)
        share = rng.dirichlet(np.full(20, 0.3), size=6).T
        c = with_parameters(6)
        c["budget"] = [line(f"source {k}", "AB"[k % 2], list(share[k])) for k in range(20)]
        for most in (1, 5, 20):
            rows = budget_figure.table_of_shares(c, EN, most, 0.005)
            self.assertLessEqual(len(rows), most + 1)
            np.testing.assert_allclose(np.sum([of for _, _, of in rows], axis=0), 1)

    def test_a_source_is_never_called_others(self):
        c = with_parameters(1)
        c["budget"] = [line("large", "A", [0.9999]), line("small", "B", [0.0001])]
        self.assertEqual([source for source, _, _ in budget_figure.table_of_shares(c, EN, 12, 0.005)],
                         ["large", "small"])

    def test_the_largest_share_in_any_parameter_comes_first(self):
        c = with_parameters(2)
        c["budget"] = [line("a", "A", [0.5, 0.1]), line("b", "B", [0.2, 0.9]), line("c", "A", [0.3, 0.0])]
        self.assertEqual([each["source"] for each in uncertainty.sources_by_share(c)], ["b", "a", "c"])

    def test_bars_of_a_parameter_end_at_100_percent(self):
        c = with_parameters(6)
        c["budget"] = [line("a", "A", [0.5] * 6), line("b", "B", [0.3] * 6), line("c", "A", [0.2] * 6)]
        bars = figures.draw("budget", c, EN).axes[0].patches
        for k in range(6):
            own = [bar for bar in bars if abs(bar.get_y() + bar.get_height() / 2 - k) < 0.1]
            self.assertAlmostEqual(max(bar.get_x() + bar.get_width() for bar in own), 100)
            self.assertEqual(len({bar.get_hatch() for bar in own}), 3, "told apart without colours")

    def test_angles_are_told_in_mrad(self):
        c = with_parameters(2)
        self.assertIn("u(p1) / mm", text_of("budget", c))
        self.assertRegex(text_of("budget", c), r"u\(p2\) / mrad.*Combined 0\.010 100 10 100")


class CorrelationTest(unittest.TestCase):
    def test_the_strongest_pairs_come_first_whatever_their_sign(self):
        c = with_parameters(3)
        c["correlation"] = [[1, 0.2, -0.9], [0.2, 1, 0.5], [-0.9, 0.5, 1]]
        self.assertEqual(uncertainty.strongest_pairs(c, 2), [("p1", "p3", -0.9), ("p2", "p3", 0.5)])

    def test_two_parameters_are_a_sentence(self):
        c = with_parameters(2)
        self.assertIsNone(figures.draw("correlation", c, EN))
        self.assertIn(f"The correlation of p1 and p2 is {MINUS}0.80.", text_of("correlation", c))
        self.assertIn(f"{MINUS}0,80", text_of("correlation", c, language="de"))

    def test_a_disc_has_the_area_of_the_correlation(self):
        c = with_parameters(12)
        discs = {}
        for of in figures.draw("correlation", c, EN).axes[0].lines:
            for x, y in zip(of.get_xdata(), of.get_ydata()):
                if of.get_marker() == "o":
                    discs[int(x), int(y)] = (of.get_markersize() + of.get_markeredgewidth(), of.get_color())
        whole_disc = discs[0, 0][0]
        self.assertAlmostEqual((discs[0, 1][0] / whole_disc) ** 2, 0.8, delta=0.021)
        self.assertAlmostEqual((discs[0, 2][0] / whole_disc) ** 2, 0.64, delta=0.021)
        self.assertNotEqual(discs[0, 1][1], discs[0, 2][1], "the sign is seen")
        self.assertNotIn((1, 0), discs)

    def test_the_weakest_direction_names_those_that_take_part(self):
        c = with_parameters(3)
        c["weakest"] = {"p1": -0.8, "p2": 0.1, "p3": 0.59}
        self.assertEqual(uncertainty.weakest_direction(c), [("p1", 0.8), ("p3", -0.59)])
        self.assertIn(f"0.80 p1 {MINUS} 0.59 p3", text_of("correlation", c))


class MonteCarloTest(unittest.TestCase):
    def test_of_many_parameters_the_worst_are_drawn(self):
        c = with_parameters(9)
        shift = [0.0, 0.3, 0.1, 0.0, 0.5, 0.2, 0.4, 0.6, 0.05]
        c["montecarlo"] = trials(c, shift)
        drawn = [each["name"] for each in monte_carlo_figure._panels(c)]
        self.assertEqual(drawn, ["p8", "p5", "p7", "p2", "p6", "p3"])
        self.assertIn("9", figures.caption("monte_carlo", c, EN)["left_out"])
        titles = [axes.get_title(loc="left") for axes in figures.draw("monte_carlo", c, DE).axes]
        self.assertIn("p8: nicht bestanden", titles)

    def test_the_histogram_is_a_density(self):
        c = with_parameters(2)
        c["montecarlo"] = trials(c, [0.0, 0.0])
        for axes, density in zip(figures.draw("monte_carlo", c, EN).axes[:2], (1.0, 1000.0)):  # mm, mrad
            heights, edges, _ = axes.patches[0].get_data()
            self.assertAlmostEqual(float(np.sum(heights * np.diff(edges))), 1)
            x, y = axes.lines[0].get_data()
            self.assertAlmostEqual(float(np.trapz(y, x)), 1, delta=1e-3)
            self.assertAlmostEqual(edges[-1] - edges[0], 0.08 * density)

    def test_both_intervals_stand_at_their_ends(self):
        c = with_parameters(1)
        c["montecarlo"] = trials(c, [0.5])
        strip = figures.draw("monte_carlo", c, EN).axes[1]
        brackets = [of.get_xdata() for of in strip.lines if np.ptp(of.get_xdata()) > 0]
        np.testing.assert_allclose(sorted(map(tuple, brackets)),
                                   [(100 - 0.0204, 100 + 0.0204), (100.005 - 0.0196, 100.005 + 0.0196)])


if __name__ == "__main__":
    unittest.main()
