"""The documents of the project, taken apart: blocks, spans of code, headings, links."""
import re
from dataclasses import dataclass, field
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
DOCUMENTS = [SOURCE / name for name in ("README.md", "CONVENTIONS.md", "CHANGELOG.md", "data/README.md")]
DOCUMENTS += sorted((SOURCE / "docs").glob("*.md"))


@dataclass
class Block:
    """A fenced block. before: what invisible comments ask for, [("first", COMMAND), ("data", "NAME at PATH")]."""
    kind: str
    line: int
    lines: list[str]
    before: list[tuple[str, str]] = field(default_factory=list)


def blocks(text: str) -> list[Block]:
    found, before, block = [], [], None
    for number, line in enumerate(text.splitlines(), 1):
        if block is not None:
            if line.strip() == "```":
                found.append(block)
                block = None
            else:
                block.lines.append(line)
        elif line.startswith("```"):
            block, before = Block(line[3:].strip(), number, [], before), []
        elif asked := re.fullmatch(r"<!-- (first|data): (.*) -->", line):
            before.append(asked.groups())
    assert block is None, f"the block of line {block.line} has no end"
    return found


def prose(text: str) -> str:
    """Without fenced and indented blocks."""
    return re.sub(r"^(```.*?^```|    [^\n]*)$", "", text, flags=re.M | re.S)


def spans(text: str) -> list[str]:
    """Code within sentences and tables."""
    return re.findall(r"`([^`\n]+)`", prose(text))


def links(text: str) -> list[str]:
    return re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", prose(text)))


def anchors(text: str) -> set[str]:
    """Of the headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S), re.M):
        name = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower())
        found.add(name.strip().replace(" ", "-"))
    return found
