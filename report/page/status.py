"""What may be said of a result in one line, and what speaks against signing it."""
import math
from dataclasses import dataclass

from calibration import Calibration
from notation import significant
from uncertainty import known

SIGNIFICANT = 1e-3  # as the program judges
MOST_NAMES = 3


@dataclass(frozen=True)
class Status:
    """key: words of [status] and [verdict]; color: the class of the box."""
    key: str
    color: str
    count: int = 0

    def line(self, t) -> str:
        return t(f"status.{self.key}", count=self.count)


@dataclass(frozen=True)
class Unexcluded:
    """What is held exactly, although the residuals ask for more of it than would move a parameter by its U; they ask
    for no more than chance does, so they neither show nor exclude it."""
    source: str
    parameter: str
    in_u: float


def of(c: Calibration) -> Status:
    if not c.is_reliable:
        return Status("unreliable", "unreliable")
    if c.get("warnings"):
        return Status("with_warnings" if len(c["warnings"]) > 1 else "with_warning", "with_warnings",
                      len(c["warnings"]))
    if not c.traceable:
        return Status("repeatability", "with_warnings")
    return Status("unexcluded", "with_warnings") if unexcluded(c) else Status("ok", "ok")


def unexcluded(c: Calibration) -> list[Unexcluded]:
    """The one that would move most first."""
    found = []
    for misfit in c.get("misfits") or []:
        p = misfit.get("p")
        if misfit.get("considered") or p is None or p < SIGNIFICANT:  # significant: the program says so itself
            continue
        moves = []
        for name, move in (misfit.get("moves") or {}).items():
            parameter = c.parameter(name) or {}
            u, U = known(parameter.get("u")), known(parameter.get("U"))
            if move is not None and u > 0 and abs(move) > U:
                moves.append((abs(move) / u, name))
        if moves and math.isfinite(max(moves)[0]):
            found.append(Unexcluded(misfit["source"], max(moves)[1], max(moves)[0]))
    return sorted(found, key=lambda each: -each.in_u)


def unexcluded_in_words(c: Calibration, t) -> str:
    found = unexcluded(c)
    if not found:
        return ""
    named = ", ".join(t("verdict.not_excluded.one", source=each.source, name=each.parameter,
                        ratio=t.number(significant(each.in_u, 2))) for each in found[:MOST_NAMES])
    if len(found) > MOST_NAMES:
        named = t("verdict.not_excluded.more", named=named, count=len(found) - MOST_NAMES)
    return t("verdict.not_excluded.about", named=named)
