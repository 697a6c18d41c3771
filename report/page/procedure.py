"""What was done, in sentences: of the page's head and of the certificate."""
import volume
from calibration import Calibration
from language import Language
from notation import MINUS, count, shortened, significant

FEW_NAMES, LONGEST_NAME = 6, 40
COORDINATES = 3  # of a ball: what a robot's targets count as points


def sentences(c: Calibration, t: Language) -> list[str]:
    told = [_seen(c, t)] if c.get("targets") else []
    found = volume.of(c)
    if found:
        ends = {f"{name}_{which}": t.number(significant(end(nodes), 3)) for name, nodes in zip(volume.READING, found.nodes)
                for which, end in (("low", min), ("high", max))}
        told.append(t("procedure.range", **ends))
    told += [_fitted(c, t), t(f"procedure.method.{c['model']}")]
    trials = (c.get("montecarlo") or {}).get("trials")
    if trials:
        told.append(t("procedure.monte_carlo", trials=count(trials)))
    return told


def has_equal_weights(c: Calibration) -> bool:
    return any(str(line.get("source")).startswith("residuals, clustered") for line in c.get("budget") or [])


def _seen(c: Calibration, t: Language) -> str:
    targets, words = c["targets"], f"procedure.{c['model']}"
    names = ", ".join(shortened(str(target["name"]), LONGEST_NAME) for target in targets)
    key = "one" if len(targets) == 1 else "few" if len(targets) <= FEW_NAMES else "many"
    numbers = {"views": _views(c)} | {what: sum(target.get(what) or 0 for target in targets)
                                      for what in ("points", "missing", "set_aside")}
    if not c.is_turntable:
        numbers["points"] /= COORDINATES
    counted = [t(f"{words}.{what}", count=count(number)) for what, number in numbers.items() if number]
    return t(f"{words}.seen", targets=t(f"{words}.targets_{key}", count=len(targets), names=names),
             counted=", ".join(counted))


def _views(c: Calibration) -> float:
    """Profiles or poses; 0: this file does not say."""
    data = c.get("data") or {}
    profiles = sum(target.get("profiles") or 0 for target in data.get("targets") or [])
    residuals = (c.get("residuals") or {}).get("targets") or []
    return profiles or sum(len((target.get("poses") or {}).get("rows") or []) for target in residuals)


def _fitted(c: Calibration, t: Language) -> str:
    names = [parameter["name"] for parameter in c.estimated]
    many = t("procedure.many_names", count=len(names))
    weights = t("procedure.weights_equal" if has_equal_weights(c) else "procedure.weights_estimated")
    return t(f"procedure.{c['model']}.fitted", names=", ".join(names) if len(names) <= FEW_NAMES else many,
             residual=t.named("procedure.residual", str(c.get("residual") or "–")), weights=weights,
             iterations=c.get("iterations") or "–", start=_start(c, t))


def _start(c: Calibration, t: Language) -> str:
    grid, search = c.get("grid") or {}, c.table("surface", "search")
    if not grid.get("nodes"):
        return ""
    intervals = [t("procedure.interval", name=name, lower=_node(search[name].min(), t), upper=_node(search[name].max(), t))
                 for name in ("M", "N") if name in search and len(search)]
    return t("procedure.start_over" if intervals else "procedure.start", intervals=", ".join(intervals),
             step=t.number(f"{grid.get('step') or 0:g}"), nodes=count(grid["nodes"]))


def _node(number: float, t: Language) -> str:
    return t.number(f"{number:g}".replace("-", MINUS))
