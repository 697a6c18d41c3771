"""The scene from obliquely above: axis, profiler and planes; arm, scanner and balls."""
import math

import numpy as np

import arm
import oblique
import poses
import scene
import style
from calibration import Calibration
from labels import along, place_labels
from notation import shortened

MOST_NAMES, MOST_TARGETS = 12, 60
MOST_EYES = 300
LOWEST, TALLEST = 1.8, 3.0  # inches
AIR = 0.07       # of the larger extent
ARROW = 0.16     # of the axes of the frame: at most this part of the larger extent
ABOVE = 0.15     # by which the table's axis goes beyond what stands around it


def draw(c: Calibration, t) -> style.Figure | None:
    standing = scene.standings(c)[:MOST_TARGETS]
    if not standing:
        return None
    shapes = [_shape(each, c) for each in standing]
    bends, sights = _arm(c, standing)
    of_all = np.vstack([np.zeros((1, 3)), bends, *shapes, *(each.all_points for each in standing)])
    fans = [_fan(each) if c.is_turntable else np.empty((0, 3)) for each in standing]
    flat = [oblique.normal_of(shape) for shape in [*shapes, *fans] if len(shape) > 2] if _has_planes(c) else []
    view = oblique.best_view(of_all, flat)
    axis = _axis(of_all) if c.is_turntable else np.zeros((1, 3))
    ring = _ring(standing) if c.is_turntable else np.empty((0, 3))
    figure, axes = _axes(view(np.vstack([of_all, axis, ring])))
    drawn = [view(each.eyes) for each in standing] + [along(*view(np.array(part))) for part in zip(bends, bends[1:])]
    few = len(standing) <= MOST_NAMES
    for k in sorted(range(len(standing)), key=lambda k: view.towards @ standing[k].middle):
        color = style.SERIES[k] if len(standing) <= len(style.SERIES) else style.PRIMARY
        drawn.append(_target(axes, view, standing[k], shapes[k], fans[k] if few else fans[k][:0], color, c))
        if few and _has_planes(c):
            axes.fill(*view(shapes[k]).T, facecolor=color, alpha=0.22, lw=0, linestyle="-", zorder=2)
    for sight in sights:
        axes.plot(*view(sight).T, "-", color=style.SECONDARY, lw=0.8, zorder=5)
        drawn.append(along(*view(sight)))
    if c.is_turntable:
        axes.plot(*view(ring).T, ":", color=style.MUTED, lw=0.8, zorder=1)
        axes.plot(*view(axis).T, "-.", color=style.INK, lw=1.1, zorder=4)
        drawn.append(along(*view(axis)))
    axes.plot(*view(bends).T, "-", color=style.INK, lw=2.6, alpha=0.75, solid_joinstyle="round", zorder=6)
    axes.plot(*view(bends).T, "o", color="white", markeredgecolor=style.INK, markersize=3.5, linestyle="none", zorder=7)
    arrows = _frame(axes, view, of_all)
    _names(axes, view, standing, shapes, axis, bends, arrows, np.vstack(drawn), c, t)
    return figure


def caption(c: Calibration, t) -> dict[str, str]:
    standing = scene.standings(c)[:MOST_TARGETS]
    bends, _ = _arm(c, standing)
    kind = "turntable" if c.is_turntable else "robot" if len(bends) else "flange"
    points = np.vstack([np.zeros((1, 3)), bends, *(each.all_points for each in standing)])
    return {"what": t(f"figure.scene_3d.{kind}"), "length": t.number(f"{_arrow(points):g}")}


def _has_planes(c: Calibration) -> bool:
    return c["model"] in ("turntable", "robot-profiler")


def _shape(each: scene.Standing, c: Calibration) -> np.ndarray:
    """Its outline; of a plane whose outline nobody measured what was seen of it."""
    if len(each.outline) or not _has_planes(c) or len(each.seen) < 3:
        return each.outline
    return oblique.patch(each.seen[np.isfinite(each.seen).all(axis=1)])


def _arm(c: Calibration, standing: list[scene.Standing]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Where it bends in the middle pose of the first target, up to the scanner, and its sights, 2 x 3."""
    links, targets = arm.links(c), (c.get("scene") or {}).get("targets") or []
    for station, each, target in zip(poses.stations(c), standing, targets):
        if not len(links) or station.joints.shape[1] != len(links) or not len(station.joints):
            continue
        k = len(station.joints) // 2
        bends, flange = arm.along(links, station.joints[k])
        end = (flange @ np.array(c.get("hand_eye") or np.eye(4), dtype=float))[:3, 3]
        named = {station.ball_of[row] for row in np.flatnonzero(station.pose_of == k)}
        seen = [j for j, name in enumerate((target.get("outline") or {}).get("names") or []) if name in named]
        near = np.argsort(np.linalg.norm(each.eyes - end, axis=1))[:1]
        ends = each.outline[seen] if seen else each.seen[near]
        return np.vstack([bends, end]), [np.array([end, far]) for far in ends]
    return np.empty((0, 3)), []


def _axis(points: np.ndarray) -> np.ndarray:
    """Of the table, a little beyond what stands around it."""
    low, high = points[:, 2].min(), points[:, 2].max()
    beyond = ABOVE * max(high - low, 0.3 * np.ptp(points[:, :2], axis=0).max())
    return np.array([[0, 0, low - beyond], [0, 0, high + beyond]])


def _ring(standing: list[scene.Standing]) -> np.ndarray:
    """The profiler's way around the axis in a whole turn."""
    eyes = np.vstack([each.eyes for each in standing])
    if not len(eyes):
        return eyes
    turn = np.linspace(0, 2 * math.pi, 73)
    radius = np.median(np.hypot(eyes[:, 0], eyes[:, 1]))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(turn.shape, np.median(eyes[:, 2]))])


