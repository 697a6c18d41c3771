"""`certificate:` of dataset.yaml: what only the laboratory can say; passed through, never completed."""

# In this order on the page, with words of [certificate.key]; other keys follow under their own name.
KNOWN = ["identification", "order", "performed", "begin", "end", "place", "received", "issued", "item",
         "name", "role", "signs", "manufacturer", "model", "identifications", "issuer", "value", "laboratory",
         "code",
         "customer", "address", "street", "number", "post_office_box", "postcode", "city", "state", "country",
         "further", "email", "phone", "fax", "persons", "equipment", "certificate", "procedure", "conditions",
         "statements"]

Path = tuple[str | int, ...]


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


def rows(certificate: object, language) -> list[tuple[str, str, str]]:
    """(what, which part of it, as given); what is empty where it is that of the row above."""
    found, last = [], None
    for path, text in leaves(certificate):
        what, whole = label(path[:1], certificate, language), label(path, certificate, language)
        part = whole.removeprefix(what).removeprefix(", ")
        if path[:1] and path[0] in KNOWN:
            what = what[:1].upper() + what[1:]
        found.append((what if path[:1] != last else "", part, text))
        last = path[:1]
    return found
