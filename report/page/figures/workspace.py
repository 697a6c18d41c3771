"""Where the flange was: from above, and how far from the first joint's axis at which height."""
import numpy as np

import poses
import scene
import style
from calibration import Calibration
from labels import place_labels
from notation import shortened

MOST_NAMED = 10   # places
MANY_DOTS = 800   # beyond, they are pixels


def draw(c: Calibration, t) -> style.Figure | None:
    flange = np.vstack([np.empty((0, 3))] + [each.flange for each in poses.stations(c)])
    flange = flange[np.isfinite(flange).all(axis=1)]
    if not len(flange):
        return None
    standing = scene.standings(c)
    middles = np.array([each.middle for each in standing]).reshape(-1, 3)
    views = [(scene.from_above, "X / mm", "Y / mm"),
             (scene.beside_axis, t("figure.workspace.distance"), "Z / mm")]
    figure, panels = style.new_figure(3.6, 1, 2)
    for axes, (project, across, up) in zip(panels, views):
        axes.plot(*project(flange).T, "o", color=style.PRIMARY, markersize=2.5, alpha=0.6, linestyle="none",
                  markeredgewidth=0, rasterized=len(flange) > MANY_DOTS, label=t("figure.workspace.flange"))
        axes.plot(*project(middles).T, "s", color=style.SECONDARY, markerfacecolor="none", linestyle="none",
                  markersize=6 if len(standing) <= MOST_NAMED else 3, markeredgewidth=0.8,
                  label=t(f"figure.workspace.{c['model']}"))
        axes.plot(0, 0, "+", color=style.INK, markersize=11, markeredgewidth=1.4, linestyle="none",
                  label=t("figure.workspace.base"))
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        axes.set_aspect("equal", "datalim")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(style.ticker.MaxNLocator(5, steps=[1, 2, 5, 10]))
    style.legend_above(figure, panels[0], 3)
    if len(standing) <= MOST_NAMED:
        for axes, (project, *_) in zip(panels, views):
            names = [shortened(each.name, 16) for each in standing]
            place_labels(axes, project(middles), names, project(flange))
    return figure
