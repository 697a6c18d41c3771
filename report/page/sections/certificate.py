"""What only the laboratory can say, as it was given."""
import administration
from calibration import Calibration
from language import Language


def content(c: Calibration, previous: Calibration | None, t: Language) -> dict[str, object]:
    given = c.get("certificate")
    untraced = administration.without_certificate(given)
    return {"blocks": administration.blocks(given, t), "signers": administration.signers(given),
            "untraced": t("certificate.untraced", names=", ".join(untraced)) if untraced else ""}
