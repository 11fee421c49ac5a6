"""One effect that a start may call for, and which of them a start simulates.

An effect is on, off, or left to the plan. Each is one record `Effect` in `engine.case.effects`;
`StartEffects` holds which of them the start simulates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from engine.case.choices import ContactLaw
from engine.case.data import CaseData


@dataclass(frozen=True)
class StartEffects:
    """Effects to simulate in one start."""

    #: Elements whose clearance is modelled; empty = a linear train.
    clearances: tuple[str, ...] = ()
    breaker_closing: bool = False  #: Whether that effect is simulated.
    pull_in: bool = False  #: Likewise.
    aborted_start: bool = False  #: Likewise.
    switch_over: bool = (
        False  #: Whether motors are switched over from a reduced voltage, as table `Supply` says.
    )
    #: True: dampers act as torques between their ends; False: on each mode for itself.
    coupled_damping: bool = False
    electrical_damping: bool = False  #: True: motors answer to the vibration of each mode.
    motor_transient: bool = (
        False  #: True: the torque of motors follows from their fluxes, not from curves.
    )
    fast_modes: bool = False  #: True: no mode is left out.
    #: Only so many of the lowest modes are integrated, and no error is estimated for the others; None = no limit.
    most_modes: int | None = None
    full_length: bool = False  #: True: the run does not stop early because the train has settled.
    contact_law: str = ContactLaw.LIMITED  #: One of `ContactLaw`.

    @property
    def need_events(self) -> bool:
        """Whether one of them needs the event-driven simulation. [flag]"""
        switched = self.pull_in or self.aborted_start or self.switch_over
        return bool(self.clearances) or switched or self.motor_transient


@dataclass(frozen=True)
class EffectInputs:
    """Inputs without which an effect cannot be forced on."""

    cells: str  #: The cells to fill, in words.
    missing: str  #: How they stand while the effect cannot be simulated, in words.
    given: Callable[[CaseData], bool]  #: Whether a case has them.


@dataclass(frozen=True)
class Effect:
    """An effect that a start may call for: one file in `engine.case.effects`.

    The file of the same name in `engine.plan.effects` decides from the evidence whether it is simulated.
    """

    name: str  #: As inputs and results call it.
    sentence: str  #: What it means, beside its name on the sheet.
    order: int  #: Place in the tables; the least comes first.
    number: str  #: The number that decides, and when it switches the effect on, in words.
    bound: str  #: The most that leaving it out changes a result, in words.
    called_for_by: str | None = None  #: Inputs that ask for it, in words; None = those of `inputs`.
    flag: str | None = None  #: Field of `StartEffects` that switches it on in the start.
    inputs: EffectInputs | None = None  #: What must be filled in before it can be forced on.
    cost: float = 0.0  #: Wall time over that of the linear start, where its finding gives none. [1]
    analysis: str | None = None  #: Analysis of the run whose wall time is its own.
    of_the_start: bool = True  #: Whether it means nothing without a start or prescribed torque.

    @property
    def module(self) -> str:
        """Name of its two files: its own, with underscores. [1]"""
        return self.name.replace(" ", "_").replace("-", "_")
