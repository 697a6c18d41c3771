#!/usr/bin/env python3
"""Do twelve calibrations with 40 poses each, none of them in two, agree within their U?

    agree.py PROGRAM DATASET FOLDER [INFLUENCES]    tests/real/irb120-faro and the folder irb120-faro, or
                                                    tests/real/ur10-ipa and ipa-robot-accuracy; "gravity: estimate"

Prints how many differences of two sets' parameters lie within sqrt(U_a^2 + U_b^2), with the 95 % interval of that share
from the scatter of the sets (each set left out in turn), and how many results say that they are not reliable.
Standard library only.
"""
import itertools
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SETS, POSES = 12, 40


def parts(table: str, part: int) -> str:
    """Its header and the lines of some poses, which the first column names, or each is the pose of its number."""
    header, *lines = table.splitlines(keepends=True)
    names = [line.partition(",")[0] if header.startswith("pose,") else k for k, line in enumerate(lines)]
    kept = set(list(dict.fromkeys(names))[part::SETS][:POSES])
    return header + "".join(line for name, line in zip(names, lines) if name in kept)


def calibrate(program: str, dataset: Path, folder: Path, part: int, influences: str) -> dict:
    yaml = (dataset / "dataset.yaml").read_text().replace("check: {every: 2}\n", "")
    with tempfile.TemporaryDirectory() as scratch:
        for name in set(re.findall(r"[\w/.-]+\.csv", yaml)):
            (Path(scratch) / name).parent.mkdir(parents=True, exist_ok=True)
            (Path(scratch) / name).write_text(parts((folder.parent / name).read_text(), part))
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
    program, dataset, folder, influences = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), "".join(sys.argv[4:5])
    results = [calibrate(program, dataset, folder, part, influences) for part in range(SETS)]
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
