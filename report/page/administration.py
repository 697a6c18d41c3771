"""`certificate:` of dataset.yaml: what only the laboratory can say; passed through, never completed."""
from dataclasses import dataclass

# In this order on the page, with words of [certificate.key]; other keys follow under their own name.
KNOWN = ["identification", "order", "performed", "begin", "end", "place", "received", "issued", "item",
         "name", "role", "signs", "manufacturer", "model", "identifications", "issuer", "value", "laboratory",
         "code",
         "customer", "address", "street", "number", "post_office_box", "postcode", "city", "state", "country",
         "further", "email", "phone", "fax", "persons", "equipment", "certificate", "procedure", "conditions", "temperature", "humidity", "pressure",
         "statements"]

Path = tuple[str | int, ...]
_OF_A_LIST = ("issuer", "place", "signs")  # whose values are words of the program, in certificate.value
_ADDRESS = (("street", "number"), ("postcode", "city"), ("state",), ("country",))  # lines of it


def leaves(given: object, path: Path = ()) -> list[tuple[Path, str]]:
    """Every single value with the keys that lead to it; empty ones are left out."""
    if isinstance(given, dict):
        keys = sorted(given, key=lambda key: KNOWN.index(key) if key in KNOWN else len(KNOWN))
        return [leaf for key in keys for leaf in leaves(given[key], (*path, key))]
    if isinstance(given, list):
        return [leaf for k, each in enumerate(given) for leaf in leaves(each, (*path, k))]
    text = as_text(given)
    return [(path, text)] if text else []


def as_text(given: object) -> str:
    if given is None or isinstance(given, (dict, list)):
        return ""
    return str(given).lower() if isinstance(given, bool) else str(given).strip()


def serial_numbers(c) -> list[str]:
    """Of the item, as identifications: say; the manufacturer's first."""
    item = c["certificate"].get("item") if isinstance(c.get("certificate"), dict) else None
    given = item.get("identifications") if isinstance(item, dict) else None
    given = [each for each in given if isinstance(each, dict)] if isinstance(given, list) else []
    given = sorted(given, key=lambda each: each.get("issuer") != "manufacturer")
    return [text for each in given if (text := as_text(each.get("value")))]


def period(c, language) -> str:
    """From when to when it was measured; empty if it does not say."""
    performed = c["certificate"].get("performed") if isinstance(c.get("certificate"), dict) else None
    begin, end = (as_text(performed.get(key)) if isinstance(performed, dict) else "" for key in ("begin", "end"))
    return begin or end if begin == end or not (begin and end) else language("head.period", begin=begin, end=end)


def label(path: Path, certificate: object, language) -> str:
    """item: identifications: 2: value, in words; the only item of a list needs no number."""
    words, at = [], certificate
    for key in path:
        if isinstance(key, str):
            words.append(language(f"certificate.key.{key}") if key in KNOWN else key)
        elif len(at) > 1:
            words.append(str(key + 1))
        at = at[key]
    return ", ".join(words)


@dataclass(frozen=True)
class Block:
    """One key of `certificate:` with what stands under it: its first line is a name where there is one."""
    title: str
    lines: list[str]


def blocks(certificate: object, language) -> list[Block]:
    """What a reader sees of it: an address as an address, a person or a piece of equipment on one line."""
    if not isinstance(certificate, dict):
        text = as_text(certificate)
        return [Block("", [text])] if text else []
    found = []
    for key in dict.fromkeys(path[0] for path, _ in leaves(certificate)):
        title = label((key,), certificate, language)
        lines = _lines(certificate[key], (key,), certificate, language)
        found.append(Block(title[:1].upper() + title[1:] if key in KNOWN else title, lines))
    return found


def _lines(given: object, path: Path, certificate: object, language) -> list[str]:
    if isinstance(given, list):
        return [", ".join(_lines(each, (*path, k), certificate, language)) for k, each in enumerate(given)
                if leaves(each)]
    if not isinstance(given, dict):
        return [as_text(given)]
    lines, said = [], set()
    for parts in (("name",), *_ADDRESS):
        text = " ".join(filter(None, (as_text(given.get(key)) for key in parts)))
        if text:
            lines.append(text)
        said |= {key for key in parts if as_text(given.get(key))}
    for key in dict.fromkeys(at[0] for at, _ in leaves(given)):
        if key in said:
            continue
        if key in ("address", "identifications"):
            lines += _lines(given[key], (*path, key), certificate, language)
            continue
        lines += [f"{label_of(at, language)}: "
                  f"{language.named('certificate.value', text) if at[-1] in _OF_A_LIST else text}"
                  for at, text in leaves({key: given[key]})]
    return lines


def label_of(path: Path, language) -> str:
    return ", ".join(language(f"certificate.key.{key}") if key in KNOWN else str(key) for key in path
                     if isinstance(key, str))


def signers(certificate: object) -> list[tuple[str, str]]:
    """Name and function of those who sign."""
    persons = certificate.get("persons") if isinstance(certificate, dict) else None
    return [(as_text(each.get("name")), as_text(each.get("role"))) for each in persons or []
            if isinstance(each, dict) and as_text(each.get("signs")) in ("true", "yes")] \
        if isinstance(persons, list) else []


def without_certificate(certificate: object) -> list[str]:
    """Equipment of which no certificate is named: nobody can trace what it brings."""
    equipment = certificate.get("equipment") if isinstance(certificate, dict) else None
    return [as_text(each.get("name")) for each in equipment if isinstance(each, dict) and as_text(each.get("name"))
            and not as_text(each.get("certificate"))] if isinstance(equipment, list) else []
