"""What the sections about the uncertainty compute from a calibration's numbers; what is not known is nan."""
import math

import numpy as np

from calibration import Calibration

FEW_PARAMETERS = 3   # that stand side by side in a table
TAKES_PART = 0.2     # of a unit vector
STRONG = 0.1         # correlation: it changes u of a sum by 5 %


def known(number: float | None) -> float:
    """nan for what calibration.json has as null or not at all."""
    return math.nan if number is None else float(number)


def student_t_density(t: np.ndarray, dof: float) -> np.ndarray:
    """Of Student's t; the normal density from a million degrees of freedom on, where both are the same."""
    if not dof < 1e6:
        return np.exp(-t**2 / 2) / math.sqrt(2 * math.pi)
    scale = math.exp(math.lgamma((dof + 1) / 2) - math.lgamma(dof / 2)) / math.sqrt(dof * math.pi)
    return scale * np.exp(-(dof + 1) / 2 * np.log1p(t**2 / dof))


def gum_density(x: np.ndarray, parameter: dict) -> np.ndarray:
    """What value, u and dof of a parameter say of it (JCGM 101, 6.4.9.7); x in its unit."""
    u = known(parameter.get("u"))
    dof = math.inf if parameter.get("dof") is None else parameter["dof"]  # JSON has no infinity
    return student_t_density((x - parameter["value"]) / u, dof) / u


def axis_unit(parameter: dict) -> tuple[float, str]:
    """For an axis along a parameter: what to multiply its value with, and the unit."""
    return {"rad": (1000.0, "mrad"), "mm": (1.0, "mm")}.get(parameter.get("unit"), (1.0, "1"))


def moves(c: Calibration) -> tuple[list[str], np.ndarray]:
    """Leaving one target out: names of the targets, and by how much each parameter moves without each."""
    rows = [[known((without.get("value") or {}).get(p["name"])) - known(p.get("value")) for p in c.estimated]
            for without in c.get("jackknife") or []]
    names = [without["without"] for without in c.get("jackknife") or []]
    return names, np.array(rows, dtype=float).reshape(len(names), len(c.estimated))


def moves_in_u(c: Calibration) -> tuple[list[str], np.ndarray]:
    """The same in units of the parameters' standard uncertainties; nan where u is 0 or not known."""
    names, by = moves(c)
    u = np.array([known(p.get("u")) or math.nan for p in c.estimated])
    return names, by / u


def sources_by_share(c: Calibration) -> list[dict]:
    """Lines of the budget, first the one with the largest share in any parameter."""
    return sorted(c.get("budget") or [], key=lambda line: -max(shares(line, c), default=0.0))


def shares(line: dict, c: Calibration) -> list[float]:
    """Of the variance of each estimated parameter."""
    of_parameter = line.get("share") or {}
    return [max(0.0, of_parameter.get(p["name"]) or 0.0) for p in c.estimated]


def strongest_pairs(c: Calibration, most: int) -> list[tuple[str, str, float]]:
    """Pairs of estimated parameters, the most correlated first."""
    correlation, names = c.correlation, [p["name"] for p in c.estimated]
    pairs = [(names[j], names[i], correlation[i, j]) for i in range(len(names)) for j in range(i)
             if math.isfinite(correlation[i, j])]
    return sorted(pairs, key=lambda pair: -abs(pair[2]))[:most]


def weakest_direction(c: Calibration) -> list[tuple[str, float]]:
    """The parameters that take part in it, largest first, the largest positive: components of a unit vector,
    of quantities that are scaled to move the residuals alike."""
    parts = [(name, known(component)) for name, component in (c.get("weakest") or {}).items()]
    parts = sorted((part for part in parts if math.isfinite(part[1])), key=lambda part: -abs(part[1]))
    if not parts or parts[0][1] == 0:
        return []
    sign = math.copysign(1, parts[0][1])
    return [(name, sign * component) for k, (name, component) in enumerate(parts)
            if k == 0 or abs(component) > TAKES_PART]


def apart_in_u(trials: dict) -> float:
    """How far the ends of the two 95 % intervals of a parameter lie from each other, in u of the trials."""
    keys = ("low", "high", "gum_low", "gum_high", "u")
    low, high, gum_low, gum_high, u = (known(trials.get(key)) for key in keys)
    return max(abs(low - gum_low), abs(high - gum_high)) / u if u > 0 else math.nan


def f_upper_tail(F: float, dof1: float, dof2: float) -> float:
    """How often chance alone gives an F at least so large: the incomplete beta function as its continued fraction
    (Press et al., Numerical Recipes, 6.4, by the method of Lentz)."""
    a, b, x = dof2 / 2, dof1 / 2, dof2 / (dof2 + dof1 * F)
    if not 0 < x < 1:
        return math.nan if math.isnan(x) else float(x > 0)
    if x > (a + 1) / (a + b + 2):  # where the fraction of the other side converges fast
        return 1 - _incomplete_beta(b, a, 1 - x)
    return _incomplete_beta(a, b, x)


def _incomplete_beta(a: float, b: float, x: float) -> float:
    tiny, c = 1e-300, 1.0
    d = 1 / (1 - (a + b) * x / (a + 1) or tiny)
    fraction = d
    for m in range(1, 1000):
        for factor in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                       -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d, c = 1 / (1 + factor * d or tiny), 1 + factor / c or tiny
            fraction *= c * d
        if abs(c * d - 1) < 1e-14:
            break
    front = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)
    return math.exp(front) * fraction / a


def raw_p(misfit: dict) -> float:
    """Of one of "misfits" as if it had been the only test; its p is that of the strongest of all (Bonferroni)."""
    return f_upper_tail(*(known(misfit.get(key)) for key in ("F", "dof1", "dof2")))
