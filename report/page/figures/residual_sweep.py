"""Residuals along the sweep: the mean of every profile, and the autocorrelation of these means."""
import math

import numpy as np

import style
from calibration import Calibration, Table
from notation import length_unit, shortened
from residuals import (MOST_LINES, MOST_PANELS, correlation_factor, panel_columns, scanned_targets,
                       white_noise_band, with_table, worst)

COLUMNS = 3          # of autocorrelations
MOST_VECTORS = 3000  # profiles: more are a picture


def draw(c: Calibration, t) -> style.Figure | None:
    targets = _shown(c)
    if not targets:
        return None
    correlated = with_table(worst(scanned_targets(c), MOST_LINES), "sweep_correlation")
    columns = panel_columns(len(targets))
    rows = math.ceil(len(targets) / columns)
    below = math.ceil(len(correlated) / COLUMNS)
    heights = [(1.3 if rows < 3 else 1.1) * rows + 0.3] + ([1.2 * below + 0.3] if correlated else [])
    figure = style.pyplot.figure(figsize=(style.WIDTH, sum(heights)))
    parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    _sweeps(parts[0], parts[0].subplots(rows, columns, squeeze=False, sharey=True), targets, t)
    if correlated:
        panels = parts[1].subplots(below, min(COLUMNS, len(correlated)), squeeze=False, sharey=True)
        _correlations(panels, correlated, t)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    shown, swept = len(_shown(c)), len(with_table(scanned_targets(c), "sweep"))
    notes = []
    if shown < swept:
        notes.append(t("figure.residual_sweep.some", shown=shown, all=swept))
    if swept > MOST_LINES:
        notes.append(t("figure.residual_sweep.some_lines", lines=MOST_LINES))
    return {"notes": " ".join(notes)}


def _shown(c: Calibration) -> list[dict]:
    return worst(with_table(scanned_targets(c), "sweep"), MOST_PANELS)


def _sweeps(part, grid, targets: list[dict], t) -> None:
    tables = [Table(target["sweep"]) for target in targets]
    largest = max(np.nanmax(np.abs(table["residual"]), initial=0) for table in tables)
    factor, unit = length_unit(largest)
    many = sum(map(len, tables)) > MOST_VECTORS
    for axes, target, table in zip(grid.flat, targets, tables):
        order = np.argsort(table["alpha"], kind="stable")
        angle, mean = np.degrees(table["alpha"])[order], factor * table["residual"][order]
        u = factor * table["u"][order] * correlation_factor(target)
        axes.fill_between(angle, mean - 2 * u, mean + 2 * u, color=style.TERTIARY, linewidth=0,
                          rasterized=many)
        axes.plot(angle, mean, color=style.PRIMARY, linewidth=0.8, linestyle="-", rasterized=many)
        axes.axhline(0, color=style.INK, linewidth=0.7, linestyle="-")
        axes.set_title(shortened(target["name"], 20), fontsize=8)
        axes.margins(x=0.02)
        axes.locator_params(nbins=5)
    for axes in grid.flat[len(targets):]:
        axes.set_axis_off()
    part.supxlabel(t("figure.residual_sweep.angle"), fontsize=9)
    part.supylabel(t("figure.residual_sweep.mean", unit=unit), fontsize=9)


def _correlations(panels, targets: list[dict], t) -> None:
    """A panel for each target, all on one scale."""
    for k, (axes, target) in enumerate(zip(panels.flat, targets)):
        table = Table(target["sweep_correlation"])
        band = white_noise_band(target["profiles"] or len(Table(target.get("sweep"))) or 1)
        axes.axhspan(-band, band, color=style.FAINT, linewidth=0, label=t("figure.residual_sweep.band"))
        axes.axhline(0, color=style.MUTED, linewidth=0.7, linestyle="-")
        after = table["lag"] > 0
        axes.plot(table["lag"][after], table["correlation"][after], color=style.PRIMARY, linestyle="-", marker="o",
                  markersize=2.5, linewidth=0.8)
        axes.set_title(shortened(target["name"], 20), fontsize=8)
        axes.locator_params(nbins=4)
        if k == 0:
            axes.set_ylabel(t("figure.residual_sweep.autocorrelation"))
            axes.legend(loc="upper right", fontsize=7)
    for axes in panels.flat[len(targets):]:
        axes.set_axis_off()
    panels.flat[0].figure.supxlabel(t("figure.residual_sweep.lag"), fontsize=9)
