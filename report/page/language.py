"""Every word of the report, in the language of its reader: texts/<language>/*.toml."""
import re
import tomllib
from pathlib import Path

from markupsafe import Markup

TEXTS = Path(__file__).parent / "texts"
LANGUAGES = sorted(folder.name for folder in TEXTS.iterdir())

# In sentences.toml: {name} is taken over, {#number} gets the decimal sign, {~phrase} is a sentence by itself.
PLACE = re.compile(r"\{([#~]?)(\w+)\}")
_NUMBER = r"[-+]?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|inf|nan)"


class Language:
    """text("figure.budget.caption", share="61"): the words of that key; a missing key is our mistake (KeyError)."""

    def __init__(self, code: str):
        self.code = code
        self._texts: dict = {}
        for file in sorted((TEXTS / code).glob("*.toml")):
            _merge(tomllib.loads(file.read_text(encoding="utf-8")), self._texts)
        sentences = self._texts.pop("sentence", [])
        self._sentences = [(pattern_of(each["english"]), each["here"]) for each in sentences]

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
        """What the program itself wrote into calibration.json, and the language it is in now: this one where a
        pattern of sentences.toml knows it, else English."""
        for pattern, here in self._sentences:
            if found := pattern.fullmatch(english):
                return PLACE.sub(lambda place: self._filled(place, found[place[2]]), here).strip(), self.code
        return english, "en"

    def sentence(self, english: str) -> Markup:
        """The same for the page: what had to stay English is marked."""
        text, code = self.translated(english)
        return Markup.escape(text) if code == self.code else Markup('<span lang="en">{}</span>').format(text)

    def _filled(self, place: re.Match, found: str) -> str:
        return {"#": self.number, "~": lambda text: self.translated(text)[0], "": str}[place[1]](found)

    def number(self, text: str) -> str:
        """A number as notation.py writes it, with this language's decimal sign."""
        return text.replace(".", self("decimal_sign"))


def pattern_of(english: str) -> re.Pattern:
    """Of a sentence with places: groups of their names."""
    pieces, at = [], 0
    for place in PLACE.finditer(english):
        pieces.append(re.escape(english[at:place.start()]))
        pieces.append(f"(?P<{place[2]}>{_NUMBER if place[1] == '#' else '.*?'})")
        at = place.end()
    return re.compile("".join(pieces) + re.escape(english[at:]), re.DOTALL)


def _merge(new: dict, into: dict) -> None:
    for key, value in new.items():
        if isinstance(value, dict):
            _merge(value, into.setdefault(key, {}))
        else:
            into[key] = value
