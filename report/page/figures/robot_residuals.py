"""Residuals of the balls, pose by pose, along the three axes in which they were measured."""
import numpy as np

import poses
import style
from bands import name_bands
from calibration import Calibration
from labels import place_labels
from notation import count, length_unit, shortened, significant

MOST_STATIONS = 10   # drawn, those with the longest residuals
MANY_DOTS = 800      # beyond, they are pixels
WORST = 3            # named
AXES = "xyz"


def draw(c: Calibration, t) -> style.Figure | None:
    drawn = _drawn(c)
    if not drawn:
        return None
    factor, unit = length_unit(float(np.abs(np.vstack([each.residuals for each in drawn])).max()))
    figure, panels = style.new_figure(5.4, 3, 1, sharex=True, sharey=True)
    starts = np.concatenate([[0], np.cumsum([len(each.poses) for each in drawn])])
    at = np.concatenate([start + each.pose_of for start, each in zip(starts, drawn)])
    residuals = factor * np.vstack([each.residuals for each in drawn])
    many = len(at) > MANY_DOTS
    for axes, name, of_axis in zip(panels, AXES, residuals.T):
        for k in range(1, len(drawn), 2):
            axes.axvspan(starts[k] - 0.5, starts[k + 1] - 0.5, color=style.FAINT, alpha=0.45, lw=0)
        axes.axhline(0, color=style.INK, lw=0.7, linestyle="-")
        band = 2 * np.sqrt(np.mean(of_axis**2))
        for end in (-band, band):
            axes.axhline(end, color=style.MUTED, lw=0.8, linestyle="--")
        axes.plot(at, of_axis, "o", color=style.PRIMARY, markersize=2.2 if many else 3, alpha=0.7,
                  markeredgewidth=0, linestyle="none", rasterized=many)
        axes.set_ylabel(f"{name} / {unit}")
    panels[0].set_xlim(-0.5, starts[-1] - 0.5)
    for axes in panels:
        axes.tick_params(axis="x", length=0)
    panels[-1].set_xlabel(t(f"figure.robot_residuals.{_kind(c)}"))
    limit = 1.12 * np.abs(residuals).max() or 1.0
    panels[0].set_ylim(-limit, limit)
    name_bands(panels[-1], starts - 0.5, [each.name for each in drawn])
    _name_worst(panels, drawn, at, residuals, _kind(c), t)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    found, drawn, kind = _with_residuals(c), _drawn(c), _kind(c)
    station, k = _worst(found, 1)[0]
    factor, unit = length_unit(float(station.lengths[k]))
    rms = np.sqrt(np.mean(np.vstack([each.residuals for each in found])**2, axis=0))
    factor_rms, unit_rms = length_unit(float(rms.max()))
    words = {key: t(f"figure.robot_residuals.{key}_{kind}") for key in ("frame", "what", "bad")}
    return words | {
        "size": t.number(significant(factor * float(station.lengths[k]), 2)), "unit": unit,
        "where": t(f"figure.robot_residuals.where_{kind}", pose=shortened(_pose(station, k), 60),
                   ball=shortened(station.ball_of[k], 60), station=shortened(station.name, 60)),
        "rms": ", ".join(f"{name} {t.number(significant(factor_rms * of, 2))}" for name, of in zip(AXES, rms)),
        "unit_rms": unit_rms,
        "notes": t("figure.robot_residuals.some", drawn=len(drawn), number=count(len(found)))
        if len(drawn) < len(found) else ""}


def _kind(c: Calibration) -> str:
    return "flange" if c["model"] == "flange-ball" else "robot"


def _with_residuals(c: Calibration) -> list[poses.Station]:
    return [each for each in poses.stations(c) if len(each.residuals)]


def _drawn(c: Calibration) -> list[poses.Station]:
    return poses.worst(_with_residuals(c), MOST_STATIONS)


def _pose(station: poses.Station, k: int) -> str:
    return station.poses[station.pose_of[k]]


def _worst(found: list[poses.Station], most: int) -> list[tuple[poses.Station, int]]:
    """Station and row of the largest residuals, the largest first."""
    sizes = [(-float(length), i, k) for i, each in enumerate(found) for k, length in enumerate(each.lengths)]
    return [(found[i], k) for _, i, k in sorted(sizes)[:most]]


def _name_worst(panels, drawn: list[poses.Station], at: np.ndarray, residuals: np.ndarray, kind: str, t) -> None:
    """In the panel of the axis where it is largest."""
    first_of = np.concatenate([[0], np.cumsum([len(each.residuals) for each in drawn])])
    worst = _worst(drawn, WORST)
    rows = [int(first_of[[each is station for each in drawn].index(True)]) + k for station, k in worst]
    names = [t(f"figure.robot_residuals.label_{kind}", pose=shortened(_pose(station, k), 14),
               ball=shortened(station.ball_of[k], 10)) for station, k in worst]
    for axis, axes in enumerate(panels):
        here = [j for j, row in enumerate(rows) if int(np.argmax(np.abs(residuals[row]))) == axis]
        axes.plot(at[[rows[j] for j in here]], residuals[[rows[j] for j in here], axis], "o", markersize=7,
                  markerfacecolor="none", color=style.SECONDARY, linestyle="none")
        place_labels(axes, [(at[rows[j]], residuals[rows[j], axis]) for j in here], [names[j] for j in here],
                     np.stack([at, residuals[:, axis]], axis=1))
