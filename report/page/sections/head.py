"""The first screen: who, what, which one, when; every quantity with U and k; the status in one line."""
import as_found
import status
from administration import as_text, period, serial_numbers
from calibration import Calibration
from language import Language
from meaning import meaning
from notation import significant, to_last_digit_of
from spread import of_parameter

EXPECTED = ("item", "serial", "performed", "laboratory")  # without which nobody can sign


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    told = _identification(c, t)
    missing = [t(f"head.expected.{key}") for key, text in told if key in EXPECTED and not text]
    return {"identification": [(t(f"head.{key}"), text) for key, text in told if text],
            "missing": t("head.missing", names=", ".join(missing)) if missing else "",
            "quantities": [_quantity(parameter, c, t) for parameter in c.own],
            "elsewhere": len(c.estimated) - len(c.own), "percent": t.number(significant(c.coverage_percent, 2)),
            "status": status.of(c).color, "status_line": status.of(c).line(t),
            "as_found": _as_found(previous, c, t) if previous else ""}


def _identification(c: Calibration, t: Language) -> list[tuple[str, str]]:
    certificate = c.get("certificate")

    def given(*path: str) -> str:
        found = certificate
        for key in path:
            found = found.get(key) if isinstance(found, dict) else None
        return as_text(found)
    item = ", ".join(filter(None, [given("item", "name"), given("item", "manufacturer"), given("item", "model")]))
    return [("item", item), ("serial", ", ".join(serial_numbers(c))), ("performed", period(c, t)),
            ("identification", given("identification")), ("laboratory", given("laboratory", "name")),
            ("customer", given("customer", "name"))]


def _quantity(parameter: dict, c: Calibration, t: Language) -> dict[str, str]:
    """Of an unreliable result where it went without one target, instead of a U that nobody may believe."""
    unit = "" if parameter["unit"] == "1" else " " + parameter["unit"]
    named = {"name": parameter["name"], "meaning": meaning(parameter["name"], t), "unit": unit.strip()}
    value, U = parameter.get("value"), parameter.get("U")
    if c.is_reliable:
        if not U:
            return named | {"result": t.number(significant(value, 6)) + unit, "k": "–"}
        digits = f"{to_last_digit_of(U, value)} ± {significant(U, 2)}"
        return named | {"result": t.number(f"({digits})" if unit else digits) + unit,
                        "k": t.number(significant(parameter.get("k"), 3))}
    found = of_parameter(c, parameter["name"])
    if found is None:
        return named | {"result": t.number(significant(value, 4)) + unit, "k": "–"}
    low, high, size = found
    return named | {"result": t.number(to_last_digit_of(size, value)) + unit,
                    "k": t("head.spread", low=t.number(to_last_digit_of(size, low)),
                           high=t.number(to_last_digit_of(size, high)), unit=unit).strip()}


def _as_found(found: Calibration, left: Calibration, t: Language) -> str:
    """In one line; what it says of a doubtful comparison is that it is doubtful."""
    changes = as_found.changes(found, left)
    doubtful = t("head.as_found.doubtful") if as_found.doubts(left, t.code) else ""
    changed = [each for each in changes if each.e_n is not None and abs(each.e_n) > 1]
    known = [each for each in changes if each.e_n is not None]
    if not known:
        return t("head.as_found.unknown", doubtful=doubtful).strip()
    if not changed:
        return t("head.as_found.agrees", doubtful=doubtful).strip()
    worst = max(changed, key=lambda each: abs(each.e_n))
    return t("head.as_found.changed", count=len(changed), all=len(known), name=worst.left["name"],
             e_n=t.number(significant(worst.e_n, 2)), doubtful=doubtful).strip()
