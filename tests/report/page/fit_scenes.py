"""Small calibrations of a turntable with methods to compare, residuals and a searched surface."""
import math
from statistics import NormalDist

import numpy as np

from synthetic import calibration


def table(columns: str, rows) -> dict:
    return {"columns": columns.split(), "units": ["mm"] * len(columns.split()), "rows": rows}


def normal_counts(total: float, limit: float = 4.0, bins: int = 32, sigma: float = 1.0) -> dict:
    """As so many normal residuals would fall, on average."""
    edges = np.linspace(-limit, limit, bins + 1)
    share = np.array([NormalDist(0, sigma).cdf(edge) for edge in edges])
    return {"from": -limit, "to": limit, "unit": "sigma", "counts": list(total * np.diff(share)),
            "below": total * share[0], "above": total * (1 - share[-1])}


def target(name: str, **changes) -> dict:
    """Two columns of cells, three profiles."""
    return {"name": name, "lags": [0.0, 1.0, 2.0, 4.0], "correlation": [1.0, 0.5, 0.2, 0.0],
            "correlation_length": 2.6, "correlation_dies_out": True, "sigma": 0.05,
            "histogram": normal_counts(1000.0),
            "cells": table("alpha_from alpha_to z_from z_to residual points",
                           [[0.0, 0.1, -50, 0, 0.01, 100], [0.1, 0.2, -50, 0, -0.02, 300],
                            [0.0, 0.2, 0, 50, 0.03, 50]]),
            "sweep": table("alpha residual u", [[0.05, 0.01, 0.004], [0.10, -0.01, 0.004],
                                                 [0.15, 0.002, 0.004]]),
            "time": table("time alpha residual u", [[0, 0.05, 0.01, 0.004], [1, 0.15, 0.002, 0.004],
                                                    [2, 0.10, -0.01, 0.004]]),
            "sweep_correlation": table("lag correlation", [[0, 1.0], [1, -0.2], [2, 0.1]])} | changes


def scanned(count: int = 2, **changes):
    names = [f"plate {k}" for k in range(count)]
    summaries = [{"name": name, "points": 1000, "missing": 0, "set_aside": 0, "rms": 0.05 + 0.001 * k}
                 for k, name in enumerate(names)]
    return calibration(targets=summaries, residuals={"targets": [target(name) for name in names]}, **changes)


def bowl(M: np.ndarray, N: np.ndarray, scale: float = 1.0) -> dict:
    return table("M N S", [[m, n, 0.05 + scale * 1e-3 * ((m - 123) ** 2 + (n - 409) ** 2)] for m in M
                           for n in N])


def searched(**changes):
    surfaces = {"search": bowl(np.arange(110, 131.0), np.arange(395, 426.0)),
                "near": bowl(np.linspace(122.9, 123.1, 11), np.linspace(408.9, 409.1, 11))}
    return calibration(surface=surfaces | changes)


def row(method: str, note: str = "", **cells) -> dict:
    """A cell is a value, or value and u."""
    pairs = {column: cell if isinstance(cell, tuple) else (cell, None) for column, cell in cells.items()}
    return {"method": method, "note": note, "cells": [{"column": column, "value": value, "u": u}
                                                      for column, (value, u) in pairs.items()]}


def turntable_row(method: str, M, N, step=None, tilt=0.0, **more) -> dict:
    u = [cell[1] if isinstance(cell, tuple) else None for cell in (M, N)]
    return row(method, **{"M/mm": M, "N/mm": N, "tilt_x/mrad": tilt, "u(M)/um": u[0] and 1000 * u[0],
                          "u(N)/um": u[1] and 1000 * u[1],
                          "step/√12/um": step and 1000 * step / math.sqrt(12), **more})


METHODS = [turntable_row("grid, as published, step 1", 123.0, 409.0, step=1.0),
           row("grid, as published, step 0.01", note="left out: 6e+06 nodes"),
           turntable_row("joint, depth, weighted", (123.002, 0.005), (408.988, 0.013))]
