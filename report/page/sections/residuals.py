"""What was read and how well it fits, target by target."""


def content(c, previous, t) -> dict[str, object]:
    targets = c.get("targets") or []
    residuals = dict(enumerate((c.get("residuals") or {}).get("targets") or []))  # in the same order
    rows = [{"length": residuals.get(k, {}).get("correlation_length"),
             "at_least": residuals.get(k, {}).get("correlation_dies_out") is False, **target}
            for k, target in enumerate(targets)]
    return {"rows": rows, "has_lengths": any(row["length"] for row in rows),
            "has_missing": any(row.get("missing") for row in rows)}
