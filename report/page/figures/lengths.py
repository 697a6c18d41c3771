"""Errors of the known lengths before and after the calibration, a line from one to the other."""
import numpy as np

import lengths
import style
from calibration import Calibration
from notation import count, length_unit, shortened

MOST_ROWS = 30
SEEN = 0.004  # of the largest error: a smaller u would be a hair


def draw(c: Calibration, t) -> style.Figure | None:
    rows = lengths.worst(lengths.known_lengths(c), MOST_ROWS)
    if not rows:
        return None
    of = np.array([[row.before, row.after, row.u] for row in rows])
    factor, unit = length_unit(float(np.nanmax(np.abs(of[:, :2]), initial=0)))
    before, after, u = factor * of.T
    at = np.arange(len(rows))
    figure, axes = style.new_figure(0.85 + 0.2 * len(rows))
    axes.axvline(0, color=style.INK, lw=0.7, linestyle="-")
    if np.nanmax(u, initial=0) > SEEN * np.nanmax(np.abs([before, after]), initial=0):
        axes.barh(at, 4 * u, 0.6, -2 * u, color=style.FAINT, lw=0, zorder=0, label=t("figure.lengths.u"))
    axes.hlines(at, before, after, color=style.MUTED, lw=0.8, linestyles="-", zorder=1)
    axes.plot(before, at, "s", markerfacecolor="white", color=style.SECONDARY, linestyle="none",
              label=t("figure.lengths.before"))
    axes.plot(after, at, "o", color=style.PRIMARY, linestyle="none", label=t("figure.lengths.after"))
    axes.set_yticks(at, [shortened(t.translated(row.name)[0]) for row in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlabel(t("figure.lengths.error", unit=unit))
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    style.legend_above(figure, axes, 3)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    found = lengths.known_lengths(c)
    return {"notes": t("figure.lengths.some", drawn=MOST_ROWS, number=count(len(found)))
            if len(found) > MOST_ROWS else ""}
