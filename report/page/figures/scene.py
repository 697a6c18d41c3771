"""Where scanner and targets stood, from above and from the side, at one scale."""
import math

import numpy as np
from matplotlib import ticker

import scene
import style
from calibration import Calibration
from labels import along, place_labels
from notation import shortened

MOST_NAMES, MOST_TARGETS = 12, 60
MOST_SIGHTS, MOST_OF_ALL = 9, 120  # lines of sight of a target, of all together
MOST_EYES = 600
LEFT, RIGHT, BELOW, ABOVE, BETWEEN = 0.62, 0.1, 0.5, 0.3, 0.75  # inches around the axes
TALLEST = 6.5          # inches of axes
WORTH_A_PAGE = 1.6     # by how much larger the views must come out to stand one above the other
AIR = 0.08             # of the larger extent


def draw(c: Calibration, t) -> style.Figure | None:
    standing = scene.standings(c)[:MOST_TARGETS]
    if not standing:
        return None
    side = scene.beside_axis if c.is_turntable else scene.from_front
    of_all = np.vstack([each.all_points for each in standing] + [np.zeros((1, 3))])
    views = [(scene.from_above, "X", "Y", "above"), (side, "r" if c.is_turntable else "X", "Z", "side")]
    figure, panels = _panels([_extent(project(of_all)) for project, *_ in views])
    for axes, (project, across, up, name) in zip(panels, views):
        _draw(axes, project, standing, c, t)
        axes.set_xlabel(t("figure.scene.distance") if across == "r" else f"{across} / mm")
        axes.set_ylabel(f"{up} / mm")
        axes.set_title(t(f"figure.scene.{name}"))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(ticker.MaxNLocator(5, steps=[1, 2, 5, 10]))
    for axes, (project, *_) in zip(panels, views):
        _names(axes, project, standing, c, t)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    number = len(scene.standings(c))
    kind = {"turntable": "turntable", "robot-ball": "robot", "robot-tracker": "tracker", "robot-profiler": "carried",
            "flange-ball": "flange"}[c["model"]]
    words = ["named"] * (number > MOST_NAMES) + ["drawn"] * (number > MOST_TARGETS)
    sentences = [t(f"figure.scene.{word}", shown=MOST_TARGETS, number=number) for word in words]
    return {"what": t(f"figure.scene.seen_{kind}"), "left_out": "".join(" " + each for each in sentences)}


