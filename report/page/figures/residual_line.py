"""Residuals along the laser line: their mean by place, and how far the noise of a point is seen in others."""
import numpy as np

import style
from calibration import Calibration, Table
from notation import length_unit, shortened
from residuals import MOST_LINES, along_the_line, noise_of_mean, scanned_targets, with_table, worst

COLUMNS = 3         # of panels
LEAST_SCALE = 0.05  # of an autocorrelation: below it is nothing


def draw(c: Calibration, t) -> style.Figure | None:
    targets = scanned_targets(c)
    parts = _parts(targets)
    if not parts:
        return None
    chosen = worst(with_table(targets, "cells"), MOST_LINES) if _by_place in parts else []
    across = min(len(chosen), COLUMNS)
    down = -(-len(chosen) // COLUMNS) if chosen else 1
    figure = style.pyplot.figure(figsize=(style.WIDTH, 0.5 + 1.5 * down))
    grid = figure.add_gridspec(down, across + (_by_lag in parts))
    _by_place([figure.add_subplot(grid[k // COLUMNS, k % COLUMNS]) for k in range(len(chosen))], chosen, t)
    if _by_lag in parts:
        _by_lag(figure.add_subplot(grid[:, -1]), targets, t)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    targets = scanned_targets(c)
    parts = [t(f"figure.residual_line{part.__name__.replace('_by', '.by')}") for part in _parts(targets)]
    some = t("figure.residual_line.some", shown=MOST_LINES, all=len(targets))
    return {"parts": " ".join(parts), "notes": some if len(targets) > MOST_LINES else ""}


def _parts(targets: list[dict]) -> list:
    """Of the figure, from left to right."""
    by_place, by_lag = with_table(targets, "cells"), any(target.get("lags") for target in targets)
    return [part for part, has in ((_by_place, by_place), (_by_lag, by_lag)) if has]


def _by_place(panels: list, chosen: list[dict], t) -> None:
    """A panel for each target, all on one scale."""
    lines = [along_the_line(Table(target["cells"])) for target in chosen]
    factor, unit = length_unit(max((np.max(np.abs(mean), initial=0) for _, mean, _ in lines), default=0))
    for k, (axes, (z, mean, points), target, look) in enumerate(zip(panels, lines, chosen, _looks())):
        axes.errorbar(z, factor * mean, 2 * factor * noise_of_mean(target, points), **look, elinewidth=0.7)
        axes.axhline(0, color=style.MUTED, linewidth=0.7, linestyle="-", zorder=0)
        axes.set_title(shortened(target["name"], 16), fontsize=8)
        axes.sharey(panels[0])
        axes.locator_params(nbins=4)
        axes.tick_params(labelleft=k % COLUMNS == 0)
        if k == 0:
            axes.set_ylabel(t("figure.residual_line.mean", unit=unit))
        if k >= len(panels) - COLUMNS:
            axes.set_xlabel(t("figure.residual_line.z"))


def _by_lag(axes, targets: list[dict], t) -> None:
    chosen = worst([target for target in targets if target.get("lags")], MOST_LINES)
    for target, look in zip(chosen, _looks()):
        lags, correlation = np.array(target["lags"]), np.array(target["correlation"], dtype=float)
        axes.plot(lags[1:], correlation[1:], label=shortened(target["name"]), **look)
    axes.axhline(0, color=style.MUTED, linewidth=0.7, linestyle="-", zorder=0)
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter(style.plain_numbers(t))
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -LEAST_SCALE), max(high, LEAST_SCALE))
    axes.set_xlabel(t("figure.residual_line.lag"))
    axes.set_ylabel(t("figure.residual_line.autocorrelation"))


def _looks() -> list[dict]:
    return [{"color": color, "linestyle": dash, "marker": marker, "markersize": 3}
            for color, dash, marker in zip(style.SERIES, style.DASHES, style.MARKERS)]
