"""What the result takes for granted, what was left out of it, and what the residuals were asked."""
from calibration import Calibration
from language import Language
from meaning import meaning
from notation import count, significant
from uncertainty import raw_p

MOST_NAMES, MOST_ROWS = 24, 20
ROLES = ["consider", "estimate", "hold"]
ASKED = 0.05  # p by itself, from which on a question may stay without its row
FAR = 1.0     # u, up to which a move may, too


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    influences = _influences(c)
    zero = [each["source"] for each in influences if each["role"] == "hold" and not each.get("value")]
    in_budget = {name for line in c.get("budget") or [] for name in (line["source"], line["source"].split(" (")[0])}
    shown = [each for each in influences if each["source"] not in zero
             and (each["role"] == "hold" or each["source"] not in in_budget)]
    misfits = [_misfit(misfit, c, t) for misfit in c.get("misfits") or []]
    rows = [each for each in misfits if not each["raw"] > ASKED or each["ratio"] > FAR]
    rows = sorted(rows, key=lambda each: each["raw"])[:MOST_ROWS]
    targets = c.get("targets") or []
    return {"meaning": lambda source: meaning(source, t), "influences": sorted(shown, key=lambda each: ROLES.index(each["role"])),
            "held_at_zero": _listed(zero, t), "misfits": rows, "tested": len(misfits),
            "rest": len(misfits) - len(rows), "set_aside": _set_aside(targets, t) if targets else ""}


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
    """With the parameter that it would move furthest, in its u, and p as if it had been the only test."""
    ratios = {name: abs(move) / parameter["u"] for name, move in (misfit.get("moves") or {}).items()
              if move is not None and (parameter := c.parameter(name)) and parameter.get("u")}
    furthest = max(ratios, key=ratios.get, default="")
    ratio = t.number(significant(ratios.get(furthest), 2))
    return misfit | {"move": t("considered.misfits.move", name=furthest, ratio=ratio) if furthest else "–",
                     "ratio": ratios.get(furthest, 0.0), "raw": raw_p(misfit)}


def _set_aside(targets: list[dict], t: Language) -> str:
    """How many points and why, over all; how many of each target stands beside its residuals."""
    reasons: dict[str, int] = {}
    for target in targets:
        for reason, number in (target.get("set_aside_reasons") or {}).items():
            reasons[reason] = reasons.get(reason, 0) + number
    number = sum(target.get("set_aside") or 0 for target in targets)
    if not number:
        return t("considered.set_aside.none")
    if not reasons:
        return t("considered.set_aside.unexplained", count=count(number))
    told = ", ".join(t("considered.set_aside.reason", count=count(of), reason=t.named(
        "considered.set_aside.because", reason)) for reason, of in reasons.items())
    return t("considered.set_aside.some", count=count(number), reasons=told)
