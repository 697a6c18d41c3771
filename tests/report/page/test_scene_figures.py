"""Scene and volume, and names beside what they name: what is computed for them, and what is drawn of what."""
import math
import unittest

import numpy as np

from synthetic import calibration, text_of
from uncertainty_scenes import plate, readings, table
import arm
import figures
import labels
import oblique
import pages
import poses
import scene
import style
import volume
from calibration import read_calibration
from language import Language

EN, DE = Language("en"), Language("de")


def texts(drawing) -> list[str]:
    return [text.get_text() for axes in drawing.axes for text in axes.texts]


class LabelsTest(unittest.TestCase):
    def placed(self, points, names, **more):
        figure, axes = style.new_figure(3)
        axes.set_xlim(0, 1)
        axes.set_ylim(0, 1)
        found = labels.place_labels(axes, points, names, **more)
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in axes.texts if text.get_text()]
        style.pyplot.close(figure)
        return axes, found, boxes

    def assert_apart(self, boxes):
        for k, box in enumerate(boxes):
            for other in boxes[:k]:
                self.assertFalse(box.overlaps(other), f"{box} {other}")

    def test_no_name_lies_on_another_on_a_point_or_outside(self):
        rng = np.random.default_rng(1)
        points = rng.uniform(0.02, 0.98, size=(30, 2))
        axes, found, boxes = self.placed(points, [f"placement {k}" for k in range(30)])
        self.assertGreater(len(found), 20)
        self.assertEqual(len(boxes), len(found))
        self.assert_apart(boxes)
        inside = axes.get_window_extent()
        for box in boxes:
            self.assertTrue(inside.x0 <= box.x0 and box.x1 <= inside.x1 and inside.y0 <= box.y0
                            and box.y1 <= inside.y1)
            for x, y in axes.transData.transform(points):
                self.assertFalse(box.x0 < x < box.x1 and box.y0 < y < box.y1)

    def test_no_corner_draws_a_name_outside(self):
        for corner, direction in (((0, 0), 225), ((1, 0), 315), ((0, 1), 135), ((1, 1), 45)):
            axes, found, boxes = self.placed([corner], ["name"], directions=[direction])
            self.assertEqual(found, [0])
            self.assertTrue((boxes[0].min >= axes.get_window_extent().min).all())
            self.assertTrue((boxes[0].max <= axes.get_window_extent().max).all())

    def test_names_of_one_point_spread(self):
        _, found, boxes = self.placed([(0.5, 0.5)] * 4, ["the same place"] * 4)
        self.assertEqual(len(found), 4)
        self.assert_apart(boxes)

    def test_a_name_keeps_off_a_line(self):
        across = labels.along((0, 0.5), (1, 0.5), 400)
        axes, found, boxes = self.placed([(0.5, 0.5)], ["name"], obstacles=across)
        self.assertEqual(found, [0])
        y = axes.transData.transform((0.5, 0.5))[1]
        self.assertFalse(boxes[0].y0 < y < boxes[0].y1)

    def test_what_finds_no_room_is_left_out(self):
        full = np.stack(np.meshgrid(np.linspace(0, 1, 150), np.linspace(0, 1, 150)), axis=-1).reshape(-1, 2)
        axes, found, _ = self.placed([(0.5, 0.5)], ["name"], obstacles=full)
        self.assertEqual((found, [text.get_text() for text in axes.texts]), ([], []))


class SceneTest(unittest.TestCase):
    def test_both_views_have_one_scale(self):
        for model, second in (("turntable", plate("b", 300, 900)), ("robot-ball", plate("b", -700, -900))):
            c = calibration(model=model, scene={"targets": [plate("a", 0, 500), second]})
            drawing = figures.draw("scene", c, EN)
            scales = []
            for axes in drawing.axes:
                box = axes.get_window_extent()
                scales += [box.width / np.ptp(axes.get_xlim()), box.height / np.ptp(axes.get_ylim())]
            np.testing.assert_allclose(scales, scales[0], rtol=1e-6)

    def test_a_point_keeps_its_distance_from_the_axis(self):
        np.testing.assert_allclose(scene.beside_axis(np.array([[3.0, -4.0, 7.0]])), [[5, 7]])

    def test_an_edge_is_bent_beside_the_axis(self):
        line = scene.beside_axis(scene.closed(np.array([[-3.0, 4, 0], [3, 4, 0], [3, 4, 1], [-3, 4, 1]]), 10))
        self.assertAlmostEqual(line[:, 0].min(), 4)
        self.assertAlmostEqual(line[:, 0].max(), 5)

    def test_everything_is_named(self):
        c = calibration(scene={"targets": [plate("left", -100, 500), plate("right", 300, 700)]})
        for language, words in ((EN, {"axis", "profiler"}), (DE, {"Achse", "Profilsensor"})):
            self.assertLessEqual({"left", "right"} | words, set(texts(figures.draw("scene", c, language))))

    def test_thinning_keeps_both_ends(self):
        self.assertEqual(list(scene.thinned(100, 3)), [0, 50, 99])
        self.assertEqual(list(scene.thinned(2, 9)), [0, 1])
        self.assertEqual(list(scene.thinned(0, 9)), [])

    def test_many_targets_stay_small(self):
        c = calibration(scene={"targets": [plate(f"plate {k}", 10 * k, 500 + k) for k in range(400)]})
        self.assertLess(len(style.to_svg(figures.draw("scene", c, EN), "x", "x", EN)), 400_000)
        self.assertIn("400", figures.caption("scene", c, EN)["left_out"])


