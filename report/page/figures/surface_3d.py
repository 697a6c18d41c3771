"""The paper's Fig. 6: S(M, N) over the search box as a surface."""
import numpy as np

import style
from calibration import Calibration
from surface import searched, unit_of_S

MOST_NODES = 41  # along a side: the picture has no room for more


def draw(c: Calibration, t) -> style.Figure | None:
    surface = searched(c)
    if not surface:
        return None
    factor, unit = unit_of_S(c)
    rows, columns = (max(1, -(-n // MOST_NODES)) for n in surface.S.shape)
    M, N = np.meshgrid(surface.M, surface.N, indexing="ij")
    height = np.log10(factor * surface.S) if surface.is_logarithmic else factor * surface.S
    figure = style.pyplot.figure(figsize=(style.WIDTH, 3.7))
    axes = figure.add_subplot(projection="3d", computed_zorder=False)
    drawn = axes.plot_surface(M, N, height, rstride=rows, cstride=columns, cmap=style.MAP, linewidth=0.2,
                              edgecolor=style.INK, antialiased=True, rasterized=True)
    axes.set_xlabel(t("figure.surface_contour.M"))
    axes.set_ylabel(t("figure.surface_contour.N"))
    axes.set_zlabel(t("figure.surface_contour.S", unit=unit))
    if surface.is_logarithmic:
        low, high = np.floor(np.nanmin(height)), np.ceil(np.nanmax(height))
        axes.set_zticks(np.arange(low, high + 1))
        axes.zaxis.set_major_formatter(lambda power, _: style.plain_numbers(t)(10**power))
    axes.locator_params(axis="x", nbins=5)
    axes.locator_params(axis="y", nbins=5)
    axes.view_init(elev=30, azim=-128)
    axes.set_box_aspect((1.3, 1.3, 0.9))
    return figure
