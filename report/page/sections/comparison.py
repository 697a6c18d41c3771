"""Tables of the methods: as many columns in each as a page is wide."""
import math

from comparison import SUMMARIES, cell, column_title, columns, method_name, methods
from notation import MINUS, concise, count, significant, to_last_digit_of

WIDTH = 66  # characters beside the names of the methods
VALUES = ["M/mm", "N/mm", "ΔM/u", "ΔN/u", "tilt_x/mrad", "tilt_y/mrad"]  # in one table, in this order
WHOLE = ["nodes, iter."]
ALIKE = ["S/um", "plane rms/um", "held out/um"]  # of which a table has a sentence where they are
SAME = 0.01  # part of the largest: what lies so close tells no method from another
MOST_MICROMETRES = 1000
NOTHING = 5e-4  # u
ROUGH = ["ΔM/u", "ΔN/u"]  # two digits are enough, as for single lengths


def content(c, previous, t) -> dict[str, object]:
    rows = methods(c)
    shown = [column for column in columns(rows) if not _says_nothing(column, rows)]
    notes = list(dict.fromkeys(row["note"] for row in rows if row.get("note")))
    decimals = {column: _decimals(cell(rows[-1], column)) for column in VALUES[:2]} if rows else {}
    if not c.is_reliable:  # no u behind a value
        rows = [row | {"cells": [each | {"u": None} for each in row.get("cells") or []]} for row in rows]
    rows = [row | {"decimals": decimals} for row in rows]
    tables = [_table(part, k == 0, rows, notes, t) for k, part in enumerate(_parts(shown, rows, t))]
    return {"tables": tables, "alike": _alike(rows, t), "notes": [(_mark(k), t.sentence(note)) for k, note in enumerate(notes)],
            "about": t(f"comparison.about.{c['model']}")}


def _decimals(reference: dict) -> int | None:
    """To which its u leaves a value: those of all that stand in its column without one."""
    if not reference.get("u") or reference.get("value") is None:
        return None
    return len(to_last_digit_of(reference["u"], reference["value"]).partition(".")[2])


def _rounded(value: float, decimals: int | None) -> str:
    return significant(value, 6) if decimals is None else f"{value:.{decimals}f}".replace("-", MINUS)


def _in_mm(column: str, rows: list[dict]) -> bool:
    """Micrometres are no unit for millimetres."""
    largest = max((abs(value) for row in rows if (value := cell(row, column).get("value")) is not None), default=0)
    return column.endswith("/um") and largest >= MOST_MICROMETRES


def _title(column: str, rows: list[dict], t) -> str:
    title = column_title(column, t)
    return title.replace("µm", "mm") if _in_mm(column, rows) else title


def _alike(rows: list[dict], t) -> str:
    """What all methods say alike, in words."""
    told = []
    for column in ALIKE:
        known = [value for row in rows if (value := cell(row, column).get("value")) is not None]
        if known and max(known) - min(known) < SAME * max(known):
            name, _, unit = _title(column, rows, t).replace("\u00a0", " ").partition(" / ")
            factor = 1e-3 if _in_mm(column, rows) else 1
            least, most = (t.number(significant(factor * end, 3)) for end in (min(known), max(known)))
            told.append(t("comparison.alike.one" if least == most else "comparison.alike.range", name=name,
                          least=least, most=most, unit=unit))
    return t("comparison.alike.about", told=", ".join(told)) if told else ""


def _says_nothing(column: str, rows: list[dict]) -> bool:
    """Empty, or the u that a value already has behind it, or a tilt that is zero throughout."""
    values = [cell(row, column).get("value") for row in rows]
    if column.startswith("u("):
        return any(cell(row, other).get("u") for row in rows for other in columns(rows)
                   if other.startswith(column[2:column.index(")")] + "/"))
    known = [value for value in values if value is not None]
    if column.startswith("step/") or column in WHOLE or column.isdecimal():  # in the name of the method; of its speed; among the known lengths
        return True
    if column.startswith("tilt_"):
        return not any(values)
    return not known or column in ALIKE and max(known) - min(known) < SAME * max(known)


def _parts(shown: list[str], rows: list[dict], t) -> list[list[str]]:
    first = [column for column in [*VALUES, *SUMMARIES] if column in shown]
    parts = []
    for group in (first, [column for column in shown if column not in first]):
        left = 0
        for column in group:
            width = 2 + max([len(word) for word in _title(column, rows, t).split()]
                            + [len(_text(row, column, rows, t)) for row in rows])
            if width > left:
                parts.append([])
                left = WIDTH
            parts[-1].append(column)
            left -= width
    return parts


def _table(part: list[str], first: bool, rows: list[dict], notes: list[str], t) -> dict:
    rows = [row for row in rows if first or row.get("cells")]  # what was left out is said once
    return {"columns": [_title(column, rows, t) for column in part],
            "rows": [{"method": method_name(row, t),
                      "note": _mark(notes.index(row["note"])) if row.get("note") else "",
                      "cells": [_text(row, column, rows, t) for column in part]} for row in rows]}


def _text(row: dict, column: str, rows: list[dict], t) -> str:
    value, u = cell(row, column).get("value"), cell(row, column).get("u")
    if value is None or not math.isfinite(value):
        return "–"
    if column in WHOLE:
        return count(value)
    if u:
        return t.number(concise(value, u))
    if column in VALUES[:2]:
        return t.number(min(significant(value, 6), _rounded(value, row["decimals"].get(column)), key=len))
    if _in_mm(column, rows):
        return t.number(significant(value / 1000, 3))
    if any(cell(other, column).get("u") for other in rows):
        return t.number(significant(value, 6))
    if column in ROUGH and abs(value) < NOTHING:
        value = 0.0
    return t.number(significant(value, 2 if column.isdecimal() or column in ROUGH else 3))


def _mark(note: int) -> str:
    """A letter: a figure above a number would be its power."""
    return "abcdefghijklmnopqrstuvwxyz"[note % 26]
