"""Methods on the same data, as "compare" of calibration.json has them; the last one is the reference."""
import math
import re

from calibration import Calibration

Cell = dict  # "column", "value", "u"
# Columns of a robot that hold more than one length or location.
SUMMARIES = ["max/mm", "mean/mm", "rms of balls/mm", "calibrated with/mm", "held out/mm", "worst spacing/mm",
             "worst, held out/mm"]


def methods(c: Calibration) -> list[dict]:
    """Also the search from which this result started, where its step is not among the others."""
    rows = c.get("compare") or []
    grid = c.get("grid") or {}
    if not c.is_turntable or not rows or not grid.get("nodes") or "M" not in grid or "N" not in grid:
        return rows
    resolution = 1000 * grid["step"] / math.sqrt(12)
    if any(math.isclose(value(row, "step/√12/um"), resolution) for row in rows):
        return rows
    cells = {"M/mm": grid["M"], "N/mm": grid["N"], "S/um": 1000 * grid["S"], "step/√12/um": resolution,
             "nodes, iter.": grid["nodes"]}
    for name in "MN":
        apart = (grid[name] - value(rows[-1], f"{name}/mm")) / u(rows[-1], f"{name}/mm")
        cells[f"Δ{name}/u"] = apart if math.isfinite(apart) else None
    own = {"search": f"{grid['step']:g}",
           "cells": [{"column": column, "value": number, "u": None} for column, number in cells.items()]}
    return [own, *rows]


def columns(rows: list[dict]) -> list[str]:
    """In the order of the reference; a method that was left out has no cells."""
    return list(dict.fromkeys(cell["column"] for row in reversed(rows) for cell in row.get("cells") or []))


def cell(row: dict, column: str) -> Cell:
    return next((cell for cell in row.get("cells") or [] if cell["column"] == column), {})


def value(row: dict, column: str) -> float:
    """nan where there is none."""
    return _known(cell(row, column).get("value"))


def u(row: dict, column: str) -> float:
    return _known(cell(row, column).get("u"))


def _known(number: float | None) -> float:
    return math.nan if number is None else number


def column_title(column: str, t) -> str:
    """A column of a location or of a tool is called as that is."""
    title = t.named("comparison.column", column)
    return re.sub(r"/(\w+)$", r" / \1", column) if title == column else title


def method_name(row: dict, t) -> str:
    """In the language of the report."""
    return t("comparison.search", step=t.number(row["search"])) if "search" in row else t.translated(row["method"])[0]
