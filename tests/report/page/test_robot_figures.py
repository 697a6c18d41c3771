"""Links, residuals of balls, known lengths, coverage of the poses: what is computed for them, what is drawn."""
import math
import unittest
from xml.etree import ElementTree

import numpy as np

from synthetic import calibration, estimated, text_of
import figures
import lengths
import links
import poses
import style
from figures import links as links_figure
from figures import robot_residual_map, robot_residuals
from language import Language

EN, DE = Language("en"), Language("de")
FIGURES = ["links", "robot_residuals", "robot_residual_map", "lengths", "joints", "workspace"]


def station(name: str, count: int, balls: list[str], bad: tuple[int, int] | None = None) -> dict:
    """So many poses, each of which sees all balls; residuals of 0.03 mm, that of (pose, ball) of 1 mm."""
    rows = [[0.1 * k, -0.2 * k, 400.0 + k, 20.0 * k, 300.0, len(balls), 0.03] for k in range(count)]
    seen = [[k, *([0.0, -1.0, 0.0] if (k, b) == bad else [0.03 * (-1) ** (k + b), 0.0, 0.0])]
            for k in range(count) for b in range(len(balls))]
    return {"name": name, "poses": {"columns": ["q1", "q2", "x", "y", "z", "balls", "rms"], "rows": rows,
                                    "names": [f"{name}-{k}" for k in range(count)]},
            "balls": {"columns": ["pose", "x", "y", "z"], "rows": seen, "names": balls * count}}


def robot(stations: list[dict], **changes):
    scene = {"targets": [{"name": each["name"], "outline": {
        "columns": ["X", "Y", "Z"], "rows": [[500, 0, 0], [600, 50, 10]], "names": ["b1", "b2"]}} for each in stations]}
    held = {"name": "d_1", "unit": "mm", "role": "hold", "value": 0.0, "u": 0.0, "nominal": 400.0}
    found = {"model": "robot-ball", "residual": "ball centre", "scene": scene, "residuals": {"targets": stations},
             "parameters": [held, estimated("a_1", 0.213, 0.063, nominal=25.0, prior=0.0, prior_u=0.5),
                            estimated("alpha_1", 8.2e-5, 6.4e-5, "rad", nominal=-math.pi / 2)],
             "determined": {"d_1": "held", "a_1": "prior", "alpha_1": "data"},
             "check": {"names": ["long", "short", "none"], "u": [0.002, None, 0.002],
                       "before": {"errors": [0.5, -0.4, None]}, "after": {"errors": [-0.01, 0.03, None]}}}
    return calibration(**(found | changes))


def drawn(name: str, c, t=EN) -> str:
    figure = figures.draw(name, c, t)
    return "" if figure is None else style.to_svg(figure, name, name, t)


def texts_in(svg: str) -> list[str]:
    return [text.text for text in ElementTree.fromstring(svg).iter("text")]


