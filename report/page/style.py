"""One visual language: the colours, the type and the lines of every figure and of the page.

Colours keep their order of lightness, so that they part for colour-blind readers and on grey printers; where two lines
meet in a figure they differ in dash or marker, too. Maps are cividis, which was made for both; what has a sign goes from blue to red, which both tell apart, too.
"""
import io
import logging
import re
import warnings

import matplotlib

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it tells of a cache that it makes, or has no room for
matplotlib.use("svg")
from matplotlib import font_manager, pyplot, ticker  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from fonts import FONT_FILES  # noqa: E402
from notation import MINUS  # noqa: E402

INK = "#1b2733"        # text, axes
MUTED = "#66727f"      # what stands behind: second lines, notes
FAINT = "#dfe4e9"      # grids, rules
PRIMARY = "#0b4f8a"    # the result: dark
SECONDARY = "#d9822b"  # what it is compared with: middle
TERTIARY = "#8ec3e6"   # fills: light
SERIES = [PRIMARY, SECONDARY, "#5e9c4a", "#8b4a8b", "#c2a83e", "#4d4d4d"]
DASHES = ["-", "--", "-.", ":", (0, (6, 2, 1, 2, 1, 2)), (0, (1, 1))]
MARKERS = ["o", "s", "^", "D", "v", "P"]
MAP = "cividis"
DIVERGING = "RdBu_r"  # of what has a sign: white is nothing
WIDTH = 6.9  # inches: the text width of an A4 page, at 96 pixels an inch that of the page's column

# A name may be in any script: a letter that these fonts lack is drawn by the reader's.
warnings.filterwarnings("ignore", message="Glyph .* missing from current font")
for font in FONT_FILES.values():
    font_manager.fontManager.addfont(font)
matplotlib.rcParams.update({
    "font.family": ["Inter", "DejaVu Sans"], "font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9,
    "xtick.labelsize": 8, "ytick.labelsize": 8, "legend.fontsize": 8, "figure.titlesize": 10,
    "figure.facecolor": "none", "axes.facecolor": "none",  # a phone's hint that there is more lies behind them
    "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.edgecolor": MUTED,
    "axes.linewidth": 0.7, "xtick.major.width": 0.7, "ytick.major.width": 0.7, "axes.spines.top": False,
    "axes.spines.right": False, "axes.titlelocation": "left", "axes.titleweight": "semibold", "axes.axisbelow": True,
    "grid.color": FAINT, "grid.linewidth": 0.7, "lines.linewidth": 1.4, "lines.markersize": 4,
    "patch.linewidth": 0.7, "legend.frameon": False, "image.cmap": MAP, "figure.constrained_layout.use": True,
    "axes.prop_cycle": matplotlib.cycler(color=SERIES, linestyle=DASHES),
    "svg.fonttype": "none",     # text stays text: it can be found and read aloud
    "text.parse_math": False,   # a name may hold dollars
    "axes.unicode_minus": True, "axes.formatter.useoffset": False, "savefig.dpi": 200,
})


class DecimalSign(ticker.ScalarFormatter):
    """Tick labels with the decimal sign of the report's language."""

    def __init__(self, language):
        super().__init__(useOffset=False)
        self._language = language

    def __call__(self, x, pos=None):
        return self._language.number(super().__call__(x, pos))


def plain_numbers(language) -> ticker.FuncFormatter:
    """For logarithmic axes and levels: 0.01, 1, 100, never powers."""
    return ticker.FuncFormatter(lambda x, _: language.number(f"{x:.6g}".replace("-", MINUS)))


def new_figure(height: float, rows: int = 1, columns: int = 1, **layout) -> tuple[Figure, object]:
    """A figure as wide as the page, height in inches, and its axes."""
    return pyplot.subplots(rows, columns, figsize=(WIDTH, height), **layout)


def legend_above(figure: Figure, axes, columns: int) -> None:
    """What is labelled in these axes, in a strip of its own over the whole figure."""
    handles, labels = axes.get_legend_handles_labels()
    strip = 0.05 + 0.19 * -(-len(labels) // columns)  # inches
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - strip / figure.get_figheight()))
    figure.legend(handles, labels, loc="upper left", ncols=columns, borderaxespad=0)


def to_svg(figure: Figure, name: str, title: str, language) -> str:
    """The figure as an <svg> element to stand in the page: the same bytes for the same figure, no fixed size, its ids
    its own, its title for those who cannot see it."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis, getattr(axes, "zaxis", axes.xaxis)):
            if type(axis.get_major_formatter()) is ticker.ScalarFormatter:
                axis.set_major_formatter(DecimalSign(language))
    matplotlib.rcParams["svg.hashsalt"] = name
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    pyplot.close(figure)
    svg = stream.getvalue()
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.S)
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = re.sub(r'href="#', f'href="#{name}-', svg)
    svg = svg.replace("url(#", f"url(#{name}-")
    viewbox = re.search(r'viewBox="[^"]*"', svg)[0]
    escaped = title.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return re.sub(r"<svg[^>]*>", f'<svg {viewbox} role="img" aria-label="{escaped}" '
                  'xmlns:xlink="http://www.w3.org/1999/xlink">', svg, count=1)
