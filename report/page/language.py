"""Every word of the report, in the language of its reader: texts/<language>/*.toml."""
import re
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

    def named(self, key: str, word: str) -> str:
        """A word of calibration.json (a column, a reason) in this language, from the table of that key; one that the
        table does not know stays as it is. Numbers in it stand in the table as #: "step #" for "step 0.1"."""
        number = r"\d+(?:\.\d+)?(?:e[+-]?\d+)?"
        found = self._find_table(key).get(re.sub(number, "#", word))
        if found is None:
            return word
        numbers = iter(re.findall(number, word))
        return re.sub("#", lambda _: self.number(next(numbers)), found)

    def _find_table(self, key: str) -> dict:
        found = self._texts
        for part in key.split("."):
            found = found[part]
        return found

    def _find(self, key: str) -> str:
        table, _, word = key.rpartition(".")
        return (self._find_table(table) if table else self._texts)[word].strip()

    def number(self, text: str) -> str:
        """A number as notation.py writes it, with this language's decimal sign."""
        return text.replace(".", self("decimal_sign"))


def _merge(new: dict, into: dict) -> None:
    for key, value in new.items():
        if isinstance(value, dict):
            _merge(value, into.setdefault(key, {}))
        else:
            into[key] = value
