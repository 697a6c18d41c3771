"""One drawing, one file: draw(calibration, language) -> Figure, or None where this calibration has nothing to draw."""
from importlib import import_module


def draw(name: str, calibration, language):
    return import_module(f"figures.{name}").draw(calibration, language)
