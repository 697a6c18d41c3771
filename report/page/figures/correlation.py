"""Correlation of the estimated parameters: the area of a disc is its size, a ring is negative."""
import math

import numpy as np

import style
from calibration import Calibration
from notation import MINUS, shortened
from uncertainty import strongest_pairs

WORDS_UP_TO = 2      # parameters: one number is a sentence
NUMBERS_UP_TO = 10   # parameters: beyond, the numbers would not be read
CELL = 0.36          # inches, at most
BESIDE = 3.7         # inches of a matrix with the pairs at its right; a larger one has them in its empty half
MOST_PAIRS, ROW = 10, 0.2
LETTER = 0.068       # inches, at 8 points
LEVELS = 25          # of area: the eye parts fewer
TOP = 0.3            # inches, for the title of the pairs


def draw(c: Calibration, t) -> style.Figure | None:
    names = [shortened(parameter["name"], 18) for parameter in c.estimated]
    if len(names) <= WORDS_UP_TO or not np.isfinite(c.correlation).all():
        return None
    margin = 0.2 + LETTER * max(len(name) for name in names)
    size = min(style.WIDTH - margin - 0.1, CELL * len(names))
    height = size + margin + TOP
    figure = style.pyplot.figure(figsize=(style.WIDTH, height), layout="none")
    _matrix(_axes(figure, margin, margin, size, size), names, c.correlation, t)
    pairs = strongest_pairs(c, MOST_PAIRS if size > BESIDE else max(3, int(size / ROW)))
    tall = ROW * len(pairs)
    words = 0.1 + LETTER * max(len(_pair(pair)) for pair in pairs)
    left = margin + (size / 2 if size > BESIDE else size + 0.3) + words
    _pairs(_axes(figure, left, height - TOP - tall, style.WIDTH - left - 0.55, tall), pairs, t)
    return figure


def _axes(figure, left: float, bottom: float, width: float, height: float):
    """Inches."""
    wide, high = figure.get_size_inches()
    return figure.add_axes([left / wide, bottom / high, width / wide, height / high])


def _matrix(axes, names: list[str], correlation: np.ndarray, t) -> None:
    n = len(names)
    cell_points = 72 * axes.get_position().width * style.WIDTH / n
    row, column = np.tril_indices(n)
    r = correlation[row, column]
    level = np.round(LEVELS * np.minimum(np.abs(r), 1)).astype(int)
    disc, ring = (_looks(sign) for sign in (1, -1))
    for k in range(1, LEVELS + 1):
        for of_sign, looks in ((r > 0, disc), (r < 0, ring)):
            here = of_sign & (level == k)
            if here.any():
                across = 0.9 * cell_points * math.sqrt(k / LEVELS) - looks["markeredgewidth"]
                axes.plot(column[here], row[here], "o", linestyle="none", markersize=across, **looks)
    for i, j in zip(row, column) if n <= NUMBERS_UP_TO else ():
        if i != j:
            axes.text(i, j, t.number(_number(correlation[i, j])), ha="center", va="center", fontsize=8)
    _grid(axes, n, whole=n <= NUMBERS_UP_TO)
    axes.set_xlim(-0.5, n - 0.5)
    axes.set_ylim(n - 0.5, -0.5)
    axes.set_xticks(range(n), names, rotation=90, fontsize=min(8.0, 0.83 * cell_points))
    axes.set_yticks(range(n), names, fontsize=min(8.0, 0.83 * cell_points))
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)


def _grid(axes, n: int, whole: bool) -> None:
    edges = np.arange(n + 1) - 0.5
    to = np.full(n + 1, n - 0.5)
    first = np.full(n + 1, -0.5)
    ends, starts = (to, first) if whole else (np.minimum(edges + 1, to), np.maximum(edges - 1, first))
    axes.hlines(edges, first, ends, color=style.FAINT, lw=0.6, zorder=0)
    axes.vlines(edges, starts, to, color=style.FAINT, lw=0.6, zorder=0)


def _looks(sign: float) -> dict:
    if sign > 0:
        return {"color": style.PRIMARY, "markeredgewidth": 0}
    return {"color": "white", "markeredgecolor": style.SECONDARY, "markeredgewidth": 1}


def _number(r: float) -> str:
    return f"{round(r, 2) + 0.0:.2f}".replace("-", MINUS)


def _pair(pair: tuple[str, str, float]) -> str:
    return f"{shortened(pair[0], 14)}, {shortened(pair[1], 14)}"


def _pairs(axes, pairs: list[tuple[str, str, float]], t) -> None:
    for row, (_, _, r) in enumerate(pairs):
        axes.plot([0, r], [row, row], "-", color=style.MUTED, lw=1)
        axes.plot(r, row, "o", markersize=7, clip_on=False, **_looks(r))
        axes.annotate(t.number(_number(r)), (1, row), (32, 0), textcoords="offset points", ha="right",
                      va="center", fontsize=8, annotation_clip=False)
    axes.axvline(0, color=style.MUTED, lw=0.7)
    axes.set_xlim(-1, 1)
    axes.set_xticks([-1, 0, 1])
    axes.set_ylim(len(pairs) - 0.4, -0.6)
    axes.set_yticks(range(len(pairs)), [_pair(pair) for pair in pairs])
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.set_title(t("figure.correlation.strongest"))
