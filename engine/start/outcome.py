"""How a start ended: the word, and the sentence with its numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from engine.case.defaults import LONGEST_START
from engine.case.result_words import Outcome
from engine.model.rigid_runup import RigidRunup
from engine.numerics.same_bits import interp, log
from engine.start.settings import StartSettings
from engine.start.trajectory import Trajectory

#: An equilibrium at or above this share of synchronous speed is `asynchronous`, below `stalled`.
ASYNCHRONOUS_ABOVE = 0.95
#: Time simulated where the motor cannot break the train away. [s]
STANDSTILL_TIME = 2.0
#: Speed this close to the equilibrium of the rigid train has settled.
SETTLED = 0.01


@dataclass(frozen=True)
class StartOutcome:
    """How the start ended."""

    outcome: Outcome  #: The word.
    time: float  #: Simulated time. [s]
    end_speed: float  #: Mean speed of the reference shaft at that time. [rad/s]
    sentence: str  #: The outcome with its numbers.

    @classmethod
    def with_numbers(
        cls, outcome: Outcome, time: float, end_speed: float, **numbers: object
    ) -> StartOutcome:
        """An outcome whose sentence names its numbers.

        Parameters
        ----------
        outcome : Outcome
            The word.
        time : float
            Simulated time; `end` in the sentence. [s]
        end_speed : float
            Mean speed of the reference shaft then. [rad/s]
        **numbers
            What else its sentence names.

        Returns
        -------
        StartOutcome
            Word, numbers and sentence. [mixed]
        """
        return cls(outcome, time, end_speed, outcome.sentence.format(end=time, **numbers))


def run_length(runup: RigidRunup) -> float:
    """Time to simulate: that of the rigid train with a reserve.

    Parameters
    ----------
    runup : RigidRunup
        The rigid train. [SI]

    Returns
    -------
    float
        Time. [s]
    """
    if runup.equilibrium is None:
        return 1.5 * float(runup.time[-1]) + 1.0
    if runup.equilibrium <= 0.0:
        return STANDSTILL_TIME
    # up to a speed where the net torque is still clearly positive, then the exponential approach
    i = int(np.flatnonzero(runup.speed <= 0.98 * runup.equilibrium)[-1])
    gap = runup.equilibrium - float(runup.speed[i])
    approach = runup.inertia * gap / float(runup.net[i])
    time_constants = max(log(gap / (0.002 * runup.equilibrium)), 0.0)
    return 1.1 * (float(runup.time[i]) + approach * time_constants) + 2.0


def start_settled(
    runup: RigidRunup, trajectory: Trajectory, end: float, synchronous: float
) -> bool:
    """Whether a start that did not reach its end speed has come to rest at some speed.

    Parameters
    ----------
    runup : RigidRunup
        The rigid train. [SI]
    trajectory : Trajectory
        The start. [SI]
    end : float
        When it ended. [s]
    synchronous : float
        Synchronous speed of the reference shaft. [rad/s]
    """
    speed = _late_speed(trajectory, end)
    if runup.equilibrium is not None:
        if runup.equilibrium <= 0.0:
            if speed < 0.01 * synchronous:
                return True
        elif abs(speed - runup.equilibrium) <= SETTLED * runup.equilibrium:
            return True
    before = _late_speed(trajectory, 0.8 * end)
    gained = (speed - before) / (0.2 * end)
    return gained * 10.0 * end < synchronous - speed and end > STANDSTILL_TIME


def _cut_by_itself(settings: StartSettings, end: float) -> bool:
    """Whether a run ended before MaximumTime (or the longest start simulated) ended it."""
    return end < 0.999 * (settings.maximum_time or LONGEST_START)


def _late_speed(trajectory: Trajectory, end: float) -> float:
    """Speed at the end: of a straight line through the last tenth of a run, half a second at most.

    The line leaves out what the rotor oscillates; the mean alone would be that of half a stretch before.
    """
    t, w = trajectory.time, trajectory.mean_speed
    inside = (t >= end - min(0.5, 0.1 * end)) & (t <= end)
    if np.sum(inside) < 3 or np.ptp(t[inside]) == 0.0:
        return float(w[-1])
    from_end, mean = t[inside] - end, float(np.mean(w[inside]))
    middle = float(np.mean(from_end))
    across = from_end - middle
    slope = float(np.sum(across * (w[inside] - mean)) / np.sum(across * across))
    return mean - slope * middle


def outcome_of(
    runup: RigidRunup,
    settings: StartSettings,
    trajectory: Trajectory,
    end: float,
    synchronous: float,
) -> StartOutcome:
    """Name the way a start without field or trip ended, with its numbers.

    Parameters
    ----------
    runup : RigidRunup
        The rigid train. [SI]
    settings : StartSettings
        How it was calculated. [SI]
    trajectory : Trajectory
        The start. [SI]
    end : float
        When it ended. [s]
    synchronous : float
        Synchronous speed of the reference shaft. [rad/s]

    Returns
    -------
    StartOutcome
        Word, numbers and sentence. [mixed]
    """
    speed = settings.end_speed if trajectory.reached else _late_speed(trajectory, end)
    share, rpm = speed / synchronous, speed * 30.0 / math.pi
    numbers: dict[str, object] = {"share": share, "rpm": rpm}
    if trajectory.reached:
        return StartOutcome.with_numbers(Outcome.REACHED, end, speed, **numbers)
    if runup.equilibrium is not None and runup.equilibrium <= 0.0 and share < 0.01:
        numbers = {"load": runup.load[0], "average": runup.average[0]}
        return StartOutcome.with_numbers(Outcome.NO_BREAKAWAY, end, speed, **numbers)
    near = runup.equilibrium and abs(speed - runup.equilibrium) <= SETTLED * runup.equilibrium
    if near or (
        _cut_by_itself(settings, end) and start_settled(runup, trajectory, end, synchronous)
    ):
        # judged by where the speed tends to, quoted as simulated
        tends_to = runup.equilibrium / synchronous if near and runup.equilibrium else share
        word = Outcome.ASYNCHRONOUS if tends_to >= ASYNCHRONOUS_ABOVE else Outcome.STALLED
        numbers["end_share"] = settings.end_speed / synchronous
        return StartOutcome.with_numbers(word, end, speed, **numbers)
    speed = float(interp(end, trajectory.time, trajectory.mean_speed))
    numbers = {"share": speed / synchronous, "rpm": speed * 30.0 / math.pi}
    outcome = StartOutcome.with_numbers(Outcome.TIME_OUT, end, speed, **numbers)
    if not math.isfinite(float(runup.time[-1])):
        return outcome
    needed = (
        f" A rigid train needs {float(runup.time[-1]):.4g} s to reach the end speed: raise "
        "MaximumTime."
    )
    return replace(outcome, sentence=outcome.sentence + needed)
