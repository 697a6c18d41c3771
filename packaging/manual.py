"""The manual page of scancal, in roff, made of what the program says of itself: manual.py PROGRAM > scancal.1"""
import re
import subprocess
import sys

_HEAD = """.TH SCANCAL 1 "" "{version}" "User Commands"
.SH NAME
scancal \\- {summary}
.SH SYNOPSIS
.B scancal
.I COMMAND
[\\fIflags\\fR]
.SH DESCRIPTION
Estimates the geometry of a 3D scanner from scans of plates or balls, and its uncertainty. A data set is a folder with
dataset.yaml and the scans; the result is a file, calibration.json, and a table.
.SH COMMANDS
"""
_TAIL = """.SH EXIT STATUS
.TP
.B 0
no doubt beyond the printed warnings
.TP
.B 1
usage or input
.TP
.B 2
computed, but not to be relied on
.SH ENVIRONMENT
.TP
.B SCANCAL_PYTHON
the Python that makes the page of the report; else /usr/bin/python3, or python3 of the PATH
.TP
.B XDG_CACHE_HOME
an installed program keeps the fonts of the page in scancal/fonts.css below it; else below ~/.cache
.SH SEE ALSO
docs/program.md, docs/data.md and the others in share/doc/scancal of the installation
"""


def said_by(program: str, *arguments: str) -> str:
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def escaped(text: str) -> str:
    """Backslashes and hyphens as they are, nothing at a line's begin that roff would take for itself."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def command_section(program: str, command: str) -> str:
    usage, _, rest = said_by(program, command, "--help").partition("\n\n")
    summary, _, flags = rest.partition("\n\n")
    section = f".SS {escaped(usage.removeprefix('usage: '))}\n{escaped(summary)}\n"
    for flag, meaning in re.findall(r"^  (--\S+) +(.*)$", flags, re.M):
        section += f".TP\n.B {escaped(flag)}\n{escaped(meaning)}\n"
    return section


def manual(program: str) -> str:
    overview = said_by(program, "--help")
    version, _, summary = overview.splitlines()[0].partition(": ")
    commands = re.findall(r"^  (\w+) ", overview, re.M)
    head = _HEAD.format(version=escaped(version), summary=escaped(summary))
    return head + "".join(command_section(program, command) for command in commands) + _TAIL


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    print(manual(sys.argv[1]), end="")
