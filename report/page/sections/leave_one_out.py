"""Leaving one target out, as the table shows it."""
import math

import numpy as np

from calibration import Calibration
from notation import MINUS, to_last_digit_of
from uncertainty import FEW_PARAMETERS, axis_unit, known, moves, moves_in_u

MOST_ROWS, MOST_PARAMETERS = 40, 10


def content(c: Calibration, previous, t) -> dict[str, object]:
    names, in_u = moves_in_u(c)
    few = len(c.estimated) <= FEW_PARAMETERS
    rows = (_by_target if few else _by_parameter)(c, t) if np.isfinite(in_u).any() else []
    return {"few": few, "number": len(names), "rows": rows, "units": [axis_unit(p)[1] for p in c.estimated]}


def _by_target(c: Calibration, t) -> list[tuple[str, list[tuple[str, str]]]]:
    """In the order of the file; of many those that move something most."""
    (names, by), (_, in_u) = moves(c), moves_in_u(c)
    largest = np.argsort(-np.max(np.nan_to_num(np.abs(in_u)), axis=1), kind="stable")[:MOST_ROWS]
    return [(names[k], [(t.number(_move(by[k, i], p)), t.number(_in_u(in_u[k, i])))
                        for i, p in enumerate(c.estimated)]) for k in sorted(largest)]


def _move(by: float, parameter: dict) -> str:
    factor, _ = axis_unit(parameter)
    return _signed(to_last_digit_of(factor * known(parameter.get("u")), factor * by))


def _by_parameter(c: Calibration, t) -> list[tuple[str, str, str, str]]:
    names, in_u = moves_in_u(c)
    rows = []
    for p, of in zip(c.estimated, in_u.T):
        if np.isfinite(of).any():
            most = int(np.nanargmax(np.abs(of)))
            rows.append((p["name"], t.number(_in_u(of[most])), names[most],
                         t.number(f"{math.sqrt(float(np.nanmean(of**2))):.2f}"), float(np.nanmax(np.abs(of)))))
    farthest = sorted(rows, key=lambda row: -row[-1])[:MOST_PARAMETERS]
    return [row[:-1] for row in rows if row in farthest]


def _in_u(by: float) -> str:
    return _signed(f"{by:.2f}".replace("-", MINUS)) if math.isfinite(by) else "–"


def _signed(number: str) -> str:
    return number if number[0] in f"{MINUS}–∞" or not number.strip("0.") else "+" + number
