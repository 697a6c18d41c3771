"""Whether a program printed what a document shows."""
import re

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_OF_THIS_RUN = re.compile(r"\d[\d.,]*(?:e[-+]?\d+)? (?=(m?s|iterations)\b)")


def difference(shown: list[str], printed: list[str]) -> str:
    """Empty, or the first line of a document that was not printed. "..." stands for any lines."""
    at, anywhere, seconds = 0, False, False
    for line in shown:
        if line.strip() == "...":
            anywhere = True
            continue
        words = line.split()
        seconds = (seconds or words[-1] == "s") if words else False  # the column of a table, till its end
        while at < len(printed) and anywhere and not _same(line, printed[at], seconds):
            at += 1
        if at >= len(printed) or not _same(line, printed[at], seconds):
            return f"shown:   {line}\nprinted: {printed[at] if at < len(printed) else '(nothing more)'}"
        at, anywhere = at + 1, False
    rest = [line for line in printed[at:] if line.strip()]
    return "" if anywhere or not rest else f"printed, but not shown: {rest[0]}"


def _same(shown: str, printed: str, seconds: bool) -> bool:
    a, b = (_OF_THIS_RUN.sub("# ", line).split() for line in (shown, printed))
    if seconds:
        a, b = a[:-1], b[:-1]
    if re.fullmatch("-{5,}", shown):
        return bool(re.fullmatch("-{5,}", printed))
    return len(a) == len(b) and all(_same_word(x, y) for x, y in zip(a, b))


def _same_word(shown: str, printed: str) -> bool:
    """The numbers in it to one unit of the last digit: another C library may round the other way."""
    if shown == printed:
        return True
    if _NUMBER.sub("#", shown) != _NUMBER.sub("#", printed):
        return False
    return all(abs(float(x) - float(y)) <= 1.001 * max(_unit(x), _unit(y))
               for x, y in zip(_NUMBER.findall(shown), _NUMBER.findall(printed)))


def _unit(number: str) -> float:
    digits, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
