"""Names beside what they name, so that none lies on another, on what is drawn or outside its axes."""
import math

import numpy as np
from matplotlib.transforms import Bbox

import style

_DIRECTIONS = [0, 180, 90, 270, 45, 135, 315, 225]  # degrees: the sides first
_DISTANCES = [4, 10, 18, 28, 40, 56]  # points
_TIED_FROM = 14  # points: a name farther off is tied to what it names
_AIR = 2.5       # points around a name
_OWN = 6         # points around what is named, where its tie may lie on what is drawn


def place_labels(axes, points, names: list[str], obstacles=(), directions=None, looks=()) -> list[int]:
    """Writes each name beside its point (data coordinates), the first one first, and returns which found
    room; the others are left out. obstacles: (x, y) that no name may hide. directions: degrees, where each name
    should lie if it can; looks: of each text. Names take no part in the layout of the figure: everything else
    must be there."""
    axes.figure.draw_without_rendering()
    points = np.array(points, dtype=float).reshape(-1, 2)
    drawn = np.vstack([points, np.array(obstacles, dtype=float).reshape(-1, 2)])
    sheet = _Sheet(axes, drawn[np.isfinite(drawn).all(axis=1)])
    placed = []
    for k, name in enumerate(names):
        text = axes.annotate(name, points[k], (0, 0), textcoords="offset points", ha="center", va="center",
                             annotation_clip=False, **{"fontsize": 8} | (looks[k] if looks else {}))
        text.set_in_layout(False)
        place = sheet.place(points[k], text, [] if directions is None else [directions[k]])
        if place is None:
            text.remove()
            continue
        text.set_position(place.centre)
        if place.is_tied:
            line = {"arrowstyle": "-", "color": style.MUTED, "lw": 0.5, "shrinkA": 0, "shrinkB": 2}
            tie = axes.annotate("", points[k], place.tie, textcoords="offset points", annotation_clip=False,
                                zorder=1, arrowprops=line)
            tie.set_in_layout(False)
        placed.append(k)
    return placed


def along(start, end, pieces: int = 40) -> np.ndarray:
    """Points of a line, as obstacles."""
    return np.linspace(np.asarray(start, dtype=float), np.asarray(end, dtype=float), pieces)


class _Place:
    """Of a name; centre and tie in points from what it names."""

    def __init__(self, distance: float, direction: float, half: np.ndarray):
        ray = np.array([math.cos(math.radians(direction)), math.sin(math.radians(direction))])
        self.centre = ray * distance + half * np.clip(ray * math.sqrt(2), -1, 1)
        self.tie = np.clip(0, self.centre - half, self.centre + half)
        self.is_tied = distance >= _TIED_FROM
        self.half = half

    def box(self, at: np.ndarray) -> Bbox:
        return Bbox([at + self.centre - self.half, at + self.centre + self.half]).padded(_AIR)

    def line(self, at: np.ndarray) -> np.ndarray:
        return at + along(0 * self.tie, self.tie) if self.is_tied else np.empty((0, 2))


class _Sheet:
    """What stands on the axes, in points (1/72 inch)."""

    def __init__(self, axes, drawn: np.ndarray):
        self._to_points = axes.transData.transform
        self._per_pixel = 72 / axes.figure.dpi
        inside = axes.get_window_extent()
        self._inside = Bbox([inside.min * self._per_pixel, inside.max * self._per_pixel])
        self._drawn = self._at(drawn)
        self._names: list[Bbox] = []
        self._ties = np.empty((0, 2))

    def place(self, point: np.ndarray, text, wished: list[float]) -> _Place | None:
        """The nearest free one; rather a farther one than a tie across what is drawn."""
        at, size = self._at(point), text.get_window_extent()
        half = np.array([size.width, size.height]) * self._per_pixel / 2
        places = [_Place(distance, direction, half) for distance in _DISTANCES
                  for direction in [*wished, *_DIRECTIONS]]
        free = [place for place in places if self._is_free(place, at)]
        clear = (place for place in free if not self._crosses(place.line(at), at))
        found = next(clear, free[0] if free else None)
        if found is not None:
            self._names.append(found.box(at))
            self._ties = np.vstack([self._ties, found.line(at)])
        return found

    def _at(self, points: np.ndarray) -> np.ndarray:
        return self._to_points(points) * self._per_pixel if np.size(points) else np.empty((0, 2))

    def _is_free(self, place: _Place, at: np.ndarray) -> bool:
        box = place.box(at)
        return ((box.min >= self._inside.min).all() and (box.max <= self._inside.max).all()
                and not any(box.overlaps(name) or _holds(name, place.line(at)) for name in self._names)
                and not _holds(box, self._drawn) and not _holds(box, self._ties))

    def _crosses(self, line: np.ndarray, at: np.ndarray) -> bool:
        line = line[np.hypot(*(line - at).T) > _OWN]
        return any((np.hypot(*(self._drawn - point).T) < _AIR).any() for point in line)


def _holds(box: Bbox, points: np.ndarray) -> bool:
    return bool(((points > box.min) & (points < box.max)).all(axis=1).any())
