"""The page: sections in their order, figures drawn as the templates ask for them."""
import json
import sys
from pathlib import Path

import jinja2
from markupsafe import Markup

import figures
import notation
import sections
import style
from calibration import Calibration
from fonts import font_faces
from language import Language

TEMPLATES = Path(__file__).parent / "templates"

# The order of the page. A section whose template renders to nothing (it has no data) takes no number.
SECTIONS = ["verdict", "result", "procedure", "links", "budget", "comparison", "residuals", "surface", "correlation",
            "leave_one_out", "monte_carlo", "scene", "coverage_of_poses", "lengths", "volume", "considered",
            "certificate", "inputs"]


class Figures:
    """figure("budget") in a template: the drawing of figures/budget.py, numbered, with its caption."""

    def __init__(self, calibration: Calibration, language: Language):
        self._calibration, self._language, self._drawn = calibration, language, 0

    def __call__(self, name: str, **captions: str) -> Markup:
        """captions: what the caption of the figure needs beside its words."""
        if sys.stderr.isatty():
            print(f"\r\033[Kreport: {name}", end="", file=sys.stderr, flush=True)
        drawing = figures.draw(name, self._calibration, self._language)
        if drawing is None:
            return Markup("")
        self._drawn += 1
        title = self._language(f"figure.{name}.title")
        captions = figures.caption(name, self._calibration, self._language) | captions
        svg = style.to_svg(drawing, name.replace("_", "-"), title, self._language)
        caption = Markup.escape(self._language(f"figure.{name}.caption", **captions))
        number = Markup.escape(self._language("figure.number", number=self._drawn))
        return Markup(f'<figure id="figure-{name}"><div class="drawing">{svg}</div><figcaption><b>{number}</b> {caption}</figcaption></figure>')


def render_page(calibration: Calibration, previous: Calibration | None, language: Language,
                fonts: Path | None = None) -> str:
    """The whole HTML page: nothing in it is loaded from elsewhere, and the same input gives the same bytes. fonts: the
    file in which their rules are kept."""
    environment = environment_of(calibration, previous, language)
    rendered = [(name, render_section(name, environment))
                for name in SECTIONS if (TEMPLATES / "sections" / f"{name}.html").exists()]
    html = environment.get_template("page.html").render(
        sections=[(name, Markup(body)) for name, body in rendered if body],
        **sections.content("head", calibration, previous, language),
        page_number=Markup(_page_number(language)), fonts=Markup(font_faces(fonts)), css=Markup((TEMPLATES / "page.css").read_text(encoding="utf-8")))
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr, flush=True)
    return html


def environment_of(calibration: Calibration, previous: Calibration | None, language: Language) -> jinja2.Environment:
    """What every template knows: the calibration as c, an earlier one, words as t, figures, the rules of notation."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    for rule in (notation.significant, notation.concise, notation.to_last_digit_of, notation.count, notation.dof,
                 notation.percent, notation.p_value):
        environment.filters[rule.__name__] = _in(language, rule)
    environment.filters["breakable"] = _breakable
    environment.globals |= {"t": language, "c": calibration, "previous": previous,
                            "figure": Figures(calibration, language), "json": json}
    return environment


def render_section(name: str, environment: jinja2.Environment) -> str:
    """Without its heading; empty where it has no data."""
    known = environment.globals
    content = sections.content(name, known["c"], known["previous"], known["t"])
    return environment.get_template(f"sections/{name}.html").render(content).strip()


def _page_number(language: Language) -> str:
    """Page n of N, as a style sheet says it."""
    before, between, after = language("page.number", page="|", pages="|").split("|")
    return f'"{before}" counter(page) "{between}" counter(pages) "{after}"'


def _breakable(name: str) -> Markup:
    """A name of the program that may be broken after each underscore: in the head of a narrow column."""
    return Markup.escape(name).replace("_", Markup("_<wbr>"))


def _in(language: Language, rule):
    return lambda *values: language.number(rule(*values))
