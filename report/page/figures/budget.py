"""Shares of the variance of each parameter, one bar a parameter."""
import style
from calibration import Calibration
from notation import shortened

MOST_BARS = 30


def draw(c: Calibration, t) -> style.Figure | None:
    lines, parameters = c.get("budget", []), c.estimated[:MOST_BARS]
    if not lines or not parameters:
        return None
    figure, axes = style.new_figure(0.75 + 0.3 * len(parameters))
    left = [0.0] * len(parameters)
    greys = style.matplotlib.colormaps[style.MAP]
    for k, line in enumerate(lines):
        shares = [100 * max(0.0, line["share"][parameter["name"]] or 0.0) for parameter in parameters]
        axes.barh(range(len(parameters)), shares, 0.62, left, color=greys(0.08 + 0.84 * k / max(1, len(lines) - 1)),
                  edgecolor="white", label=f"{shortened(line['source'])} ({line['type']})")
        left = [a + b for a, b in zip(left, shares)]
    axes.set_yticks(range(len(parameters)), [shortened(parameter["name"]) for parameter in parameters])
    axes.invert_yaxis()
    axes.set_xlim(0, 100)
    axes.set_xlabel(t("figure.budget.share"))
    axes.spines["left"].set_visible(False)
    axes.tick_params(left=False)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3)
    return figure
