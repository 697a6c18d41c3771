"""--dcc: the Digital Calibration Certificate of a calibration (https://ptb.de/dcc, 3.3.0 with D-SI 2.2.1).

Lengths are written in metre, angles in radian. A number is the shortest decimal that stands for the one in
calibration.json, shifted by whole powers of ten: no digit is rounded or added.
"""
import math
import re
from decimal import Decimal
from pathlib import Path

import jinja2

import procedure
from administration import as_text, label
from calibration import Calibration, Complaint
from dcc_administration import Administration, read_administration
from language import Language
from meaning import meaning
from output import write_whole

TEMPLATES = Path(__file__).parent / "templates"
SI = {"mm": (-3, r"\metre"), "rad": (0, r"\radian"), "1": (0, r"\one")}  # power of ten, unit
NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_certificate(c: Calibration, t: Language, file: Path) -> None:
    """Raises Complaint, and writes nothing, if result or laboratory do not give enough."""
    write_whole(file, certificate(c, t).encode("utf-8"))


def certificate(c: Calibration, t: Language) -> str:
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
    return template.render(t=t, c=c, given=given, **_content(c, t, given))


def number(value: float, power: int = 0) -> str:
    """value 10^power to its last digit."""
    return str(Decimal(repr(value)).scaleb(power))


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


def _content(c: Calibration, t: Language, given: dict) -> dict[str, object]:
    """For templates/certificate.xml."""
    units = [parameter["unit"] for parameter in c.estimated]
    return {"version": as_text(c.get("version")) or "–", "procedure": procedure.sentences(c, t),
            "quantities": [_quantity(parameter, t) for parameter in c.estimated],
            "columns": _columns(c["covariance"], units), "joint_k": _factor(c["joint"]["k"]),
            "probability": _factor(c.get("coverage_probability") or 0.95),
            "budget": [_source(line, c) for line in c.get("budget") or []],
            "trials": (c.get("montecarlo") or {}).get("trials"),
            "warnings": [t.translated(str(warning)) for warning in c.get("warnings") or []],
            "rest": [(label(path, c["certificate"], t), text) for path, text in given["rest"]]}


def _quantity(parameter: dict, t: Language) -> dict[str, object]:
    power, unit = SI[parameter["unit"]]
    dof = number(parameter["dof"]) if _is_number(parameter.get("dof")) else ""
    numbers = {key: number(parameter[key], power) for key in ("value", "u", "U")}
    return numbers | {"name": parameter["name"], "meaning": meaning(parameter["name"], t), "unit": unit,
                      "k": _factor(parameter["k"]), "dof": dof}


def _columns(covariance: list[list[float]], units: list[str]) -> list[list[tuple[str, str]]]:
    """Of the covariance matrix: (value, unit) of every element."""
    return [[(number(row[j], SI[units[i]][0] + SI[units[j]][0]), _product(units[i], units[j]))
             for i, row in enumerate(covariance)] for j in range(len(units))]


def _product(*units: str) -> str:
    return "".join(SI[unit][1] for unit in units if unit != "1") or r"\one"


def _factor(k: float) -> str:
    return format(Decimal(repr(k)), "f")  # the schema has no exponent here


def _source(line: dict, c: Calibration) -> dict[str, object]:
    """A line of the budget: its own u, and what it brings to each parameter. The unknown is left out."""
    power, unit = SI[line["unit"]]
    brought = [(each["name"], (line.get("u") or {}).get(each["name"]), *SI[each["unit"]])
               for each in c.estimated]
    return {"name": line["source"], "type": line["type"], "unit": unit,
            "u": number(line["value"], power) if _is_number(line.get("value")) else "",
            "contributions": [(name, number(u, shift), of) for name, u, shift, of in brought
                              if _is_number(u)]}
