"""The numbers that are signed, and how they are to be read; as found beside as left."""
import as_found
from administration import as_text, period, serial_numbers
from calibration import Calibration
from language import Language

OTHERS = ["naive", "clustered", "jackknife", "bootstrap"]  # estimates of u
MOST_NAMES = 8


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    return {"shown": c.own,
            "others": [name for name in OTHERS if any(each.get(f"u_{name}") is not None for each in c.own)],
            "changes": as_found.changes(previous, c) if previous else None,
            "both": [(which, each.get("name") or each.file.name, as_text((each.get("certificate") or {}).get(
                "identification")) if isinstance(each.get("certificate"), dict) else "", period(each, t),
                ", ".join(serial_numbers(each))) for which, each in (("found", previous), ("left", c)) if each],
            "has_turns": bool(previous) and any(p["name"].endswith("_rx") for p in previous.estimated),
            "doubts": [_in_words(doubt, t) for doubt in as_found.doubts(previous, c)] if previous else []}


def _in_words(doubt: as_found.Doubt, t: Language) -> str:
    names = ", ".join(doubt.names[:MOST_NAMES])
    if len(doubt.names) > MOST_NAMES:
        names = t("as_found.and_more", names=names, count=len(doubt.names) - MOST_NAMES)
    return t(f"as_found.doubt.{doubt.key}", names=names)
