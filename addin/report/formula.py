"""Formulas as plain nested tuples, written once and set by either writer.

`formula` reads a short notation, words separated by blanks: ``f_exc`` a letter with an index,
``D^4`` with a power, ``*K`` a bold matrix, ``+ − = ≤`` operators and relations, ``sin min`` names
of functions; nodes such as `frac` stand between them.

Nodes: ``("row", node, ...)``, ``("sign", text, style)`` with style italic, upright or bold,
``("operator", text, class)``, ``("function", name)``, ``("script", base, sub or None, sup or None)``,
``("fraction", over, under)``, ``("root", body)``, ``("accent", base, dots)`` and
``("fence", open, body, close)``.
"""

from __future__ import annotations

import re
from typing import Any

Node = tuple[Any, ...]

_RELATIONS = frozenset("=≤≥<>≈≪→")
_BINARIES = frozenset("+−·×±")
_OPENING, _CLOSING = frozenset("([|"), frozenset(")]|")
_FUNCTIONS = frozenset({"sin", "cos", "min", "max", "log", "tan"})
_LARGE = frozenset("∑∫")


def formula(*parts: str | Node) -> Node:
    """A row of what the short notation says."""
    items: list[Node] = []
    for part in parts:
        items += [_word(word) for word in part.split()] if isinstance(part, str) else [part]
    return items[0] if len(items) == 1 else ("row", *items)


def frac(over: str | Node, under: str | Node) -> Node:
    """A fraction."""
    return ("fraction", formula(over), formula(under))


def root(body: str | Node) -> Node:
    """A square root."""
    return ("root", formula(body))


def fence(body: str | Node, around: str = "()") -> Node:
    """Something in brackets of its own height."""
    return ("fence", around[0], formula(body), around[1])


def _word(word: str) -> Node:
    if word in _RELATIONS:
        return ("operator", word, "relation")
    if word in _BINARIES:
        return ("operator", word, "binary")
    if word in _OPENING and word != "|":
        return ("operator", word, "opening")
    if word in _CLOSING and word != "|":
        return ("operator", word, "closing")
    if word == ",":
        return ("operator", word, "punctuation")
    match = re.fullmatch(r"(.+?)(?:_([^\^]+))?(?:\^(.+))?", word)
    assert match is not None
    base, sub, sup = match.groups()
    node = _sign(base)
    if sub is None and sup is None:
        return node
    above = None if not sup else ("sign", "T", "upright") if sup == "T" else _sign(sup)
    return ("script", node, _sign(sub) if sub else None, above)


def _sign(text: str) -> Node:
    """A letter with its style; dots above are written as quotes."""
    dots = len(text) - len(text.rstrip("'"))
    if dots:
        return ("accent", _sign(text[:-dots]), dots)
    if text in _FUNCTIONS:
        return ("function", text)
    if text in _LARGE:
        return ("operator", text, "large")
    if text.startswith("*") and len(text) > 1:
        return ("sign", text[1:], "bold")
    is_letter = len(text) == 1 and text.isalpha() and text not in "πΣ"
    return ("sign", text.replace("~", "\u00a0"), "italic" if is_letter else "upright")
