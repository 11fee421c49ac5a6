"""Checks of the chosen effects: one that is forced on needs its data."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from engine.case.checks.problem import check_names, suggestion, wrong_value
from engine.case.data import CaseData
from engine.case.effects import CHOICES as EFFECT_CHOICES
from engine.case.effects import EFFECTS
from engine.errors import Problem

#: Effects that need data before they can be forced on: effect, whether the data are there, the
#: cells to fill.
EFFECT_DATA: tuple[tuple[str, Callable[[CaseData], bool], str], ...] = (
    ("pull-in", lambda case: case.field_slip is not None, "FieldSlip and PullOutTorque"),
    (
        "breaker closing",
        lambda case: case.shock_amplitude is not None,
        "ShockAmplitude and ShockTimeConstant",
    ),
    ("aborted start", lambda case: case.trip_speed is not None, "TripSpeed"),
    (
        "backlash",
        lambda case: any(m.backlash or m.angular_backlash for m in case.meshes),
        "Backlash or Angular backlash in table Meshes",
    ),
    (
        "bearings",
        lambda case: any(
            m.bearing_stiffness_drive or m.bearing_stiffness_driven for m in case.meshes
        ),
        "a bearing stiffness and the mass of its gear in table Meshes",
    ),
)


def check_effect_choices(case: CaseData) -> Iterator[Problem]:
    """Known effects and choices; the data of effects that are forced on."""
    table = "EffectChoices"
    yield from check_names(table, "Effect", [e.effect for e in case.effect_choices], "an effect")
    for row, e in enumerate(case.effect_choices, start=1):
        if e.effect and e.effect not in EFFECTS:
            allowed = "one of " + ", ".join(EFFECTS)
            yield wrong_value(
                table, row, "Effect", e.effect, allowed, suggestion(e.effect, set(EFFECTS))
            )
        if e.choice not in (None, *EFFECT_CHOICES):
            yield wrong_value(
                table, row, "Choice", e.choice, "auto, on or off", "Choose from the list."
            )
        for effect, is_given, cells in EFFECT_DATA:
            if e.choice == "on" and e.effect == effect and not is_given(case):
                yield wrong_value(
                    table,
                    row,
                    "Choice",
                    e.choice,
                    f"auto or off while {cells} {'are' if ' and ' in cells else 'is'} "
                    + ("blank or 0" if effect == "backlash" else "blank"),
                    f"There is nothing to simulate: fill {cells}, or choose auto.",
                )
