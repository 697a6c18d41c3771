"""grid_study.py PROGRAM SETS: how far the published grid search and the refinement end from the truth, as a table.

Simulated data sets of four placements; M and N anywhere between the nodes of the grid, tilts of some tenths of a degree.
See scripts/grid_study.
"""

import json
import math
import random
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

STEPS = "1,0.1,0.01"
METHODS = ("grid, as published", "joint, depth, weighted, tilts")


def run(*arguments):
    return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout


def value(cell):
    """123.456(78) or 123.456."""
    return float(cell.split("(")[0])


def compare(program, folder):
    """Method to (M, N in mm, seconds)."""
    lines = run(program, "compare", str(folder), f"--steps={STEPS}").splitlines()
    rows = [re.split(r"  +", line) for line in lines if line.startswith(METHODS)]
    return {cells[0]: (value(cells[1]), value(cells[2]), float(cells[-1])) for cells in rows}


def study(program, sets):
    """Per method: errors of M and N in mm, seconds."""
    found = {}
    with tempfile.TemporaryDirectory() as scratch:
        for seed in range(1, sets + 1):
            folder = Path(scratch) / "data"
            draw = random.Random(seed)
            run(program, "simulate", f"--out={folder}", f"--seed={seed}", "--placements=4", "--format=npy",
                f"--M={123 + draw.uniform(-0.5, 0.5)}", f"--N={409 + draw.uniform(-0.5, 0.5)}",
                f"--tilt_x={draw.gauss(0, 0.4)}", f"--tilt_y={draw.gauss(0, 0.4)}")
            truth = json.loads((folder / "truth.json").read_text())
            for method, (m, n, seconds) in compare(program, folder).items():
                found.setdefault(method, []).append((m - truth["M"], n - truth["N"], seconds))
            print(f"\r{seed} of {sets} data sets", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return found


def main():
    program, sets = sys.argv[1], int(sys.argv[2])
    print("| method | bias of M, mm | bias of N, mm | rms error of M, mm | rms error of N, mm | seconds, the least |")
    print("| --- | --- | --- | --- | --- | --- |")
    for method, rows in study(program, sets).items():
        cells = []
        for errors in list(zip(*rows))[:2]:
            cells.append(f"{statistics.fmean(errors):+.4f} ± {statistics.stdev(errors) / math.sqrt(sets):.4f}")
        cells += [f"{math.sqrt(statistics.fmean(e * e for e in errors)):.4f}" for errors in list(zip(*rows))[:2]]
        print(f"| {method} | {' | '.join(cells)} | {min(row[2] for row in rows):.3f} |")


main()
