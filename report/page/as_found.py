"""As found and as left: this calibration beside an earlier one of the same instrument.

E_n = (x_left - x_found) / sqrt(U_left^2 + U_found^2) (ISO 13528): at most 1 in size where the two agree
within their expanded uncertainties. It holds for independent results only; what speaks against that is told
with it.

An orientation is compared as a whole: its change is the rotation R_left R_found' between the two, as a vector
about the axes of the frame that it turns into, and the covariances of both rotation vectors v are taken to it by
d(rotation) = J(v) dv, J = 1 + (1 - cos t) / t^2 [v]x + (t - sin t) / t^3 [v]x^2, t = |v| (Sola, Deray, Atchuthan,
A micro Lie theory, 2018, eq. (145)). Vectors near half a turn on either side are neighbours.
"""
import math
from dataclasses import dataclass

import numpy as np

from administration import leaves
from calibration import Calibration


@dataclass(frozen=True)
class Change:
    """Of one parameter that both have estimated; mm or rad. None: an uncertainty is not known."""
    found: dict
    left: dict
    change: float | None
    u: float | None    # of the change, if the two are independent
    e_n: float | None


@dataclass(frozen=True)
class Doubt:
    """Why the numbers may not be compared: words of [as_found.doubt], and the names they are about."""
    key: str
    names: tuple[str, ...] = ()


def changes(found: Calibration, left: Calibration) -> list[Change]:
    earlier = {parameter["name"]: parameter for parameter in found.estimated}
    turns = {name: change for first in earlier if first.endswith("_rx")
             for name, change in _turn(first[:-3], found, left).items()}
    told = [turns.get(parameter["name"]) or _change(earlier[parameter["name"]], parameter)
            for parameter in left.estimated if parameter["name"] in earlier]
    return told if found.is_reliable and left.is_reliable else [_without_U(each) for each in told]


def doubts(found: Calibration, left: Calibration) -> list[Doubt]:
    """What makes the comparison doubtful, worst first."""
    items = [_item(found), _item(left)]
    told = [Doubt("same_file")] if found.sha256 and found.sha256 == left.sha256 else []
    told += [Doubt(key, (str(a), str(b))) for key, a, b in (
        ("model", found["model"], left["model"]), ("residual", found.get("residual"), left.get("residual")),
        ("item", *items)) if a and b and a != b]
    told += [Doubt("item_of_one", (items[0] or items[1],))] if bool(items[0]) != bool(items[1]) else []
    told += [Doubt(f"{which}_unreliable") for which, c in (("found", found), ("left", left))
             if not c.is_reliable]
    told += [Doubt(key, tuple(names)) for key, names in (
        ("missing", _missing(found, left)), ("roles", _in_other_roles(found, left)),
        ("values", _at_other_values(found, left)), ("considered", _considered_in_one(found, left)),
        ("nominal", _with_other_nominals(found, left)), ("inputs", _common_inputs(found, left)),
        ("influences", _common_influences(found, left))) if names]
    return told


def _without_U(change: Change) -> Change:
    """Where one of the two is unreliable nobody knows how far they may lie apart."""
    found, left = ({key: value for key, value in each.items() if key not in ("u", "U", "k")}
                   for each in (change.found, change.left))
    return Change(found, left, change.change, None, None)


def _change(found: dict, left: dict) -> Change:
    def known(key: str) -> bool:
        return all(isinstance(each.get(key), (int, float)) for each in (found, left))
    if not known("value"):
        return Change(found, left, None, None, None)
    change = left["value"] - found["value"]
    expanded = math.hypot(found["U"], left["U"]) if known("U") else 0.0
    return Change(found, left, change, math.hypot(found["u"], left["u"]) if known("u") else None,
                  change / expanded if expanded > 0 else None)


def _turn(what: str, found: Calibration, left: Calibration) -> dict[str, Change]:
    """Of what_rx, _ry, _rz: the rotation from found to left; empty where one of them has not estimated all three."""
    names = [f"{what}_r{axis}" for axis in "xyz"]
    both = []
    for c in (found, left):
        at = {parameter["name"]: k for k, parameter in enumerate(c.estimated)}
        if not all(name in at for name in names):
            return {}
        rows = [at[name] for name in names]
        if not np.isfinite(c.covariance[np.ix_(rows, rows)]).all():
            return {}
        told = [c.estimated[row] for row in rows]
        if not all(isinstance(each.get(key), (int, float)) for each in told for key in ("value", "u", "U")):
            return {}
        v = np.array([each["value"] for each in told])
        j = _jacobian(v)
        k = np.array([each["U"] / each["u"] if each["u"] > 0 else 0.0 for each in told])
        both.append((told, _rotation(v), j @ c.covariance[np.ix_(rows, rows)] @ j.T, k))
    (before, r_found, cov_found, k_found), (after, r_left, cov_left, k_left) = both
    change = _vector(r_left @ r_found.T)
    variances = [np.diag(cov_found), np.diag(cov_left)]
    u = np.sqrt(sum(variances))
    expanded = np.sqrt(k_found**2 * variances[0] + k_left**2 * variances[1])
    return {name: Change(before[i], after[i], float(change[i]), float(u[i]),
                         float(change[i] / expanded[i]) if expanded[i] > 0 else None)
            for i, name in enumerate(names)}


