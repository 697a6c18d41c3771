"""The administrative data of a Digital Calibration Certificate, from `certificate:` of dataset.yaml: all that
the schema demands has to be there, nothing is made up, and what it has no place for becomes a statement."""
import datetime
import re

from administration import Path, as_text, leaves

PLACES = ("laboratory", "customer", "laboratoryBranch", "customerBranch", "other")
ISSUERS = ("manufacturer", "calibrationLaboratory", "customer", "owner", "other")
# Our key -> element of dcc:locationType, in the order of the schema.
LOCATION = {"city": "city", "country": "countryCode", "postcode": "postCode", "state": "state",
            "post_office_box": "postOfficeBox", "street": "street", "number": "streetNo"}


class Administration:
    """Asks for one field after the other; remembers what was missing or wrong, and what nobody asked for."""

    def __init__(self, certificate: object):
        self._root = certificate
        self._taken: set[Path] = set()
        self.complaints: list[str] = []

    def text(self, *path: str | int, example: str = "") -> str:
        """Empty if it is absent, which is a complaint if there is an example."""
        self._taken.add(path)
        found = as_text(self._at(path))
        if not found and example:
            self.complaints.append(f"{place(path)}: missing, for example {example}")
        return found

    def date(self, *path: str | int, example: str = "") -> str:
        found = self.text(*path, example=example)
        if found and not _is_date(found):
            self._found(path, found, "a date like 2026-03-01")
        return found

    def code(self, *path: str | int, example: str = "") -> str:
        found = self.text(*path, example=example)
        if found and not re.fullmatch("[A-Z]{2}", found):
            self._found(path, found, "two capital letters of ISO 3166-1, like DE")
        return found

    def choice(self, *path: str | int, of: tuple[str, ...], example: str = "") -> str:
        found = self.text(*path, example=example)
        if found and found not in of:
            self._found(path, found, f"one of {', '.join(of)}")
        return found

    def yes(self, *path: str | int) -> bool:
        found = self.text(*path)
        if found not in ("", "true", "false", "yes", "no"):
            self._found(path, found, "yes or no")
        return found in ("true", "yes")

    def items(self, *path: str | int, example: str = "") -> list[Path]:
        """Paths of the items of a list."""
        found = self._at(path)
        if isinstance(found, list) and found:
            return [(*path, k) for k in range(len(found))]
        if example or found not in (None, "", []):
            state = "missing" if found in (None, "", []) else "found no list"
            self.complaints.append(f"{place(path)}: {state}, for example {example or '[{name: ...}]'}")
            self._taken |= {at for at, _ in leaves(found, path)}
        return []

    def rest(self) -> list[tuple[Path, str]]:
        """What nobody asked for."""
        return [(path, text) for path, text in leaves(self._root) if path not in self._taken]

    def _at(self, path: Path) -> object:
        found = self._root
        for key in path:
            if isinstance(key, int):
                found = found[key]
            else:
                found = found.get(key) if isinstance(found, dict) else None
        return found

    def _found(self, path: Path, found: str, expected: str) -> None:
        self.complaints.append(f'{place(path)}: found "{found}", expected {expected}')


def place(path: Path) -> str:
    """As the program names a place in dataset.yaml."""
    return ": ".join(["certificate", *(f"item {key + 1}" if isinstance(key, int) else key for key in path)])


def read_administration(a: Administration) -> dict[str, object]:
    """For templates/certificate.xml; worth nothing while there are complaints."""
    found = {
        "identification": a.text("identification", example="K-2026-0815"), "order": a.text("order"),
        "country": a.code("country", example="DE"),
        "received": a.date("received"), "issued": a.date("issued"),
        "begin": a.date("performed", "begin", example="2026-03-01"),
        "end": a.date("performed", "end", example="2026-03-02"),
        "place": a.choice("performed", "place", of=PLACES, example="laboratory"),
        "item": _thing(a, ("item",), mandatory=True), "laboratory": _contact(a, ("laboratory",)),
        "code": a.text("laboratory", "code"), "customer": _contact(a, ("customer",)),
        "persons": [_person(a, at) for at in a.items("persons", example="[{name: A. Berg, signs: yes}]")],
        "equipment": [_thing(a, at) for at in a.items("equipment")], "conditions": _conditions(a),
        "statements": _statements(a)}
    if _is_date(found["begin"]) and _is_date(found["end"]) and found["begin"] > found["end"]:
        a.complaints.append(f"{place(('performed', 'end'))}: {found['end']} lies before the begin, "
                            f"{found['begin']}")
    return found | {"rest": a.rest()}


def _contact(a: Administration, path: Path) -> dict[str, object]:
    found = {"name": a.text(*path, "name", example="Calibration Ltd")}
    found |= {key: a.text(*path, key) for key in ("email", "phone", "fax")}
    address = (*path, "address")
    location = [(element, a.code(*address, key) if key == "country" else
                 a.text(*address, key, example="Braunschweig" if key == "city" else ""))
                for key, element in LOCATION.items()]
    return found | {"location": [(element, text) for element, text in location if text],
                    "further": a.text(*address, "further")}


def _thing(a: Administration, path: Path, mandatory: bool = False) -> dict[str, object]:
    """The item, or a piece of equipment."""
    found = {"name": a.text(*path, "name", example="line profiler on a turntable")}
    found |= {key: a.text(*path, key) for key in ("manufacturer", "model", "certificate")}
    given = a.items(*path, "identifications",
                    example="[{issuer: manufacturer, value: 4711}]" if mandatory else "")
    return found | {"identifications": [
        {"issuer": a.choice(*at, "issuer", of=ISSUERS, example="manufacturer"),
         "value": a.text(*at, "value", example="4711"), "name": a.text(*at, "name")} for at in given]}


def _person(a: Administration, path: Path) -> dict[str, object]:
    return {"name": a.text(*path, "name", example="A. Berg"), "role": a.text(*path, "role"),
            "signs": a.yes(*path, "signs")}


def _statements(a: Administration) -> list[str]:
    """A text or a list of texts."""
    one = a.text("statements")
    return [one] if one else [a.text(*path) for path in a.items("statements")]


def _conditions(a: Administration) -> list[tuple[str, str]]:
    """The environment: (what, how it was); a text alone has no name."""
    found = a._at(("conditions",))
    told = [(path, text) for path, text in leaves(found, ("conditions",))]
    a._taken |= {path for path, _ in told}
    return [(", ".join(str(key) for key in path[1:] if isinstance(key, str)), text) for path, text in told]


def _is_date(text: str) -> bool:
    if not re.fullmatch(r"\d{4}-\d\d-\d\d", text, re.ASCII):
        return False
    try:
        datetime.date.fromisoformat(text)
    except ValueError:
        return False
    return True
