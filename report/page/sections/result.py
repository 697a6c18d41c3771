"""The numbers that are signed, and how they are to be read; as found beside as left."""
import as_found
from calibration import Calibration
from language import Language
from meaning import meaning

OTHERS = ["naive", "clustered", "jackknife", "bootstrap"]  # estimates of u
MOST_NAMES = 8


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    own = [parameter for parameter in c.estimated if parameter not in c.link_errors] or c.estimated
    return {"shown": [(parameter, meaning(parameter["name"], t)) for parameter in own],
            "elsewhere": len(c.estimated) - len(own),
            "others": [name for name in OTHERS if any(each.get(f"u_{name}") is not None for each in own)],
            "changes": as_found.changes(previous, c) if previous else None,
            "doubts": [_in_words(doubt, t) for doubt in as_found.doubts(previous, c)] if previous else []}


def _in_words(doubt: as_found.Doubt, t: Language) -> str:
    names = ", ".join(doubt.names[:MOST_NAMES])
    if len(doubt.names) > MOST_NAMES:
        names = t("as_found.and_more", names=names, count=len(doubt.names) - MOST_NAMES)
    return t(f"as_found.doubt.{doubt.key}", names=names)
