"""What the evidence says of one effect, and what is decided after the user's choice."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from engine.case.effect import Effect


@dataclass(frozen=True)
class EffectDecision:
    """One effect: whether it is simulated, why, and what leaving it out may cost."""

    effect: str  #: One of `engine.case.effects.EFFECTS`.
    choice: str  #: What the user chose: ``auto``, ``on`` or ``off``.
    on: bool  #: Whether it is simulated.
    #: The number that decided, and what it was compared with; None where the inputs leave nothing
    #: to decide. [1]
    deciding_number: float | None
    limit: float | None  #: Likewise. [1]
    #: Bound on the relative change of the reported answers while the effect is left out; 0 =
    #: exact, None = it is on, or nothing is known (forced off). [1]
    bound: float | None
    time: float | None  #: Time it cost in this run, or would cost when on (estimated). [s]
    why: str  #: The decision in words, with its numbers.


@dataclass(frozen=True)
class Finding:
    """What the evidence says of one effect, before the user's choice."""

    wanted: bool  #: Whether the evidence calls for it.
    possible: bool  #: Whether the data for it are there.
    number: float | None  #: The number that decided. [1]
    limit: float | None  #: What it was compared with. [1]
    bound: float | None  #: As in `EffectDecision`, while the effect is off. [1]
    why: str  #: The finding in words, with its numbers.
    cost: float | None = None  #: Wall time over that of the linear start; None = the effect's. [1]
    while_off: str = ""  #: What a reader must know while it is off, though it is possible.

    @classmethod
    def impossible(cls, why: str, bound: float | None = 0.0) -> Finding:
        """An effect whose data are not there; nothing is lost without it unless `bound` is None."""
        return cls(False, False, None, None, bound, why)


def decide(
    effect: Effect, choice: str, finding: Finding, wall_time: float | None
) -> tuple[EffectDecision, str | None]:
    """A finding after the user's choice.

    Parameters
    ----------
    effect : Effect
        The effect. [record]
    choice : str
        ``auto``, ``on`` or ``off``. [word]
    finding : Finding
        What the evidence says. [1]
    wall_time : float or None
        Wall time of the linear start, where it was calculated. [s]

    Returns
    -------
    decision : EffectDecision
        The line of the Effects sheet. [1, s]
    warning : str or None
        Where the choice goes against the evidence. [sentence]
    """
    on = finding.possible and (choice == "on" or (choice == "auto" and finding.wanted))
    bound, why, warning = None if on else finding.bound, finding.why, None
    if choice == "off" and finding.wanted:
        bound, why = None, f"Forced off although required: {finding.why}"
        warning = f"Effect '{effect.name}' is forced off although required: {finding.why}"
    elif choice == "on" and not finding.possible:
        why = f"Forced on, but there is nothing to simulate: {finding.why}"
        warning = f"Effect '{effect.name}' is forced on, but cannot be simulated: {finding.why}"
    elif choice == "on" and not finding.wanted:
        why = f"Forced on; the estimate says off: {finding.why}"
    elif choice == "off":
        why = f"Forced off, in agreement with the estimate: {finding.why}"
    if finding.possible and not on and finding.while_off:
        why = f"{why} {finding.while_off}"
    cost = effect.cost if finding.cost is None else finding.cost
    time = None if wall_time is None or not finding.possible else cost * wall_time
    number = finding.number
    if number is not None and not math.isfinite(number):
        number = None
    return (
        EffectDecision(effect.name, choice, on, number, finding.limit, bound, time, why),
        warning,
    )


def percent(share: float) -> str:
    """A share in per cent with two digits, without powers of ten down to a millionth.

    Parameters
    ----------
    share : float
        The share. [1]

    Returns
    -------
    str
        With its unit. [sentence]
    """
    value = 100.0 * share
    if value == 0.0 or not 1e-4 <= abs(value) < 1e4:
        return f"{value:.2g} %"
    return f"{float(f'{value:.2g}'):.10f}".rstrip("0").rstrip(".") + " %"


def quoted(names: Iterable[str]) -> str:
    """Names in a sentence, each between quotation marks."""
    return ", ".join(f"'{name}'" for name in names)
