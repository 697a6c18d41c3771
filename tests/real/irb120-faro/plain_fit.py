#!/usr/bin/env python3
"""The user's alternative: the same robot by numpy and scipy.optimize.least_squares, every point with unit weight.

    plain_fit.py FOLDER    FOLDER: irb120-faro

Fits links, tool and tracker to every second pose, without and with gravity, and prints the mean distance of the
reflectors at the others, mm. Links after Hayati, Rz(q + theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
"""
import csv
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

NOMINAL = np.array([[0, 290, 0, -90, 0], [-90, 0, 270, 0, 0], [0, 0, 70, -90, 0], [0, 302, 0, 90, 0],
                    [0, 0, 0, -90, 0], [180, 72, 0, 0, 0]], float)
NOMINAL[:, [0, 3, 4]] = np.radians(NOMINAL[:, [0, 3, 4]])
THETA, D, A, ALPHA, BETA = range(5)
# Not the base's (theta_1, d_1), not the tool's (link 6), d before a parallel axis: its beta instead.
FREE = [(link, number) for link in range(5) for number in range(5)
        if (link, number) not in {(0, THETA), (0, D), (1, D)} and (number != BETA or link == 1)]
MILLI = 1e-3  # rad a unit of the fit


def read(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Joints (poses x 6, rad) and points (poses x 3 x 3, mm)."""
    with open(folder / "joints.csv", newline="") as f:
        joints = {row["pose"]: [float(row[f"q{k}_deg"]) for k in range(1, 7)] for row in csv.DictReader(f)}
    points: dict[str, dict[str, list[float]]] = {}
    with open(folder / "points.csv", newline="") as f:
        for row in csv.DictReader(f):
            points.setdefault(row["pose"], {})[row["point"]] = [float(row[axis]) for axis in "xyz"]
    return np.radians(list(joints.values())), np.array([[points[pose][p] for p in "123"] for pose in joints])


def turn(axis: int, angle: np.ndarray) -> np.ndarray:
    return Rotation.from_euler("xyz"[axis], angle).as_matrix()


def chain(links: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, list, list, list]:
    """Flange, and axis, origin and end of every link."""
    r, p = np.tile(np.eye(3), (len(q), 1, 1)), np.zeros((len(q), 3))
    axes, origins, ends = [], [], []
    for k, link in enumerate(links):
        axes.append(r[:, :, 2])
        origins.append(p)
        r = r @ turn(2, q[:, k] + link[THETA])
        p = p + r[:, :, 2] * link[D] + r[:, :, 0] * link[A]
        r = r @ turn(0, link[ALPHA]) @ turn(1, link[BETA])
        ends.append(p)
    return r, p, axes, origins, ends


def moments(q: np.ndarray) -> tuple[list[int], np.ndarray]:
    """Of a mass at the end of link k about axis i, over the reach: joints, poses x terms."""
    _, _, axes, origins, ends = chain(NOMINAL, q)
    reach = np.abs(NOMINAL[:, [D, A]]).sum()
    terms = [(i, np.einsum("ij,ij->i", axes[i], np.cross(ends[k] - origins[i], [0, 0, -1])) / reach)
             for i in range(6) for k in range(i, 6)]
    terms = [(i, term) for i, term in terms if np.linalg.norm(term) > 1e-6]
    return [i for i, _ in terms], np.array([term for _, term in terms]).T


def start(q: np.ndarray, seen: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tool, rotation and translation of the tracker, by linear least squares of R t + p = V m + v."""
    r, p = chain(NOMINAL, q)[:2]
    rows, right = [], []
    for pose in range(len(q)):
        for k in range(3):
            row = np.zeros((3, 21))
            row[:, 3 * k:3 * k + 3] = r[pose]
            row[:, 9:18] = -np.kron(np.eye(3), seen[pose, k])
            row[:, 18:] = -np.eye(3)
            rows.append(row)
            right.append(-p[pose])
    x = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]
    u, _, vt = np.linalg.svd(x[9:18].reshape(3, 3))
    v = u @ vt
    return x[:9], v.T, -v.T @ x[18:]


def main() -> None:
    q, seen = read(Path(sys.argv[1]))
    fitted = np.arange(len(q)) % 2 == 0
    tool, rotation, translation = start(q[fitted], seen[fitted])
    joint, moment = moments(q)

    def points(x: np.ndarray, poses: np.ndarray, terms: int) -> np.ndarray:
        links, turned = NOMINAL.copy(), q[poses].copy()
        for value, (link, number) in zip(x, FREE):
            links[link, number] += value * (1 if number in (D, A) else MILLI)
        for k in range(terms):
            turned[:, joint[k]] += moment[poses, k] * x[len(FREE) + k] * MILLI
        rest = x[len(FREE) + terms:]
        r, p = chain(links, turned)[:2]
        in_base = np.einsum("nij,kj->nki", r, rest[:9].reshape(3, 3)) + p[:, None]
        tracker = Rotation.from_rotvec(rest[12:] * MILLI).as_matrix() @ rotation
        return in_base @ tracker.T + rest[9:12] + translation

    for name, terms in (("links", 0), ("links and gravity", len(joint))):
        x = np.concatenate([np.zeros(len(FREE) + terms), tool, np.zeros(6)])
        fit = least_squares(lambda x: (points(x, fitted, terms) - seen[fitted]).ravel(), x)
        off = np.linalg.norm(points(fit.x, ~fitted, terms) - seen[~fitted], axis=2)
        print(f"{name}: {off.mean():.3f} mm")


if __name__ == "__main__":
    main()
