"""The type of the report. It travels inside the page: figures are laid out with its metrics, so they need it."""
import base64
import contextlib
import functools
import hashlib
import io
from pathlib import Path

from calibration import Complaint
from output import write_whole

FOLDER = Path("/usr/share/fonts/opentype/inter")  # Debian's fonts-inter
FONT_FILES = {400: FOLDER / "Inter-Regular.otf", 600: FOLDER / "Inter-SemiBold.otf"}
# Latin with all accents, Greek, punctuation, super- and subscripts, arrows, mathematics; other letters come from the
# reader's machine.
_CHARACTERS = [*range(0x20, 0x250), *range(0x370, 0x400), *range(0x2000, 0x20D0), *range(0x2190, 0x2200),
               *range(0x2200, 0x2300), 0x25CF, 0x25A0, 0x25B2, 0x2713, 0x2717]

for _file in FONT_FILES.values():
    if not _file.exists():
        raise Complaint(f"{_file} is missing: install fonts-inter")


def font_faces(kept: Path | None = None) -> str:
    """CSS @font-face rules with the fonts inside, cut down to the letters above. Cutting takes a second: the rules are
    read from the file `kept` if they are of these fonts, else written there, if that can be."""
    if not kept:
        return _cut()
    of_these = hashlib.sha256(repr(_CHARACTERS).encode())
    for file in FONT_FILES.values():
        of_these.update(file.read_bytes())
    first_line = f"/* {of_these.hexdigest()} */\n"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        found = kept.read_text(encoding="utf-8")
        if found.startswith(first_line):
            return found.removeprefix(first_line)
    rules = _cut()
    with contextlib.suppress(Complaint):
        write_whole(kept, (first_line + rules).encode())
    return rules


@functools.cache
def _cut() -> str:
    from fontTools import subset, ttLib
    rules = []
    for weight, file in FONT_FILES.items():
        font = ttLib.TTFont(file, recalcTimestamp=False)
        options = subset.Options(layout_features=["kern", "tnum", "calt", "ccmp", "mark"], desubroutinize=True)
        subsetter = subset.Subsetter(options)
        subsetter.populate(unicodes=_CHARACTERS)
        subsetter.subset(font)
        font.flavor = "woff"
        stream = io.BytesIO()
        font.save(stream)
        data = base64.b64encode(stream.getvalue()).decode()
        rules.append(f'@font-face {{ font-family: Inter; font-weight: {weight}; '
                     f'src: url("data:font/woff;base64,{data}") format("woff"); }}')
    return "\n".join(rules)
