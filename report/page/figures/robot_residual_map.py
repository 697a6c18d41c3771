"""How long the residual of every ball is in every pose: who errs, the pose or the ball."""
import numpy as np

import poses
import style
from bands import name_bands
from calibration import Calibration
from notation import count, length_unit, shortened

MOST_COLUMNS = 240   # beyond, a column is the largest of several poses
MOST_BALLS = 30      # beyond, a row is the largest of several balls
MOST_NAMED = 10      # stations


def draw(c: Calibration, t) -> style.Figure | None:
    found, balls = [each for each in poses.stations(c) if len(each.residuals)], _balls(c)
    if len(balls) < 2:
        return None
    starts = np.concatenate([[0], np.cumsum([len(each.poses) for each in found])])
    lengths, of_balls = _largest_of(_lengths(found, balls, starts).T, MOST_BALLS)
    lengths, of_poses = _largest_of(lengths.T, MOST_COLUMNS)
    factor, unit = length_unit(float(np.nanmax(lengths)))
    figure, axes = style.new_figure(1.1 + 0.2 * max(4, len(lengths)))
    axes.set_facecolor(style.FAINT)
    drawn = axes.imshow(factor * lengths, aspect="auto", interpolation="nearest", vmin=0,
                        extent=(0, of_poses * lengths.shape[1], len(lengths) - 0.5, -0.5))
    axes.set_xlim(0, starts[-1])
    axes.set_yticks(range(len(lengths)), [shortened(name, 16) for name in balls[::of_balls]])
    axes.set_ylabel(t("figure.robot_residual_map.ball"))
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)
    few = len(found) <= MOST_NAMED
    axes.set_xlabel(t("figure.robot_residual_map.station" if few else "figure.robot_residual_map.pose"))
    figure.colorbar(drawn, ax=axes, label=t("figure.robot_residual_map.size", unit=unit), pad=0.01)
    if few:
        axes.vlines(starts[1:-1], -0.5, len(lengths) - 0.5, color="white", lw=1.2, linestyles="-")
        name_bands(axes, starts, [each.name for each in found])
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    columns = sum(len(each.poses) for each in poses.stations(c) if len(each.residuals))
    folded = columns > MOST_COLUMNS or len(_balls(c)) > MOST_BALLS
    return {"notes": t("figure.robot_residual_map.folded", poses=count(columns)) if folded else ""}


def _lengths(found: list[poses.Station], balls: list[str], starts: np.ndarray) -> np.ndarray:
    """Of the residuals, balls x poses; nan where a pose did not see a ball."""
    lengths = np.full((len(balls), starts[-1]), np.nan)
    for start, each in zip(starts, found):
        lengths[[balls.index(name) for name in each.ball_of], start + each.pose_of] = each.lengths
    return lengths


def _balls(c: Calibration) -> list[str]:
    """In the order of the artifact; none where there is but one on the flange."""
    if c["model"] not in ("robot-ball", "robot-tracker"):
        return []
    names = {name for each in poses.stations(c) for name in each.ball_of}
    outline = [name for each in (c.get("scene") or {}).get("targets") or []
               for name in (each.get("outline") or {}).get("names") or []]
    known = {name: k for k, name in reversed(list(enumerate(outline)))}
    return sorted(names, key=lambda name: (known.get(name, len(known)), len(name), name))


def _largest_of(size: np.ndarray, most: int) -> tuple[np.ndarray, int]:
    """Columns folded into at most so many, each of equally many, nan where all of them are; and how many those are."""
    step = -(-size.shape[1] // most)
    padding = np.full((len(size), -size.shape[1] % step), np.nan)
    pieces = np.nan_to_num(np.hstack([size, padding]), nan=-1).reshape(len(size), -1, step)
    folded = pieces.max(axis=2)
    return np.where(folded < 0, np.nan, folded), step
