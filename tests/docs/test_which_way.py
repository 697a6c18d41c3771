"""docs/turntable.md, "Which way the scanner looks" and "Which way it turns", from plain geometry without the program's."""
import json
import math
import os
import random
import subprocess
import tempfile
import unittest
from pathlib import Path

from documents import SOURCE

PROGRAM = os.environ.get("SCANCAL_PROGRAM", str(SOURCE / "build" / "scancal"))
PLATES = [(-25, 12), (0, -8), (25, 16)]  # turned about the axis, leaning, deg
STANDOFF, NOISE = 75, 0.001  # mm


def turned(p, angle):  # about Z, counterclockwise seen from +Z
    c, s = math.cos(angle), math.sin(angle)
    return c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def scan(plate, at, looks, turn_of_scanner, reading):
    """Lines of a file: the scanner stands at `at` when the reading is 0, looks along +-Y, and turns against the plate."""
    turned_by, leaning = (math.radians(angle) for angle in PLATES[plate])
    # The plate faces the scanner, as seen where it stands when the reading is 0.
    normal = (math.sin(turned_by) * math.cos(leaning), looks * math.cos(turned_by) * math.cos(leaning), math.sin(leaning))
    middle = (at[0], at[1] + looks * STANDOFF, 0)
    draw = random.Random(plate)
    for alpha in (reading * (k / 10 - 1) for k in range(21)):
        for z in range(-100, 101, 10):
            zero = turned((at[0], at[1], z), turn_of_scanner * math.radians(alpha))
            along = turned((0, looks, 0), turn_of_scanner * math.radians(alpha))
            y = dot(normal, [m - p for m, p in zip(middle, zero)]) / dot(normal, along)
            yield f"{alpha:.6f},{y + draw.gauss(0, NOISE):.6f},{z}"


def calibrated(rotation, search, **scene):
    with tempfile.TemporaryDirectory(prefix="scancal_docs_") as folder:
        targets = []
        for plate in range(len(PLATES)):
            (Path(folder) / f"{plate}.csv").write_text("\n".join(["angle,y,z", *scan(plate, **scene)]) + "\n")
            targets.append(f"  - {{name: plate {plate}, scan: {plate}.csv}}")
        (Path(folder) / "dataset.yaml").write_text("\n".join([
            "scancal: 1", "model: turntable", "units: {length: mm, angle: deg}", f"rotation: {rotation}",
            f"search: {search}", "targets:", *targets]) + "\n")
        done = subprocess.run([PROGRAM, "refine", folder, f"--out={folder}"], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        found = json.loads((Path(folder) / "calibration.json").read_text())["parameters"]
        return {each["name"]: each["value"] for each in found}


class WhichWay(unittest.TestCase):
    def expect(self, found, M, N):
        self.assertAlmostEqual(found["M"], M, delta=0.05)
        self.assertAlmostEqual(found["N"], N, delta=0.05)

    def test_a_scanner_that_rides_on_the_table_and_looks_away(self):
        """At Y = -D, looking along -Y; clockwise is a negative turn about Z."""
        found = calibrated("clockwise", "{M: [10, 30], N: [290, 310], step: 1}",
                           at=(20, -300), looks=-1, turn_of_scanner=-1, reading=15)
        self.expect(found, M=20, N=300)

    def test_a_scanner_that_stands_and_looks_at_the_axis(self):
        """At Y = D, looking along -Y at targets on a table. They turn clockwise: against them it turns the other way."""
        scene = dict(at=(20, 300), looks=-1, reading=15)
        found = calibrated("counterclockwise", "{M: [10, 30], N: [-310, -290], step: 1}", turn_of_scanner=+1, **scene)
        self.expect(found, M=20, N=-300)

    def test_the_wrong_sense_shows_in_the_sign_of_M_alone(self):
        scene = dict(at=(20, 300), looks=-1, reading=15)
        found = calibrated("clockwise", "{M: [-30, -10], N: [-310, -290], step: 1}", turn_of_scanner=+1, **scene)
        self.expect(found, M=-20, N=-300)


if __name__ == "__main__":
    unittest.main()