def _extent(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    low, high = points.min(axis=0), points.max(axis=0)
    air = AIR * max(1e-6, (high - low).max())
    return low - air, high + air


def _panels(extents) -> tuple[style.Figure, list]:
    """Side by side or one above the other, whichever draws them larger; one scale for both."""
    sizes = [high - low for low, high in extents]
    beside = min((style.WIDTH - 2 * LEFT - RIGHT - 0.1) / (sizes[0][0] + sizes[1][0]),
                 TALLEST / max(size[1] for size in sizes))
    stacked = min((style.WIDTH - LEFT - RIGHT) / max(size[0] for size in sizes),
                  (TALLEST - BETWEEN) / (sizes[0][1] + sizes[1][1]))
    scale = beside if stacked < WORTH_A_PAGE * beside else stacked  # inches per mm
    inches = [scale * size for size in sizes]
    if scale == beside:
        height = max(size[1] for size in inches) + BELOW + ABOVE
        second = max(style.WIDTH - RIGHT - inches[1][0], 2 * LEFT + inches[0][0])
        places = [(LEFT, height - ABOVE - inches[0][1]), (second, height - ABOVE - inches[1][1])]
    else:
        height = inches[0][1] + inches[1][1] + BELOW + ABOVE + BETWEEN
        places = [(LEFT, BELOW + BETWEEN + inches[1][1]), (LEFT, BELOW)]
    figure = style.pyplot.figure(figsize=(style.WIDTH, height), layout="none")
    panels = []
    for (low, high), size, (left, bottom) in zip(extents, inches, places):
        axes = figure.add_axes([left / style.WIDTH, bottom / height, size[0] / style.WIDTH, size[1] / height])
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        panels.append(axes)
    return figure, panels


def _draw(axes, project, standing: list[scene.Standing], c: Calibration, t) -> None:
    few = len(standing) <= len(style.SERIES)
    sights = max(1, min(MOST_SIGHTS, MOST_OF_ALL // len(standing)))
    for k, each in enumerate(standing):
        color, dash = (style.SERIES[k], style.DASHES[k]) if few else (style.PRIMARY, "-")
        outline, eyes, seen = project(each.outline), project(each.eyes), project(each.seen)
        for i in scene.thinned(len(eyes), sights):
            axes.plot(*np.stack([eyes[i], seen[i]], axis=-1), "-", color=style.MUTED, lw=0.4, zorder=1)
        axes.plot(*eyes[scene.thinned(len(eyes), max(2, MOST_EYES // len(standing)))].T, linestyle="none",
                  marker="." if c.is_turntable else "x", color=style.INK, markersize=3 if few else 2,
                  markeredgewidth=0.6 if few else 0.4, zorder=3)
        if c.is_turntable and len(outline):
            line = project(scene.closed(each.outline, 12 if project is scene.beside_axis else 1)).T
            axes.plot(*line, linestyle=dash, color=color, lw=1.4 if few else 0.5, zorder=4)
            if few:
                axes.fill(*line, color=color, alpha=0.15, lw=0, linestyle="-", zorder=2)
        else:
            axes.plot(*outline.T, "o", color=color, markersize=3 if few else 2, linestyle="none", zorder=4)
    if c.is_turntable and project is scene.beside_axis:
        axes.axvline(0, linestyle="-.", color=style.INK, lw=1)
    else:
        axes.plot(0, 0, "+", color=style.INK, markersize=11, markeredgewidth=1.4, zorder=5)


def _names(axes, project, standing: list[scene.Standing], c: Calibration, t) -> None:
    named = standing[:MOST_NAMES]
    centre = project(np.nanmean([each.middle for each in standing], axis=0))
    many = len(standing) > len(style.SERIES)
    points, directions, looks = [], [], []
    for k, each in enumerate(named):
        outline = project(each.outline if len(each.outline) else each.seen)
        away = project(each.middle) - centre
        farthest = outline[np.argmax(outline @ away)] if np.linalg.norm(away) > 0 else outline[0]
        points.append(farthest)
        directions.append(math.degrees(math.atan2(away[1], away[0])))
        looks.append({"color": style.PRIMARY if many else style.SERIES[k]})
    texts = [shortened(each.name, 20) for each in named]
    height = axes.get_ylim()[0] if c.is_turntable and project is scene.beside_axis else 0
    points.insert(0, (0, height))
    texts.insert(0, t("figure.scene.axis" if c.is_turntable else "figure.scene.base"))
    eyes = np.vstack([project(each.eyes) for each in standing])
    if len(eyes):
        kind = {"turntable": "profiler", "robot-ball": "scanner", "robot-profiler": "profiler"}.get(c["model"], "flange")
        points.append(eyes[np.argmin(np.hypot(*eyes.T))])
        texts.append(t(f"figure.scene.{kind}"))
    number = len(texts)
    place_labels(axes, points, texts, _obstacles(axes, project, standing, c), [45, *directions, 225][:number],
                 [{}, *looks, {}][:number])


def _obstacles(axes, project, standing: list[scene.Standing], c: Calibration) -> np.ndarray:
    """What no name may hide."""
    drawn = [project(each.outline) for each in standing] + [project(each.eyes) for each in standing]
    if c.is_turntable:
        drawn += [project(scene.closed(each.outline)) for each in standing if len(each.outline)]
        drawn += [along(a, b, 12) for each in standing
                  for a, b in zip(project(each.eyes[::4]), project(each.seen[::4]))]
        if project is scene.beside_axis:
            drawn.append(along((0, axes.get_ylim()[0]), (0, axes.get_ylim()[1])))
    return np.vstack(drawn)
