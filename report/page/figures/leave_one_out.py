"""What the result would have been without each target: two parameters as arrows in their plane, more as a dot
for each target on a line of each parameter."""
import math

import numpy as np
from matplotlib.patches import Rectangle

import ellipse
import style
from calibration import Calibration
from labels import along, place_labels
from notation import shortened
from uncertainty import axis_unit, known, moves, moves_in_u

MOST_ARROWS, MOST_NAMES, MOST_ROWS = 40, 12, 40
MANY_DOTS = 3000
ROOM = 1.45    # beside the farthest dots, for their names
STRETCH = 5.0  # of one axis against the other, from which on equal scales would flatten the figure


def draw(c: Calibration, t) -> style.Figure | None:
    names, by = moves(c)
    if not names or not np.isfinite(moves_in_u(c)[1]).any():
        return None
    return _plane(c, names, by, t) if len(c.estimated) == 2 and np.isfinite(by).all() else _dots(c, t)


def caption(c: Calibration, t) -> dict[str, str]:
    names, by = moves(c)
    if len(c.estimated) == 2:
        kind = "bare" if not c.is_reliable else "plane" if len(_region(c, np.ones(2))) else "no_region"
        left_out = _left_out(t, "names", MOST_NAMES, len(names))
    else:
        kind, left_out = "dots" if c.is_reliable else "bare_dots", _left_out(t, "rows", MOST_ROWS, len(c.estimated))
    return {"how": t(f"figure.leave_one_out.{kind}"), "left_out": left_out}


def _left_out(t, what: str, most: int, number: int) -> str:
    return " " + t(f"figure.leave_one_out.most_{what}", shown=most, number=number) if number > most else ""


def _plane(c: Calibration, names: list[str], by: np.ndarray, t) -> style.Figure:
    figure, axes = style.new_figure(3.0)
    (fx, unit_x), (fy, unit_y) = (axis_unit(parameter) for parameter in c.estimated)
    scale = np.array([fx, fy])
    tips, U = by * scale, np.array([known(parameter.get("U")) for parameter in c.estimated]) * scale
    axes.axhline(0, color=style.FAINT, lw=0.7, zorder=0)
    axes.axvline(0, color=style.FAINT, lw=0.7, zorder=0)
    outline, words = _uncertainty(axes, c, U, scale, t)
    few = len(tips) <= MOST_ARROWS
    for tip in tips if few else ():
        axes.annotate("", tip, (0, 0), arrowprops={"arrowstyle": "-|>", "color": style.SECONDARY, "lw": 1.3,
                                                   "shrinkA": 0, "shrinkB": 0}, annotation_clip=False)
    axes.plot(*tips.T, ".", color=style.SECONDARY, markersize=1 if few else 4, linestyle="none", zorder=1)
    axes.plot(0, 0, "o", color=style.PRIMARY, markersize=5)
    _limits(axes, np.vstack([tips, outline, [[0, 0]]]))
    for axis, parameter, unit in ((axes.xaxis, c.estimated[0], unit_x), (axes.yaxis, c.estimated[1], unit_y)):
        axis.set_label_text(t("figure.leave_one_out.axis", name=shortened(parameter["name"]), unit=unit))
    largest = np.argsort(-np.max(np.abs(moves_in_u(c)[1]), axis=1), kind="stable")[:MOST_NAMES]
    arrows = np.vstack([along((0, 0), tip) for tip in (tips if few else tips[:0])] + [outline])
    labels = [(shortened(names[k]), tips[k], math.degrees(math.atan2(*tips[k][::-1])), {}) for k in largest]
    labels += [(*word, {"color": style.PRIMARY}) for word in words]
    texts, points, sides, looks = zip(*labels)
    place_labels(axes, points, texts, np.vstack([arrows, tips]), sides, looks)
    return figure


