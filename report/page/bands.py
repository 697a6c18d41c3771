"""Names under the bands of an x axis."""
import numpy as np

from notation import shortened

MOST_LETTERS, FEWEST = 28, 3
AIR = 5  # pixels between neighbours


def name_bands(axes, edges: np.ndarray, names: list[str]) -> None:
    """Ticks without lines in the middle of the bands between edges: of each name as much as its band has room for. The
    figure must have everything else that takes part in its layout."""
    axes.figure.draw_without_rendering()
    pixels = axes.transData.transform(np.column_stack([edges, np.zeros(len(edges))]))[:, 0]
    labels = [_fitting(axes, name, width - AIR) for name, width in zip(names, np.diff(pixels))]
    axes.set_xticks((edges[:-1] + edges[1:]) / 2, labels)
    axes.tick_params(axis="x", length=0)


def _fitting(axes, name: str, width: float) -> str:
    """Empty where not even a few letters have room."""
    for letters in range(min(MOST_LETTERS, len(name)), min(FEWEST, len(name)) - 1, -1):
        text = axes.text(0, 0, shortened(name, letters), fontsize=8)
        fits = text.get_window_extent().width <= width
        text.remove()
        if fits:
            return shortened(name, letters)
    return ""
