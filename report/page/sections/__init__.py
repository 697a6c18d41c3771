"""What a section says beside the file's own numbers: sections/NAME.py, where there is one, has
content(calibration, previous, language) -> {name: value} for templates/sections/NAME.html."""
from importlib import import_module
from pathlib import Path

FOLDER = Path(__file__).parent


def content(name: str, calibration, previous, language) -> dict[str, object]:
    if not (FOLDER / f"{name}.py").exists():
        return {}
    return import_module(f"sections.{name}").content(calibration, previous, language)
