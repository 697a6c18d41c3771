"""What was measured and done."""
import procedure


def content(c, previous, t) -> dict[str, object]:
    return {"sentences": procedure.sentences(c, t)}
