"""How far a result goes without one of its targets: what is told of it where no uncertainty may be."""
import math

from calibration import Calibration
from uncertainty import known


def of_parameter(c: Calibration, name: str) -> tuple[float, float, float] | None:
    """Least and largest value without one target, and the farthest of them from the result; None where nobody knows."""
    value = known((c.parameter(name) or {}).get("value"))
    without = [known((each.get("value") or {}).get(name)) for each in c.get("jackknife") or []]
    without = [each for each in without if math.isfinite(each)]
    farthest = max((abs(each - value) for each in without), default=math.nan)
    return (min(without), max(without), farthest) if farthest > 0 else None
