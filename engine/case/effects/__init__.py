"""The effects a start may call for: one file an effect, found by being in this folder.

A new effect is a file here with one `Effect`, and the file of the same name in
`engine.plan.effects` with its finding. No list names them; `EFFECTS` does, in the order of the
sheet.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from importlib import import_module
from pkgutil import iter_modules

from engine.case.data import CaseData
from engine.case.effect import Effect, StartEffects


def _records() -> Iterator[Effect]:
    flags = {field.name for field in fields(StartEffects)}
    for file in iter_modules(__path__):
        module = import_module(f"{__name__}.{file.name}")
        records = [value for value in vars(module).values() if isinstance(value, Effect)]
        if [record.module for record in records] != [file.name]:
            raise ImportError(
                f"{module.__file__} must define exactly one Effect, named after the file"
            )
        if records[0].flag not in {None, *flags}:
            raise ImportError(f"{module.__file__}: StartEffects has no field {records[0].flag}")
        yield records[0]


#: Name of an effect → its record, in the order of the sheet.
EFFECTS: dict[str, Effect] = {
    effect.name: effect for effect in sorted(_records(), key=lambda effect: effect.order)
}


def choice_of(case: CaseData, effect: str) -> str:
    """What the user chose for an effect.

    Parameters
    ----------
    case : CaseData
        The case. [mixed]
    effect : str
        A name in `EFFECTS`. [name]

    Returns
    -------
    str
        ``auto``, ``on`` or ``off``. [word]
    """
    choices = [
        row.choice
        for row in case.effect_choices
        if row.choice and str(row.effect).strip().casefold() == effect
    ]
    return choices[-1] if choices else "auto"
