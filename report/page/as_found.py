"""As found and as left: this calibration beside an earlier one of the same instrument.

E_n = (x_left - x_found) / sqrt(U_left^2 + U_found^2) (ISO 13528): at most 1 in size where the two agree
within their expanded uncertainties. It holds for independent results only; what speaks against that is told
with it.
"""
import math
from dataclasses import dataclass

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
    return [_change(earlier[parameter["name"]], parameter) for parameter in left.estimated
            if parameter["name"] in earlier]


def doubts(found: Calibration, left: Calibration) -> list[Doubt]:
    """What makes the comparison doubtful, worst first."""
    told = [Doubt("same_file")] if found.sha256 and found.sha256 == left.sha256 else []
    told += [Doubt(key, (str(a), str(b))) for key, a, b in (
        ("model", found["model"], left["model"]), ("residual", found.get("residual"), left.get("residual")),
        ("item", _item(found), _item(left))) if a and b and a != b]
    told += [Doubt(f"{which}_unreliable") for which, c in (("found", found), ("left", left))
             if not c.is_reliable]
    told += [Doubt(key, tuple(names)) for key, names in (
        ("missing", _missing(found, left)), ("roles", _in_other_roles(found, left)),
        ("nominal", _with_other_nominals(found, left)), ("inputs", _common_inputs(found, left)),
        ("influences", _common_influences(found, left))) if names]
    return told


def _change(found: dict, left: dict) -> Change:
    def known(key: str) -> bool:
        return all(isinstance(each.get(key), (int, float)) for each in (found, left))
    if not known("value"):
        return Change(found, left, None, None, None)
    change = left["value"] - found["value"]
    expanded = math.hypot(found["U"], left["U"]) if known("U") else 0.0
    return Change(found, left, change, math.hypot(found["u"], left["u"]) if known("u") else None,
                  change / expanded if expanded > 0 else None)


def _item(c: Calibration) -> str:
    """What the certificate calls the thing that was calibrated, if it does."""
    return ", ".join(text for path, text in leaves(c.get("certificate"))
                     if path[:2] == ("item", "identifications") and path[-1] == "value")


def _missing(found: Calibration, left: Calibration) -> list[str]:
    """Parameters that only one of them knows at all."""
    names = [{parameter["name"] for parameter in c["parameters"]} for c in (found, left)]
    return sorted(names[0] ^ names[1])


def _in_other_roles(found: Calibration, left: Calibration) -> list[str]:
    """Estimated in one and not in the other, or held at another value: the others answer to that."""
    other = []
    for parameter in left["parameters"]:
        earlier = found.parameter(parameter["name"])
        if not earlier:
            continue
        moved = parameter["role"] != "estimate" and earlier.get("value") != parameter.get("value")
        if earlier["role"] != parameter["role"] or moved:
            other.append(parameter["name"])
    return other


def _with_other_nominals(found: Calibration, left: Calibration) -> list[str]:
    return [parameter["name"] for parameter in left["parameters"]
            if (earlier := found.parameter(parameter["name"]))
            and earlier.get("nominal") != parameter.get("nominal")]


def _common_inputs(found: Calibration, left: Calibration) -> list[str]:
    """By content, not by name. dataset.yaml is a declaration, no measurement."""
    earlier = {each.get("sha256") for each in found.get("inputs") or []}
    return [str(each.get("file")) for each in left.get("inputs") or []
            if each.get("sha256") in earlier and not str(each.get("file")).endswith((".yaml", ".yml"))]


def _common_influences(found: Calibration, left: Calibration) -> list[str]:
    """Systematic and declared in both: if it is the same plate or artifact, it is also the same error."""
    declared = [[line["source"] for line in c.get("budget") or []
                 if line.get("type") == "B" and not line.get("random")] for c in (found, left)]
    return [source for source in declared[1] if source in declared[0]]
