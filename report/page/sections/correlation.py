"""What the correlation says in words."""
import math

from calibration import Calibration
from notation import MINUS, significant
from uncertainty import STRONG, strongest_pairs, weakest_direction


def content(c: Calibration, previous, t) -> dict[str, str]:
    return {"two": _two(c, t) if len(c.estimated) == 2 else "", "weakest": _weakest(c, t)}


def _two(c: Calibration, t) -> str:
    pairs = strongest_pairs(c, 1)
    if not pairs:
        return ""
    one, other, r = pairs[0]
    return " ".join([t("correlation.two", one=one, other=other, r=t.number(significant(r, 2))),
                     t("correlation.strong" if abs(r) > STRONG else "correlation.weak")])


def _weakest(c: Calibration, t) -> str:
    parts = weakest_direction(c)
    if len(parts) < 2:
        return t("correlation.weakest_one", name=parts[0][0]) if parts else ""
    return t("correlation.weakest", direction=_direction(parts, t))


def _direction(parts: list[tuple[str, float]], t) -> str:
    """0.60 theta_2 − 0.50 a_1 + 0.37 a_2"""
    words = ""
    for name, component in parts:
        sign = "" if not words and component > 0 else "+ " if component > 0 else f"{MINUS} "
        words += f"{' ' if words else ''}{sign}{t.number(significant(abs(component), 2))} {name}"
    return words
