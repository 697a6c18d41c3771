"""Control charts as one page; started by `scancal history --out`. It reads the charts as JSON from standard input."""
import argparse
import json
import sys
from pathlib import Path

import jinja2
import numpy as np
from markupsafe import Markup
from matplotlib import ticker

import notation
import style
from calibration import Complaint
from fonts import font_faces
from language import LANGUAGES, Language
from output import write_whole

TEMPLATES = Path(__file__).parent / "templates"


def draw(chart: dict, history: dict, t: Language) -> style.Figure:
    """Values with U, centre and limits; below them both CUSUM."""
    def column(key: str) -> np.ndarray:
        return np.array([np.nan if each[key] is None else each[key] for each in chart["points"]], dtype=float)
    times = np.array(history["times"])
    figure, (values, sums) = style.new_figure(3.6, 2, 1, sharex=True, height_ratios=[2.2, 1])
    values.fill_between(times, column("low"), column("high"), color=style.TERTIARY, alpha=0.35, step="mid",
                        label=t("history.limits"))
    values.axhline(chart["centre"], color=style.MUTED, linewidth=0.8, linestyle="--", label=t("history.centre"))
    values.errorbar(times, column("value"), column("U"), fmt="o", color=style.PRIMARY, capsize=2, linestyle="none",
                    label=t("history.value"))
    out = np.array([each["beyond"] or each["alarm"] for each in chart["points"]])
    if out.any():
        values.plot(times[out], column("value")[out], "s", color=style.SECONDARY, markersize=8, fillstyle="none",
                    linestyle="none", label=t("history.out"))
    values.set_ylabel(chart["name"] + ("" if chart["unit"] == "1" else f" / {chart['unit']}"))
    sums.plot(times, column("up"), "-o", color=style.PRIMARY, label=t("history.up"))
    sums.plot(times, column("down"), "--s", color=style.SECONDARY, label=t("history.down"))
    sums.axhline(history["cusum"]["alarm"], color=style.INK, linewidth=0.8, linestyle=":")
    sums.set_ylabel("CUSUM / u")
    sums.set_xlabel(t(f"history.time.{history['unit_of_time']}"))
    if history["unit_of_time"] == "calibration":
        sums.xaxis.set_major_locator(ticker.MaxNLocator(integer=True))
    style.legend_above(figure, values, 4)
    sums.legend(loc="upper left", ncols=2)
    return figure


def alarms(history: dict, t: Language) -> list[str]:
    """What the program says of the charts, in the reader's language: points beyond the limits, the first alarm of
    CUSUM, drifts."""
    told = []
    for chart in history["charts"]:
        named = list(zip(history["calibrations"], chart["points"]))
        told += [t("history.beyond", name=chart["name"], calibration=calibration,
                   deviation=t.number(f"{point['deviation']:+.1f}".replace("-", notation.MINUS)))
                 for calibration, point in named if point["beyond"]]
        first = next(((calibration, point) for calibration, point in named if point["alarm"]), None)
        if first:
            told.append(t("history.larger" if first[1]["up"] > first[1]["down"] else "history.smaller",
                          name=chart["name"], calibration=first[0]))
        if chart["drifts"]:
            told.append(t(f"history.drifts.{history['unit_of_time']}", name=chart["name"],
                          slope=t.number(notation.concise(chart["slope"], chart["u_slope"])),
                          unit="" if chart["unit"] == "1" else " " + chart["unit"],
                          ratio=t.number(f"{abs(chart['slope']) / chart['u_slope']:.1f}")))
    return told


def render(history: dict, t: Language, fonts: Path | None = None) -> str:
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    for rule in (notation.significant, notation.concise, notation.p_value):
        environment.filters[rule.__name__] = lambda *values, rule=rule: t.number(rule(*values))
    figures = {chart["name"]: Markup(style.to_svg(draw(chart, history, t), f"history-{k}", chart["name"], t))
               for k, chart in enumerate(history["charts"])}
    return environment.get_template("history.html").render(
        t=t, h=history, alarms=alarms(history, t), figures=figures, fonts=Markup(font_faces(fonts)),
        css=Markup((TEMPLATES / "page.css").read_text(encoding="utf-8")))


def main(given: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="scancal history")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--fonts", type=Path)
    parser.add_argument("--language", choices=LANGUAGES, default="en")
    choice = parser.parse_args(given)
    try:
        write_whole(choice.out, render(json.load(sys.stdin), Language(choice.language), choice.fonts).encode())
    except Complaint as complaint:
        print(f"scancal: {complaint}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
