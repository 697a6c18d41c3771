"""The joint region of two quantities."""
import numpy as np


def semi_axes(covariance: np.ndarray, k: float) -> tuple[np.ndarray, np.ndarray]:
    """Of {x: x' covariance^-1 x = k^2}: lengths, the longer first, and unit directions as columns."""
    values, directions = np.linalg.eigh(covariance)
    return k * np.sqrt(np.maximum(values[::-1], 0)), directions[:, ::-1]


def outline(centre: np.ndarray, covariance: np.ndarray, k: float, points: int = 181) -> np.ndarray:
    """2 x points."""
    lengths, directions = semi_axes(covariance, k)
    turn = np.linspace(0, 2 * np.pi, points)
    return centre[:, None] + directions @ (lengths[:, None] * np.array([np.cos(turn), np.sin(turn)]))
