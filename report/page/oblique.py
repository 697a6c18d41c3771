"""Looking at a scene from obliquely above: parallel projection, from the side on which most of it is seen."""
import math
from dataclasses import dataclass

import numpy as np

ELEVATION = math.radians(24)
SIDES = np.radians(np.arange(0, 360, 15))
EDGE_ON = 0.3  # how much a plane that is seen edge-on counts, of one that is seen from the front
OPEN = 0.6     # cosine, from which on a plane is seen well enough: what stands upright on it is to be seen, too


@dataclass(frozen=True)
class View:
    """right, up: unit vectors of the picture; towards: of the viewer."""
    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray

    def __call__(self, points: np.ndarray) -> np.ndarray:
        return np.stack([points @ self.right, points @ self.up], axis=-1)


def view_from(side: float) -> View:
    """side: azimuth of the viewer, rad."""
    towards = np.array([math.cos(ELEVATION) * math.cos(side), math.cos(ELEVATION) * math.sin(side),
                        math.sin(ELEVATION)])
    right = np.array([-math.sin(side), math.cos(side), 0.0])
    return View(right, np.cross(towards, right), towards)


def best_view(points: np.ndarray, normals: list[np.ndarray]) -> View:
    """From where the points spread most, and no plane is seen edge-on."""
    def shown(view: View) -> float:
        spread = math.sqrt(max(0.0, np.linalg.det(np.cov(view(points).T))))
        return spread * (EDGE_ON + min((min(OPEN, abs(normal @ view.towards)) for normal in normals), default=OPEN))
    return max(map(view_from, SIDES), key=shown)


def normal_of(points: np.ndarray) -> np.ndarray:
    """Of the plane through them."""
    return np.linalg.svd(points - points.mean(axis=0))[2][2]


def patch(points: np.ndarray) -> np.ndarray:
    """The rectangle on their plane that holds them, 4 x 3."""
    middle = points.mean(axis=0)
    first, second, _ = np.linalg.svd(points - middle)[2]
    ends = [((points - middle) @ axis).min() for axis in (first, second)], [((points - middle) @ axis).max()
                                                                            for axis in (first, second)]
    (a, b), (p, q) = ends
    return np.array([middle + x * first + y * second for x, y in ((a, b), (p, b), (p, q), (a, q))])


def cut(outline: np.ndarray, at: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Where a plane (a point, a normal) cuts the closed line: the two points farthest apart, 2 x 3, or none."""
    beside = (outline - at) @ normal
    points = []
    for a, b, to_a, to_b in zip(outline, np.roll(outline, -1, axis=0), beside, np.roll(beside, -1)):
        if to_a * to_b < 0 or to_a == 0:
            points.append(a + (b - a) * (to_a / (to_a - to_b) if to_a != to_b else 0.0))
    if len(points) < 2:
        return np.empty((0, 3))
    points = np.array(points)
    far = points[np.argmax(np.linalg.norm(points - points[0], axis=1))]
    return np.array([points[np.argmax(np.linalg.norm(points - far, axis=1))], far])
