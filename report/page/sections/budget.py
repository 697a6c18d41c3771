"""Lines of the budget as the tables show them."""
from calibration import Calibration
from figures.budget import MOST_BARS, MOST_PIECES, table_of_shares
from meaning import meaning
from notation import significant
from uncertainty import axis_unit, known

FEW_PARAMETERS = 2  # whose columns stand beside those of the sources
NO_COLUMN = 0.0005  # a share that would be printed as 0.0 in every row


def content(c: Calibration, previous, t) -> dict[str, object]:
    few = len(c.estimated) <= FEW_PARAMETERS
    return {"lines": c.get("budget") or [], "few": few, "known": known,
            "units": [axis_unit(p) for p in c.estimated],
            "drawn": MOST_BARS, "own": lambda line: _own(line, t),
            "meaning": lambda source: meaning(source, t),
            "by_parameter": [] if few else table_of_shares(c, t, MOST_PIECES, NO_COLUMN)}


def _own(line: dict, t) -> str:
    """Its u with the unit; scatter that was found in u alone has none of its own."""
    if not line.get("value"):
        return "–"
    unit = line.get("unit", "1")
    return t.number(significant(line["value"])) + ("" if unit == "1" else f" {unit}")
