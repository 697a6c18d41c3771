"""The trials of the Monte Carlo as a histogram against the density of value, u and dof; both intervals."""
import math

import numpy as np
from matplotlib import ticker

import style
from calibration import Calibration
from notation import shortened
from uncertainty import apart_in_u, axis_unit, gum_density, known

MOST_PANELS = 6


def draw(c: Calibration, t) -> style.Figure | None:
    panels = _panels(c)
    if not panels:
        return None
    columns = 3 if len(panels) == 3 else min(2, len(panels))
    rows = math.ceil(len(panels) / columns)
    figure, axes = style.new_figure(2.8 * rows, 2 * rows, columns, squeeze=False, sharex=False,
                                    gridspec_kw={"height_ratios": [4, 1] * rows, "hspace": 0.0})
    figure.get_layout_engine().set(hspace=0.0, h_pad=0.02, w_pad=0.12)
    for k in range(rows * columns):
        pair = axes[2 * (k // columns), k % columns], axes[2 * (k // columns) + 1, k % columns]
        if k < len(panels):
            _panel(*pair, c, panels[k], t)
        else:
            for each in pair:
                each.set_visible(False)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    number = len((c.get("montecarlo") or {}).get("parameters") or [])
    shown = len(_panels(c))
    left_out = " " + t("figure.monte_carlo.left_out", shown=shown, number=number) if number > shown else ""
    return {"left_out": left_out}


def _panels(c: Calibration) -> list[dict]:
    """What was drawn; of many parameters those where the two intervals differ most."""
    all_of = [each for each in (c.get("montecarlo") or {}).get("parameters") or []
              if c.parameter(each["name"]) and _is_whole(each.get("histogram") or {})]
    if len(all_of) <= MOST_PANELS:
        return all_of
    return sorted(all_of, key=lambda each: -np.nan_to_num(apart_in_u(each), nan=math.inf))[:MOST_PANELS]


def _is_whole(histogram: dict) -> bool:
    edges, counts = (np.array(histogram.get(key) or [], dtype=float) for key in ("edges", "counts"))
    return counts.size > 0 and edges.size == counts.size + 1 and np.isfinite(edges).all() and counts.sum() > 0


def _panel(upper, lower, c: Calibration, trials: dict, t) -> None:
    parameter = c.parameter(trials["name"])
    factor, unit = axis_unit(parameter)
    edges, counts = (np.array(trials["histogram"][key], dtype=float) for key in ("edges", "counts"))
    ends = np.array([known(trials.get(key)) for key in ("low", "high", "gum_low", "gum_high")])
    seen = np.append(ends[np.isfinite(ends)], edges[[0, -1]])
    low, high = seen.min(), seen.max()
    density = counts / (counts.sum() * np.diff(edges) * factor)
    upper.stairs(density, edges * factor, fill=True, color=style.TERTIARY)
    x = np.linspace(low, high, 300)
    if known(parameter.get("u")) > 0:
        upper.plot(x * factor, gum_density(x, parameter) / factor, "-", color=style.PRIMARY)
    verdict = t.named("monte_carlo.verdict", trials["verdict"])
    upper.set_title(f"{shortened(trials['name'])}: {verdict}", pad=12)
    upper.set_yticks([])
    upper.spines["left"].set_visible(False)
    upper.set_ylim(bottom=0)
    percent = t.number(f"{c.coverage_percent:.4g}")
    _bracket(lower, 1, ends[2] * factor, ends[3] * factor, t("figure.monte_carlo.gum"), style.PRIMARY, 1.4)
    _bracket(lower, 0, ends[0] * factor, ends[1] * factor, t("figure.monte_carlo.trials", percent=percent),
             style.TERTIARY, 4)
    lower.set_ylim(-0.7, 1.6)
    lower.set_yticks([])
    lower.spines["left"].set_visible(False)
    lower.set_xlabel(f"{shortened(trials['name'])} / {unit}")
    upper.tick_params(axis="x", length=0, labelbottom=False)
    for axes in (upper, lower):
        axes.set_xlim((low - 0.02 * (high - low)) * factor, (high + 0.02 * (high - low)) * factor)
        axes.xaxis.set_major_locator(ticker.MaxNLocator(4))


def _bracket(axes, row: float, low: float, high: float, words: str, color: str, width: float) -> None:
    axes.plot([low, high], [row, row], "-", color=color, lw=width, solid_capstyle="butt")
    for end in (low, high):
        axes.plot([end, end], [row - 0.4, row + 0.4], "-", color=style.INK, lw=0.8)
    axes.text((low + high) / 2, row, words, ha="center", va="center", fontsize=7,
              bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})
