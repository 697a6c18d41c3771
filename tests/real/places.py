#!/usr/bin/env python3
"""An arm with a ball on its flange: each place of the tool left out once, calibrated with the others.

    places.py PROGRAM DATASET FOLDER [INFLUENCES]    tests/real/mukca-panda/panda_1.yaml, the folder mukca-panda/panda_3
                                                     with a folder a place; "gravity: estimate"

Prints how far the ball strays in its sockets at the place that took no part, mm, the status, and the mean over the
places. Standard library only.
"""
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def without(program: str, yaml: str, places: list[Path], out: Path, influences: str) -> tuple[float, dict]:
    def lines(some: list[Path]) -> str:
        return "".join(f"  - {{name: {p.name}, sockets: [{p / 'hole_0.csv'}, {p / 'hole_1.csv'}]}}\n" for p in some)

    told = f"targets:\n{lines([p for p in places if p != out])}check:\n{lines([out])}"
    yaml = re.sub(r"targets:\n(  - .*\n)+check:\n(  - .*\n)+", lambda _: told, yaml)
    yaml += f"influences: {{{influences}}}\n" if influences else ""
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "dataset.yaml").write_text(yaml)
        refined = subprocess.run([program, "refine", scratch, f"--out={scratch}/out"], capture_output=True, text=True)
        compared = subprocess.run([program, "compare", scratch], capture_output=True, text=True)
        if refined.returncode == 1 or compared.returncode == 1:
            sys.exit(refined.stderr + compared.stderr)
        stray = float(re.findall(r"^refined +\S+ +(\S+)", compared.stdout, re.M)[0])  # where calibrated, held out
        return stray, json.loads((Path(scratch) / "out" / "calibration.json").read_text())


def main() -> None:
    program, yaml, folder, influences = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), "".join(sys.argv[4:5])
    places = sorted(path.parent.resolve() for path in folder.glob("*/hole_0.csv"))
    strays = []
    for out in places:
        stray, result = without(program, yaml.read_text(), places, out, influences)
        strays.append(stray)
        print(f"{out.name}: {stray:.3f} mm, {result['status']}")
    print(f"mean: {sum(strays) / len(strays):.3f} mm")


if __name__ == "__main__":
    main()
