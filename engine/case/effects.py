"""The effects a start may call for: their names, what was chosen, what was found.

An effect is on, off, or left to the plan. `StartEffects` tells the start which of them to simulate;
`EffectDecision` is one line of the Effects sheet.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "CHOICES",
    "CONTACT_LAWS",
    "EFFECTS",
    "BearingForce",
    "ContactRecord",
    "EffectDecision",
    "PullIn",
    "Sensitivity",
    "StartEffects",
]

#: What a user may choose for an effect; blank = auto.
CHOICES = ("auto", "on", "off")

#: Effects in the order of the sheet, each with what it means.
EFFECTS: dict[str, str] = {
    "bearings": "gears move sideways on their bearings (lateral-torsional coupling at the mesh)",
    "coupled damping": "dampers couple the modes in the start (non-proportional damping)",
    "fast modes": "modes above those that the tolerance asks for are integrated",
    "breaker closing": "electrical transient at breaker closing",
    "pull-in": "field application, synchronising torque, pull-in and swing",
    "aborted start": "trip at a speed, and coast-down",
    "backlash": "teeth that part, cross their clearance and meet again",
    "resonance sweep": "the falling 2 × slip frequency crosses modes",
    "cycle counting": "rainflow counting of stress cycles and damage",
    "run length": "the run goes on to its longest time even when the train has settled",
}

#: Contact damping laws. `limited`: never pulls and never exceeds the spring force, so the force
#: begins at zero (Modelica Standard Library 4.0, Rotational.Components.ElastoBacklash; Hunt and
#: Crossley, J. Applied Mechanics 42 (1975) 440, for why it should). `no adhesion`: never pulls
#: (ElastoBacklash2 of the same library).
CONTACT_LAWS = ("limited", "no adhesion")


@dataclass(frozen=True)
class StartEffects:
    """Effects to simulate in one start."""

    #: Elements whose clearance is modelled; empty = a linear train.
    clearances: tuple[str, ...] = ()
    breaker_closing: bool = False  #: Whether that effect is simulated.
    pull_in: bool = False  #: Likewise.
    aborted_start: bool = False  #: Likewise.
    #: True: dampers act as torques between their ends; False: on each mode for itself.
    coupled_damping: bool = False
    fast_modes: bool = False  #: True: no mode is left out.
    full_length: bool = False  #: True: the run does not stop early because the train has settled.
    contact_law: str = CONTACT_LAWS[0]  #: One of `CONTACT_LAWS`.


@dataclass(frozen=True)
class EffectDecision:
    """One effect: whether it is simulated, why, and what leaving it out may cost."""

    effect: str  #: One of `EFFECTS`.
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
class ContactRecord:
    """What happened at one clearance during a start."""

    element: str  #: Gear mesh or geared coupling.
    impacts: int  #: Recontacts after free flight, of any flank; and those of the back flank.
    back_impacts: int  #: Likewise.
    time_unloaded: float  #: Total time without tooth contact. [s]
    #: Largest approach speed at a recontact along the normal of the flank; None for a coupling.
    #: [m/s]
    recontact_speed: float | None
    recontact_speed_angular: float  #: The same as relative angular speed on the From side. [rad/s]
    tooth_force: float | None  #: Largest normal tooth force; None for a coupling. [N]
    tooth_torque: float  #: The same as torque on the From side. [N m]


@dataclass(frozen=True)
class BearingForce:
    """Largest radial force of one gear's bearings during a start."""

    station: str  #: The gear.
    #: Largest magnitude of the vibratory and transmitted force together, without weight. [N]
    force: float
    time: float  #: When. [s]


@dataclass(frozen=True)
class PullIn:
    """Field application and what came of it."""

    field_time: float  #: When the field was applied, and the slip then. [s, 1]
    field_slip: float  #: Likewise. [s, 1]
    synchronised: bool  #: True if the motor was in step at the end of the run.
    pole_slips: int  #: Full turns of the load angle between field application and the last passage.
    #: When the load angle passed 180 degrees for the last time (or the field was applied, if it
    #: never did); None if it never stayed. [s]
    pull_in_time: float | None
    load_angle: float | None  #: Mean load angle at the end. [rad]
    #: Frequency of the swing after pull-in, from its zero crossings; None where it does not swing.
    #: [Hz]
    swing_frequency: float | None


#: A start is sensitive if one tiny change shows this share of the tolerance: others show more.
NEARLY_FELT = 1.0 / 3.0


@dataclass(frozen=True)
class Sensitivity:
    """Change of the answers under a change of the input by 1e-9."""

    #: Largest relative change of a peak torque, seen or, by what three runs did once they had
    #: parted, to be expected. [1]
    spread: float
    #: True if another such change may well exceed the tolerance: the answer is one of many equally
    #: right ones.
    sensitive: bool

    @classmethod
    def of(cls, spread: float, tolerance: float) -> Sensitivity:
        """Judge one change: the spread that it shows is one sample of many.

        Parameters
        ----------
        spread : float
            Largest relative change of a peak torque. [1]
        tolerance : float
            Wanted relative error of the peaks. [1]

        Returns
        -------
        Sensitivity
            Sensitive from `NEARLY_FELT` of the tolerance on. [1]
        """
        return cls(spread, spread > NEARLY_FELT * tolerance)
