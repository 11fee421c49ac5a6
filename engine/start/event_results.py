"""What a start with events found: teeth that met again, forces of bearings, pull-in, repeatability."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.start.peaks import Range
from engine.start.trajectory import Turning


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
    recontact_error: float = 0.0  #: Relative error of the recontact speeds. [1]


@dataclass(frozen=True)
class BearingForce:
    """Largest radial force of one gear's bearings during a start."""

    station: str  #: The gear.
    #: Largest magnitude of the vibratory and transmitted force together, without weight. [N]
    force: float
    time: float  #: When. [s]


@dataclass(frozen=True, eq=False)
class MachineTorque:
    """Torque of a motor in time: from its fluxes, not from curves."""

    station: int  #: Where it acts. [index]
    largest: float  #: The largest in magnitude; negative brakes. [N m]
    time: float  #: When. [s]
    error: float  #: Change of its extremes from spacing h to h/2, relative. [1]
    torque: Floats  #: At the samples of the trajectory. [N m] Shape (n_times,).
    #: Electrical angle by which the rotor lags what turns with the line, from any origin. [rad] Shape (n_times,).
    lag: Floats


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


#: Probability that one more run lies in an interval from some. [1]
CONFIDENCE = 0.99
#: Probability of the quantile that gives it. Extremes of runs that have parted are not normal: they gather around a
#: few values. Ranges of the maximum from twelve runs held 98.7 % of 4,417 repetitions with the quantile of 0.99,
#: 99.2 % with this one (docs/claims.md). [1]
STUDENT = 0.998


@dataclass(frozen=True, eq=False)
class Repeatability:
    """Spread of the answers over an ensemble of equally right runs, where impacts make runs part.

    Each run has torques changed by less than 1e-7 and a step of its own. Whatever is reported of one run
    is one of many possible values; one more run lies in the intervals with a probability of `CONFIDENCE`.
    """

    spread: float  #: Largest distance of a reported peak from an end of its interval, relative. [1]
    sensitive: bool  #: Whether that is more than the tolerance. [flag]
    runs: int  #: Runs of the ensemble. [count]
    #: Intervals of maximum and minimum of each element with a peak. [N m]
    extremes: tuple[tuple[Range, Range], ...]
    #: Of each run the turning points of the outputs whose cycles are counted. [s, N m]
    histories: tuple[Mapping[int, Turning], ...]
    #: Change of the torques, in billionths, and step of each run beyond the two of any start. [1e-9, s]
    further: tuple[tuple[int, float], ...] = ()


def prediction_interval(values: Floats) -> tuple[float, float]:
    """Interval in which one more of some values is expected, and all of them lie.

    mean ± t s √(1 + 1/n), t of Student for `STUDENT`, widened to the values themselves.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Two at least, of independent runs. [any unit]

    Returns
    -------
    tuple of (float, float)
        Its ends. [as given]

    References
    ----------
    Hahn and Meeker, Statistical Intervals, section 4.7 (interval for one future observation).
    """
    from scipy.special import stdtrit

    n = len(values)
    quantile = float(stdtrit(n - 1, 0.5 + 0.5 * STUDENT))
    reach = quantile * float(np.std(values, ddof=1)) * math.sqrt(1.0 + 1.0 / n)
    middle = float(np.mean(values))
    return min(middle - reach, float(np.min(values))), max(middle + reach, float(np.max(values)))
