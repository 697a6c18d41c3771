"""Where everything stood: the table frame of a turntable, its axis Z; the base of a robot."""
from dataclasses import dataclass

import numpy as np

from calibration import Calibration, Table


@dataclass(frozen=True)
class Standing:
    """One target: outline n x 3 (around a plate, or balls of an artifact), eyes and points seen m x 3; mm."""
    name: str
    outline: np.ndarray
    eyes: np.ndarray
    seen: np.ndarray

    @property
    def all_points(self) -> np.ndarray:
        points = np.vstack([self.outline, self.eyes, self.seen])
        return points[np.isfinite(points).all(axis=1)]

    @property
    def middle(self) -> np.ndarray:
        points = self.outline if len(self.outline) else self.seen
        return np.nanmean(points, axis=0)


def standings(c: Calibration) -> list[Standing]:
    """Targets of which anything is known."""
    targets = (c.get("scene") or {}).get("targets") or []
    found = [Standing(each.get("name", ""), _points(each.get("outline"), ""),
                      _points(each.get("views"), "from_"),
                      _points(each.get("views"), "to_")) for each in targets]
    return [each for each in found if len(each.outline) + len(each.eyes) and np.isfinite(each.middle).all()]


def from_above(points: np.ndarray) -> np.ndarray:
    return points[..., :2]


def beside_axis(points: np.ndarray) -> np.ndarray:
    """Distance from Z, and height: what turns with a table stays where it is."""
    return np.stack([np.hypot(points[..., 0], points[..., 1]), points[..., 2]], axis=-1)


def from_front(points: np.ndarray) -> np.ndarray:
    return points[..., [0, 2]]


def closed(corners: np.ndarray, pieces: int = 40) -> np.ndarray:
    """The line around a plate, in pieces: seen beside an axis its edges are bent."""
    share = np.linspace(0, 1, pieces, endpoint=False)[:, None]
    sides = [a + share * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))]
    return np.vstack(sides + [corners[:1]])


def thinned(number: int, most: int) -> np.ndarray:
    """Indices, first and last among them."""
    return np.unique(np.linspace(0, max(0, number - 1), min(number, most)).round().astype(int))


def _points(json_table: dict | None, prefix: str) -> np.ndarray:
    table = Table(json_table)
    if not all(prefix + axis in table for axis in "XYZ"):
        return np.empty((0, 3))
    return np.column_stack([table[prefix + axis] for axis in "XYZ"])
