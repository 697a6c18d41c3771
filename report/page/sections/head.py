"""What was measured, for whom, and what was done."""
import procedure
from administration import as_text
from calibration import Calibration
from language import Language


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    return {"identification": [(t(f"head.{key}"), text) for key, text in _identification(c, t) if text],
            "procedure": procedure.sentences(c, t)}


def _identification(c: Calibration, t: Language) -> list[tuple[str, str]]:
    certificate = c.get("certificate")

    def given(*path: str) -> str:
        found = certificate
        for key in path:
            found = found.get(key) if isinstance(found, dict) else None
        return as_text(found)
    begin, end = given("performed", "begin"), given("performed", "end")
    period = begin or end if begin == end or not (begin and end) else t("head.period", begin=begin, end=end)
    return [("item", given("item", "name")), ("identification", given("identification")),
            ("performed", period), ("laboratory", given("laboratory", "name")),
            ("customer", given("customer", "name"))]