def _cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def _jacobian(v: np.ndarray) -> np.ndarray:
    t, x = float(np.linalg.norm(v)), _cross(v)
    if t < 1e-6:
        return np.eye(3) + x / 2
    return np.eye(3) + (1 - math.cos(t)) / t**2 * x + (t - math.sin(t)) / t**3 * x @ x


def _rotation(v: np.ndarray) -> np.ndarray:
    t, x = float(np.linalg.norm(v)), _cross(v)
    if t < 1e-12:
        return np.eye(3) + x
    return np.eye(3) + math.sin(t) / t * x + (1 - math.cos(t)) / t**2 * x @ x


def _vector(r: np.ndarray) -> np.ndarray:
    """Of a rotation; of half a turn either of its two vectors."""
    axis = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / 2
    sine, cosine = float(np.linalg.norm(axis)), (float(np.trace(r)) - 1) / 2
    t = math.atan2(sine, cosine)
    if sine > 1e-6 or cosine > 0:
        return axis * (t / sine if sine > 1e-12 else 1.0)
    column = max(range(3), key=lambda k: r[k, k])
    along = r[:, column] + np.eye(3)[:, column]
    return math.pi * along / np.linalg.norm(along)


def _item(c: Calibration) -> str:
    """What the certificate calls the thing that was calibrated, if it does."""
    return ", ".join(text for path, text in leaves(c.get("certificate"))
                     if path[:2] == ("item", "identifications") and path[-1] == "value")


def _missing(found: Calibration, left: Calibration) -> list[str]:
    """Parameters that only one of them knows at all."""
    names = [{parameter["name"] for parameter in c["parameters"]} for c in (found, left)]
    return sorted(names[0] ^ names[1])


def _pairs(found: Calibration, left: Calibration) -> list[tuple[dict, dict]]:
    """Parameters that both know."""
    return [(earlier, parameter) for parameter in left["parameters"] if (earlier := found.parameter(parameter["name"]))]


def _in_other_roles(found: Calibration, left: Calibration) -> list[str]:
    """Estimated in one and not in the other."""
    return [now["name"] for earlier, now in _pairs(found, left)
            if (earlier["role"] == "estimate") != (now["role"] == "estimate")]


def _at_other_values(found: Calibration, left: Calibration) -> list[str]:
    """Estimated in neither, but with another value: the others answer to that. Without one it is 0."""
    return [now["name"] for earlier, now in _pairs(found, left) if "estimate" not in (earlier["role"], now["role"])
            and (earlier.get("value") or 0) != (now.get("value") or 0)]


def _considered_in_one(found: Calibration, left: Calibration) -> list[str]:
    """In u of one, held as exactly known in the other, at the same value."""
    return [now["name"] for earlier, now in _pairs(found, left) if {earlier["role"], now["role"]} == {"consider", "hold"}
            and (earlier.get("value") or 0) == (now.get("value") or 0)]


def _with_other_nominals(found: Calibration, left: Calibration) -> list[str]:
    return [parameter["name"] for parameter in left["parameters"]
            if (earlier := found.parameter(parameter["name"]))
            and earlier.get("nominal") != parameter.get("nominal")]


def _common_inputs(found: Calibration, left: Calibration) -> list[str]:
    """By content, not by name. dataset.yaml is a declaration, no measurement."""
    earlier = {each.get("sha256") for each in found.get("inputs") or [] if each.get("sha256")}
    return [str(each.get("file")) for each in left.get("inputs") or []
            if each.get("sha256") in earlier and not str(each.get("file")).endswith((".yaml", ".yml"))]


def _common_influences(found: Calibration, left: Calibration) -> list[str]:
    """Systematic and declared in both: if it is the same plate or artifact, it is also the same error."""
    declared = [[line["source"] for line in c.get("budget") or []
                 if line.get("type") == "B" and not line.get("random")] for c in (found, left)]
    return [source for source in declared[1] if source in declared[0]]
