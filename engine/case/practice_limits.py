"""What the literature says of torque reversal, with its sources."""

from __future__ import annotations

from dataclasses import dataclass

from engine.case.choices import ElementKind


@dataclass(frozen=True)
class PracticeLimit:
    """What a published source says about reversing torque."""

    applies_to: str  #: ``gear mesh`` or ``coupling``.
    service: str  #: ``continuous`` or ``start``.
    #: Lowest torque allowed over the full-load torque; None = no number in the source. [1]
    share: float | None
    says: str  #: What the source says, in our words.
    source: str  #: Where it is written. [citation]


#: What the literature says. None of it puts a number on the reversal that a *start* may cause, so
#: none of it judges a start: that limit is the maker's, column `Reversal limit` of Elements.
PRACTICE_LIMITS = (
    PracticeLimit(
        ElementKind.GEAR_MESH,
        "start",
        None,
        "To be avoided if at all possible; tolerated to a minimal degree where tooth accuracy and "
        "hardening are specified for it. No number: gear makers set the limit of each gear.",
        "Szenasi and von Nimitz, Transient analyses of synchronous motor trains (1978), section "
        "Torque reversals",
    ),
    PracticeLimit(
        "coupling",
        "start",
        None,
        "Geared couplings for synchronous motors are built with an overload factor and special "
        "manufacture to allow for reversals. No number: the coupling maker sets the limit.",
        "Szenasi and von Nimitz (1978), section Torque reversals",
    ),
    PracticeLimit(
        ElementKind.GEAR_MESH,
        "continuous",
        0.0,
        "Vibratory torque at most 75 % of the driving torque at that speed and 25 % of the "
        "full-load torque, whichever is smaller: no reversal in continuous operation.",
        "MIL-STD-167-2 type III",
    ),
)
