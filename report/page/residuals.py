"""Residuals of scans of flat targets, from the tables of calibration.json to what the figures show.

Nothing here of a robot's balls.
"""
from statistics import NormalDist

import numpy as np

from calibration import Calibration, Table

MOST_PANELS = 12  # targets in one figure
MOST_LINES = 6    # targets in one pair of axes: as many as there are colours and dashes


def scanned_targets(c: Calibration) -> list[dict]:
    """c["residuals"]["targets"], of which each also gets the "rms" of its target and its count of "profiles";
    none if there are balls."""
    targets = (c.get("residuals") or {}).get("targets") or []
    if any(target.get("balls") or target.get("poses") for target in targets):
        return []
    summaries = _of_each(targets, c.get("targets"))
    read = _of_each(targets, (c.get("data") or {}).get("targets"))
    return [{**target, "rms": summary.get("rms"), "profiles": of_data.get("profiles")}
            for target, summary, of_data in zip(targets, summaries, read)]


def _of_each(targets: list[dict], found: list[dict] | None) -> list[dict]:
    """In the same order."""
    return found if found and len(found) == len(targets) else [{}] * len(targets)


def with_table(targets: list[dict], key: str) -> list[dict]:
    return [target for target in targets if len(Table(target.get(key)))]


def worst(targets: list[dict], most: int) -> list[dict]:
    """Those with the largest rms where there are more, in their own order."""
    order = sorted(range(len(targets)), key=lambda i: -(targets[i]["rms"] or 0))
    return [targets[i] for i in sorted(order[:most])]


class Histogram:
    """Residuals in units of the standard deviation of their target, pooled: counts in bins of equal width and
    how many lie beyond either end. Targets whose bins differ from those of the first are left out."""

    def __init__(self, targets: list[dict]):
        self.counts, self.edges, self.below, self.above = np.zeros(0), np.zeros(1), 0, 0
        for target in targets:
            self._add(target.get("histogram") or {})

    def _add(self, histogram: dict) -> None:
        counts = np.array(histogram.get("counts") or [], dtype=float)
        if not counts.sum() > 0:
            return
        edges = np.linspace(histogram["from"], histogram["to"], len(counts) + 1)
        if self.total == 0:
            self.counts, self.edges = np.zeros(len(counts)), edges
        if not np.array_equal(edges, self.edges):
            return
        self.counts += counts
        self.below += histogram.get("below") or 0
        self.above += histogram.get("above") or 0

    @property
    def total(self) -> float:
        return self.counts.sum() + self.below + self.above

    @property
    def density(self) -> np.ndarray:
        return self.counts / (self.total * np.diff(self.edges))

    def quantiles(self) -> tuple[np.ndarray, np.ndarray]:
        """At every edge of a bin with residuals on both sides: the quantile of the normal distribution below
        which it would have as large a share, and the edge itself. Of the edges of an empty bin only the one
        towards the middle."""
        all_counts = np.concatenate([[self.below], self.counts, [self.above]])
        share = np.cumsum(all_counts)[:-1] / self.total
        outer = np.where(share < 0.5, all_counts[:-1], all_counts[1:])
        inside = (share > 0) & (share < 1) & (outer > 0)
        return np.array([NormalDist().inv_cdf(p) for p in share[inside]]), self.edges[inside]


def panel_columns(panels: int) -> int:
    """Panels side by side."""
    return {1: 1, 2: 2, 4: 2}.get(panels, 3)


def along_the_line(cells: Table, bins: int = 24) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """z and mean residual of the points of all cells whose middles lie in the same one of so many bins, and
    how many points these are."""
    cells_middle, points, residual = (cells["z_from"] + cells["z_to"]) / 2, cells["points"], cells["residual"]
    edges = np.linspace(cells["z_from"].min(), cells["z_to"].max(), bins + 1)
    bin_of = np.clip(np.searchsorted(edges, cells_middle, side="right") - 1, 0, bins - 1)
    used = np.isfinite(residual) & (points > 0)
    total, z, mean = (np.bincount(bin_of[used], (points * each)[used], minlength=bins)
                      for each in (np.ones(len(points)), cells_middle, residual))
    filled = total > 0
    return z[filled] / total[filled], mean[filled] / total[filled], total[filled]


def noise_of_mean(target: dict, points: np.ndarray) -> np.ndarray:
    """u of the mean of so many points, mm, from the scatter within the lines."""
    return (target.get("sigma") or 0) / np.sqrt(points) * correlation_factor(target)


def correlation_factor(target: dict) -> float:
    """By which the u of a mean along a line is larger than that of as many independent points."""
    return np.sqrt(max(1.0, target.get("correlation_length") or 1.0))


def white_noise_band(numbers: int) -> float:
    """95 % of the autocorrelations of so many independent numbers lie within this of 0 (Bartlett 1946)."""
    return NormalDist().inv_cdf(0.975) / np.sqrt(numbers)
