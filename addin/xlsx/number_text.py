"""What a number format shows of a value: the text in the cell, and the number that a reader takes from it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Context, Decimal

_CONDITION = re.compile(r"\[(<=|>=|<>|<|>|=)\s*(-?[\d.]+(?:[eE][+-]?\d+)?)\]")
_TESTS = {
    "<": float.__lt__,
    "<=": float.__le__,
    ">": float.__gt__,
    ">=": float.__ge__,
    "=": float.__eq__,
    "<>": float.__ne__,
}
_TOKEN = re.compile(
    r'"(?P<quoted>[^"]*)"|\\(?P<escaped>.)|_(?P<space>.)|\*(?P<filled>.)|\[(?P<bracket>[^\]]*)\]|'
    r"(?P<general>[Gg]eneral)|(?P<digit>[0#?])|(?P<exponent>[eE][+-])|(?P<other>.)",
    re.DOTALL,
)
_COLOUR = re.compile(r"black|blue|cyan|green|magenta|red|white|yellow|colou?r ?\d{1,2}", re.I)
_LOCALE = re.compile(r"\$(?P<words>[^-]*)(?:-.*)?", re.DOTALL)
#: Letters of dates and times, and the stroke of a fraction.
_NOT_A_NUMBER = frozenset("ymdhsYMDHSaAbBgG/")
_READ = re.compile(
    r"(?P<open>\()?(?P<sign>[-+\u2212])?(?P<open2>\()?(?P<whole>(?:\d+(?:[ ,'\u2019]\d{3})*)?)(?:\.(?P<part>\d*))?"
    r"(?:[eE](?P<power>[+-]?\d+))?\s*(?P<percent>%)?(?P<close>\))?"
)

#: As many digits as any number and format have together.
_EXACT = Context(prec=1000)


@dataclass(frozen=True)
class ShownNumber:
    """What stands in a cell for a number."""

    text: str  #: The text; of a date or fraction what is not shown here is blank.
    colour: str = ""  #: Colour that the format itself gives, such as ``white``.
    is_plain: bool = True  #: False for dates, times and fractions, which are not shown here.


def section_of(value: float, code: str) -> str:
    """The part of a number format that holds for a number."""
    return _section(value, code)[0]


def _section(value: float, code: str) -> tuple[str, bool]:
    """The part that holds for a number, and whether it says the sign itself."""
    sections = _split(code)
    if not any(_CONDITION.search(part) for part in sections):
        if value < 0 and len(sections) > 1:
            return sections[1], True
        return (sections[2] if value == 0 and len(sections) > 2 else sections[0]), False
    for part in sections[:3]:
        found = _CONDITION.search(part)
        if found is None:
            return part, False
        if _TESTS[found[1]](float(value), float(found[2])):
            return part, found[1] in ("<", "<=") and float(found[2]) <= 0
    return sections[-1], False


def _split(code: str) -> list[str]:
    """Sections of a number format; a semicolon in quotes separates nothing."""
    parts, text = [], ""
    for found in re.finditer(r'"[^"]*"?|\\.|[_*].|.', code, re.DOTALL):
        if found[0] == ";":
            parts.append(text)
            text = ""
        else:
            text += found[0]
    return [*parts, text]


def shown_text(text: str, code: str) -> ShownNumber:
    """What a number format shows of a text."""
    sections = _split(code)
    own = sections[3] if len(sections) > 3 else sections[-1] if "@" in _bare(sections[-1]) else ""
    if len(sections) <= 3 and not own:
        return ShownNumber(text)
    words, colour = "", ""
    for token in _TOKEN.finditer(own):
        kind, part = token.lastgroup, token[token.lastgroup or 0]
        if kind == "bracket":
            colour = part.casefold() if _COLOUR.fullmatch(part) else colour
        elif kind == "space":
            words += " "
        elif kind == "other" and part == "@":
            words += text
        elif kind == "general":
            words += text
        elif kind != "filled":
            words += part
    return ShownNumber(words, colour)


def _bare(section: str) -> str:
    return re.sub(r'"[^"]*"|\\.|[_*].|\[[^\]]*\]', "", section)


def shown_number(value: float, code: str) -> ShownNumber:
    """What a number format shows of a number.

    Parameters
    ----------
    value : float
        The number. [as in the cell]
    code : str
        Excel number format. [code]

    Returns
    -------
    ShownNumber
        With decimal point and thousands comma, as an English program shows it.
    """
    section, says_sign = _section(value, code)
    tokens: list[tuple[str, str]] = []
    colour = ""
    for token in _TOKEN.finditer(section):
        kind, part = token.lastgroup or "other", token[token.lastgroup or 0]
        if kind == "bracket":
            if _COLOUR.fullmatch(part):
                colour = part.casefold()
            elif not _CONDITION.fullmatch(f"[{part}]"):
                words = _LOCALE.fullmatch(part)
                if words is None:  # elapsed time
                    return ShownNumber("", colour, is_plain=False)
                tokens.append(("text", words["words"]))
        elif kind in ("quoted", "escaped"):
            tokens.append(("text", part))
        elif kind == "space":
            tokens.append(("text", " "))
        elif kind == "other" and part in _NOT_A_NUMBER:
            return ShownNumber("", colour, is_plain=False)
        elif kind == "other" and part not in ".,%@":
            tokens.append(("text", part))
        elif kind != "filled":
            tokens.append((kind if kind != "other" else part, part))
    sign = "-" if value < 0 and not says_sign else ""
    return ShownNumber(_laid_out(abs(value), tokens, sign), colour)


def _laid_out(size: float, tokens: list[tuple[str, str]], sign: str) -> str:
    """The text of a number without sign by the tokens of its section."""
    kinds = [kind for kind, _ in tokens]
    if "general" in kinds or "@" in kinds:
        shown = f"{size:.10g}".replace("e", "E")
        return sign + "".join(shown if kind in ("general", "@") else part for kind, part in tokens)
    power_at = kinds.index("exponent") if "exponent" in kinds else len(kinds)
    point = kinds.index(".") if "." in kinds[:power_at] else power_at
    places = [at for at, kind in enumerate(kinds[:power_at]) if kind == "digit"]
    whole, part = ([at for at in places if (at > point) is after] for after in (False, True))
    commas = [at for at, kind in enumerate(kinds[:power_at]) if kind == "," and whole]
    scaling = sum(at > whole[-1] for at in commas)  # behind the last digit: thousands left out
    grouped = any(whole[0] < at < whole[-1] for at in commas)
    size *= 100.0 ** kinds.count("%") / 1000.0**scaling
    power = 0
    if "exponent" in kinds:
        size, power = _in_powers(size, max(len(whole), 1), len(part))
    integer, decimals = _digits(
        size, [tokens[at][1] for at in whole], [tokens[at][1] for at in part]
    )
    if grouped:
        integer = f"{'0' * (-len(integer) % 3)}{integer}"
        integer = (
            ",".join(integer[k : k + 3] for k in range(0, len(integer), 3)).lstrip("0,") or "0"
        )
    placed: dict[int, str] = dict(zip(part, decimals, strict=False))
    # words between digits part them; the first place takes all digits that have none of their own
    for at in reversed(whole):
        cut = 0 if at == whole[0] else max(len(integer) - 1, 0)
        placed[at], integer = integer[cut:], integer[:cut]
        if grouped and integer.endswith(","):
            placed[at], integer = f",{placed[at]}", integer[:-1]
    exponent = f"{abs(power):0{max(kinds[power_at:].count('digit'), 1)}d}"
    out = []
    for at, (kind, words) in enumerate(tokens):
        if kind == "exponent":
            out.append(f"E{'-' if power < 0 else '+' if words[1] == '+' else ''}{exponent}")
        elif kind in (".", "%", "text"):
            out.append(words)
        elif at in placed:
            out.append(placed[at])
    is_zero = not any(digit in "123456789" for text in placed.values() for digit in text)
    return ("" if is_zero and places else sign) + "".join(out)


def _in_powers(size: float, step: int, decimals: int) -> tuple[float, int]:
    """Mantissa and power of ten, a multiple of a step."""
    if not size:
        return 0.0, 0
    power = math.floor(math.log10(size))
    power -= power % step
    mantissa = size / 10.0**power if abs(power) < 300 else float(f"{size:.17e}".split("e")[0])
    if round(mantissa, decimals) >= 10.0**step - 1e-9:
        return mantissa / 10.0**step, power + step
    return mantissa, power


def _digits(size: float, whole: list[str], part: list[str]) -> tuple[str, str]:
    """Digits before and behind the point, with the zeros that the format wants."""
    rounded = Decimal(repr(size)).quantize(Decimal(1).scaleb(-len(part)), ROUND_HALF_UP, _EXACT)
    integer, _, decimals = f"{rounded:f}".partition(".")
    least = whole.count("0")
    integer = integer.lstrip("0").rjust(least, "0")
    spare = list(part)
    while spare and spare[-1] != "0" and decimals.endswith("0"):
        spare.pop()
        decimals = decimals[:-1]
    return integer, decimals


def read_number(text: str, unit: str = "") -> tuple[float, float] | None:
    """The number that a reader takes from a text, and the worth of its last digit.

    Parameters
    ----------
    text : str
        What stands in the cell.
    unit : str
        Word that may stand behind the number. [unit]

    Returns
    -------
    tuple of float or None
        None where anything else than a number and that word stands there.
    """
    bare = " ".join(text.split())
    if unit and bare.endswith(unit):
        bare = bare[: -len(unit)].rstrip()
    found = _READ.fullmatch(bare)
    if found is None or not (found["whole"] or found["part"]):
        return None
    in_brackets = bool(found["open"] or found["open2"])
    if in_brackets != bool(found["close"]) or (found["open"] and found["open2"]):
        return None
    decimals, power = found["part"] or "", int(found["power"] or 0)
    if abs(power) > 400:
        return None
    share = 0.01 if found["percent"] else 1.0
    size = float(f"{re.sub('[^0-9]', '', found['whole']) or '0'}.{decimals or '0'}e{power}") * share
    negative = in_brackets or found["sign"] in ("-", "\u2212")
    step = share * 10.0 ** (power - len(decimals))
    return (-size if negative else size), step
