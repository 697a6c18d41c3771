"""The English that the C++ can put into warnings, reasons and the words of calibration.json: its string literals,
found in the sources where they are pushed, with those of the local names and functions of the same file that they
are made of."""
import re
from dataclasses import dataclass
from pathlib import Path

PUSH = re.compile(r"\b(?:warnings|unreliable)\)?\s*(?:->|\.)\s*(?:push_back|emplace_back)\(")
ASSIGNED = re.compile(r"(?:\.|->)(?:warning|residual|message)\s*=[^=]|\bkReason\w+\[\]\s*=")
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
COMMENT = re.compile(r'("(?:[^"\\]|\\.)*")|//[^\n]*')
PLACE = re.compile(r"\{[^{}]*\}")  # of fmt


@dataclass(frozen=True)
class Written:
    """A statement that writes English: where, and its pieces without what is filled in."""
    where: str
    pieces: tuple[str, ...]


def written(rooms: list[Path]) -> list[Written]:
    found = []
    for file in sorted(file for room in rooms for file in room.rglob("*.cc")):
        source = COMMENT.sub(lambda match: match[1] or "", file.read_text(encoding="utf-8"))
        for match in [*PUSH.finditer(source), *ASSIGNED.finditer(source)]:
            statement = _statement(source, match.end() - 1)
            pieces = _pieces(statement) + [piece for name in _names(statement)
                                           for piece in _pieces(_made_of(name, source))]
            if pieces:
                line = source.count("\n", 0, match.start()) + 1
                found.append(Written(f"{file.relative_to(file.parents[1])}:{line}", tuple(pieces)))
    return found


def _statement(source: str, start: int) -> str:
    """Up to its semicolon; those within literals are none."""
    quoted = False
    for at in range(start, len(source)):
        if source[at] == '"' and source[at - 1] != "\\":
            quoted = not quoted
        elif source[at] == ";" and not quoted:
            return source[start:at]
    return source[start:]


def _pieces(code: str) -> list[str]:
    """Constant pieces of its sentences: neighbouring literals are one; places, keys and punctuation go."""
    joined = re.sub(r'\["\w+"\]', "", re.sub(r'"\s*\n?\s*"', "", code))
    texts = [piece.strip() for literal in LITERAL.findall(joined)
             for piece in PLACE.split(literal.replace('\\"', '"'))]
    return [text for text in texts if re.search(r"[A-Za-z]{2,}", text)]


def _names(code: str) -> set[str]:
    return set(re.findall(r"\b[A-Za-z_]\w*\b", LITERAL.sub("", code)))


def _made_of(name: str, source: str) -> str:
    """What a local string of this name is set to, or what a function of this name returns."""
    found = [_statement(source, match.end()) for match in re.finditer(rf"std::string {name} =", source)]
    for function in re.finditer(rf"std::string {name}\([^)]*\) \{{(.*?)\n?\}}\n", source, re.S):
        found += [_statement(function[1], each.end()) for each in re.finditer(r"\breturn\b", function[1])]
    return "\n".join(found)
