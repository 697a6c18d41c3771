"""Shares of the variance of each parameter: for few parameters a bar for each source, largest first; for many
a bar for each parameter, in pieces."""
import numpy as np

import style
from calibration import Calibration
from notation import shortened, significant
from uncertainty import axis_unit, known, shares, sources_by_share

FEW_PARAMETERS, MOST_BARS = 4, 40
MOST_SOURCES, MOST_PIECES = 12, 5  # the smaller ones as one
NO_PIECE = 0.005  # a share that could not be seen
HATCHES = ["", "////", "\\\\\\\\", "----", "xxxx", "||||"]


def draw(c: Calibration, t) -> style.Figure | None:
    if not c.get("budget") or not c.estimated:
        return None
    return _by_source(c, t) if len(c.estimated) <= FEW_PARAMETERS else _by_parameter(c, t)


def caption(c: Calibration, t) -> dict[str, str]:
    few = len(c.estimated) <= FEW_PARAMETERS
    how = t("figure.budget.by_source" if few else "figure.budget.by_parameter")
    rest = len(c.estimated) - MOST_BARS
    left_out = " " + t("figure.budget.left_out", shown=MOST_BARS, left_out=rest) if rest > 0 else ""
    return {"what": t(f"figure.budget.{'reliable' if c.is_reliable else 'unreliable'}", how=how), "left_out": left_out}


def table_of_shares(c: Calibration, t, most: int, least: float) -> list[tuple[str, str, list[float]]]:
    """Source, type and shares of the estimated parameters; the smaller sources as one."""
    lines = [(t.translated(line["source"])[0], line["type"], shares(line, c)) for line in sources_by_share(c)]
    keep = [line for line in lines if max(line[2]) >= least][:most]
    rest = lines[len(keep):]
    if len(rest) == 1:
        keep, rest = lines, []
    if rest:
        together = np.sum([line[2] for line in rest], axis=0)
        keep.append((t("budget.others", number=len(rest)), "", list(together)))
    return keep


def _by_source(c: Calibration, t) -> style.Figure:
    lines, parameters = table_of_shares(c, t, MOST_SOURCES, NO_PIECE), c.estimated
    figure, axes = style.new_figure(0.75 + 0.27 * len(lines), 1, len(parameters), sharey=True, squeeze=False)
    label_inches = 0.55 if len(parameters) < 4 else 0.45
    panel_inches = (style.WIDTH - 1.9) / len(parameters)
    for k, (panel, parameter) in enumerate(zip(axes[0], parameters)):
        for row, (_, kind, of) in enumerate(lines):
            declared = kind == "B"
            panel.barh(row, 100 * of[k], 0.62, color=style.TERTIARY if declared else style.PRIMARY,
                       edgecolor=style.PRIMARY, hatch="////" if declared else "")
            panel.annotate(t.number(f"{100 * of[k]:.1f}") + " %", (100 * of[k], row), (4, 0),
                           textcoords="offset points", va="center", fontsize=8)
        panel.set_title(_title(parameter, c, t))
        panel.set_xlim(0, 100 / (1 - min(0.6, label_inches / panel_inches)))
        panel.set_xticks([0, 50, 100])
        panel.spines["bottom"].set_bounds(0, 100)
        panel.tick_params(axis="y", length=0)
    figure.supxlabel(t("figure.budget.share"), fontsize=9)
    names = [f"{shortened(source)} ({kind})" if kind else source for source, kind, _ in lines]
    axes[0, 0].set_yticks(range(len(lines)), names)
    axes[0, 0].invert_yaxis()
    return figure


def _title(parameter: dict, c: Calibration, t) -> str:
    """With its u, where that is a result."""
    name, (factor, unit) = shortened(parameter["name"]), axis_unit(parameter)
    return f"u({name}) = {t.number(significant(factor * known(parameter.get('u'))))} {unit}" if c.is_reliable else name


def _by_parameter(c: Calibration, t) -> style.Figure:
    parameters = c.estimated[:MOST_BARS]
    pieces = table_of_shares(c, t, MOST_PIECES, NO_PIECE)
    figure, axes = style.new_figure(0.75 + 0.2 * len(parameters))
    left = np.zeros(len(parameters))
    for k, (source, kind, of) in enumerate(pieces):
        lightness = k / max(1, len(pieces) - 1)
        width = 100 * np.array(of[:len(parameters)])
        if kind:
            looks = {"color": style.matplotlib.colormaps[style.MAP](0.1 + 0.85 * lightness),
                     "edgecolor": "white" if lightness < 0.5 else style.INK, "hatch": HATCHES[k]}
        else:  # the others
            looks = {"color": "white", "edgecolor": style.INK}
        label = f"{shortened(source)} ({kind})" if kind else source
        axes.barh(range(len(parameters)), width, 0.7, left, linewidth=0.4, label=label, **looks)
        left += width
    axes.set_yticks(range(len(parameters)), [shortened(parameter["name"]) for parameter in parameters])
    axes.set_ylim(len(parameters) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.set_xlabel(t("figure.budget.share"))
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    longest = max(len(source) for source, _, _ in pieces)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=max(1, min(3, int(90 / (longest + 12)))),
                handleheight=1.4, handlelength=2.6)
    return figure