class LinksTest(unittest.TestCase):
    def test_errors_in_the_units_of_the_figure(self):
        held, a, alpha = links.link_errors(robot([]))
        self.assertEqual((held.kind, held.U, held.link), ("held", 0.0, 1))
        self.assertEqual((a.kind, a.unit, a.value, a.prior_u), ("prior", "mm", 0.213, 0.5))
        self.assertAlmostEqual(a.prior_U, 0.5 * 2.04)
        self.assertEqual((alpha.kind, alpha.unit), ("data", "mrad"))
        self.assertAlmostEqual(alpha.value, 0.082)
        self.assertAlmostEqual(alpha.U, 2.04 * 0.064)

    def test_table(self):
        shown = text_of("links", robot([]))
        self.assertIn("a_1 25 mm 0.213(63) mm 0.13 mm 2.04 25.213(63) mm mostly the prior prior u = 0.50 mm", shown)
        self.assertIn("alpha_1 −90° 0.082(64) mrad 0.13 mrad 2.04 −89.9953(37)° data", shown)
        self.assertIn("Held at their nominal numbers: d_1.", shown)
        self.assertNotIn("d_1 400 mm", shown)  # a row would say nothing
        self.assertIn("0,213(63) mm", text_of("links", robot([]), language="de"))

    def test_without_nominal_numbers(self):
        shown = text_of("links", robot([], parameters=[estimated("theta_2", 1e-3, 1e-4, "rad")], determined=None))
        self.assertNotIn("Nominal ", shown)
        self.assertIn("theta_2 1.00(10) mrad", shown)

    def test_a_number_that_is_not_known_is_none(self):
        unknown = estimated("a_1", 0.0, 1.0, nominal=25.0) | {"value": None, "u": None, "U": None}
        c = robot([], parameters=[unknown, estimated("a_2", 0.1, 0.01)])
        self.assertIn("a_1 25 mm – mm – mm 2.04 – mm mostly the prior", text_of("links", c))
        self.assertIn("a_1", texts_in(drawn("links", c)))

    def test_hand_eye(self):
        numbers = [estimated(f"hand_eye_{axis}", 0.5, 0.01, "rad" if "r" in axis else "mm")
                   for axis in ("x", "y", "z", "rx", "ry", "rz")]
        matrix = [[0.0, 1.0, 0.0, 1.31907], [1.0, 0.0, -1e-9, 0.5], [0.0, 0.0, -1.0, 264.0], [0.0, 0.0, 0.0, 1.0]]
        shown = text_of("links", robot([], parameters=numbers, hand_eye=matrix))
        self.assertIn("0.0000000 1.0000000 0.0000000 1.3191 1.0000000 0.0000000 0.0000000 0.5000", shown)
        self.assertIn("translation / mm 0.500(10) 0.500(10) 0.500(10)", shown)
        damaged = text_of("links", robot([], parameters=numbers, hand_eye=[[None] * 4] * 4))
        self.assertNotIn("1.3191", damaged)

    def test_what_was_held_is_left_out_of_many(self):
        many = [{"name": f"theta_{k}", "unit": "rad", "role": "hold", "value": 0.0, "u": 0.0} for k in range(60)]
        c = robot([], parameters=many + [estimated("theta_99", 1e-3, 1e-4, "rad")])
        self.assertIn("theta_99", texts_in(drawn("links", c)))
        self.assertNotIn("theta_7", texts_in(drawn("links", c)))
        self.assertIn(EN("figure.links.no_held"), links_figure.caption(c, EN)["notes"])
        self.assertEqual(links_figure.caption(robot([]), EN)["notes"], "")

    def test_an_endless_interval_does_not_hide_the_others(self):
        several = [estimated(f"a_{k}", 0.1, 0.01) for k in range(6)]
        c = robot([], parameters=several + [estimated("a_7", 50.0, 400.0)])
        self.assertEqual(links_figure.caption(c, EN)["notes"], EN("figure.links.cut"))
        widest = figures.draw("links", c, EN).axes[0].get_xlim()
        self.assertLess(max(widest), 1)


class ResidualsTest(unittest.TestCase):
    def test_the_longest_is_named(self):
        c = robot([station("s1", 4, ["b1", "b2"]), station("s2", 4, ["b1", "b2"], bad=(2, 1))])
        caption = EN("figure.robot_residuals.caption", **robot_residuals.caption(c, EN))
        self.assertIn("1.0 mm: ball b2 in pose s2-2, station s2", caption)
        self.assertIn("pose s2-2, ball b2", texts_in(drawn("robot_residuals", c)))
        self.assertIn("Kugel b2 in Pose s2-2", str(robot_residuals.caption(c, DE)))

    def test_of_many_stations_the_worst_are_drawn(self):
        c = robot([station(f"s{k}", 3, ["b1", "b2"], bad=(0, 0) if k == 77 else None) for k in range(100)])
        shown = texts_in(drawn("robot_residuals", c))
        self.assertIn("s77", shown)
        self.assertEqual(len([text for text in shown if text.startswith("s")]), robot_residuals.MOST_STATIONS)
        self.assertIn("Of 100 places the 10 with", robot_residuals.caption(c, EN)["notes"])
        self.assertIn("The 300 poses are folded", robot_residual_map.caption(c, EN)["notes"])
        self.assertLess(len(drawn("robot_residual_map", c)), 60_000)

    def test_folding_keeps_the_longest(self):
        size = np.full((3, 306), np.nan)
        size[1, 203] = 7.0
        folded, each = robot_residual_map._largest_of(size, 240)
        self.assertEqual((folded.shape, each), ((3, 153), 2))  # evenly: the axis counts poses
        self.assertEqual(folded[1, 101], 7.0)
        self.assertEqual(np.isfinite(folded).sum(), 1)
        self.assertEqual(robot_residual_map._largest_of(size, 400)[1], 1)

    def test_a_row_of_the_map_for_every_ball_in_the_order_of_the_artifact(self):
        c = robot([station("s1", 3, ["b2", "b1", "b10"])])
        self.assertEqual([text for text in texts_in(drawn("robot_residual_map", c)) if text.startswith("b")][:3],
                         ["b1", "b2", "b10"])

    def test_one_ball_on_the_flange(self):
        one = station("front", 3, [""])
        del one["balls"]["names"], one["poses"]["names"]
        one["poses"]["columns"][5] = "socket"
        one["poses"]["rows"] = [row[:5] + [k % 2, 0.03] for k, row in enumerate(one["poses"]["rows"])]
        c = robot([one], model="flange-ball")
        self.assertEqual(drawn("robot_residual_map", c), "")
        self.assertEqual(poses.stations(c)[0].ball_of, ["1", "2", "1"])
        self.assertIn("in socket", robot_residuals.caption(c, EN)["where"])
        self.assertIn("pose 1, socket 1", texts_in(drawn("robot_residuals", c)))


