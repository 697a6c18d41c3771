"""The page as a PDF that is filed: A4, PDF/A-2b, its fonts inside, the same bytes for the same page.

WeasyPrint, not a browser: a browser's PDF is no PDF/A and carries the hour of its making. Debian's WeasyPrint 57 leaves
two rules of PDF/A to its caller: an identifier, and images that are not interpolated.
"""
import hashlib
import logging
import os
import re
import subprocess
from pathlib import Path

from administration import as_text, serial_numbers
from calibration import Calibration, Complaint
from language import Language
from notation import shortened
from output import write_whole

# A foot with name and numbers on every page: a sheet that is found alone can be put back. Not cut by text-overflow: there
# WeasyPrint tells readers of the file that an ellipsis, here and everywhere, means the words that it stands for.
_FOOT = """
@page { @bottom-left { content: "%s"; font: 8pt Inter; color: #66727f; width: 85%%; margin-top: 6mm;
                       max-height: 1.5em; overflow: hidden; white-space: nowrap; }
        @bottom-right { margin-top: 6mm; max-height: 1.5em; } }
"""
_LETTERS, _OF_NAME = 90, 16  # as many as have room, of which the name keeps some


def foot(c: Calibration, t: Language) -> str:
    """Of every sheet: the numbers of certificate and item, and the name."""
    given = c.get("certificate")
    numbers = {"certificate": as_text(given.get("identification")) if isinstance(given, dict) else "",
               "serial": ", ".join(serial_numbers(c))}
    told = ", ".join(t(f"page.foot_{key}", number=number) for key, number in numbers.items() if number)
    told = shortened(told, _LETTERS - _OF_NAME - 2)
    name = shortened(str(c.get("name") or c["model"]), _LETTERS - len(told) - 2 if told else _LETTERS)
    return f"{told}; {name}" if told else name


def print_page(html: str, foot_words: str, file: Path) -> None:
    """Raises Complaint where WeasyPrint or a letter's font is missing. Nothing is loaded from anywhere."""
    try:
        import weasyprint
    except (ImportError, OSError) as error:  # OSError: one of its libraries
        raise Complaint(f"--pdf needs WeasyPrint ({error}): install Debian's weasyprint") from None
    missing = _letters_without_font(html)
    if missing:  # else there would be a gap in a name
        raise Complaint(f"{file}: no font of this computer has {missing}: install one that has; it was not written")
    logging.getLogger("weasyprint").setLevel(logging.ERROR)  # it warns of every property that is the screen's
    os.environ["SOURCE_DATE_EPOCH"] = "0"  # the embedded fonts carry a date
    document = weasyprint.HTML(string=_for_weasyprint(html), base_url="", url_fetcher=_only_inside)
    archived = {"variant": "pdf/a-2b", "identifier": hashlib.sha256(html.encode()).hexdigest()[:32].encode()}
    if "pdf_variant" in getattr(weasyprint, "DEFAULT_OPTIONS", {}):  # since WeasyPrint 59, which passes over others
        archived = {f"pdf_{key}": value for key, value in archived.items()}
    write_whole(file, document.write_pdf(stylesheets=[weasyprint.CSS(string=_foot(foot_words))],
                                         finisher=_without_interpolation, **archived))


def _foot(words: str) -> str:
    return _FOOT % "".join(c if c.isalnum() or c == " " else f"\\{ord(c):x} " for c in words)


def _letters_without_font(html: str) -> str:
    letters = sorted({letter for letter in html if ord(letter) > 0x2FF})  # Latin is in the page's own fonts
    return "".join(letter for letter in letters
                   if not subprocess.run(["fc-list", f":charset={ord(letter):x}"], capture_output=True).stdout)


def _for_weasyprint(html: str) -> str:
    """What WeasyPrint 57 passes over, in words that it knows: the font of a figure's text, variables in shorthands."""
    html = re.sub(r'(<text style="[^"]*?)font: (?:(\w+) )?([\d.]+px) ([^;"]*)', _font, html)
    head, body = html.split("</style>", 1)
    variables = dict(re.findall(r"(--[\w-]+):\s*([^;}]+)", head))
    return re.sub(r"var\((--[\w-]+)\)", lambda name: variables.get(name[1], name[0]).strip(), head) + "</style>" + body


def _font(shorthand: re.Match) -> str:
    before, weight, size, families = shorthand.groups()
    families = ",".join(family.strip(" '") for family in families.split(","))
    return f"{before}font-weight: {weight or 400}; font-size: {size}; font-family: {families}"


def _only_inside(url: str, *timeout, **ssl) -> dict:
    from weasyprint import default_url_fetcher
    if not url.startswith("data:"):
        raise ValueError(f"{url[:60]}: the page loads nothing")
    return default_url_fetcher(url)


def _without_interpolation(document, pdf) -> None:
    for thing in pdf.objects:
        if "Interpolate" in getattr(thing, "extra", {}):
            thing.extra["Interpolate"] = "false"
