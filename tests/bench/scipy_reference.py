"""The joint fit as one writes it with numpy and scipy: vectorised residuals, one per point.

usage: scipy_reference.py FOLDER plane|depth

FOLDER holds start.json and the placements as .npy files with the columns angle (deg), y, z (mm). Prints the answer as
JSON. One thread, as on the other side.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # before numpy is loaded
    os.environ[name] = "1"

import json
import pathlib
import resource
import sys
import time

import numpy as np
import scipy
from scipy.optimize import least_squares

METHOD = "trf"  # the default; "lm" takes as long and stops farther from the minimum
TOLERANCE = 1e-12


class Placement:
    def __init__(self, folder, start):
        angle, self.y, self.z = np.ascontiguousarray(np.load(folder / start["file"]).T)
        self.cos, self.sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        self.normal, self.e1, self.e2 = (np.array(start[key]) for key in ("normal", "e1", "e2"))
        self.distance = start["distance"]

    def residuals(self, M, N, own, depth):
        n = self.normal + own[0] * self.e1 + own[1] * self.e2
        n /= np.linalg.norm(n)
        from_axis = N + self.y
        X = M * self.cos - from_axis * self.sin
        Y = -M * self.sin - from_axis * self.cos
        r = n[0] * X + n[1] * Y + n[2] * self.z - own[2]
        if depth:
            r /= -n[0] * self.sin - n[1] * self.cos
        return r


def resident_mb():
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def main():
    folder, depth = pathlib.Path(sys.argv[1]), sys.argv[2] == "depth"
    start = json.loads((folder / "start.json").read_text())
    placements = [Placement(folder, plane) for plane in start["planes"]]
    x0 = np.array([start["M"], start["N"]] + [v for p in placements for v in (0, 0, p.distance)])

    def residuals(x):
        return np.concatenate(
            [p.residuals(x[0], x[1], x[2 + 3 * k : 5 + 3 * k], depth) for k, p in enumerate(placements)]
        )

    before = resident_mb()
    began = time.process_time()
    fit = least_squares(
        residuals, x0, method=METHOD, x_scale="jac", ftol=TOLERANCE, xtol=TOLERANCE, gtol=TOLERANCE
    )
    seconds = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6 - before
    answer = {
        "M": fit.x[0],
        "N": fit.x[1],
        "cost": 2 * fit.cost,
        "seconds": seconds,
        "peak_mb": peak,
        "calls": int(fit.nfev),
        "version": scipy.__version__,
        "method": METHOD,
    }
    print(json.dumps(answer))


main()
