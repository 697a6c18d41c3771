"""Which angles every joint took: a tick a pose."""
import numpy as np

import poses
import style
from calibration import Calibration
from notation import MINUS, count

MANY_TICKS = 800  # beyond, they are pixels


def draw(c: Calibration, t) -> style.Figure | None:
    angles = poses.joint_angles(c)
    if not angles.size:
        return None
    figure, axes = style.new_figure(0.7 + 0.36 * angles.shape[1])
    axes.set_xlim(*_limits(angles))
    alpha = float(np.clip(60 / len(angles), 0.12, 0.8))
    for k, of_joint in enumerate(angles.T):
        low, high = of_joint.min(), of_joint.max()
        axes.barh(k, high - low, 0.62, low, color=style.TERTIARY, alpha=0.4, lw=0)
        axes.vlines(of_joint, k - 0.31, k + 0.31, color=style.PRIMARY, lw=0.8, alpha=alpha, linestyles="-",
                    rasterized=angles.size > MANY_TICKS)
        words = t("figure.joints.range", low=_degree(low), high=_degree(high), gap=_degree(_gap(of_joint)))
        axes.annotate(words, (1, k), (6, 0), xycoords=("axes fraction", "data"), textcoords="offset points",
                      va="center", fontsize=8)
    axes.set_yticks(range(angles.shape[1]), [f"q{k + 1}" for k in range(angles.shape[1])])
    axes.set_ylim(angles.shape[1] - 0.5, -0.5)
    axes.xaxis.set_major_locator(style.ticker.MaxNLocator(9, steps=[1, 3, 4.5, 6, 9, 10]))
    axes.set_xlabel(t("figure.joints.angle"))
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    return {"number": count(len(poses.joint_angles(c)))}


def _limits(angles: np.ndarray) -> tuple[float, float]:
    air = 0.02 * max(10.0, float(np.ptp(angles)))
    return angles.min() - air, angles.max() + air


def _gap(of_joint: np.ndarray) -> float:
    """The widest between neighbours."""
    return float(np.diff(np.sort(of_joint)).max(initial=0))


def _degree(angle: float) -> str:
    return f"{angle:.0f}".replace("-", MINUS) if round(angle) else "0"
