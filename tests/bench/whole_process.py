"""Whole commands, as a user waits for them, against what else one would run on the same files. See scripts/bench.

usage: whole_process.py PROGRAM FOLDER

FOLDER: for data that are simulated here. Prints a table in Markdown. Elapsed times, medians of runs that take turns,
files in the page cache; memory is the most that was resident.
"""
import os
import shutil
import statistics
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
DATA_SETS = Path(os.environ.get("SCANCAL_DATASETS", REPOSITORY.parent / "shared" / "datasets"))  # not of the project
LIDAR = DATA_SETS / "tilting-lidar" / "0_to_pos90_degree.csv"
PYTHON = sys.executable
ROUNDS = 5

LOADTXT = """
import glob, numpy
for file in sorted(glob.glob({folder!r} + "/*.csv")): numpy.loadtxt(file, delimiter=",", skiprows=1)
"""
GENFROMTXT = """
import numpy
numpy.genfromtxt({file!r}, delimiter=",")
"""
LOAD = """
import glob, numpy
for file in sorted(glob.glob({folder!r} + "/*.npy")): numpy.load(file)
"""
# What one writes without this program: point-to-plane distances of all points, planes and M, N found together.
ALTERNATIVE = """
import glob, numpy as np
from scipy.optimize import least_squares
scans = [np.loadtxt(f, delimiter=",", skiprows=1).T for f in sorted(glob.glob({folder!r} + "/*.csv"))]
scans = [(np.cos(np.radians(a)), np.sin(np.radians(a)), y, z) for a, y, z in scans]
def points(M, N, scan):
    c, s, y, z = scan
    return M * c - (N + y) * s, -M * s - (N + y) * c, z
def residuals(q):
    rest = []
    for k, scan in enumerate(scans):
        X, Y, Z = points(q[0], q[1], scan)
        theta, phi, d = q[2 + 3 * k : 5 + 3 * k]
        rest.append(np.cos(phi) * (np.cos(theta) * X + np.sin(theta) * Y) + np.sin(phi) * Z - d)
    return np.concatenate(rest)
start = [120.0, 410.0]
for scan in scans:
    P = np.array(points(*start[:2], scan))
    n = np.linalg.svd(P - P.mean(axis=1, keepdims=True), full_matrices=False)[0][:, 2]
    start += [np.arctan2(n[1], n[0]), np.arcsin(n[2]), n @ P.mean(axis=1)]
print(least_squares(residuals, start, x_scale="jac").x[:2])
"""
FIGURES = """
import io, json, sys
sys.path.insert(0, {page!r})
import style, figures
from calibration import read_calibration
from language import Language
from pathlib import Path
calibration = read_calibration(Path({file!r}))
calibration.add_figures(json.loads(Path({numbers!r}).read_text()))
language = Language("en", calibration, None)
for name in {names!r}:
    drawing = figures.draw(name, calibration, language)
    if drawing: drawing.savefig(io.StringIO(), format="svg")
"""


def run(*command: str | Path, code: str = "") -> tuple[float, float]:
    """Seconds, and MB."""
    began = time.monotonic()
    pid = os.posix_spawn(command[0], [str(each) for each in command] + (["-c", code] if code else []), os.environ,
                         file_actions=[(os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)])
    _, status, used = os.wait4(pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 2):  # 2: unreliable, as the lidar is
        sys.exit(f"{command} ended with {os.waitstatus_to_exitcode(status)}")
    return time.monotonic() - began, used.ru_maxrss * 1024 / 1e6


class Bench:
    def __init__(self, program: Path, folder: Path):
        self.program, self.folder, self.rows = program, folder, []

    def simulated(self, name: str, *flags: str) -> Path:
        run(self.program, "simulate", f"--out={self.folder / name}", "--encoder_jitter=0.002", *flags)
        return self.folder / name

    def refine(self, data: Path):
        return lambda: run(self.program, "refine", data, f"--out={self.folder / 'out'}")

    def compare(self, what: str, ours, other, at_most: float = 0, rounds: int = ROUNDS) -> None:
        """Two commands in turn."""
        print(f"bench: {what}", file=sys.stderr)
        runs = [(ours(), other()) for _ in range(rounds)]
        seconds = [statistics.median(pair[side][0] for pair in runs) for side in (0, 1)]
        memory = [max(pair[side][1] for pair in runs) for side in (0, 1)]
        ratio = seconds[0] / seconds[1]
        claim = f"at most {at_most:g}" if at_most else ""
        self.rows.append((what, *(f"{s:.3g} s, {mb:.0f} MB" for s, mb in zip(seconds, memory)), f"{ratio:.3g}", claim,
                          ("yes" if ratio <= at_most else "NO") if at_most else ""))

    def limit(self, what: str, found: float, unit: str, at_most: float) -> None:
        self.rows.append((what, f"{found:.4g} {unit}", "", "", f"at most {at_most:g} {unit}",
                          "yes" if found <= at_most else "NO"))

    def print(self) -> None:
        print("| what | ours | other | ratio | claim | holds |\n| --- | --- | --- | --- | --- | --- |")
        for row in self.rows:
            print("| " + " | ".join(row) + " |")


