"""Checks of the chosen effects: one that is forced on needs its data."""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.checks.problem import check_names, each_row, suggestion
from engine.case.choices import EffectChoice
from engine.case.data import CaseData
from engine.case.effects import EFFECTS
from engine.errors import Problem


def check_effect_choices(case: CaseData) -> Iterator[Problem]:
    """Known effects and choices; the data of effects that are forced on."""
    table = "EffectChoices"
    yield from check_names(table, "Effect", [e.effect for e in case.effect_choices], "an effect")
    for cells, e in each_row(table, case.effect_choices):
        if e.effect and e.effect not in EFFECTS:
            allowed = "one of " + ", ".join(EFFECTS)
            yield cells.wrong("Effect", e.effect, allowed, suggestion(e.effect, EFFECTS))
        yield from cells.choice("Choice", e.choice, EffectChoice, "auto, on or off")
        inputs = EFFECTS[e.effect].inputs if e.effect in EFFECTS else None
        if e.choice == EffectChoice.ON and inputs is not None and not inputs.given(case):
            yield cells.wrong(
                "Choice",
                e.choice,
                f"auto or off while {inputs.cells} {inputs.missing}",
                f"There is nothing to simulate: fill {inputs.cells}, or choose auto.",
            )
