"""Errors of the links with their intervals, lengths beside angles: what was estimated, what was held."""
import numpy as np

import links
import style
from calibration import Calibration
from notation import shortened

MOST_ROWS = 48       # in one panel: beyond, what was held is left out
ROW = 0.165          # inches
FAR = 20             # an interval so many times as long as the usual one is cut off
KINDS = {"data": ("o", style.PRIMARY, style.PRIMARY), "prior": ("D", style.PRIMARY, "white"),
         "considered": ("s", style.MUTED, "white"), "held": ("x", style.MUTED, style.MUTED)}


def draw(c: Calibration, t) -> style.Figure | None:
    panels = [_rows(c, unit) for unit in links.UNITS]
    if not any(panels):
        return None
    figure, all_axes = style.new_figure(0.85 + ROW * max(map(len, panels)), 1, 2)
    for axes, unit, rows in zip(all_axes, links.UNITS, panels):
        _draw(axes, rows, t)
        axes.set_xlabel(t(f"figure.links.{unit}"))
    kinds = [kind for kind in KINDS if any(row.kind == kind for rows in panels for row in rows)]
    for kind in kinds:
        marker, edge, fill = KINDS[kind]
        all_axes[0].plot([], [], marker, color=edge, markerfacecolor=fill, linestyle="none",
                         label=t(f"links.determined.{kind}"))
    if any(row.prior_U for rows in panels for row in rows):
        all_axes[0].axhspan(-2, -2, color=style.TERTIARY, alpha=0.5, lw=0, label=t("figure.links.prior"))
    style.legend_above(figure, all_axes[0], 4)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    panels = [_rows(c, unit) for unit in links.UNITS]
    notes = {"no_held": any(len(_all_rows(c, unit)) > MOST_ROWS for unit in links.UNITS),
             "cut": any(_reach(rows) < _extents(rows).max(initial=0) for rows in panels)}
    how = t("figure.links.intervals" if c.is_reliable else "figure.links.no_intervals",
            coverage=t.number(f"{c.coverage_percent:.3g}"))
    return {"how": how,
            "notes": " ".join(t(f"figure.links.{note}") for note, holds in notes.items() if holds)}


def _all_rows(c: Calibration, unit: str) -> list[links.LinkError]:
    return [each for each in links.link_errors(c) if each.unit == unit]


def _rows(c: Calibration, unit: str) -> list[links.LinkError]:
    rows = _all_rows(c, unit)
    return rows if len(rows) <= MOST_ROWS else [row for row in rows if row.kind != "held"]


def _extents(rows: list[links.LinkError]) -> np.ndarray:
    return np.array([abs(row.value) + row.U for row in rows if row.kind != "held" and np.isfinite(row.value)])


def _reach(rows: list[links.LinkError]) -> float:
    """How far from 0 an interval is drawn: all, unless one is so long that the others would not be seen."""
    extents = _extents(rows)
    if not extents.max(initial=0) > 0:
        return 1.0
    usual = float(np.median(extents))
    return float(extents.max()) if extents.max() <= FAR * usual else 4 * usual


def _limits(rows: list[links.LinkError]) -> tuple[float, float]:
    """With 0 between them."""
    reach = _reach(rows)
    drawn = [row for row in rows if row.kind != "held" and np.isfinite(row.value)]
    low = max(-reach, min((row.value - row.U for row in drawn), default=-reach))
    high = min(reach, max((row.value + row.U for row in drawn), default=reach))
    air = 0.05 * (max(high, 0) - min(low, 0))
    return min(low, 0) - air, max(high, 0) + air


def _draw(axes, rows: list[links.LinkError], t) -> None:
    if not rows:
        axes.set_visible(False)
        return
    low, high = _limits(rows)
    for k, row in enumerate(rows):
        if row.link % 2 == 0:
            axes.axhspan(k - 0.5, k + 0.5, color=style.FAINT, alpha=0.45, lw=0, zorder=0)
        marker, edge, fill = KINDS[row.kind]
        if row.prior_U:
            axes.barh(k, 2 * row.prior_U, 0.7, row.prior - row.prior_U, color=style.TERTIARY, alpha=0.5, lw=0,
                      zorder=1)
        if row.U:
            axes.plot([row.value - row.U, row.value + row.U], [k, k], "-", color=edge, lw=1.2, zorder=2)
        if not np.isfinite(row.value):
            continue
        axes.plot(min(max(row.value, low), high), k, marker, color=edge, markerfacecolor=fill, zorder=3,
                  linestyle="none")
    axes.axvline(0, color=style.INK, lw=0.7, linestyle="-", zorder=1)
    axes.set_yticks(range(len(rows)), [shortened(row.name, 20) for row in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlim(low, high)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
