#!/usr/bin/env python3
"""The user's alternative: the same robots by numpy and scipy.optimize.least_squares, every number with unit weight.

    plain_fit.py ROBOT FOLDER    irb120-faro or ipa-robot-accuracy, and the folder of that name

Fits links, tool and tracker to every second pose, without and with gravity, and prints the mean distance at the others,
mm: of the IRB 120's three reflectors, of the origin of the UR10's 6-DoF target, of which three points are fitted (its
origin, 100 mm along its x and its y). Links after Hayati, Rz(q + theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
"""
import csv
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

THETA, D, A, ALPHA, BETA = range(5)
MILLI = 1e-3  # rad a unit of the fit


def nominal(rows: list[list[float]]) -> np.ndarray:
    links = np.array(rows, float)
    links[:, [THETA, ALPHA, BETA]] = np.radians(links[:, [THETA, ALPHA, BETA]])
    return links


def read_irb120(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Joints (poses x 6, rad) and points (poses x 3 x 3, mm)."""
    with open(folder / "joints.csv", newline="") as f:
        joints = {row["pose"]: [float(row[f"q{k}_deg"]) for k in range(1, 7)] for row in csv.DictReader(f)}
    points: dict[str, dict[str, list[float]]] = {}
    with open(folder / "points.csv", newline="") as f:
        for row in csv.DictReader(f):
            points.setdefault(row["pose"], {})[row["point"]] = [float(row[axis]) for axis in "xyz"]
    return np.radians(list(joints.values())), np.array([[points[pose][p] for p in "123"] for pose in joints])


def read_ur10(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """The same of points of the target."""
    with open(folder / "Series_B" / "measurements_joint_configurations.csv", newline="") as f:
        rows = list(csv.DictReader(f, delimiter=";"))

    def numbers(names: list[str]) -> np.ndarray:
        return np.array([[float(row[name].replace(",", ".")) for name in names] for row in rows])

    joints = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
    turns = Rotation.from_euler("XYZ", numbers([f"measurement_r{axis}" for axis in "xyz"]), degrees=True).as_matrix()
    on_target = np.array([[0, 0, 0], [100, 0, 0], [0, 100, 0]], float)
    return (numbers([f"{joint}_joint" for joint in joints]),
            numbers([f"measurement_{axis}" for axis in "xyz"])[:, None] + np.einsum("nij,kj->nki", turns, on_target))


# Nominal links; those whose next axis is parallel; the reader; how many points count.
ROBOTS = {
    "irb120-faro": (nominal([[0, 290, 0, -90, 0], [-90, 0, 270, 0, 0], [0, 0, 70, -90, 0], [0, 302, 0, 90, 0],
                             [0, 0, 0, -90, 0], [180, 72, 0, 0, 0]]), {1}, read_irb120, 3),
    "ipa-robot-accuracy": (nominal([[0, 127.3, 0, 90, 0], [0, 0, -612, 0, 0], [0, 0, -572.3, 0, 0],
                                    [0, 163.941, 0, 90, 0], [0, 115.7, 0, -90, 0], [0, 92.2, 0, 0, 0]]),
                           {1, 2}, read_ur10, 1),
}


def chain(links: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, list, list, list]:
    """Flange, and axis, origin and end of every link."""
    r, p = np.tile(np.eye(3), (len(q), 1, 1)), np.zeros((len(q), 3))
    axes, origins, ends = [], [], []
    for k, link in enumerate(links):
        axes.append(r[:, :, 2])
        origins.append(p)
        r = r @ Rotation.from_euler("z", q[:, k] + link[THETA]).as_matrix()
        p = p + r[:, :, 2] * link[D] + r[:, :, 0] * link[A]
        r = r @ Rotation.from_euler("x", link[ALPHA]).as_matrix() @ Rotation.from_euler("y", link[BETA]).as_matrix()
        ends.append(p)
    return r, p, axes, origins, ends


def moments(links: np.ndarray, q: np.ndarray) -> tuple[list[int], np.ndarray]:
    """Of a mass at the end of link k about axis i, over the reach: joints, poses x terms."""
    _, _, axes, origins, ends = chain(links, q)
    reach = np.abs(links[:, [D, A]]).sum()
    terms = [(i, np.einsum("ij,ij->i", axes[i], np.cross(ends[k] - origins[i], [0, 0, -1])) / reach)
             for i in range(6) for k in range(i, 6)]
    terms = [(i, term) for i, term in terms if np.linalg.norm(term) > 1e-6]
    return [i for i, _ in terms], np.array([term for _, term in terms]).T


def start(links: np.ndarray, q: np.ndarray, seen: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points on the tool, rotation and translation of the tracker, by linear least squares of R t + p = V m + v."""
    r, p = chain(links, q)[:2]
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
    robot, parallel, read, counted = ROBOTS[sys.argv[1]]
    # Not the base's (theta_1, d_1), not the tool's (link 6), d before a parallel axis: its beta instead.
    free = [(link, number) for link in range(5) for number in range(5)
            if (link, number) not in {(0, THETA), (0, D)} and (number != D or link not in parallel)
            and (number != BETA or link in parallel)]
    q, seen = read(Path(sys.argv[2]))
    fitted = np.arange(len(q)) % 2 == 0
    tool, rotation, translation = start(robot, q[fitted], seen[fitted])
    joint, moment = moments(robot, q)

    def points(x: np.ndarray, poses: np.ndarray, links_free: bool, terms: int) -> np.ndarray:
        links, turned = robot.copy(), q[poses].copy()
        for value, (link, number) in zip(x, free if links_free else []):
            links[link, number] += value * (1 if number in (D, A) else MILLI)
        rest = x[len(free) * links_free:]
        for k in range(terms):
            turned[:, joint[k]] += moment[poses, k] * rest[k] * MILLI
        rest = rest[terms:]
        r, p = chain(links, turned)[:2]
        in_base = np.einsum("nij,kj->nki", r, rest[:9].reshape(3, 3)) + p[:, None]
        tracker = Rotation.from_rotvec(rest[12:] * MILLI).as_matrix() @ rotation
        return in_base @ tracker.T + rest[9:12] + translation

    for name, links_free, terms in (("nominal", False, 0), ("links", True, 0), ("links and gravity", True, len(joint))):
        x = np.concatenate([np.zeros(len(free) * links_free + terms), tool, np.zeros(6)])
        fit = least_squares(lambda x: (points(x, fitted, links_free, terms) - seen[fitted]).ravel(), x)
        off = np.linalg.norm(points(fit.x, ~fitted, links_free, terms) - seen[~fitted], axis=2)[:, :counted]
        print(f"{name}: {off.mean():.3f} mm")


if __name__ == "__main__":
    main()
