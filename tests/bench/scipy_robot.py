"""The joint fit of robot, hand-eye and artifact as one writes it with numpy and scipy: residuals of all poses at once.

usage: scipy_robot.py START.json

START.json holds links, poses, balls, noise and the start. Prints the answer as JSON. One thread, as on the other side.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # before numpy is loaded
    os.environ[name] = "1"

import json
import sys
import time

import numpy as np
import scipy
from scipy.optimize import least_squares

METHOD = "trf"
TOLERANCE = 1e-12
HAND_EYE, OWN = 6, 6


def rotation(v):
    """Rotation matrices of rotation vectors, (..., 3) to (..., 3, 3)."""
    angle = np.linalg.norm(v, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(v.shape + (3,))
    small = angle < 1e-9
    safe = np.where(small, 1, angle)
    first = np.where(small, 1, np.sin(safe) / safe)
    second = np.where(small, 0.5, (1 - np.cos(safe)) / safe**2)
    return np.eye(3) + first * cross + second * (cross @ cross)


def turned(frame, angle, u, v):
    """Columns u and v of the rotations turned by the angle about the third."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    frame[:, :, u], frame[:, :, v] = frame[:, :, u] * c + frame[:, :, v] * s, frame[:, :, v] * c - frame[:, :, u] * s


class Robot:
    def __init__(self, start):
        self.links = np.array(start["links"])  # theta, d, a, alpha, beta
        self.free = np.array(start["free"])  # which of them, flat
        self.prior = np.array(start["prior"])
        self.joints = np.array(start["joints"])
        self.station = np.array(start["station"])
        self.balls = np.array(start["balls"])  # pose, ball, xyz
        self.spheres = np.array(start["spheres"])
        self.reference = np.array(start["base_from_artifact"])
        noise, repeatability = start["ball_noise"], start["repeatability"]
        n = self.balls.shape[1]
        self.noise = noise
        self.common = 1 - 1 / np.sqrt(1 + n * (repeatability / noise) ** 2)

    def base_from_flange(self, errors):
        poses = len(self.joints)
        frame = np.tile(np.eye(3), (poses, 1, 1))
        origin = np.zeros((poses, 3))
        for (theta, d, a, alpha, beta), q in zip(self.links + errors, self.joints.T):
            turned(frame, q + theta, 0, 1)
            origin += frame[:, :, 2] * d + frame[:, :, 0] * a
            turned(frame, np.full(poses, alpha), 1, 2)
            turned(frame, np.full(poses, beta), 2, 0)
        return frame, origin

    def residuals(self, x):
        system = HAND_EYE + len(self.free)
        errors = np.zeros(self.links.size)
        errors[self.free] = x[HAND_EYE:system]
        frame, origin = self.base_from_flange(errors.reshape(self.links.shape))
        scanner = frame @ rotation(x[3:6])
        origin = origin + frame @ x[:3]
        own = x[system:].reshape(-1, OWN)
        in_base = (rotation(own[:, 3:]) @ self.reference[:, :3, :3]) @ self.spheres.T
        in_base += (self.reference[:, :3, 3] + own[:, :3])[:, :, None]
        r = self.balls - np.moveaxis(in_base[self.station] - origin[:, :, None], 1, 2) @ scanner
        r -= self.common * r.mean(axis=1, keepdims=True)  # repeatability is common to the balls of a pose
        return np.concatenate([r.ravel() / self.noise, x[HAND_EYE:system] / self.prior])


def main():
    with open(sys.argv[1]) as file:
        start = json.load(file)
    robot = Robot(start)
    began = time.process_time()
    fit = least_squares(
        robot.residuals,
        np.array(start["x"]),
        method=METHOD,
        x_scale="jac",
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        gtol=TOLERANCE,
    )
    seconds = time.process_time() - began
    answer = {
        "x": list(fit.x),
        "cost": 2 * fit.cost,
        "seconds": seconds,
        "calls": int(fit.nfev),
        "version": scipy.__version__,
        "method": METHOD,
    }
    print(json.dumps(answer))


main()
