"""Numbers as GUM 7.2 writes them; the same rules as the text that scancal prints."""
import math
import re

MINUS = "\N{MINUS SIGN}"
_MICROMETRES = r"(?<=\d )um\b(?! [±+−]?\d)"  # in German "um" is a word, too: by


def significant(value: float | None, digits: int = 2) -> str:
    """To so many digits; in exponents only below 1e-4 and from 1e6 on."""
    if value is None or not math.isfinite(value):
        return "–" if value is None or math.isnan(value) else "∞" if value > 0 else MINUS + "∞"
    if value == 0:
        return f"{0:.{digits - 1}f}"
    exponent = int(f"{value:.{digits - 1}e}".split("e")[1])  # after rounding: 0.0999 to two digits is 0.10
    if not 1e-4 <= abs(value) < 1e6:
        mantissa = f"{value / 10.0**exponent:.{digits - 1}f}"
        return f"{mantissa} × 10{_superscript(exponent)}".replace("-", MINUS)
    return _fixed(value, max(0, digits - 1 - exponent))


def concise(value: float | None, u: float | None) -> str:
    """123.0021(54): to the second digit of u, which stands in units of the last digit (GUM 7.2.2)."""
    if value is None or u is None or not (math.isfinite(value) and math.isfinite(u) and u > 0):
        return significant(value, 6)
    last = math.floor(math.log10(u)) - 1
    if round(u / 10.0**last) >= 100:  # 0.0996 rounds to 0.10
        last += 1
    if last >= 0:
        return f"{_fixed(value, 0)}({u:.0f})"
    return f"{_fixed(value, -last)}({u / 10.0**last:.0f})"


def to_last_digit_of(u: float | None, value: float | None) -> str:
    """value to the second digit of u: concise() without its brackets."""
    return concise(value, u).split("(")[0]


def count(number: float | None) -> str:
    """Whole, in groups of three."""
    if number is None or not math.isfinite(number):
        return "∞"
    return f"{number:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def dof(number: float | None) -> str:
    """Degrees of freedom, truncated (GUM G.4.1); beyond a million k no longer depends on them."""
    return count(math.floor(number)) if number is not None and number < 1e6 else "∞"


def percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * max(0.0, share):.1f}"


def p_value(p: float | None) -> str:
    """= 0.02, with its sign of relation; below 1e-16 it is not known better."""
    return "= –" if p is None or math.isnan(p) else "< 10⁻¹⁶" if p < 1e-16 else "= " + significant(p, 1)


def in_sentence(text: str) -> str:
    """What the program says in plain letters as the page writes it: true minus signs, powers of ten, micrometres."""
    text = re.sub(r"\b(\d+(?:[.,]\d+)?)e([+-]?\d+)\b", _power, text)
    return re.sub(_MICROMETRES, "µm", re.sub(r"(?<![\w.,])-(?=\d)", MINUS, text))


def _power(found: re.Match) -> str:
    """1.6e+03 is 1600: a power of ten only where significant() has one."""
    mantissa, exponent = found[1], int(found[2])
    if 0 <= exponent < 6:
        whole, _, decimals = mantissa.replace(",", ".").partition(".")
        if len(decimals) <= exponent:
            return whole + decimals.ljust(exponent, "0")
    return ("" if mantissa == "1" else f"{mantissa} × ") + f"10{_superscript(exponent)}"


def length_unit(largest_mm: float) -> tuple[float, str]:
    """For an axis of lengths that go up to this one: what to multiply mm with, and the unit."""
    return (1000.0, "µm") if 0 < largest_mm < 0.1 else (1.0, "mm")


def shortened(name: str, length: int = 28) -> str:
    """For figures, where there is no room: both ends of a long name."""
    if len(name) <= length:
        return name
    return name[: length // 2] + "…" + name[len(name) - (length - length // 2 - 1):]


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    if text.startswith("-"):
        text = (MINUS if text.strip("-0.") else "") + text[1:]
    return text


def _superscript(exponent: int) -> str:
    return "".join("⁰¹²³⁴⁵⁶⁷⁸⁹"[int(c)] if c.isdigit() else "⁻" for c in str(exponent))