class LengthsTest(unittest.TestCase):
    def test_table(self):
        shown = text_of("lengths", robot([]))
        self.assertIn("long 0.0020 +0.5000 −0.0100 short – −0.4000 +0.0300 none 0.0020 – –", shown)
        self.assertIn("mean of the sizes 0.450 0.0200 largest size 0.500 0.0300", shown)

    def test_of_many_the_worst(self):
        errors = [0.004 * k for k in range(500)]
        check = {"names": [f"l{k}" for k in range(500)], "before": {"errors": errors[::-1]},
                 "after": {"errors": [-error for error in errors]}}
        c = robot([], check=check)
        self.assertEqual([each.name for each in lengths.worst(lengths.known_lengths(c), 2)], ["l498", "l499"])
        shown = text_of("lengths", c)
        self.assertIn("Of 500 lengths the 60 with", shown)
        self.assertIn("mean of the sizes 0.998 0.998", shown)
        self.assertNotIn("l3 ", shown)

    def test_without_a_check_there_is_no_section(self):
        for check in (None, {}, {"before": None, "after": {"errors": []}, "names": []}):
            self.assertEqual(text_of("lengths", robot([], check=check)), "")


class CoverageTest(unittest.TestCase):
    def test_ranges_and_gaps_of_the_joints(self):
        c = robot([station("s1", 4, ["b1", "b2"])])
        self.assertIn("0° to 17°, gap 6°", texts_in(drawn("joints", c)))
        self.assertIn("−34° bis 0°, Lücke 11°", texts_in(drawn("joints", c, DE)))

    def test_without_joints_the_flange_is_drawn(self):
        given = station("s1", 4, ["b1", "b2"])
        given["poses"]["columns"] = given["poses"]["columns"][2:]
        given["poses"]["rows"] = [row[2:] for row in given["poses"]["rows"]]
        c = robot([given])
        self.assertEqual(drawn("joints", c), "")
        self.assertIn("s1", texts_in(drawn("workspace", c)))


class AllFiguresTest(unittest.TestCase):
    def test_nothing_is_drawn_of_nothing(self):
        bare = robot([], parameters=[], check=None, scene=None, residuals=None, determined=None)
        for c in (bare, calibration(), calibration(residuals={"targets": [{"name": "x", "poses": None}]})):
            for name in FIGURES:
                self.assertEqual(drawn(name, c), "", name)

    def test_odd_tables(self):
        """Poses that saw nothing, residuals that are no numbers, joints of which some are missing."""
        odd = station("s1", 3, ["b1", "b2"])
        odd["balls"]["rows"][0][1] = None
        odd["poses"]["rows"][1][0] = None
        empty = station("s2", 3, ["b1", "b2"]) | {"balls": {"columns": [], "rows": []}}
        for name in FIGURES:
            self.assertTrue(drawn(name, robot([odd, empty])), name)


if __name__ == "__main__":
    unittest.main()