class ObliqueTest(unittest.TestCase):
    def test_a_planar_arm(self):
        """Two links of 300 and 200 mm at 90 and -90 degrees: up, then along X."""
        points, flange = arm.along(np.array([[0, 50, 300, 0, 0], [0, 0, 200, 0, 0.0]]), np.radians([90, -90]))
        np.testing.assert_allclose(points, [[0, 0, 0], [0, 0, 50], [0, 300, 50], [0, 300, 50], [200, 300, 50]], atol=1e-12)
        np.testing.assert_allclose(flange[:3, :3], np.eye(3), atol=1e-12)

    def test_the_flange_is_where_the_program_has_it(self):
        c = read_calibration(pages.calibration("robot"))
        for station in poses.stations(c):
            for joints, flange in zip(station.joints, station.flange):
                np.testing.assert_allclose(arm.along(arm.links(c), joints)[1][:3, 3], flange, atol=1e-6)

    def test_a_picture_keeps_lengths_and_the_sky_above(self):
        view = oblique.view_from(0.7)
        axes = np.stack([view.right, view.up, view.towards])
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        self.assertAlmostEqual(np.linalg.det(axes), 1)  # no mirror
        self.assertGreater(view.up[2], 0)
        self.assertEqual(view.right[2], 0)

    def test_no_plane_is_seen_edge_on(self):
        points = np.array([[x, 0.0, z] for x in (-1, 0, 1) for z in (-1, 1)])
        normal = oblique.normal_of(points)
        np.testing.assert_allclose(np.abs(normal), [0, 1, 0], atol=1e-12)
        self.assertGreater(abs(normal @ oblique.best_view(points, [normal]).towards), 0.5)

    def test_where_light_meets_a_plate(self):
        square = np.array([[-1.0, 0, -2], [1, 0, -2], [1, 0, 2], [-1, 0, 2]])
        line = oblique.cut(square, np.array([0.5, 9, 0]), np.array([1.0, 0, 0]))
        np.testing.assert_allclose(sorted(line.tolist()), [[0.5, 0, -2], [0.5, 0, 2]])
        self.assertEqual(len(oblique.cut(square, np.array([5.0, 0, 0]), np.array([1.0, 0, 0]))), 0)

    def test_a_patch_holds_what_was_seen(self):
        seen = np.array([[0.0, 0, 5], [4, 0, 5], [4, 2, 5], [1, 1, 5]])
        corners = oblique.patch(seen)
        np.testing.assert_allclose(corners[:, 2], 5)
        self.assertGreaterEqual(np.linalg.norm(corners[2] - corners[0]), math.hypot(4, 2) - 1e-9)

    def test_everything_is_drawn_and_named(self):
        c = calibration(scene={"targets": [plate("left", -100, 500), plate("right", 300, 700)]})
        self.assertLessEqual({"X", "Y", "Z", "Achse", "Profilsensor", "left", "right"},
                             set(texts(figures.draw("scene_3d", c, DE))))
        self.assertIn("100", figures.caption("scene_3d", c, EN)["length"])
        self.assertIsNone(figures.draw("scene_3d", calibration(), EN))


class VolumeTest(unittest.TestCase):
    def test_the_grid_is_found_in_any_order(self):
        found = volume.of(calibration(volume=readings(lambda a, y, z: 0.1 + 0.001 * y + 0.01 * a)))
        at = found.where(found.largest)
        self.assertAlmostEqual(at["alpha"], math.degrees(0.3))
        self.assertEqual((at["y"], at["z"]), (200, -100))
        self.assertAlmostEqual(math.hypot(at["X"], at["Y"]), 600)

    def test_slices_are_across_what_matters_least(self):
        for U, sliced, number in ((lambda a, y, z: 0.1 + 0.01 * a + 1e-3 * y, 2, 1),
                                  (lambda a, y, z: 0.1 + 1e-3 * z + 1e-3 * y + 1e-2 * a, 0, 3),
                                  (lambda a, y, z: 0.1 + 1e-4 * z + 1e-3 * y + 0.3 * a * a, 2, 3)):
            c = calibration(volume=readings(U))
            found = volume.of(c)
            self.assertEqual((found.sliced, len(found.slices)), (sliced, number))
            drawing = figures.draw("volume", c, EN)
            self.assertEqual(len([axes for axes in drawing.axes if axes.get_xlabel()]), number)

    def test_what_is_the_same_everywhere_is_a_sentence(self):
        for U, words in ((lambda a, y, z: 0.1234, "It is 0.12 mm throughout"),
                         (lambda a, y, z: 0.1244 + 1e-8 * (y + 100), "It is 0.12 mm throughout"),
                         (lambda a, y, z: 0.1249 + 1e-6 * y, "It is 0.12 to 0.13 mm throughout")):
            c = calibration(volume=readings(U))
            self.assertIsNone(figures.draw("volume", c, EN))
            self.assertIn(words, text_of("volume", c).replace("\N{NO-BREAK SPACE}", " "))

    def test_where_it_is_largest_is_told(self):
        words = text_of("volume", calibration(volume=readings(lambda a, y, z: 0.1 + 1e-3 * y)), language="de")
        self.assertRegex(words.replace("\N{NO-BREAK SPACE}", " "), r"von 0,10 mm bis 0,30 mm.* y = 200 mm")

    def test_what_is_no_whole_grid_is_not_drawn(self):
        missing, unknown = readings(lambda a, y, z: 0.1), readings(lambda a, y, z: 0.1)
        missing["rows"].pop()
        unknown["rows"][3][6] = None
        for each in (missing, unknown, {}, table("q1 X Y Z U_max", [[0, 1, 2, 3, 0.1]])):
            self.assertIsNone(volume.of(calibration(volume=each)))
            self.assertEqual(text_of("volume", calibration(volume=each)), "")


if __name__ == "__main__":
    unittest.main()
