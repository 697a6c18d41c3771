"""What the search found and what the refinement made of it."""
from surface import grid_minimum, near, refined, searched


def content(c, previous, t) -> dict[str, object]:
    return {"drawn": bool(searched(c) or near(c)), "minimum": grid_minimum(c), "refined": refined(c),
            "grid": c.get("grid") or {}}
