"""Two-axis circuit of a synchronous or induction motor, and how it follows from a data sheet.

Each axis is the stator leakage, the magnetising reactance, and the windings of the rotor side by side. A
data sheet lists what is seen from the terminals after more and more windings take part: Xd with none,
Xd' with the field, Xd'' with the damper too. So the windings are found one after the other by one rule,
and a motor without a field, or with one winding an axis, needs none of its own.

Classical time constants: that of a winding is what it has while the windings before it carry current
without resistance and those behind it are open: the relations of the Modelica Standard Library,
Electrical.Machines.Utilities.SynchronousMachineData.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from engine.case.time_constants import short_circuit_times


class Winding(NamedTuple):
    """One winding of the rotor, referred to the stator."""

    resistance: float  #: [pu]
    leakage: float  #: Leakage reactance. [pu]


class Step(NamedTuple):
    """What one more winding of an axis changes at the terminals."""

    reactance: float  #: Reactance of the axis as soon as it takes part. [pu]
    time_constant: float  #: Of the winding. [s]
    short_circuit: bool = False  #: With the stator short-circuited, not open.


@dataclass(frozen=True)
class Circuit:
    """Two-axis circuit."""

    stator_resistance: float  #: [pu]
    stator_leakage: float  #: [pu]
    magnetising_d: float  #: Magnetising reactance of the axis of the poles. [pu]
    magnetising_q: float  #: Of the axis between the poles. [pu]
    field: Winding | None  #: Field winding; None where there is none, or where it is open.
    dampers_d: tuple[Winding, ...]  #: Damper windings (cages) of the axis of the poles.
    dampers_q: tuple[Winding, ...]  #: Of the axis between the poles.
    common_leakage_d: float = 0.0  #: Leakage flux of field and dampers alone (Canay). [pu]
    #: Resistance of the field circuit for currents against that of operation, infinite where it is open for them; None:
    #: the same both ways. [pu]
    reverse_resistance: float | None = None

    @property
    def polarities(self) -> tuple[Circuit, Circuit]:
        """The circuit while the current of the field flows as in operation, and while it flows against that."""
        forward = replace(self, reverse_resistance=None)
        if self.field is None or self.reverse_resistance is None:
            return forward, forward
        is_open = math.isinf(self.reverse_resistance)
        field = None if is_open else self.field._replace(resistance=self.reverse_resistance)
        return forward, replace(forward, field=field)


def rotor_windings(
    reactance: float, leakage: float, steps: Sequence[Step], line_omega: float
) -> tuple[Winding, ...]:
    """Windings of one axis from what each changes at the terminals.

    Parameters
    ----------
    reactance : float
        Synchronous reactance of the axis. [pu]
    leakage : float
        Stator leakage; below the reactance of every step. [pu]
    steps : sequence of Step
        One a winding, the slowest first: reactance falling. [pu, s]
    line_omega : float
        Angular frequency of the line. [rad/s]

    Returns
    -------
    tuple of Winding
        In the order of the steps. [pu]
    """
    windings = []
    before = reactance
    for after, time_constant, short_circuit in steps:
        inner = before - leakage  # what the winding has in parallel
        own = inner * (after - leakage) / (before - after)
        open_time = time_constant * before / after if short_circuit else time_constant
        windings.append(Winding((own + inner) / (line_omega * open_time), own))
        before = after
    return tuple(windings)


def measured_windings(
    reactances: tuple[float, float, float],
    leakage: float,
    times: tuple[float, float],
    line_omega: float,
    *,
    short_circuit: bool,
) -> tuple[Winding, Winding] | None:
    """Field and damper of the axis of the poles, whose time constants are roots of the whole circuit.

    As a sudden short circuit shows them: 1/Xd(p) = 1/Xd + (1/Xd' − 1/Xd) p T'/(1 + p T') + (1/Xd'' − 1/Xd') p T''/(1 + p T'')
    (Canay, Determination of model parameters of synchronous machines, IEE Proc. B 130, 1983, 86-94). What the windings
    have in parallel to the magnetising reactance is 1/(Xd(p) − Xl) − 1/(Xd − Xl), one partial fraction each.

    Parameters
    ----------
    reactances : tuple of float
        Xd, Xd', Xd'', falling. [pu]
    leakage : float
        Stator leakage, below all of them. [pu]
    times : tuple of float
        Time constants of field and damper, falling. [s]
    line_omega : float
        Angular frequency of the line. [rad/s]
    short_circuit : bool
        They are those with the stator short-circuited, not open. [flag]

    Returns
    -------
    tuple of Winding, or None
        None where no circuit has these time constants: open ones that are too near to each other. [pu]
    """
    xd, transient, subtransient = reactances
    y = 1.0 / xd
    slow, fast = 1.0 / transient - y, 1.0 / subtransient - 1.0 / transient
    shorted = times if short_circuit else short_circuit_times(reactances, times)
    if shorted is None:
        return None
    t1, t2 = shorted
    # Xd(p) - Xl = (c0 + c1 p + c2 p^2) / n(p)
    c0 = 1.0 - leakage * y
    c1 = t1 * (1.0 - leakage * (y + slow)) + t2 * (1.0 - leakage * (y + fast))
    c2 = t1 * t2 * (1.0 - leakage * (y + slow + fast))
    root = 0.5 * (c1 + math.sqrt(c1 * c1 - 4.0 * c0 * c2))
    own = root / c0, c2 / root
    windings = []
    for of_this, of_other in (own, own[::-1]):
        p = -1.0 / of_this
        seen = y * (1.0 + p * t1) * (1.0 + p * t2)
        seen += slow * p * t1 * (1.0 + p * t2) + fast * p * t2 * (1.0 + p * t1)
        reactance = c0 * (of_other / of_this - 1.0) / seen
        windings.append(Winding(reactance / (line_omega * of_this), reactance))
    return windings[0], windings[1]


class TimeConstants(NamedTuple):
    """Of field and damper in the axis of the poles, the stator open and short-circuited."""

    open_transient: float  #: [s]
    open_subtransient: float  #: [s]
    short_transient: float  #: [s]
    short_subtransient: float  #: [s]


def time_constants(circuit: Circuit, line_omega: float) -> tuple[TimeConstants, TimeConstants]:
    """Time constants of a circuit with field and one damper in the axis of the poles.

    Parameters
    ----------
    circuit : Circuit
        Without common leakage. [pu]
    line_omega : float
        Angular frequency of the line. [rad/s]

    Returns
    -------
    classical : TimeConstants
        By the relations of one winding after the other. [s]
    measured : TimeConstants
        Roots of the whole circuit. [s]
    """
    assert circuit.field is not None
    field, (damper, *_) = circuit.field, circuit.dampers_d
    magnetising, leakage = circuit.magnetising_d, circuit.stator_leakage

    def classical(seen: float) -> tuple[float, float]:
        """With what the windings have in parallel to them on the side of the stator."""
        after = seen * field.leakage / (seen + field.leakage)
        slow = (field.leakage + seen) / (line_omega * field.resistance)
        return slow, (damper.leakage + after) / (line_omega * damper.resistance)

    def roots(seen: float) -> tuple[float, float]:
        a = (field.leakage + seen) / (line_omega * field.resistance)
        b = (damper.leakage + seen) / (line_omega * damper.resistance)
        cross = seen * seen / (line_omega * line_omega * field.resistance * damper.resistance)
        slow = 0.5 * (a + b + math.sqrt((a - b) * (a - b) + 4.0 * cross))
        return slow, (a * b - cross) / slow

    shorted = magnetising * leakage / (magnetising + leakage)
    return (
        TimeConstants(*classical(magnetising), *classical(shorted)),
        TimeConstants(*roots(magnetising), *roots(shorted)),
    )


def stator_resistance(
    subtransient_d: float, subtransient_q: float, armature_time: float, line_omega: float
) -> float:
    """Stator resistance from the time constant of the direct current in the stator.

    Parameters
    ----------
    subtransient_d, subtransient_q : float
        Subtransient reactances. [pu]
    armature_time : float
        Ta, with the stator short-circuited. [s]
    line_omega : float
        Angular frequency of the line. [rad/s]

    Returns
    -------
    float
        Resistance of one phase. [pu]
    """
    return 2.0 / ((1.0 / subtransient_d + 1.0 / subtransient_q) * line_omega * armature_time)


def starting_circuit(
    circuit: Circuit,
    *,
    discharge: float = 0.0,
    reverse: float | None = None,
    is_open: bool = False,
    factor: float = 1.0,
) -> Circuit:
    """The circuit while the motor starts.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    discharge : float
        Resistance across the field winding, as a multiple of its own. [1]
    reverse : float, optional
        That for currents against those of operation, infinite where it is open for them; default the same. [1]
    is_open : bool
        The field circuit is open. [flag]
    factor : float
        On the leakages of stator and dampers: large currents saturate the leakage paths. [1]

    Returns
    -------
    Circuit
        With the resistance in the field, and those leakages multiplied. [pu]
    """

    def saturated(windings: tuple[Winding, ...]) -> tuple[Winding, ...]:
        return tuple(Winding(w.resistance, factor * w.leakage) for w in windings)

    field, against = circuit.field, None
    if field is not None:
        if reverse is not None and reverse != discharge and not is_open:
            against = (1.0 + reverse) * field.resistance
        closed = Winding((1.0 + discharge) * field.resistance, field.leakage)
        field = None if is_open else closed
    return replace(
        circuit,
        stator_leakage=factor * circuit.stator_leakage,
        field=field,
        dampers_d=saturated(circuit.dampers_d),
        dampers_q=saturated(circuit.dampers_q),
        reverse_resistance=against,
    )


def line_omega(frequency: float) -> float:
    """Angular frequency of the line.

    Parameters
    ----------
    frequency : float
        Line frequency. [Hz]

    Returns
    -------
    float
        [rad/s]
    """
    return 2.0 * math.pi * frequency
