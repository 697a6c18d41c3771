"""Methods on the same data, as "compare" of calibration.json has them; the last one is the reference."""
import math

from calibration import Calibration

Cell = dict  # "column", "value", "u"
# Columns of a robot that hold more than one length or location.
SUMMARIES = ["max/mm", "mean/mm", "rms of balls/mm", "calibrated with/mm", "held out/mm", "worst spacing/mm",
             "worst, held out/mm"]


def methods(c: Calibration) -> list[dict]:
    return c.get("compare") or []


def columns(rows: list[dict]) -> list[str]:
    """In the order of the file; a method that was left out has no cells."""
    return list(dict.fromkeys(cell["column"] for row in rows for cell in row.get("cells") or []))


def cell(row: dict, column: str) -> Cell:
    return next((cell for cell in row.get("cells") or [] if cell["column"] == column), {})


def value(row: dict, column: str) -> float:
    """nan where there is none."""
    return _known(cell(row, column).get("value"))


def u(row: dict, column: str) -> float:
    return _known(cell(row, column).get("u"))


def _known(number: float | None) -> float:
    return math.nan if number is None else number


def method_name(row: dict, t) -> str:
    """In the language of the report."""
    return t.translated(row["method"])[0]
