"""--dcc: the Digital Calibration Certificate of a calibration (https://ptb.de/dcc, 3.3.0 with D-SI 2.2.1).

Lengths are written in mm, angles in radian. A result is rounded as GUM 7.2.6 has it: U to two digits, the value to the
last of them, k to three. The covariance and the budget, with which one goes on to compute, keep every digit.
"""
import math
import re
from decimal import Decimal, InvalidOperation
from pathlib import Path

import jinja2

import as_found
import procedure
import status
from administration import as_text, label, period
from calibration import Calibration, Complaint
from dcc_administration import Administration, read_administration
from language import Language
from meaning import meaning
from output import write_whole

TEMPLATES = Path(__file__).parent / "templates"
SI = {"mm": r"\milli\metre", "rad": r"\radian", "1": r"\one"}
NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_certificate(c: Calibration, previous: Calibration | None, t: Language, file: Path) -> None:
    """Raises Complaint, and writes nothing, if result or laboratory do not give enough."""
    write_whole(file, certificate(c, previous, t).encode("utf-8"))


def certificate(c: Calibration, previous: Calibration | None, t: Language) -> str:
    """previous: as found."""
    _check_result(c)
    administration = Administration(c.get("certificate"))
    given = read_administration(administration)
    if administration.complaints:
        raise Complaint("\n  ".join([
            f"{c.file}: a Digital Calibration Certificate needs more than certificate: of dataset.yaml says; "
            "complete it there and run scancal refine again:", *administration.complaints]))
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True,
                                     trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
                                     undefined=jinja2.StrictUndefined, finalize=_as_xml)
    template = environment.get_template("certificate.xml")
    def condition(what: str) -> str:
        words = ", ".join(label((key,), {key: 0}, t) for key in what.split(", ")) if what else ""
        return words or label(("conditions",), {"conditions": 0}, t)
    return template.render(t=t, c=c, given=given, condition=condition, **_content(c, previous, t, given))


def number(value: float) -> str:
    """To its last digit."""
    return str(Decimal(repr(value)))


def rounded(value: float, digits: int) -> str:
    """To so many digits that count."""
    exact = Decimal(repr(value))
    for _ in range(2):  # 0.0996 becomes 0.100 first
        exact = exact.quantize(Decimal(1).scaleb(exact.adjusted() - digits + 1)) if exact else exact
    return str(exact)


def to_last_digit_of(U: float, value: float) -> str:
    """value to the second digit of U."""
    last = Decimal(rounded(U, 2)).as_tuple().exponent
    try:
        exact = Decimal(repr(value)).quantize(Decimal(1).scaleb(last))
        return format(exact, "f") if abs(last) < 30 else str(exact)
    except InvalidOperation:  # more digits than a decimal has: a U without sense
        return number(value)


def _as_xml(found: object) -> object:
    """Text without the characters that no XML may hold; Markup stays Markup."""
    return type(found)(NOT_XML.sub("\ufffd", found)) if isinstance(found, str) else found


