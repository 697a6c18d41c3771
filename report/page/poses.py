"""Robot poses and the residuals of what was seen from them, from the tables of calibration.json."""
from dataclasses import dataclass

import numpy as np

from calibration import Calibration, Table


@dataclass(frozen=True)
class Station:
    """m poses at one place of the artifact (of the tool, for a ball on the flange), and the residuals of the n
    balls that they saw, in the scanner's frame (flange-ball: in the base, turned back by theta_1); mm, rad."""
    name: str
    poses: list[str]
    joints: np.ndarray    # m x joints; m x 0 where poses of the flange were given
    flange: np.ndarray    # m x 3, in the base
    pose_of: np.ndarray   # n: row of a pose
    ball_of: list[str]    # n; of a ball on the flange: its socket
    residuals: np.ndarray  # n x 3

    @property
    def lengths(self) -> np.ndarray:
        """Of the residuals."""
        return np.linalg.norm(self.residuals, axis=1)


def stations(c: Calibration) -> list[Station]:
    """Those of which the poses are known."""
    targets = (c.get("residuals") or {}).get("targets") or []
    return [_station(target) for target in targets if len(Table(target.get("poses")))]


def worst(found: list[Station], most: int) -> list[Station]:
    """Those with the longest residuals where there are more, in their own order."""
    order = sorted(range(len(found)), key=lambda i: -found[i].lengths.max(initial=0))
    return [found[i] for i in sorted(order[:most])]


def joint_angles(c: Calibration) -> np.ndarray:
    """All poses x joints, in degrees; empty where poses of the flange were given."""
    found = [each.joints for each in stations(c)]
    if not found or len({of.shape[1] for of in found}) > 1:
        return np.empty((0, 0))
    joints = np.degrees(np.vstack(found))
    return joints[np.isfinite(joints).all(axis=1)]


def _station(target: dict) -> Station:
    poses, balls = Table(target.get("poses")), Table(target.get("balls"))
    residuals = _columns(balls, ["pose", "x", "y", "z"])
    residuals = residuals[np.isfinite(residuals).all(axis=1)]
    pose_of = residuals[:, 0].astype(int)
    return Station(target.get("name") or "", poses.names or [str(k + 1) for k in range(len(poses))],
                   _columns(poses, [name for name in poses.columns if name.startswith("q")]),
                   _columns(poses, ["x", "y", "z"]), pose_of, _balls(poses, balls), residuals[:, 1:])


def _balls(poses: Table, balls: Table) -> list[str]:
    """Of the residuals that are numbers; of a ball on the flange the socket, which the pose knows."""
    known = np.flatnonzero(np.isfinite(balls.rows).all(axis=1))
    if balls.names or "socket" not in poses:
        return [balls.names[k] if balls.names else "1" for k in known]
    return [str(int(poses["socket"][int(balls["pose"][k])]) + 1) for k in known]


def _columns(table: Table, names: list[str]) -> np.ndarray:
    """Side by side; no rows where one of them is not in the table."""
    if not all(name in table for name in names):
        return np.empty((0, len(names)))
    return np.stack([table[name] for name in names], axis=1) if names else np.empty((len(table), 0))
