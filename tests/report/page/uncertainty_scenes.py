"""Calibrations of no instrument at all, with all that the sections of the uncertainty and the scene draw."""
import math

import numpy as np

from synthetic import calibration, estimated
from calibration import Calibration

FIGURES = ["budget", "correlation", "leave_one_out", "monte_carlo", "scene", "volume"]


def table(columns: str, rows) -> dict:
    return {"columns": columns.split(), "units": ["mm"] * len(columns.split()), "rows": rows}


def with_parameters(number: int, **changes) -> Calibration:
    """p1, p2, ...: 100, 101, ... with u of 0.01, lengths and angles in turn."""
    names = [f"p{k + 1}" for k in range(number)]
    parameters = [estimated(name, 100.0 + k, 0.01, ["mm", "rad"][k % 2]) for k, name in enumerate(names)]
    correlation = np.fromfunction(lambda i, j: (-0.8) ** np.abs(i - j), (number, number))
    return calibration(parameters=parameters, covariance_of=names, correlation=correlation.tolist(),
                       covariance=(1e-4 * correlation).tolist(), budget=[line("noise", "A", [1.0] * number)],
                       weakest={name: 1 / math.sqrt(number) for name in names}, **changes)


def line(source: str, kind: str, share: list[float]) -> dict:
    names = [f"p{k + 1}" for k in range(len(share))]
    contributions = [0.01 * math.sqrt(each) for each in share]
    return {"source": source, "type": kind, "value": 0.05, "unit": "mm", "dof": None, "random": kind == "A",
            "u": dict(zip(names, contributions)), "share": dict(zip(names, share))}


def without(c: Calibration, moves: list[list[float]]) -> list[dict]:
    return [{"without": f"plate {k}", "value": {p["name"]: p["value"] + by for p, by in zip(c.estimated, of)}}
            for k, of in enumerate(moves)]


def trials(c: Calibration, shift: list[float]) -> dict:
    """Normal trials whose interval lies shifted against value +- U, in u."""
    parameters = []
    for p, by in zip(c.estimated, shift):
        middle = p["value"] + by * p["u"]
        edges = middle + p["u"] * np.linspace(-4, 4, 61)
        counts = 1000 * np.exp(-np.linspace(-3.9, 3.9, 60) ** 2 / 2)
        parameters.append({"name": p["name"], "mean": middle, "u": p["u"], "low": middle - 1.96 * p["u"],
                           "high": middle + 1.96 * p["u"], "gum_low": p["value"] - p["U"],
                           "gum_high": p["value"] + p["U"], "tolerance": p["u"] / 20,
                           "verdict": "PASS" if by == 0 else "FAIL",
                           "histogram": {"edges": list(edges), "counts": list(counts)}})
    return {"trials": 10000, "failed": 0, "seed": 1, "digits": 1, "stable": True, "parameters": parameters}


def plate(name: str, x: float, distance: float) -> dict:
    """Upright, seen from a profiler that goes about the axis at a radius of 400 mm."""
    outline = [[x - 100, -distance, -50], [x + 100, -distance, -50], [x + 100, -distance, 50],
               [x - 100, -distance, 50]]
    turns = np.linspace(-0.3, 0.3, 9)
    views = [[-r * f(a) for r in (400, 500) for f in (math.sin, math.cos, lambda a: 0)] for a in turns]
    return {"name": name, "outline": table("X Y Z", outline),
            "views": table("from_X from_Y from_Z to_X to_Y to_Z", views)}


def readings(U) -> dict:
    """A volume of 5 x 5 x 5 readings in no order, U(alpha, y, z) in mm."""
    rows = [[a, y, z, -(400 + y) * math.sin(a), -(400 + y) * math.cos(a), z, U(a, y, z)]
            for z in np.linspace(-100, 100, 5) for a in np.linspace(-0.3, 0.3, 5)
            for y in np.linspace(0, 200, 5)]
    return table("alpha y z X Y Z U_max", rows)


def whole(number: int) -> Calibration:
    """With everything that any of the figures draws."""
    c = with_parameters(number, condition=12.3)
    rng = np.random.default_rng(5)
    c |= {"jackknife": without(c, 0.01 * rng.normal(size=(5, number))),
          "montecarlo": trials(c, [0.0] * number),
          "scene": {"targets": [plate("left", -50, 500), plate("right", 50, 600)]},
          "volume": readings(lambda a, y, z: 0.1 + 1e-3 * y + 1e-6 * z * z)}
    return c