def python(code: str):
    return lambda: run(PYTHON, code=code)


def main(program: str, folder: str) -> None:
    bench = Bench(Path(program).resolve(), Path(folder).resolve())
    small = bench.simulated("small", "--profiles=500", "--points=400")
    large = bench.simulated("large", "--profiles=500", "--points=2000")
    for data, points, at_most in ((small, "600,000", 1.5), (large, "3 million", 1)):
        bench.compare(f"refine, {points} points in 1500 profiles, CSV; other: numpy.loadtxt of the same files",
                      bench.refine(data), python(LOADTXT.format(folder=str(data))), at_most)
    try:
        import scipy.optimize as _
        bench.compare("... other: numpy and scipy least_squares, point to plane, without any uncertainty",
                      bench.refine(small), python(ALTERNATIVE.format(folder=str(small))), rounds=1)
    except ModuleNotFoundError:
        print("bench: NO COMPARISON WITH SCIPY: it is not installed", file=sys.stderr)
    huge = bench.simulated("huge", "--profiles=500", "--points=8000", "--format=npy")
    bench.compare("refine, 12 million points in 1500 profiles, .npy; other: numpy.load", bench.refine(huge),
                  python(LOAD.format(folder=str(huge))), rounds=3)
    bench.limit("... memory", bench.refine(huge)()[1], "MB", 150)
    many = [bench.simulated(f"profiles_{n}", f"--profiles={n}", "--points=20") for n in (1000, 4000)]
    bench.compare("refine, 12,000 profiles of 20 points; other: 3,000 of them; linear", bench.refine(many[1]),
                  bench.refine(many[0]), 5)
    if LIDAR.exists():
        data = bench.folder / "lidar"
        data.mkdir()
        shutil.copy(REPOSITORY / "tests/real/tilting-lidar/dataset.yaml", data)
        (data / LIDAR.name).symlink_to(LIDAR)
        bench.compare("refine of a lidar's scan; other: numpy.genfromtxt of its file", bench.refine(data),
                      python(GENFROMTXT.format(file=str(LIDAR))), 1.5)
    else:
        print(f"bench: NO DATA: {LIDAR} is not there", file=sys.stderr)

    sample, out = REPOSITORY / "data/sample", bench.folder / "sample"
    bench.compare("compare of the sample; other: its refine",
                  lambda: run(bench.program, "compare", sample), bench.refine(sample), 3)
    run(bench.program, "refine", sample, f"--out={out}")
    calibration, page, numbers = out / "calibration.json", out / "page.html", out / "figures.json"
    bench.limit("calibration.json of the sample", calibration.stat().st_size / 1e3, "kB", 400)
    html = ("report", calibration, f"--out={page}")
    run(bench.program, *html)  # also makes what later reports keep
    run(bench.program, "report", calibration, f"--figures={numbers}")
    drawn = [part.split('"')[0].removeprefix("figure-")
             for part in page.read_text().split('id="') if part.startswith("figure-")]
    drawing = FIGURES.format(page=str(REPOSITORY / "report/page"), file=str(calibration), numbers=str(numbers),
                             names=drawn)
    bench.compare(f"report of the sample, HTML; other: Matplotlib alone draws the same {len(drawn)} figures",
                  lambda: run(bench.program, *html), python(drawing), 1.3)
    bench.compare("... with PDF; other: the HTML", lambda: run(bench.program, *html, f"--pdf={out / 'page.pdf'}"),
                  lambda: run(bench.program, *html), 3)
    bench.print()


if __name__ == "__main__":
    main(*sys.argv[1:])
