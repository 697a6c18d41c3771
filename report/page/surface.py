"""The searched surface S(M, N) (Zhao et al. 2021, eq. 15, Fig. 6) from its table, and a scale for it."""
import numpy as np
from matplotlib.colors import LogNorm, Normalize

from calibration import Calibration, Table
from notation import length_unit

DECADES = 1.3  # of S: from here on its levels are logarithmic
LEVELS = 14


class Surface:
    """M and N of the nodes, mm; S a row for each M, a column for each N, nan where there is none."""

    def __init__(self, table: Table):
        complete = len(table) > 0 and all(name in table for name in "MNS")
        self.M, self.N = (np.unique(table[name]) if complete else np.zeros(0) for name in "MN")
        self.S = np.full((len(self.M), len(self.N)), np.nan)
        if complete:
            self.S[np.searchsorted(self.M, table["M"]), np.searchsorted(self.N, table["N"])] = table["S"]

    def __bool__(self) -> bool:
        return min(self.S.shape) > 1 and bool(np.isfinite(self.S).any())

    def holds(self, M: float, N: float) -> bool:
        return self.M[0] <= M <= self.M[-1] and self.N[0] <= N <= self.N[-1]

    @property
    def is_logarithmic(self) -> bool:
        least, most = np.nanmin(self.S), np.nanmax(self.S)
        return least > 0 and np.log10(most / least) > DECADES

    def levels(self) -> tuple[np.ndarray, Normalize]:
        """In mm, from the least to the largest S."""
        least, most = np.nanmin(self.S), np.nanmax(self.S)
        if self.is_logarithmic:
            return np.geomspace(least, most, LEVELS + 1), LogNorm(least, most)
        most = most if most > least else least + 1e-9
        return np.linspace(least, most, LEVELS + 1), Normalize(least, most)


def unit_of_S(c: Calibration) -> tuple[float, str]:
    """The same for all figures."""
    return length_unit(min(np.nanmin(surface.S) for surface in (searched(c), near(c)) if surface))


def searched(c: Calibration) -> Surface:
    return Surface(c.table("surface", "search"))


def near(c: Calibration) -> Surface:
    return Surface(c.table("surface", "near"))


def grid_minimum(c: Calibration) -> tuple[float, float] | None:
    grid = c.get("grid") or {}
    return (grid["M"], grid["N"]) if grid.get("nodes") and "M" in grid and "N" in grid else None


def refined(c: Calibration) -> tuple[float, float] | None:
    M, N = c.parameter("M"), c.parameter("N")
    return (M["value"], N["value"]) if M and N else None
