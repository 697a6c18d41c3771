"""The Monte Carlo in words, and the rows of its table."""
from calibration import Calibration
from notation import count
from uncertainty import axis_unit, known

_LENGTHS = ("mean", "u", "low", "high", "gum_low", "gum_high", "tolerance")


def content(c: Calibration, previous, t) -> dict[str, object]:
    found = (c.get("montecarlo") or {}) if c.is_reliable else {}  # it drew what the budget says, which is not believed
    rows = [_row(each, c.parameter(each["name"])) for each in found.get("parameters") or []
            if c.parameter(each["name"])]
    percent = t.number(f"{c.coverage_percent:.4g}")
    return {"rows": rows, "about": _about(found, t) if rows else "", "percent": percent}


def _row(trials: dict, parameter: dict) -> dict[str, object]:
    """Angles in mrad: in rad their numbers would be zeros for the most part."""
    factor, unit = axis_unit(parameter)
    return {"name": trials["name"], "unit": unit, "verdict": trials["verdict"],
            **{key: factor * known(trials.get(key)) for key in _LENGTHS}}


def _about(found: dict, t) -> str:
    words = [t("monte_carlo.about", trials=count(found.get("trials")), seed=found.get("seed", "–"))]
    if found.get("failed"):
        words.append(t("monte_carlo.failed", failed=count(found["failed"])))
    words.append(t("monte_carlo.digits_1" if found.get("digits") == 1 else "monte_carlo.digits_2"))
    if found.get("stable") is False:
        words.append(t("monte_carlo.unstable"))
    return " ".join(words)
