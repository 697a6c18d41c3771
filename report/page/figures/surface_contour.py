"""S over the search box, and near the result with what the result knows of M and N."""
import numpy as np
from matplotlib import patheffects, ticker

import style
from calibration import Calibration
from ellipse import outline, semi_axes
from notation import significant
from surface import Surface, grid_minimum, near, refined, searched, unit_of_S

SMALLEST = 1 / 80  # of the side of a panel: smaller ones are a marker


def draw(c: Calibration, t) -> style.Figure | None:
    surfaces = [surface for surface in (searched(c), near(c)) if surface]
    if not surfaces:
        return None
    figure, grid = style.new_figure(3.0, 1, len(surfaces), squeeze=False)
    for axes, surface in zip(grid.flat, surfaces):
        _contours(figure, axes, surface, unit_of_S(c), t)
        _points(axes, surface, c, t)
    if near(c):
        _uncertainty(grid.flat[-1], c, near(c), t)
    if len(surfaces) > 1:
        _frame(grid.flat[0], surfaces[1])
    style.legend_above(figure, grid.flat[-1], 3)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    joint, notes = joint_region(c), []
    if searched(c) and near(c):
        hidden = (_sides(near(c)) < 3 * SMALLEST * _sides(searched(c))).all()
        notes.append(t(f"figure.surface_contour.{'inside' if hidden else 'beside'}"))
    if any(surface.is_logarithmic for surface in (searched(c), near(c)) if surface):
        notes.append(t("figure.surface_contour.logarithmic"))
    if joint and near(c):
        which = t("figure.surface_contour.two") if len(c.estimated) == 2 else \
            t("figure.surface_contour.all", count=len(c.estimated))
        k = t.number(significant(joint[1], 3))
        notes.append(t("figure.surface_contour.region", parameters=which, k=k))
        sides = _sides(near(c))
        extent = np.ptp(outline(np.zeros(2), *joint), axis=1)
        if (extent < SMALLEST * sides).all():
            notes.append(t("figure.surface_contour.too_small"))
        elif (extent > sides).any():
            notes.append(t("figure.surface_contour.too_large"))
    at, box = refined(c), searched(c)
    if at and box and not box.holds(*at):
        notes.append(t("figure.surface_contour.outside"))
    return {"notes": " ".join(notes)}


def joint_region(c: Calibration) -> tuple[np.ndarray, float] | None:
    """Covariance of M and N, and the factor of the joint region of all estimated parameters; of an unreliable result
    none."""
    names, k = [parameter["name"] for parameter in c.estimated], (c.get("joint") or {}).get("k")
    if not c.is_reliable or not k or "M" not in names or "N" not in names or not c.get("covariance"):
        return None
    both = [names.index("M"), names.index("N")]
    covariance = c.covariance[np.ix_(both, both)]
    return (covariance, k) if np.isfinite(covariance).all() else None


def _sides(surface: Surface) -> np.ndarray:
    return np.array([np.ptp(surface.M), np.ptp(surface.N)])


def _contours(figure, axes, surface: Surface, unit_of_S: tuple[float, str], t) -> None:
    factor, unit = unit_of_S
    levels, norm = surface.levels()
    filled = axes.contourf(surface.M, surface.N, factor * surface.S.T, factor * levels,
                           norm=type(norm)(factor * norm.vmin, factor * norm.vmax), cmap=style.MAP)
    axes.set_xlabel(t("figure.surface_contour.M"))
    axes.set_ylabel(t("figure.surface_contour.N"))
    axes.locator_params(nbins=6)
    bar = figure.colorbar(filled, ax=axes, orientation="horizontal",
                          label=t("figure.surface_contour.S", unit=unit))
    bar.set_ticks((factor * levels)[::2] if surface.is_logarithmic else ticker.MaxNLocator(5))
    if surface.is_logarithmic:
        bar.ax.xaxis.set_major_formatter(style.plain_numbers(t))


def _points(axes, surface: Surface, c: Calibration, t) -> None:
    for at, marker, size, color, label in ((grid_minimum(c), "s", 8, style.SECONDARY, "grid"),
                                           (refined(c), "o", 5, "white", "refined")):
        if at:  # whole where it lies on the edge, not at all outside
            drawn = at if surface.holds(*at) else (np.nan, np.nan)
            axes.plot(*drawn, marker=marker, markersize=size, color=color, linestyle="none", clip_on=False,
                      zorder=5, markeredgecolor=style.INK, markeredgewidth=0.8,
                      label=t(f"figure.surface_contour.{label}"))


def _frame(axes, surface: Surface) -> None:
    """The box of the panel beside."""
    M, N = surface.M[[0, -1, -1, 0, 0]], surface.N[[0, 0, -1, -1, 0]]
    limits = axes.axis()
    axes.plot(M, N, color="white", linewidth=0.8, linestyle="-")
    axes.axis(limits)


def _uncertainty(axes, c: Calibration, surface: Surface, t) -> None:
    centre, joint = refined(c), joint_region(c)
    seen = {"color": "white", "linestyle": "-",  # on dark and on light
            "path_effects": [patheffects.Stroke(linewidth=2.6, foreground=style.INK), patheffects.Normal()]}
    limits = axes.axis()
    if centre and joint:
        lines = outline(np.array(centre), *joint)
        if (np.ptp(lines, axis=1) < SMALLEST * _sides(surface)).all():
            axes.plot(*centre, marker="o", markersize=12, markerfacecolor="none", markeredgecolor="white",
                      linestyle="none", label=t("figure.surface_contour.ellipse"))
        else:
            axes.plot(*lines, linewidth=1.4, label=t("figure.surface_contour.ellipse"), **seen)
            _intervals(axes, c, seen, t)
    axes.axis(limits)


def _intervals(axes, c: Calibration, seen: dict, t) -> None:
    """U of each parameter alone."""
    M, N = c.parameter("M"), c.parameter("N")
    if M.get("U") and N.get("U"):
        axes.plot([M["value"] - M["U"], M["value"] + M["U"]], [N["value"]] * 2, linewidth=0.8,
                  label=t("figure.surface_contour.U"), **seen)
        axes.plot([M["value"]] * 2, [N["value"] - N["U"], N["value"] + N["U"]], linewidth=0.8, **seen)
