"""Where a robot's arm goes in a pose: its links as the model has them, eqs. (2) to (4) of Zhou et al. 2025,

    link_i = Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i) Ry(beta_i)

with nominal numbers and the errors that were found (models/chain/chain.h); what joints do besides is left out: nobody
sees it in a picture."""
import math

import numpy as np

from calibration import Calibration

NUMBERS = ("theta", "d", "a", "alpha", "beta")


def links(c: Calibration) -> np.ndarray:
    """One row of numbers a link, mm and rad; no rows where the file does not have all of them."""
    values = {p["name"]: p["nominal"] + (p.get("value") or 0.0) for p in c["parameters"]
              if p.get("nominal") is not None}
    count = 0
    while all(f"{name}_{count + 1}" in values for name in NUMBERS):
        count += 1
    rows = [[values[f"{name}_{k + 1}"] for name in NUMBERS] for k in range(count)]
    return np.array(rows).reshape(count, len(NUMBERS))


def along(numbers: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points at which the arm bends, in the base, first its origin, and the flange, base_from_flange (4 x 4)."""
    frame, points = np.eye(4), [np.zeros(3)]
    for q, (theta, d, a, alpha, beta) in zip(angles, numbers):
        frame = frame @ _turn(2, q + theta) @ _shift(2, d)
        points.append(frame[:3, 3])
        frame = frame @ _shift(0, a) @ _turn(0, alpha) @ _turn(1, beta)
        points.append(frame[:3, 3])
    return np.array(points), frame


def _turn(axis: int, angle: float) -> np.ndarray:
    turned, (i, j) = np.eye(4), ((axis + 1) % 3, (axis + 2) % 3)
    turned[i, i] = turned[j, j] = math.cos(angle)
    turned[j, i], turned[i, j] = math.sin(angle), -math.sin(angle)
    return turned


def _shift(axis: int, by: float) -> np.ndarray:
    shifted = np.eye(4)
    shifted[axis, 3] = by
    return shifted
