"""Errors of the links as a table: nominal and calibrated number, error, what determines it; the hand-eye."""
import math

import links
from calibration import Calibration
from notation import MINUS, concise, significant

_DEGREES = 180 / math.pi  # of a radian


def content(c: Calibration, previous, t) -> dict[str, object]:
    errors = links.link_errors(c)
    shown = [error for error in errors if error.kind != "held" or error.value]
    held = [error.name for error in errors if error not in shown]
    return {"rows": [_row(error, t) for error in shown], "held": ", ".join(held),
            "has_nominal": any(error.nominal is not None for error in errors),
            "matrix": _matrix(c, t), "numbers": _hand_eye(c)}


def _row(error: links.LinkError, t) -> dict[str, str]:
    estimated = error.kind in ("data", "prior")
    nominal, calibrated = _numbers(error)
    return {"name": error.name, "kind": error.kind, "nominal": t.number(nominal),
            "calibrated": t.number(calibrated), "error": t.number(_written(error.value, error.u)) + " " + error.unit,
            "U": t.number(significant(error.U or None, 2)) + " " + error.unit if estimated else "",
            "k": t.number(significant(error.k, 3)) if estimated else "",
            "prior_u": t.number(significant(error.prior_u, 2)) + " " + error.unit if error.prior_u else ""}


def _numbers(error: links.LinkError) -> tuple[str, str]:
    """Nominal and calibrated, in mm or degrees."""
    if error.nominal is None:
        return "–", "–"
    factor, of_error, unit = (1.0, 1.0, " mm") if error.unit == "mm" else (_DEGREES, _DEGREES / 1000, "°")
    nominal = factor * error.nominal
    return (_written(nominal, 0) + unit, _written(nominal + of_error * error.value, of_error * error.u) + unit)


def _written(value: float, u: float) -> str:
    if not math.isfinite(value):
        return "–"
    return concise(value, u) if u else f"{value:.6g}".replace("-", MINUS)


def _matrix(c: Calibration, t) -> list[list[str]]:
    """flange_from_scanner; rotation to 1e-7, which is 0.1 um at a metre, translation to 0.1 um."""
    rows = c.get("hand_eye") or []
    if len(rows) != 4 or any(len(row) != 4 or None in row for row in rows):
        return []
    return [[t.number(_fixed(number, 4 if j == 3 else 7)) for j, number in enumerate(row)]
            for row in rows[:3]] + [["0", "0", "0", "1"]]


def _fixed(number: float, decimals: int) -> str:
    return f"{round(number, decimals) + 0.0:.{decimals}f}".replace("-", MINUS)  # + 0.0: zero has no sign


def _hand_eye(c: Calibration) -> list[tuple[str, list[dict]]]:
    """Translation and rotation vector."""
    found = [(kind, [c.parameter(f"hand_eye_{prefix}{axis}") for axis in "xyz"])
             for kind, prefix in (("translation", ""), ("rotation", "r"))]
    return [(kind, numbers) for kind, numbers in found if all(numbers)]
