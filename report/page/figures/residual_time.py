"""Residuals in the order of time, of sweeps that turn back: what drifts shows as a slope, what the direction of turning
does as a step."""
import math

import numpy as np

import style
from calibration import Calibration, Table
from notation import length_unit, shortened
from residuals import MOST_PANELS, correlation_factor, panel_columns, scanned_targets, with_table, worst


def draw(c: Calibration, t) -> style.Figure | None:
    targets = worst(with_table(scanned_targets(c), "time"), MOST_PANELS)
    if not targets:
        return None
    tables = [Table(target["time"]) for target in targets]
    factor, unit = length_unit(max(np.nanmax(np.abs(table["residual"]), initial=0) for table in tables))
    columns = panel_columns(len(targets))
    rows = math.ceil(len(targets) / columns)
    figure = style.pyplot.figure(figsize=(style.WIDTH, 1.3 * rows + 0.75))
    above, panels = figure.subfigures(2, 1, height_ratios=[0.25, 1.3 * rows + 0.5])
    grid = panels.subplots(rows, columns, squeeze=False, sharey=True)
    for axes, target, table in zip(grid.flat, targets, tables):
        mean, u = factor * table["residual"], factor * table["u"] * correlation_factor(target)
        axes.fill_between(table["time"], mean - 2 * u, mean + 2 * u, color=style.TERTIARY, linewidth=0)
        axes.plot(table["time"], mean, color=style.MUTED, linewidth=0.5, linestyle="-")
        up = np.gradient(table["alpha"]) >= 0 if len(table) > 1 else np.ones(1, dtype=bool)
        for direction, colour, marker, label in ((up, style.PRIMARY, "o", "up"), (~up, style.SECONDARY, "s", "down")):
            axes.plot(table["time"][direction], mean[direction], color=colour, linestyle="none", marker=marker,
                      markersize=2, label=t(f"figure.residual_time.{label}"))
        axes.axhline(0, color=style.INK, linewidth=0.7, linestyle="-")
        axes.set_title(shortened(target["name"], 20), fontsize=8)
        axes.margins(x=0.02)
        axes.locator_params(nbins=5)
    for axes in grid.flat[len(targets):]:
        axes.set_axis_off()
    above.legend(*grid.flat[0].get_legend_handles_labels(), loc="center", ncol=2, fontsize=8, markerscale=2)
    panels.supxlabel(t("figure.residual_time.time"), fontsize=9)
    panels.supylabel(t("figure.residual_time.mean", unit=unit), fontsize=9)
    return figure
