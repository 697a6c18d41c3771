"""The range of U over the working volume in words."""
import volume
from calibration import Calibration
from notation import significant


def content(c: Calibration, previous, t) -> dict[str, str]:
    found = volume.of(c) if c.is_reliable else None  # else nobody knows it
    return {"words": _words(found, t) if found else "", "percent": t.number(f"{c.coverage_percent:.4g}")}


def _words(found: volume.Volume, t) -> str:
    least, largest = (t.number(significant(value)) for value in (found.least, found.largest))
    if found.is_even:
        between = t("volume.range", least=least, largest=largest)
        return t("volume.even", U=largest if least == largest else between)
    place = {name: t.number(significant(value, 3)) for name, value in found.where(found.largest).items()}
    return t("volume.uneven", least=least, largest=largest, **place)
