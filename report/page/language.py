"""Every word of the report, in the language of its reader: texts/<language>/*.toml."""
import tomllib
from pathlib import Path

from markupsafe import Markup

import notation
from calibration import Calibration

TEXTS = Path(__file__).parent / "texts"
LANGUAGES = sorted(folder.name for folder in TEXTS.iterdir())


class Language:
    """text("figure.budget.caption", share="61"): the words of that key; a missing key is our mistake (KeyError).
    calibrations: those that are shown; what the program said in them is in their "messages"."""

    def __init__(self, code: str, *calibrations: Calibration | None):
        self.code = code
        self._texts: dict = {}
        for file in sorted((TEXTS / code).glob("*.toml")):
            _merge(tomllib.loads(file.read_text(encoding="utf-8")), self._texts)
        self._said = {each["en"]: each[code] for c in filter(None, calibrations)
                      for each in c.get("messages") or [] if code in each}

    def __call__(self, key: str, **values: object) -> str:
        return self._find(key).format(**values)

    def named(self, key: str, word: str) -> str:
        """A name in calibration.json (of a column, a unit) as readers know it, from the table of that key; one that the
        table does not know stays as it is."""
        return self._find_table(key).get(word, word)

    def _find_table(self, key: str) -> dict:
        found = self._texts
        for part in key.split("."):
            found = found[part]
        return found

    def _find(self, key: str) -> str:
        table, _, word = key.rpartition(".")
        return (self._find_table(table) if table else self._texts)[word].strip()

    def translated(self, english: str) -> tuple[str, str]:
        """What the program itself wrote into calibration.json, and the language it is in now: this one where
        "messages" have it, else English."""
        return (self._said[english], self.code) if english in self._said else (english, "en")

    def sentence(self, english: str) -> Markup:
        """The same for the page: what had to stay English is marked."""
        text, code = self.translated(english)
        text = notation.in_sentence(text)
        return Markup.escape(text) if code == self.code else Markup('<span lang="en">{}</span>').format(text)

    def number(self, text: str) -> str:
        """A number as notation.py writes it, with this language's decimal sign."""
        return text.replace(".", self("decimal_sign"))


def _merge(new: dict, into: dict) -> None:
    for key, value in new.items():
        if isinstance(value, dict):
            _merge(value, into.setdefault(key, {}))
        else:
            into[key] = value
