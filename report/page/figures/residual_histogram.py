"""All residuals within the lines against the normal distribution: density and quantiles."""
from statistics import NormalDist

import numpy as np

import style
from calibration import Calibration
from notation import count, significant
from residuals import Histogram, scanned_targets

LEAST = 5  # residuals beyond: with fewer the band of the quantiles would be a guess


def draw(c: Calibration, t) -> style.Figure | None:
    histogram = Histogram(scanned_targets(c))
    if not histogram.total:
        return None
    figure, (left, right) = style.new_figure(2.2, 1, 2)
    _density(left, histogram, t)
    _quantiles(right, histogram, t)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    histogram = Histogram(scanned_targets(c))
    beyond = histogram.below + histogram.above
    limit = t.number(significant(histogram.edges[-1], 2))
    words = t("figure.residual_histogram.beyond", beyond=count(beyond), limit=limit)
    return {"total": count(histogram.total), "beyond": words if beyond else ""}


def _density(axes, histogram: Histogram, t) -> None:
    occupied = np.abs(histogram.edges[:-1][histogram.counts > 0])
    limit = min(histogram.edges[-1], max(4.0, occupied.max() if occupied.size else 0))
    axes.stairs(histogram.density, histogram.edges, fill=True, color=style.TERTIARY,
                label=t("figure.residual_histogram.residuals"))
    x = np.linspace(-limit, limit, 201)
    axes.plot(x, _normal(x), color=style.INK, linestyle="-",
              label=t("figure.residual_histogram.normal"))
    axes.set_xlim(-limit, limit)
    axes.set_ylim(0, 1.25 * max(0.4, histogram.density.max()))
    axes.set_xlabel(t("figure.residual_histogram.in_sigma"))
    axes.set_ylabel(t("figure.residual_histogram.density"))
    axes.legend(loc="upper left", ncols=2, borderaxespad=0)


def _quantiles(axes, histogram: Histogram, t) -> None:
    normal, found = histogram.quantiles()
    ends = np.array([min(-4, normal.min(), found.min()), max(4, normal.max(), found.max())]) \
        if normal.size else np.array([-4, 4])
    x = np.linspace(*ends, 201)
    axes.fill_between(x, *_band(x, histogram.total), color=style.TERTIARY, linewidth=0,
                      label=t("figure.residual_histogram.band"))
    axes.plot(ends, ends, color=style.INK, linewidth=0.9, linestyle="-")
    axes.plot(normal, found, linestyle="none", marker="o", markersize=3, color=style.PRIMARY)
    axes.set_xlabel(t("figure.residual_histogram.normal_quantile"))
    axes.set_ylabel(t("figure.residual_histogram.quantile"))
    axes.legend(loc="upper left", borderaxespad=0)


def _normal(x: np.ndarray) -> np.ndarray:
    return np.exp(-x**2 / 2) / np.sqrt(2 * np.pi)


def _band(x: np.ndarray, total: float) -> tuple[np.ndarray, np.ndarray]:
    """Where 95 % of the quantiles of so many independent residuals lie; nan where too few lie beyond."""
    share = np.array([NormalDist().cdf(each) for each in x])
    known = total * np.minimum(share, 1 - share) >= LEAST
    half = np.where(known, 1.96 * np.sqrt(share * (1 - share) / total) / _normal(x), np.nan)
    return x - half, x + half
