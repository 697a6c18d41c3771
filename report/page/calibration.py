"""calibration.json as the report reads it: its keys as they are, its tables as columns."""
import hashlib
import json
import math
import re
from pathlib import Path

import numpy as np

FORMAT_VERSION = 1
LINK_ERROR = re.compile(r"(theta|d|a|alpha|beta)_\d+")


class Complaint(Exception):
    """What is wrong with the input, and what to do, in one sentence."""


class Table:
    """{"columns": [...], "units": [...], "names": [...], "rows": [[...]]}: a column by its name, null as nan."""

    def __init__(self, json_table: dict | None):
        json_table = json_table or {}
        self.columns: list[str] = json_table.get("columns", [])
        self.units: list[str] = json_table.get("units", [])
        self.names: list[str] = json_table.get("names", [])  # of the rows
        rows = [[math.nan if number is None else number for number in row] for row in json_table.get("rows", [])]
        self.rows = np.array(rows, dtype=float).reshape(len(rows), len(self.columns))

    def __len__(self) -> int:
        return len(self.rows)

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    def __getitem__(self, column: str) -> np.ndarray:
        return self.rows[:, self.columns.index(column)]


class Calibration(dict):
    """The file's own keys: c["status"]; below, what more than one section of the report asks."""

    file: Path
    sha256: str = ""  # of the file

    def add_figures(self, figures: dict | None) -> None:
        """What `scancal report` computes again because the file leaves it out; files of older versions hold it."""
        figures = dict(figures or {})
        self["messages"] = (self.get("messages") or []) + figures.pop("messages", [])
        self.update(figures)

    @property
    def is_reliable(self) -> bool:
        return self["status"] == "ok"

    @property
    def is_turntable(self) -> bool:
        return self["model"] == "turntable"

    @property
    def estimated(self) -> list[dict]:
        """Parameters with an uncertainty, in the order of "covariance"."""
        return [parameter for parameter in self["parameters"] if parameter["role"] == "estimate"]

    @property
    def link_errors(self) -> list[dict]:
        """The estimated errors of a robot's links."""
        return [parameter for parameter in self.estimated if LINK_ERROR.fullmatch(parameter["name"])]

    @property
    def own(self) -> list[dict]:
        """The estimated parameters that are the result: all but a robot's link errors, which have a table of theirs."""
        return [parameter for parameter in self.estimated if parameter not in self.link_errors] or self.estimated

    @property
    def coverage_percent(self) -> float:
        """Of every U."""
        return 100 * (self.get("coverage_probability") or 0.95)

    def parameter(self, name: str) -> dict | None:
        return next((parameter for parameter in self["parameters"] if parameter["name"] == name), None)

    @property
    def covariance(self) -> np.ndarray:
        """n x n, of the estimated parameters; mm and rad. What is not known is nan."""
        return self._square("covariance")

    @property
    def correlation(self) -> np.ndarray:
        return self._square("correlation")

    def _square(self, key: str) -> np.ndarray:
        n, rows = len(self.estimated), self.get(key) or []
        if [len(row) for row in rows] != [n] * n:
            return np.full((n, n), np.nan)
        return np.array(rows, dtype=float).reshape(n, n)

    def table(self, *path: str) -> Table:
        """The table at that path of keys; empty if this calibration has none."""
        found = self
        for key in path:
            found = (found or {}).get(key)
        return Table(found)

    @property
    def traceable(self) -> bool:
        """Something systematic was declared (type B): else u is of repeatability and fit only. What is anew in every
        view or point is noise, declared or not."""
        noise = {each["source"] for each in self.get("influences") or [] if each.get("scope") in ("view", "point")}
        return any(line.get("type") == "B" and line["source"] not in noise for line in self.get("budget") or [])


def read_calibration(file: Path) -> Calibration:
    """Raises Complaint for what is no calibration.json of a version that is known."""
    try:
        content = file.read_bytes()
        found = json.loads(content.decode("utf-8"))
    except OSError as error:
        raise Complaint(f"{file}: {error.strerror}; expected a calibration.json of scancal refine") from None
    except json.JSONDecodeError as error:
        raise Complaint(f"{file}:{error.lineno}:{error.colno}: {error.msg}; expected a whole calibration.json") from None
    except UnicodeDecodeError:
        raise Complaint(f"{file}: not UTF-8 text; expected a calibration.json of scancal refine") from None
    if not isinstance(found, dict) or "scancal" not in found:
        raise Complaint(f'{file}: expected a format version, "scancal": 1; is it a calibration.json?')
    if found["scancal"] != FORMAT_VERSION:
        raise Complaint(f"{file}: format version {found['scancal']}, expected {FORMAT_VERSION}; use a newer scancal")
    for key, kind in (("model", str), ("parameters", list), ("status", str)):
        if not isinstance(found.get(key), kind):
            raise Complaint(f'{file}: expected "{key}"; is it a calibration.json?')
    calibration = Calibration(found)
    calibration.file, calibration.sha256 = file, hashlib.sha256(content).hexdigest()
    return calibration