def _uncertainty(axes, c: Calibration, U: np.ndarray, scale: np.ndarray, t) -> tuple[np.ndarray, list]:
    """The box of value +- U of each and the region of both; points on their lines, and text, point and side
    of their names."""
    if not np.isfinite(U).all() or not c.is_reliable:
        return np.empty((0, 2)), []
    percent = t.number(f"{c.coverage_percent:.4g}")
    axes.add_patch(Rectangle(-U, *(2 * U), facecolor=style.TERTIARY, alpha=0.35, lw=0, zorder=0.5))
    axes.add_patch(Rectangle(-U, *(2 * U), facecolor="none", edgecolor=style.PRIMARY, lw=1))
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * U
    points = [along(a, b) for a, b in zip(corners, corners[1:])]
    words = [(t("figure.leave_one_out.box", percent=percent), corners[3], 135)]
    region = _region(c, scale)
    if len(region):
        axes.plot(*region.T, "--", color=style.PRIMARY, lw=1)
        points.append(region)
        lowest = region[np.argmin(region[:, 1])]
        words.append((t("figure.leave_one_out.region", percent=percent), lowest, 270))
    return np.vstack(points), words


def _region(c: Calibration, scale: np.ndarray) -> np.ndarray:
    """The ellipse that holds both parameters jointly: with the k of two, not of one (JCGM 102, 6.5.2)."""
    k = (c.get("joint") or {}).get("k")
    if not k or not np.isfinite(c.covariance).all():
        return np.empty((0, 2))
    return ellipse.outline(np.zeros(2), c.covariance * np.outer(scale, scale), k).T


def _limits(axes, points: np.ndarray) -> None:
    """Room for names around everything; equal scales unless one axis would need much more than the other."""
    low, high = points.min(axis=0), points.max(axis=0)
    span = np.maximum(high - low, 1e-12 * max(1e-300, np.abs(points).max()))
    axes.set_xlim(low[0] - 0.12 * span[0], high[0] + 0.12 * span[0])
    axes.set_ylim(low[1] - 0.12 * span[1], high[1] + 0.12 * span[1])
    if 1 / STRETCH < span[0] / span[1] < STRETCH:
        axes.set_aspect("equal", adjustable="datalim")


def _dots(c: Calibration, t) -> style.Figure:
    names, by = moves_in_u(c)
    parameters = list(range(len(c.estimated)))
    if len(parameters) > MOST_ROWS:
        largest = np.argsort(-np.nanmax(np.abs(np.nan_to_num(by)), axis=0), kind="stable")[:MOST_ROWS]
        parameters = sorted(largest)
    figure, axes = style.new_figure(0.75 + 0.2 * max(3, len(parameters)))
    axes.axvspan(-1, 1, color=style.TERTIARY, alpha=0.35, lw=0)
    axes.axvline(0, color=style.MUTED, lw=0.7)
    for row, k in enumerate(parameters):
        of = by[:, k]
        with_none = np.append(of, 0)
        axes.hlines(row, np.nanmin(with_none), np.nanmax(with_none), color=style.FAINT, lw=1)
        axes.plot(of, np.full(len(of), row), "o", linestyle="none", color=style.SECONDARY, markersize=3.5,
                  markeredgecolor="white", markeredgewidth=0.3, rasterized=by.size > MANY_DOTS)
        if np.isfinite(of).any():
            most = int(np.nanargmax(np.abs(of)))
            axes.plot(of[most], row, "o", color=style.PRIMARY, markersize=4.5)
            side, ha = (5, "left") if of[most] > 0 else (-5, "right")
            axes.annotate(shortened(names[most], 16), (of[most], row), (side, 0), textcoords="offset points",
                          ha=ha, va="center", fontsize=7)
    axes.set_yticks(range(len(parameters)), [shortened(c.estimated[k]["name"]) for k in parameters])
    axes.set_ylim(len(parameters) - 0.4, -0.6)
    reach = max(1.2, float(np.nanmax(np.abs(np.nan_to_num(by)))))
    axes.set_xlim(-reach * ROOM, reach * ROOM)
    axes.set_xlabel(t("figure.leave_one_out.in_u"))
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    return figure
