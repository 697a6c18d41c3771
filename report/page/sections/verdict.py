"""What the data say for and against the result; never more than that."""
import status
from calibration import Calibration
from language import Language
from notation import dof, p_value, significant
from procedure import has_equal_weights
from uncertainty import raw_p


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    warnings, reasons = ([str(each) for each in c.get(key) or []] for key in ("warnings", "unreliable"))
    found = status.of(c)
    if found.key == "unreliable" and not reasons:
        reasons = [t("verdict.unexplained")]
    return {"status": found, "reasons": reasons, "warnings": warnings,
            "notes": [str(each) for each in c.get("notes") or []], "unexcluded": status.unexcluded_in_words(c, t) if c.is_reliable else "",
            "left_out": _left_out(c, t), "fit": _fit(c, t)}


def _left_out(c: Calibration, t: Language) -> str:
    """What the moves without one target were held against; where they are too far, a reason says so."""
    number = len(c.get("jackknife") or [])
    said = any(each.get("id") in ("solver.targets_disagree", "solver.target_contradicts")
               for each in c.get("messages") or [])
    if number < 2 or said or not c.is_reliable:
        return ""
    return t("verdict.left_out", count=number, limit=t.number(f"{status.SIGNIFICANT:g}"))


def _fit(c: Calibration, t: Language) -> str:
    """Lack of fit in words."""
    told, test = [], c.get("lack_of_fit") or {}
    if None not in (test.get("F"), test.get("p")):
        key = "agrees" if test["p"] >= status.SIGNIFICANT else "unexplained" if has_equal_weights(c) else "explained"
        told.append(t(f"verdict.fit.{key}", F=t.number(significant(test["F"], 3)), dof1=dof(test.get("dof1")),
                      dof2=dof(test.get("dof2")), p=t.number(p_value(test["p"]))))
    misfits = [each for each in c.get("misfits") or [] if None not in (each.get("p"), each.get("F"))]
    strongest = min(misfits, key=lambda misfit: (misfit["p"], -misfit["F"]), default=None)
    if strongest and strongest["p"] >= status.SIGNIFICANT:  # else a warning says so
        told.append(t("verdict.fit.strongest", source=strongest["source"], count=len(misfits),
                      raw=t.number(p_value(raw_p(strongest))), F=t.number(significant(strongest["F"], 3)), p=t.number(p_value(strongest["p"]))))
    return " ".join(told)
