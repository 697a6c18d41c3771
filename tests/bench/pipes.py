"""Points that are never in one place: three placements come through named pipes as they are made.

usage: pipes.py PROGRAM PROFILES POINTS

Profiles of each placement, points of each profile; needs numpy. Prints points, elapsed and processor time, the most
memory that was resident, and the size of calibration.json.
"""
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

M, N = 123.0, 409.0
PLANES = {"left": (-25, 12, 150), "centre": (0, -9, 110), "right": (25, 15, 165)}  # azimuth, elevation, distance
DATASET = """scancal: 1
model: turntable
units: {length: mm, angle: deg}
rotation: clockwise
search: {M: [110, 130], N: [395, 425], step: 1}
columns: [angle, y, z]
targets:
""" + "".join(f"  - {{name: {name}, scan: {name}.npy}}\n" for name in PLANES)
AT_ONCE = 64  # profiles


def write(pipe, plane, profiles, points):
    """Points of a plane with 0.05 mm noise along depth: n . Rz(pi - alpha) (-M, N + y, z) = distance."""
    azimuth, elevation, distance = np.radians(plane[0]), np.radians(plane[1]), plane[2]
    n = [np.sin(azimuth) * np.cos(elevation), -np.cos(azimuth) * np.cos(elevation), np.sin(elevation)]
    random = np.random.default_rng(plane[2])
    noise = (0.05 * random.standard_normal(1 << 22)).astype(np.float32)  # a part of it, anew for every batch
    z = np.linspace(-80, 80, points)
    with open(pipe, "wb") as file:
        header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({profiles * points}, 3), }}"
        header += " " * (63 - (10 + len(header)) % 64) + "\n"
        file.write(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
        for first in range(0, profiles, AT_ONCE):
            degrees = -15 + 30 * np.arange(first, min(first + AT_ONCE, profiles)) / profiles
            c, s = np.cos(np.radians(degrees) - np.pi), np.sin(np.radians(degrees) - np.pi)
            along_x, along_y = c * n[0] - s * n[1], s * n[0] + c * n[1]
            y = ((distance + M * along_x)[:, None] - n[2] * z) / along_y[:, None] - N
            at = random.integers(0, noise.size - y.size)
            rows = np.empty((*y.shape, 3), np.float32)
            rows[..., 0], rows[..., 1], rows[..., 2] = degrees[:, None], y + noise[at:at + y.size].reshape(y.shape), z
            file.write(rows.tobytes())


def main():
    program, profiles, points = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "dataset.yaml").write_text(DATASET)
        for name, plane in PLANES.items():
            pipe = Path(folder) / f"{name}.npy"
            os.mkfifo(pipe)
            if os.fork() == 0:
                write(pipe, plane, profiles, points)
                os._exit(0)
        began = time.monotonic()
        out = Path(folder) / "out"
        pid = os.posix_spawn(program, [program, "refine", folder, f"--out={out}"], os.environ)
        _, status, used = os.wait4(pid, 0)
        print(f"{3 * profiles * points} points in {3 * profiles} profiles: exit code {os.waitstatus_to_exitcode(status)},"
              f" {time.monotonic() - began:.0f} s ({used.ru_utime + used.ru_stime:.0f} s of processor),"
              f" {used.ru_maxrss * 1024 / 1e6:.0f} MB,"
              f" calibration.json {(out / 'calibration.json').stat().st_size / 1e6:.0f} MB")


main()
