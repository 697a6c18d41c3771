"""One drawing, one file: draw(calibration, language) -> Figure, or None where this calibration has nothing to draw.

A figure whose caption depends on the data (what was left out, what is too small to be seen) also has
caption(calibration, language) -> {name: value}, for the words of its caption.
"""
from importlib import import_module


def draw(name: str, calibration, language):
    return import_module(f"figures.{name}").draw(calibration, language)


def caption(name: str, calibration, language) -> dict[str, str]:
    values = getattr(import_module(f"figures.{name}"), "caption", None)
    return values(calibration, language) if values else {}
