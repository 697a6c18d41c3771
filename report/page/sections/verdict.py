"""What the data say for and against the result; never more than that."""
from calibration import Calibration
from language import Language
from notation import dof, p_value, significant
from procedure import has_equal_weights

SIGNIFICANT = 1e-3  # as the program judges


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    warnings, reasons = ([str(each) for each in c.get(key) or []] for key in ("warnings", "unreliable"))
    status = "unreliable" if not c.is_reliable else "with_warnings" if warnings else "ok"
    if status == "unreliable" and not reasons:
        reasons = [t("verdict.unexplained")]
    return {"status": status, "reasons": reasons, "warnings": warnings, "notes": [str(each) for each in c.get("notes") or []], "fit": _fit(c, t)}


def _fit(c: Calibration, t: Language) -> str:
    """Lack of fit in words."""
    told, test = [], c.get("lack_of_fit") or {}
    if None not in (test.get("F"), test.get("p")):
        key = "agrees" if test["p"] >= SIGNIFICANT else "unexplained" if has_equal_weights(c) else "explained"
        told.append(t(f"verdict.fit.{key}", F=t.number(significant(test["F"], 3)), dof1=dof(test.get("dof1")),
                      dof2=dof(test.get("dof2")), p=t.number(p_value(test["p"]))))
    misfits = [each for each in c.get("misfits") or [] if None not in (each.get("p"), each.get("F"))]
    strongest = min(misfits, key=lambda misfit: (misfit["p"], -misfit["F"]), default=None)
    if strongest and strongest["p"] >= SIGNIFICANT:  # else a warning says so
        told.append(t("verdict.fit.strongest", source=strongest["source"],
                      F=t.number(significant(strongest["F"], 3)), p=t.number(p_value(strongest["p"]))))
    return " ".join(told)
