"""From what the result came, and how it comes again."""
from calibration import Calibration
from language import Language

MOST_FILES = 100


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    files = [(str(each.get("file", "–")), each.get("sha256") or "–") for each in c.get("inputs") or []]
    from_page = [(f"{t(f'inputs.{key}')} {each.file.name}", each.sha256)
                 for key, each in (("page", c), ("previous", previous)) if each is not None and each.sha256]
    data = (c.get("data") or {}).get("sha256")
    return {"files": files[:MOST_FILES] + ([(t("inputs.data"), data)] if data else []) + from_page,
            "more_files": max(0, len(files) - MOST_FILES)}
