#!/usr/bin/env python3
"""Do twelve calibrations with 40 poses each, none of them in two, agree within their U?

    agree.py PROGRAM FOLDER [INFLUENCES]    FOLDER: irb120-faro; INFLUENCES: "gravity: estimate"

Prints how many differences of two sets' parameters lie within sqrt(U_a^2 + U_b^2), with the 95 % interval of that share
from the scatter of the sets (each set left out in turn), and how many results say that they are not reliable.
Standard library only.
"""
import csv
import itertools
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

SETS, POSES = 12, 40


def rows(file: Path) -> list[list[str]]:
    with open(file, newline="") as f:
        return list(csv.reader(f))


def calibrate(program: str, folder: Path, part: int, influences: str) -> dict:
    here = Path(__file__).parent
    joints, points = rows(folder / "joints.csv"), rows(folder / "points.csv")
    kept = joints[1:][part::SETS][:POSES]
    names = {row[0] for row in kept}
    with tempfile.TemporaryDirectory() as scratch:
        data = Path(scratch) / "irb120-faro"
        data.mkdir()
        for name, table in (("joints.csv", [joints[0]] + kept),
                            ("points.csv", [points[0]] + [row for row in points[1:] if row[0] in names])):
            with open(data / name, "w", newline="") as f:
                csv.writer(f).writerows(table)
        yaml = (here / "dataset.yaml").read_text().replace("check: {every: 2}\n", "")
        (Path(scratch) / "dataset.yaml").write_text(yaml + (f"influences: {{{influences}}}\n" if influences else ""))
        run = subprocess.run([program, "refine", scratch, f"--out={scratch}/out"], capture_output=True, text=True)
        if run.returncode == 1:
            sys.exit(run.stderr)
        return json.loads((Path(scratch) / "out" / "calibration.json").read_text())


def share(sets: list[dict], names: list[str]) -> float:
    within = [abs(a[n]["value"] - b[n]["value"]) <= math.hypot(a[n]["U"], b[n]["U"])
              for a, b in itertools.combinations(sets, 2) for n in names]
    return sum(within) / len(within)


def main() -> None:
    program, folder, influences = sys.argv[1], Path(sys.argv[2]), "".join(sys.argv[3:4])
    results = [calibrate(program, folder, part, influences) for part in range(SETS)]
    sets = [{p["name"]: p for p in result["parameters"] if p["role"] == "estimate"} for result in results]
    names = sorted(set.intersection(*(set(each) for each in sets)))
    whole = share(sets, names)
    without = [share(sets[:k] + sets[k + 1:], names) for k in range(SETS)]
    u = math.sqrt((SETS - 1) / SETS * sum((each - whole) ** 2 for each in without))
    unreliable = sum(result["status"] != "ok" for result in results)
    print(f"{100 * whole:.1f} % of the differences of {len(names)} parameters lie within their U (95 % interval of the "
          f"share: {100 * (whole - 2.2 * u):.1f} to {100 * min(1.0, whole + 2.2 * u):.1f} %); "
          f"{unreliable} of {SETS} results are unreliable")


if __name__ == "__main__":
    main()
