"""What a start with events found: teeth that met again, forces of bearings, pull-in, repeatability."""

from __future__ import annotations

from dataclasses import dataclass


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
    #: Instant from which slip stays below `in_step_slip` until the end; None if it does not. [s]
    in_step_time: float | None
    in_step_slip: float  #: Slip below which the motor is called in step. [1]
    load_angle: float | None  #: Mean load angle at the end. [rad]
    #: Frequency of the swing after pull-in, from its zero crossings; None where it does not swing.
    #: [Hz]
    swing_frequency: float | None


#: A start is sensitive if one tiny change shows this share of the tolerance: others show more.
NEARLY_FELT = 1.0 / 3.0


@dataclass(frozen=True)
class Repeatability:
    """Change of the answers under a change of the input by 1e-9."""

    #: Largest relative change of a peak torque, seen or, by what three runs did once they had
    #: parted, to be expected. [1]
    spread: float
    #: True if another such change may well exceed the tolerance: the answer is one of many equally
    #: right ones.
    sensitive: bool

    @classmethod
    def of(cls, spread: float, tolerance: float) -> Repeatability:
        """Judge one change: the spread that it shows is one sample of many.

        Parameters
        ----------
        spread : float
            Largest relative change of a peak torque. [1]
        tolerance : float
            Wanted relative error of the peaks. [1]

        Returns
        -------
        Repeatability
            Sensitive from `NEARLY_FELT` of the tolerance on. [1]
        """
        return cls(spread, spread > NEARLY_FELT * tolerance)
