"""What was read and how well it fits, target by target."""
from residuals import scanned_targets


def content(c, previous, t) -> dict[str, object]:
    targets = c.get("targets") or []
    along = {index: target for index, target in enumerate((c.get("residuals") or {}).get("targets") or [])}
    rows = [{"length": along.get(k, {}).get("correlation_length"),
             "at_least": along.get(k, {}).get("correlation_dies_out") is False, **target}
            for k, target in enumerate(targets)]
    return {"rows": rows, "scanned": bool(scanned_targets(c)),
            "has_lengths": any(row["length"] for row in rows), "has_missing": any(row.get("missing") for row in rows)}
