"""U over the working volume, from the table "volume" of a turntable: a grid of readings (alpha, y, z)."""
from dataclasses import dataclass

import numpy as np

from calibration import Calibration
from notation import significant

EVEN = 1.05  # largest over least: a step or so of the second digit
READING = ("alpha", "y", "z")


@dataclass(frozen=True)
class Volume:
    """nodes: of alpha (deg), y, z (mm); X, Y, Z, U (mm) over them, U in the direction that is known least."""
    nodes: tuple[np.ndarray, np.ndarray, np.ndarray]
    X: np.ndarray
    Y: np.ndarray
    Z: np.ndarray
    U: np.ndarray

    @property
    def least(self) -> float:
        return float(self.U.min())

    @property
    def largest(self) -> float:
        return float(self.U.max())

    @property
    def is_even(self) -> bool:
        """As good as the same throughout: a picture of it would be one of nothing."""
        return self.largest <= EVEN * self.least

    def where(self, value: float) -> dict[str, float]:
        """The first reading with this U, and the point that it says."""
        at = np.unravel_index(int(np.argmin(np.abs(self.U - value))), self.U.shape)
        return {name: float(nodes[k]) for name, nodes, k in zip(READING, self.nodes, at)} | {
            name: float(numbers[at]) for name, numbers in (("X", self.X), ("Y", self.Y), ("Z", self.Z))}

    @property
    def sliced(self) -> int:
        """Which of alpha and z U depends on least: 0 or 2. Maps of the other two lose least."""
        return min((2, 0), key=lambda axis: float(np.ptp(self.U, axis=axis).max()))

    @property
    def slices(self) -> list[int]:
        """Nodes of that: lowest, middle, highest; one where U is the same in all, to two digits."""
        maps = np.moveaxis(self.U, self.sliced, 0)
        middle = len(maps) // 2
        same = all(significant(a) == significant(b)
                   for each in maps for a, b in zip(each.ravel(), maps[middle].ravel()))
        return [middle] if same else sorted({0, middle, len(maps) - 1})


def of(c: Calibration) -> Volume | None:
    """None where there is no such table, or not a whole grid of finite numbers."""
    table = c.table("volume")
    names = [*READING, "X", "Y", "Z", "U_max"]
    if not len(table) or not all(name in table for name in names):
        return None
    alpha, y, z = (np.unique(table[name]) for name in READING)
    shape = len(alpha), len(y), len(z)
    if np.prod(shape) != len(table) or not np.isfinite(table.rows).all():
        return None
    order = np.lexsort([table[name] for name in reversed(READING)])
    return Volume((np.degrees(alpha), y, z), *(table[name][order].reshape(shape) for name in names[3:]))