def _check_result(c: Calibration) -> None:
    if not c.is_reliable:
        reasons = c.get("unreliable") or ["it says so of itself"]
        more = f" (and {len(reasons) - 1} more)" if len(reasons) > 1 else ""
        raise Complaint(f"{c.file}: no certificate is written of a result that should not be relied on: "
                        f"{reasons[0]}{more}")
    if not c.estimated:
        raise Complaint(f"{c.file}: no parameter was estimated, there is nothing to certify")
    for parameter in c.estimated:
        unknown = [key for key in ("value", "u", "U", "k") if not _is_number(parameter.get(key))]
        if unknown or parameter.get("unit") not in SI:
            raise Complaint(f"{c.file}: {parameter['name']}: no number as {', '.join(unknown) or 'unit'}, "
                            "expected a whole result; run scancal refine again")
    joint = (c.get("joint") or {}).get("k")
    if not _is_number(joint) or not all(map(math.isfinite, c.covariance.flat)):
        raise Complaint(f'{c.file}: expected a "covariance" and the k of the "joint" region; '
                        "run scancal refine again")


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _content(c: Calibration, previous: Calibration | None, t: Language, given: dict) -> dict[str, object]:
    """For templates/certificate.xml."""
    units = [parameter["unit"] for parameter in c.estimated]
    return {"version": as_text(c.get("version")) or "–", "procedure": procedure.sentences(c, t),
            "quantities": [_quantity(parameter, t) for parameter in c.estimated],
            "columns": _columns(c["covariance"], units), "joint_k": _factor(c["joint"]["k"]),
            "probability": _factor(c.get("coverage_probability") or 0.95),
            "exact": [number(parameter["value"]) for parameter in c.estimated],
            "found": _as_found(previous, c, t) if previous else None,
            "budget": [_source(line, c) for line in c.get("budget") or []],
            "unexcluded": status.unexcluded_in_words(c, t), "trials": (c.get("montecarlo") or {}).get("trials"),
            "warnings": [t.translated(str(warning)) for warning in c.get("warnings") or []],
            "rest": [(label(path, c["certificate"], t), text) for path, text in given["rest"]]}


def _quantity(parameter: dict, t: Language) -> dict[str, object]:
    dof = str(math.floor(parameter["dof"])) if _is_number(parameter.get("dof")) else ""  # GUM G.4.1
    return {"name": parameter["name"], "meaning": meaning(parameter["name"], t), "unit": SI[parameter["unit"]],
            "value": to_last_digit_of(parameter["U"], parameter["value"]), "U": rounded(parameter["U"], 2),
            "u": rounded(parameter["u"], 2), "k": _factor(parameter["k"], 3), "dof": dof}


def _as_found(found: Calibration, left: Calibration, t: Language) -> dict[str, object]:
    """The values of before, and what may be said of the change; units are those of as left."""
    told = []
    for each in as_found.changes(found, left):
        if _is_number(each.found.get("U")) and _is_number(each.found.get("value")) and each.e_n is not None:
            told.append({"name": each.left["name"], "value": to_last_digit_of(each.found["U"], each.found["value"]),
                         "U": rounded(each.found["U"], 2), "k": _factor(each.found["k"], 3),
                         "unit": SI[each.left["unit"]], "change": to_last_digit_of(each.found["U"], each.change),
                         "e_n": rounded(each.e_n, 2),
                         "meaning": t("as_found.agrees" if abs(each.e_n) <= 1 else "as_found.changed")})
    given = found.get("certificate")
    named = ", ".join(filter(None, [as_text(given.get("identification")) if isinstance(given, dict) else "",
                                    period(found, t), str(found.get("name") or "")]))
    shared = ", ".join(as_found.shared(left))
    notes = [t("as_found.note"), *([t("as_found.shared", names=shared)] if shared else [])]
    return {"quantities": told, "named": named, "notes": notes + as_found.doubts(left, t.code)}


def _columns(covariance: list[list[float]], units: list[str]) -> list[list[tuple[str, str]]]:
    """Of the covariance matrix: (value, unit) of every element."""
    return [[(number(row[j]), _product(units[i], units[j]))
             for i, row in enumerate(covariance)] for j in range(len(units))]


def _product(*units: str) -> str:
    return "".join(SI[unit] for unit in units if unit != "1") or r"\one"


def _factor(k: float, digits: int = 0) -> str:
    """To so many digits, 0: to all."""
    return format(Decimal(rounded(k, digits) if digits else repr(k)), "f")  # the schema has no exponent here


def _source(line: dict, c: Calibration) -> dict[str, object]:
    """A line of the budget: its own u, and what it brings to each parameter. The unknown is left out."""
    brought = [(each["name"], (line.get("u") or {}).get(each["name"]), SI[each["unit"]]) for each in c.estimated]
    return {"name": line["source"], "type": line["type"], "unit": SI[line["unit"]],
            "u": number(line["value"]) if _is_number(line.get("value")) else "",
            "contributions": [(name, number(u), of) for name, u, of in brought if _is_number(u)]}
