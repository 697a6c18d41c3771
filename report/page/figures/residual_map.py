"""Mean residuals where they were measured: a panel per target, angle by place along the line."""
import math

import numpy as np
from matplotlib.collections import PolyCollection

import style
from calibration import Calibration, Table
from notation import length_unit, shortened
from residuals import MOST_PANELS, panel_columns, scanned_targets, with_table, worst

MOST_VECTORS = 1000  # cells: more are a picture


def draw(c: Calibration, t) -> style.Figure | None:
    targets = _shown(c)
    if not targets:
        return None
    tables = [Table(target["cells"]) for target in targets]
    limit, saturated = _limit(_residuals(targets))
    factor, unit = length_unit(limit)
    columns = panel_columns(len(targets))
    rows = math.ceil(len(targets) / columns)
    figure, grid = style.new_figure(0.9 + (1.5 if rows < 3 else 1.25) * rows, rows, columns, squeeze=False)
    many = sum(map(len, tables)) > MOST_VECTORS
    for axes, target, table in zip(grid.flat, targets, tables):
        cells = PolyCollection(_rectangles(table), array=np.ma.masked_invalid(factor * table["residual"]),
                               cmap=style.DIVERGING, clim=(-factor * limit, factor * limit), edgecolors="face",
                               linewidths=0.3, rasterized=many)
        axes.add_collection(cells)
        axes.autoscale_view()
        axes.margins(0.02)
        axes.set_title(shortened(target["name"], 20), fontsize=8)
        axes.locator_params(nbins=5)
    for axes in grid.flat[len(targets):]:
        axes.set_axis_off()
    figure.supxlabel(t("figure.residual_map.angle"), fontsize=9)
    figure.supylabel(t("figure.residual_map.z"), fontsize=9)
    figure.colorbar(cells, ax=grid, label=t("figure.residual_map.residual", unit=unit), aspect=50,
                    location="top", pad=0.02, fraction=0.05, extend="both" if saturated else "neither")
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    shown, with_cells = _shown(c), with_table(scanned_targets(c), "cells")
    notes = []
    if len(shown) < len(with_cells):
        notes.append(t("figure.residual_map.some", shown=len(shown), all=len(with_cells)))
    if _limit(_residuals(shown))[1]:
        notes.append(t("figure.residual_map.saturated"))
    return {"notes": " ".join(notes)}


def _shown(c: Calibration) -> list[dict]:
    return worst(with_table(scanned_targets(c), "cells"), MOST_PANELS)


def _residuals(targets: list[dict]) -> np.ndarray:
    return np.concatenate([Table(target["cells"])["residual"] for target in targets])


def _limit(residuals: np.ndarray) -> tuple[float, bool]:
    """The end of the scale, the same to both sides, and whether some lie beyond: few that are far off shall
    not take the colours from all others."""
    sizes = np.abs(residuals[np.isfinite(residuals)])
    if not sizes.size or not sizes.max() > 0:
        return 1e-3, False
    usual = np.quantile(sizes, 0.98)
    return (usual, True) if 0 < 1.5 * usual < sizes.max() else (sizes.max(), False)


def _rectangles(table: Table) -> np.ndarray:
    left, right = np.degrees(table["alpha_from"]), np.degrees(table["alpha_to"])
    low, high = table["z_from"], table["z_to"]
    return np.stack([np.stack([left, low], 1), np.stack([right, low], 1),
                     np.stack([right, high], 1), np.stack([left, high], 1)], 1)