def _axes(flat: np.ndarray) -> tuple[style.Figure, object]:
    """One scale for both directions, as high as the page's width asks for."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    air = AIR * max(1e-6, (high - low).max())
    low, high = low - air, high + air
    width, height = high - low
    tall = min(TALLEST, max(LOWEST, style.WIDTH * height / width))
    figure = style.pyplot.figure(figsize=(style.WIDTH, tall), layout="none")
    axes = figure.add_axes([0, 0, 1, 1])
    scale = max(width / style.WIDTH, height / tall) / 2
    middle = (low + high) / 2
    axes.set_xlim(middle[0] - scale * style.WIDTH, middle[0] + scale * style.WIDTH)
    axes.set_ylim(middle[1] - scale * tall, middle[1] + scale * tall)
    axes.set_axis_off()
    return figure, axes


def _target(axes, view, each: scene.Standing, shape: np.ndarray, fan: np.ndarray, color: str,
            c: Calibration) -> np.ndarray:
    """What no name may hide of it."""
    eyes = each.eyes[scene.thinned(len(each.eyes), max(2, MOST_EYES // 8))]
    axes.plot(*view(eyes).T, ".", color=style.INK if c.is_turntable else style.MUTED, markersize=2.5, linestyle="none",
              zorder=3)
    if not _has_planes(c):
        axes.plot(*view(shape).T, "o", color=color, markersize=3.2, linestyle="none", zorder=5)
        return view(shape)
    corners = view(shape)
    axes.plot(*np.vstack([corners, corners[:1]]).T, "-", color=color, lw=1.1 if len(fan) else 0.6, zorder=3)
    if len(fan):
        axes.fill(*view(fan).T, facecolor=style.SECONDARY, alpha=0.18, lw=0, linestyle="-", zorder=3)
        axes.plot(*view(fan[1:]).T, "-", color=style.SECONDARY, lw=1.2, zorder=4)
    return np.vstack([view(scene.closed(shape, 6)), view(eyes)])


def _fan(each: scene.Standing) -> np.ndarray:
    """The profiler and the ends of its line on the target, in the middle of the sweep, 3 x 3."""
    if not len(each.eyes) or len(each.outline) < 3:
        return np.empty((0, 3))
    k = len(each.eyes) // 2
    across = np.cross(each.seen[k] - each.eyes[k], [0.0, 0.0, 1.0])
    line = oblique.cut(each.outline, each.eyes[k], across)
    return np.vstack([each.eyes[k], line]) if len(line) else line


def _arrow(points: np.ndarray) -> float:
    """1, 2 or 5 of a power of ten, mm."""
    most = ARROW * np.ptp(points, axis=0).max()
    power = 10.0 ** math.floor(math.log10(max(most, 1e-9)))
    return float(max(step for step in (1, 2, 5) if step * power <= max(most, power)) * power)


def _frame(axes, view, points: np.ndarray) -> np.ndarray:
    """Arrows of X, Y, Z at the origin: their ends."""
    ends = view(_arrow(points) * np.eye(3))
    for end in ends:
        axes.annotate("", end, view(np.zeros(3)), zorder=8, arrowprops={
            "arrowstyle": "-|>", "color": style.INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7})
    return ends


def _names(axes, view, standing, shapes, axis, bends, arrows, drawn, c: Calibration, t) -> None:
    points, texts, looks = list(arrows), ["X", "Y", "Z"], [{"fontsize": 8}] * 3
    points.append(view(axis)[-1])
    texts.append(t("figure.scene.axis" if c.is_turntable else "figure.scene.base"))
    eyes = np.vstack([each.eyes for each in standing])
    kind = {"turntable": "profiler", "robot-ball": "scanner", "robot-profiler": "profiler"}.get(c["model"], "flange")
    if len(bends) or len(eyes):
        points.append(view(bends[-1] if len(bends) else eyes[0]))
        texts.append(t(f"figure.scene.{kind}"))
    looks += [{"fontsize": 8}] * (len(texts) - 3)
    centre = view(np.mean([each.middle for each in standing], axis=0))
    for k, (each, shape) in enumerate(zip(standing[:MOST_NAMES], shapes)):
        corners = view(shape if len(shape) else each.seen)
        away = view(each.middle) - centre
        points.append(corners[np.argmax(corners @ away)] if np.linalg.norm(away) > 0 else corners[0])
        texts.append(shortened(each.name, 20))
        few = len(standing) <= len(style.SERIES)
        looks.append({"fontsize": 8, "color": style.SERIES[k] if few else style.PRIMARY})
    place_labels(axes, points, texts, np.vstack([drawn, *(along(view(np.zeros(3)), end, 8) for end in arrows)]),
                 looks=looks)
