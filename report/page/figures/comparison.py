"""What each method gives: of a turntable M and N against the reference, of a robot the errors of lengths."""
import math

import numpy as np

import style
from calibration import Calibration
from comparison import SUMMARIES, columns, method_name, methods, u, value
from notation import length_unit, shortened

FAR = 30  # times the reference's U: from here on the axis is logarithmic beyond it
MARKERS = dict(zip(SUMMARIES, "D|x|xDs"))


def draw(c: Calibration, t) -> style.Figure | None:
    rows = [row for row in methods(c) if row.get("cells")]
    if len(rows) < 2:
        return None
    return _offsets(c, rows, t) if c.is_turntable else _errors(rows, t)


def caption(c: Calibration, t) -> dict[str, str]:
    if not c.is_turntable:
        return {"read": t("figure.comparison.robot")}
    rows = [row for row in methods(c) if row.get("cells")]
    far = any(_Offsets(name, c, rows).are_far for name in "MN")
    logarithmic = t("figure.comparison.logarithmic") if far else ""
    which = "turntable" if c.is_reliable else "unreliable"
    return {"read": t(f"figure.comparison.{which}", logarithmic=logarithmic)}


class _Offsets:
    """One parameter in the rows, from what the last one says; mm, nan where there is none."""

    def __init__(self, name: str, c: Calibration, rows: list[dict]):
        self.name = name
        values, us = (np.array([of(row, f"{name}/mm") for row in rows]) for of in (value, u))
        self.apart = values - values[-1]
        self.U = ((c.parameter(name) or {}).get("k") or 2) * us if c.is_reliable else np.full(len(rows), np.nan)
        self.half_step = np.array([value(row, "step/√12/um") for row in rows]) * math.sqrt(3) / 1000
        self.largest = np.max(np.nan_to_num(np.abs(self.apart) + np.fmax(np.nan_to_num(self.U),
                                                                         np.nan_to_num(self.half_step))))

    @property
    def are_far(self) -> bool:
        return self.U[-1] > 0 and self.largest > FAR * self.U[-1]


def _offsets(c: Calibration, rows: list[dict], t) -> style.Figure | None:
    parameters = [_Offsets(name, c, rows) for name in "MN"]
    parameters = [offsets for offsets in parameters if np.isfinite(offsets.apart).any()]
    if not parameters:
        return None
    figure, grid = style.new_figure(0.9 + 0.21 * len(rows), 1, len(parameters), squeeze=False, sharey=True)
    for axes, offsets in zip(grid.flat, parameters):
        _offset(axes, offsets, t)
    _method_names(grid.flat[0], rows, t)
    style.legend_above(figure, grid.flat[0], 4)
    return figure


def _offset(axes, offsets: _Offsets, t) -> None:
    factor, unit = length_unit(offsets.largest)
    U = factor * offsets.U[-1]
    if math.isfinite(U):
        axes.axvspan(-U, U, color=style.FAINT, linewidth=0, label=t("figure.comparison.reference"))
    axes.axvline(0, color=style.MUTED, linewidth=0.7, linestyle="-")
    looks = {"markersize": 4, "linestyle": "none"}
    has_step = np.isfinite(offsets.half_step)
    has_U = np.isfinite(offsets.U) & ~has_step
    for chosen, bars, label, look in (
            (has_step, offsets.half_step, "step", {"marker": "s", "color": style.SECONDARY, "elinewidth": 1}),
            (has_U, offsets.U, "U", {"marker": "o", "color": style.PRIMARY, "elinewidth": 1.4, "capsize": 3}),
            (~has_step & ~has_U, None, "neither", {"marker": "^", "color": style.MUTED})):
        chosen = chosen & np.isfinite(offsets.apart)
        if chosen.any():
            axes.errorbar(factor * offsets.apart[chosen], np.flatnonzero(chosen),
                          xerr=None if bars is None else factor * bars[chosen],
                          label=t(f"figure.comparison.{label}"), **look, **looks)
    if offsets.are_far:
        _logarithmic(axes, U, factor * offsets.largest, t)
    axes.set_xlabel(t("figure.comparison.apart", name=offsets.name, unit=unit))
    axes.tick_params(axis="y", left=False)


def _logarithmic(axes, near: float, far: float, t) -> None:
    """From the power of ten above near on, to both sides: as many ticks as have room, small ones between."""
    first, last = math.ceil(math.log10(near)), max(math.ceil(math.log10(near)), math.floor(math.log10(far)))
    axes.set_xscale("symlog", linthresh=10.0**first)
    powers = 10.0 ** np.arange(last, first - 1, -max(1, -(-(last - first) // 2)))
    decades = 10.0 ** np.arange(first, last + 1)
    axes.set_xticks([*-powers, 0, *powers])
    axes.set_xticks([*-decades, *decades], minor=True)
    axes.xaxis.set_major_formatter(style.plain_numbers(t))
    axes.xaxis.set_minor_formatter("")


def _errors(rows: list[dict], t) -> style.Figure | None:
    lengths = [column for column in columns(rows) if column not in SUMMARIES]
    summaries = [column for column in SUMMARIES if column in columns(rows)]
    figure, axes = style.new_figure(1.1 + 0.34 * len(rows))
    places = np.arange(len(rows))
    for k, column in enumerate(lengths):
        axes.plot(_sizes(rows, column), places, "o", color=style.TERTIARY, markersize=5,
                  markeredgecolor=style.PRIMARY, markeredgewidth=0.5,
                  label=t("figure.comparison.single") if k == 0 else None)
    for column, color in zip(summaries, (style.INK, style.SECONDARY, style.PRIMARY, style.MUTED)):
        axes.plot(_sizes(rows, column), places, linestyle="none", marker=MARKERS[column], color=color,
                  markersize=8, markeredgewidth=1.8, markerfacecolor="none",
                  label=t.named("comparison.column", column).split(" / ")[0])
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(style.plain_numbers(t))
    axes.grid(axis="x")
    axes.set_xlabel(t("figure.comparison.error"))
    _method_names(axes, rows, t)
    style.legend_above(figure, axes, 3)
    return figure


def _sizes(rows: list[dict], column: str) -> np.ndarray:
    """Logarithmic axes have no place for zero."""
    sizes = np.abs([value(row, column) for row in rows])
    return np.where(sizes > 0, sizes, np.nan)


def _method_names(axes, rows: list[dict], t) -> None:
    axes.set_yticks(range(len(rows)), [shortened(method_name(row, t), 38) for row in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.tick_params(axis="y", left=False)
