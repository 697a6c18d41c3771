"""What the result takes for granted, what was left out of it, and what the residuals were asked."""
from calibration import Calibration
from language import Language
from notation import count, significant

MOST_NAMES, MOST_TARGETS = 24, 40
ROLES = ["consider", "estimate", "hold"]


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    influences = _influences(c)
    zero = [each["source"] for each in influences if each["role"] == "hold" and not each.get("value")]
    shown = [each for each in influences if each["source"] not in zero]
    targets = sorted(c.get("targets") or [], key=lambda target: -(target.get("set_aside") or 0))
    left_out = targets[MOST_TARGETS:]
    chosen = [target for target in c.get("targets") or [] if target not in left_out]
    return {"influences": sorted(shown, key=lambda each: ROLES.index(each["role"])),
            "held_at_zero": _listed(zero, t),
            "misfits": [_misfit(misfit, c, t) for misfit in c.get("misfits") or []],
            "targets": [(target, _reasons(target, t)) for target in chosen], "left_out": left_out,
            "sums": {key: sum(target.get(key) or 0 for target in targets)
                     for key in ("points", "missing", "set_aside")}}


def _influences(c: Calibration) -> list[dict]:
    """What the result depends on and is no estimated parameter: a line each source. Files of the first
    versions know the parameters among them only."""
    values = {parameter["name"]: parameter.get("value") for parameter in c["parameters"]}
    known = c.get("influences") or [{"source": parameter["name"]} | parameter for parameter in c["parameters"]
                                    if parameter["role"] != "estimate"]
    return [each | {"value": values.get(each["source"])} for each in known]


def _listed(names: list[str], t: Language) -> str:
    listed = ", ".join(names[:MOST_NAMES])
    more = len(names) - MOST_NAMES
    return t("considered.held.and_more", names=listed, count=more) if more > 0 else listed


def _misfit(misfit: dict, c: Calibration, t: Language) -> dict:
    """With the parameter that it would move furthest, in its u."""
    ratios = {name: abs(move) / parameter["u"] for name, move in (misfit.get("moves") or {}).items()
              if move is not None and (parameter := c.parameter(name)) and parameter.get("u")}
    furthest = max(ratios, key=ratios.get, default="")
    ratio = t.number(significant(ratios.get(furthest), 2))
    return misfit | {"move": t("considered.misfits.move", name=furthest, ratio=ratio) if furthest else "–"}


def _reasons(target: dict, t: Language) -> str:
    reasons = (target.get("set_aside_reasons") or {}).items()
    return ", ".join(t("considered.set_aside.reason", count=count(number),
                       reason=t.named("considered.set_aside.because", reason)) for reason, number in reasons)
