"""Residuals along the laser line: their mean by place, and how far the noise of a point is seen in others."""
import numpy as np

import style
from calibration import Calibration, Table
from notation import length_unit, shortened
from residuals import MOST_LINES, along_the_line, noise_of_mean, scanned_targets, with_table, worst


def draw(c: Calibration, t) -> style.Figure | None:
    targets = scanned_targets(c)
    parts = _parts(targets)
    if not parts:
        return None
    figure, grid = style.new_figure(2.9, 1, len(parts), squeeze=False)
    for part, axes in zip(parts, grid.flat):
        part(axes, targets, t)
    # One legend for both: the lines are of the same targets.
    style.legend_above(figure, grid.flat[0], 3)
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


def _by_place(axes, targets: list[dict], t) -> None:
    chosen = worst(with_table(targets, "cells"), MOST_LINES)
    lines = [along_the_line(Table(target["cells"])) for target in chosen]
    factor, unit = length_unit(max(np.max(np.abs(mean), initial=0) for _, mean, _ in lines))
    for (z, mean, points), target, look in zip(lines, chosen, _looks()):
        axes.plot(z, factor * mean, label=shortened(target["name"]), **look)
        axes.errorbar(z, factor * mean, 2 * factor * noise_of_mean(target, points), linestyle="none",
                      ecolor=look["color"], elinewidth=0.7)
    axes.axhline(0, color=style.MUTED, linewidth=0.7, linestyle="-", zorder=0)
    axes.set_xlabel(t("figure.residual_line.z"))
    axes.set_ylabel(t("figure.residual_line.mean", unit=unit))


def _by_lag(axes, targets: list[dict], t) -> None:
    chosen = worst([target for target in targets if target.get("lags")], MOST_LINES)
    for target, look in zip(chosen, _looks()):
        lags, correlation = np.array(target["lags"]), np.array(target["correlation"], dtype=float)
        axes.plot(lags[1:], correlation[1:], label=shortened(target["name"]), **look)
    axes.axhline(0, color=style.MUTED, linewidth=0.7, linestyle="-", zorder=0)
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter(style.plain_numbers(t))
    axes.set_ylim(min(-0.2, axes.get_ylim()[0]), 1)
    axes.set_xlabel(t("figure.residual_line.lag"))
    axes.set_ylabel(t("figure.residual_line.autocorrelation"))


def _looks() -> list[dict]:
    return [{"color": color, "linestyle": dash, "marker": marker, "markersize": 3}
            for color, dash, marker in zip(style.SERIES, style.DASHES, style.MARKERS)]
