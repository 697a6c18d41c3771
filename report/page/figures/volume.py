"""The largest U of a measured point over the working volume: maps from above in slices of z, or over depth
and height in slices of alpha, whichever loses less."""
import numpy as np
from matplotlib import ticker

import style
import volume
from calibration import Calibration
from notation import significant

LEVELS = 8


def draw(c: Calibration, t) -> style.Figure | None:
    found = volume.of(c)
    if found is None or found.is_even or min(found.U.shape) < 2:
        return None
    maps = [_map(found, at) for at in found.slices]
    panel = (style.WIDTH - 1.6) / len(maps)
    shape = max(np.ptp(up) for _, up, _ in maps) / max(np.ptp(across) for across, _, _ in maps)
    height = min(5.0, max(2.4, 0.9 + panel * shape)) if found.sliced == 2 else 3.2
    figure, axes = style.new_figure(height, 1, len(maps), squeeze=False, sharex=True, sharey=True)
    levels = ticker.MaxNLocator(LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(found.least, found.largest)
    ends = min(U.min() for *_, U in maps), max(U.max() for *_, U in maps)
    for each, at, (across, up, U) in zip(axes[0], found.slices, maps):
        drawn = each.contourf(across, up, U, levels)
        if found.sliced == 2:
            each.set_aspect("equal")
        each.xaxis.set_major_locator(ticker.MaxNLocator(4))
        each.set_xlabel("X / mm" if found.sliced == 2 else "y / mm")
        if len(maps) > 1:
            each.set_title(t("figure.volume.at_z" if found.sliced == 2 else "figure.volume.at_alpha",
                             value=t.number(_rounded(found.nodes[found.sliced], at))))
        for value, marker, color in zip(ends, "v^", ("white", style.INK)):
            here = np.argwhere(U == value)
            if len(here):
                at_node = tuple(here[0])
                each.plot(across[at_node], up[at_node], marker, color=color, markeredgecolor=style.INK,
                          markersize=7, clip_on=False, zorder=5)
    axes[0, 0].set_ylabel("Y / mm" if found.sliced == 2 else "z / mm")
    figure.colorbar(drawn, ax=list(axes[0]), label=t("figure.volume.scale"), ticks=levels, shrink=0.95,
                    format=style.plain_numbers(t))
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    found = volume.of(c)
    if found is None:
        return {"view": ""}
    view = "from_above" if found.sliced == 2 else "in_profile"
    return {"view": t(f"figure.volume.{view}" + ("" if len(found.slices) > 1 else "_same"))}


def _map(found: volume.Volume, at: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Across, up, U."""
    if found.sliced == 2:
        return found.X[:, :, at], found.Y[:, :, at], found.U[:, :, at]
    _, y, z = found.nodes
    return *np.meshgrid(y, z, indexing="ij"), found.U[at]


def _rounded(nodes: np.ndarray, at: int) -> str:
    """To a hundredth of the range: the middle of -102 to 102 is 0, not 0.204."""
    step = 10 ** np.floor(np.log10(np.ptp(nodes) / 100))
    return significant(round(nodes[at] / step) * step, 3) if abs(nodes[at]) > 2 * step else "0"
