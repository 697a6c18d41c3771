"""What only the laboratory can say, as it was given."""
import administration
from calibration import Calibration
from language import Language


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    return {"given": administration.rows(c.get("certificate"), t)}
