"""Errors of the known lengths as a table, and what they add up to."""
import lengths
from calibration import Calibration
from notation import MINUS, count, significant

MOST_ROWS = 60


def content(c: Calibration, previous, t) -> dict[str, object]:
    found = lengths.known_lengths(c)
    sizes = [lengths.mean_and_max([getattr(row, when) for row in found]) for when in ("before", "after")]
    rows = lengths.worst(found, MOST_ROWS)
    return {"rows": [(t.translated(row.name)[0], t.number(_signed(row.before)), t.number(_signed(row.after)),
                      t.number(significant(row.u, 2))) for row in rows],
            "sums": [(kind, [t.number(significant(size[k], 3)) for size in sizes])
                     for k, kind in enumerate(("mean", "max"))],
            "has_u": any(row.u == row.u for row in found), "number": count(len(found)),
            "some": t("lengths.some", shown=MOST_ROWS, number=count(len(found)))
            if len(found) > MOST_ROWS else ""}


def _signed(error: float) -> str:
    """To 0.1 um."""
    return "–" if error != error else f"{error:+.4f}".replace("-", MINUS)
