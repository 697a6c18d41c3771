"""The numbers that are signed, and how they are to be read; as found beside as left."""
import as_found
from administration import as_text, period, serial_numbers
from calibration import Calibration
from language import Language

OTHERS = ["naive", "clustered", "jackknife", "bootstrap"]  # estimates of u


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    return {"shown": c.own, "shown_spread": bool(c.get("jackknife")),
            "others": [name for name in OTHERS if any(each.get(f"u_{name}") is not None for each in c.own)],
            "changes": as_found.changes(previous, c) if previous else None,
            "both": [(which, each.get("name") or each.file.name, as_text((each.get("certificate") or {}).get(
                "identification")) if isinstance(each.get("certificate"), dict) else "", period(each, t),
                ", ".join(serial_numbers(each))) for which, each in (("found", previous), ("left", c)) if each],
            "has_turns": bool(previous) and any(p["name"].endswith("_rx") for p in previous.estimated),
            "shared": ", ".join(as_found.shared(c)) if previous else "",
            "doubts": as_found.doubts(c, t.code) if previous else []}
