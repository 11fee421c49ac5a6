"""What the limit on contact damping does where teeth come near parting, and do not part.

Contact damping never exceeds the spring force (`ContactLaw.LIMITED`). A linear start has no such limit. It acts
where the torque of an element with a clearance rises from near zero faster than its spring takes it up: at
the very beginning, or after a dip. There the linear start has too much torque; what is too much, applied to
the modes as a force of its own, bounds what it may have changed.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.signal import lfilter

from engine.arrays import Floats
from engine.case.choices import ContactLaw
from engine.case.data import CaseData
from engine.model.modal_train import ModalTrain
from engine.model.train import Flank
from engine.start.settings import NEGLIGIBLE
from engine.start.start import Start
from engine.start.torque_outputs import torque_outputs

#: Samples of the torque of one contact, at the most; else four in the time c/k.
MOST_SAMPLES, SAMPLES = 1_000_000, 4.0


def limit_of_contact_damping(case: CaseData, model: ModalTrain, start: Start) -> float:
    """Bound on the change of any extreme torque by the limit on contact damping, while teeth do not part.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    model : ModalTrain
        Its train, modes and damping. [SI]
    start : Start
        Its linear start. [SI]

    Returns
    -------
    float
        Relative to the larger extreme of the element; zero where no contact is damped. [1]
    """
    train, modes, _ = model
    damped = [f for f in train.flanks if f.gap and f.viscous > 0.0]
    if not damped or (case.contact_law or ContactLaw.LIMITED) != ContactLaw.LIMITED:
        return 0.0
    outputs = torque_outputs(train, modes, np.zeros(0, dtype=np.int64))
    elastic = modes.omega > 0.0
    omega = modes.omega[elastic]
    change = np.zeros(len(outputs.element))
    turnings = start.turning_of_element()
    at = {i: _times_of_extremes(turning) for i, turning in turnings.items()}
    for flank in damped:
        time, excess = _excess(start, flank)
        if not len(time):
            continue
        reach = np.abs(modes.row_twist[flank.drive_row, elastic])
        step = float(time[1] - time[0]) if len(time) > 1 else 0.0
        for i, element in enumerate(outputs.element.tolist()):
            shown = np.abs(outputs.position[i, elastic])
            for instant in at.get(element, ()):
                before = time <= instant
                faded = np.exp(
                    -np.outer(model.damping.ratio[elastic] * omega, instant - time[before])
                )
                impulse = faded @ excess[before] * step
                largest = np.max(faded * excess[before], axis=1, initial=0.0)
                reached = np.minimum(impulse / omega, 2.0 * largest / omega**2)
                change[i] = max(change[i], float(shown @ (reach * reached)))
    size = {i: float(np.max(np.abs(turning[1]))) for i, turning in turnings.items()}
    floor = NEGLIGIBLE * max(size.values(), default=0.0)
    return max(
        (
            c / max(size[e], floor, 1e-300)
            for c, e in zip(change.tolist(), outputs.element.tolist(), strict=True)
            if e in size
        ),
        default=0.0,
    )


def _times_of_extremes(turning: tuple[Floats, Floats]) -> tuple[float, float]:
    """When the highest and the lowest torque occur. [s]"""
    when, value = turning
    return float(when[int(np.argmax(value))]), float(when[int(np.argmin(value))])


def _excess(start: Start, flank: Flank) -> tuple[Floats, Floats]:
    """Equal times, those where contact damping exceeds the spring force, and by how much. [s, N m]

    The torque is T = S + D, D = (c/k) dS/dt: S is T after a lag of c/k, and D − S = T − 2 S.
    """
    trajectory = start.trajectory
    own = np.flatnonzero(trajectory.output_element == flank.element)
    keep = np.concatenate([[True], np.diff(trajectory.time) > 0.0])
    time = trajectory.time[keep]
    if not len(own) or len(time) < 2:
        return np.empty(0), np.empty(0)
    torque = trajectory.torque[int(own[0])][keep]
    rate = trajectory.torque_rate[int(own[0])][keep]
    lag, span = flank.viscous / flank.stiffness, float(time[-1] - time[0])
    n = int(min(MOST_SAMPLES, max(SAMPLES * span / lag, 2.0 * len(time)))) + 1
    at = np.linspace(time[0], time[-1], n)
    whole = CubicHermiteSpline(time, torque, rate)(at)
    # S of the next sample from T linear between two
    ratio = span / (n - 1) / lag
    fade = float(np.exp(-ratio))
    share = (1.0 - fade) / ratio
    spring = lfilter([1.0 - share, share - fade], [1.0, -fade], whole)
    spring -= (1.0 - share) * whole[0] * fade ** np.arange(n)  # untwisted at the beginning
    excess = np.maximum(whole - 2.0 * spring, 0.0)
    some = excess > NEGLIGIBLE * float(np.max(np.abs(whole)))
    return at[some], excess[some]
