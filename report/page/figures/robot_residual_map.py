"""How long the residual of every ball is in every pose: who errs, the pose or the ball."""
import numpy as np

import poses
import style
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
    size = np.full((len(balls), starts[-1]), np.nan)
    for start, each in zip(starts, found):
        rows = [balls.index(name) for name in each.ball_of]
        size[rows, start + each.pose_of] = each.lengths
    factor, unit = length_unit(float(np.nanmax(size)))
    size = _largest_of(_largest_of(size, MOST_COLUMNS).T, MOST_BALLS).T
    figure, axes = style.new_figure(1.1 + 0.2 * max(4, len(size)))
    axes.set_facecolor(style.FAINT)
    drawn = axes.imshow(factor * size, aspect="auto", interpolation="nearest", vmin=0,
                        extent=(0, starts[-1], len(balls) - 0.5, -0.5))
    step = -(-len(balls) // MOST_BALLS)
    axes.set_yticks(range(0, len(balls), step), [shortened(name, 16) for name in balls[::step]])
    axes.set_ylabel(t("figure.robot_residual_map.ball"))
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)
    if len(found) <= MOST_NAMED:
        axes.set_xticks((starts[:-1] + starts[1:]) / 2,
                        [shortened(each.name, 84 // len(found)) for each in found])
        axes.vlines(starts[1:-1], -0.5, len(balls) - 0.5, color="white", lw=1.2, linestyles="-")
        axes.set_xlabel(t("figure.robot_residual_map.station"))
    else:
        axes.set_xlabel(t("figure.robot_residual_map.pose"))
    figure.colorbar(drawn, ax=axes, label=t("figure.robot_residual_map.size", unit=unit), pad=0.01)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    columns = sum(len(each.poses) for each in poses.stations(c) if len(each.residuals))
    folded = columns > MOST_COLUMNS or len(_balls(c)) > MOST_BALLS
    return {"notes": t("figure.robot_residual_map.folded", poses=count(columns)) if folded else ""}


def _balls(c: Calibration) -> list[str]:
    """In the order of the artifact; none where there is but one on the flange."""
    if c["model"] != "robot-ball":
        return []
    names = {name for each in poses.stations(c) for name in each.ball_of}
    outline = [name for each in (c.get("scene") or {}).get("targets") or []
               for name in (each.get("outline") or {}).get("names") or []]
    known = {name: k for k, name in reversed(list(enumerate(outline)))}
    return sorted(names, key=lambda name: (known.get(name, len(known)), len(name), name))


def _largest_of(size: np.ndarray, most: int) -> np.ndarray:
    """Columns folded into at most so many, nan where all of them are."""
    if size.shape[1] <= most:
        return size
    pieces = np.array_split(np.nan_to_num(size, nan=-1), most, axis=1)
    folded = np.stack([piece.max(axis=1) for piece in pieces], axis=1)
    return np.where(folded < 0, np.nan, folded)
