"""The registry's functions under names that VBA and Python allow.

A parameter of a VBA function may not be a word of the language, whatever its capitals, and shows in
Excel's function wizard; so its name is made of the argument's by the rule of the JSON keys.
"""

from __future__ import annotations

import inspect
import keyword
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from addin.contract.tables import json_key
from addin.worksheet.registry import FUNCTIONS, Function

#: Longest help that the function wizard shows of a function or of an argument.
MOST_HELP = 255
#: Arguments whose own name is a word of VBA or Python.
RENAMED = {"case": "case_cells", "from": "from_unit", "to": "to_unit"}
#: Words of VBA that are no names, and `caller`, which xlwings keeps for itself.
RESERVED = frozenset(
    """
    abs access addressof alias and any append array as attribute base begin binary boolean byref
    byte byval caller call case cbool cbyte ccur cdate cdbl cdec cint clng clnglng clngptr close
    compare const csng cstr currency cvar cverr date debug decimal declare defbool defbyte defcur
    defdate defdbl defint deflng defobj defsng defstr defvar dim do doevents double each else
    elseif empty end endif enum eqv erase error event exit explicit false fix for friend function
    get global go gosub goto if imp implements in input inputb int integer is lbound len lenb let
    lib like line local lock long longlong longptr loop lset me mid midb mod module name new next
    not nothing null object on open option optional or output paramarray preserve print private
    property pset public put raiseevent random randomize read redim rem reset resume return rset
    scale seek select set sgn shared single spc static step stop string sub tab text then time to
    true type typeof ubound unlock until variant wend while width with withevents write xor
    """.split()
)


def exported(
    function: Callable[..., Any], described: Function, argument: Any
) -> Callable[..., Any]:
    """A function with the signature and help of one of the registry.

    Parameters
    ----------
    function : callable
        Takes the cells, with its own name. [as typed]
    described : Function
        One of `excel_functions`, whose signature and help it gets.
    argument : callable
        xlwings' decorator of an argument.

    Returns
    -------
    callable
        The function, each argument a block of cells.
    """
    function.__qualname__ = function.__name__
    function.__doc__ = described.help
    function.__annotations__ = {}  # xlwings would choose its converters by them
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    function.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(a.name, kind, default=None if a.optional else inspect._empty)
            for a in described.arguments
        ]
    )
    for a in described.arguments:
        # The shape is always asked for: xlwings' default depends on the size of the range, and
        # its version 1 shall change it.
        function = argument(a.name, ndim=2, err_to_str=True, doc=a.help)(function)
    return function


def excel_functions() -> tuple[Function, ...]:
    """All functions of the registry, with names and help as Excel takes them."""
    return tuple(
        replace(
            function,
            help=_cut(function.help),
            arguments=tuple(
                replace(a, name=_name(a.name), help=_cut(a.help)) for a in function.arguments
            ),
        )
        for _, function in sorted(FUNCTIONS.items())
    )


def _name(argument: str) -> str:
    """``Shear modulus`` → ``shear_modulus``; words of a language get a name of their own."""
    name = json_key(argument)
    name = RENAMED.get(name, name)
    usable = name.isidentifier() and not keyword.iskeyword(name) and name not in RESERVED
    assert usable, f"argument {argument}: add a name for it in RENAMED"
    return name


def _cut(text: str) -> str:
    """A help text that the wizard takes: its first sentences, as many as fit."""
    while len(text) > MOST_HELP:
        shorter = text.rstrip(".").rpartition(". ")[0]
        if not shorter:
            return text[: MOST_HELP - 1] + "…"
        text = shorter + "."
    return text
