"""Every word of the report, in the language of its reader: texts/<language>/*.toml."""
import tomllib
from pathlib import Path

TEXTS = Path(__file__).parent / "texts"
LANGUAGES = sorted(folder.name for folder in TEXTS.iterdir())


class Language:
    """text("figure.budget.caption", share="61"): the words of that key; a missing key is our mistake (KeyError)."""

    def __init__(self, code: str):
        self.code = code
        self._texts: dict = {}
        for file in sorted((TEXTS / code).glob("*.toml")):
            _merge(tomllib.loads(file.read_text(encoding="utf-8")), self._texts)

    def __call__(self, key: str, **values: object) -> str:
        return self._find(key).format(**values)

    def _find(self, key: str) -> str:
        found = self._texts
        for part in key.split("."):
            found = found[part]
        return found.strip()

    def number(self, text: str) -> str:
        """A number as notation.py writes it, with this language's decimal sign."""
        return text.replace(".", self("decimal_sign"))


def _merge(new: dict, into: dict) -> None:
    for key, value in new.items():
        if isinstance(value, dict):
            _merge(value, into.setdefault(key, {}))
        else:
            into[key] = value
