"""Known lengths that took no part in the calibration: their errors before and after it."""
from dataclasses import dataclass

import numpy as np

from calibration import Calibration


@dataclass(frozen=True)
class KnownLength:
    """Errors, measured minus known, in mm; u of the length, nan where it is not known."""
    name: str
    before: float
    after: float
    u: float


def known_lengths(c: Calibration) -> list[KnownLength]:
    """In the order of the file."""
    check = c.get("check") or {}
    before, after = ((check.get(when) or {}).get("errors") or [] for when in ("before", "after"))
    number = max(len(before), len(after))
    columns = [_padded(errors, number) for errors in (before, after, check.get("u") or [])]
    names = (check.get("names") or []) + [str(k + 1) for k in range(number)]
    return [KnownLength(name, *map(float, row)) for name, row in zip(names, zip(*columns))]


def worst(found: list[KnownLength], most: int) -> list[KnownLength]:
    """Those with the largest error after the calibration where there are more, in their own order."""
    order = sorted(range(len(found)), key=lambda i: -np.nan_to_num(abs(found[i].after)))
    return [found[i] for i in sorted(order[:most])]


def mean_and_max(errors: list[float]) -> tuple[float, float]:
    """Of their sizes; nan of none."""
    sizes = np.abs([error for error in errors if np.isfinite(error)])
    return (float(sizes.mean()), float(sizes.max())) if len(sizes) else (np.nan, np.nan)


def _padded(numbers: list, length: int) -> list[float]:
    return [np.nan if number is None else number for number in numbers] + [np.nan] * (length - len(numbers))
