"""Correlation of the estimated parameters: lightness is the size, a number says the sign."""
import style
from calibration import Calibration
from notation import significant

NUMBERS_UP_TO = 12  # parameters: beyond, the numbers would not be read


def draw(c: Calibration, t) -> style.Figure | None:
    names, correlation = [parameter["name"] for parameter in c.estimated], c.correlation
    if len(names) < 2:
        return None
    few = len(names) <= NUMBERS_UP_TO
    figure, axes = style.new_figure(min(6.2, 1.2 + 0.42 * len(names)) if few else 5.6)
    drawn = axes.imshow(correlation, vmin=-1, vmax=1, aspect="equal")
    axes.set_xticks(range(len(names)), names, rotation=90)
    axes.set_yticks(range(len(names)), names)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)
    for i in range(len(names) if few else 0):
        for j in range(len(names)):
            axes.text(j, i, t.number(significant(correlation[i, j], 2)), ha="center", va="center", fontsize=8,
                      color="white" if correlation[i, j] < 0.25 else style.INK)
    figure.colorbar(drawn, ax=axes, label=t("figure.correlation.scale"), shrink=0.8)
    return figure
