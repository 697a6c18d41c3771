"""What the search found, and that the refinement started there."""
from notation import MINUS, significant
from surface import grid_minimum, near, searched


def content(c, previous, t) -> dict[str, object]:
    minimum, grid = grid_minimum(c), c.get("grid") or {}
    return {"drawn": bool(searched(c) or near(c)), "nodes": grid.get("nodes"),
            "minimum": minimum and {"M": _node(minimum[0], t), "N": _node(minimum[1], t),
                                    "step": _node(grid["step"], t), "S": t.number(significant(grid["S"], 3))}}


def _node(number: float, t) -> str:
    """Of the grid: an exact number."""
    return t.number(f"{number:.10g}".replace("-", MINUS))
