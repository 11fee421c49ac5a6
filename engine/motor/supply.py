"""What feeds a motor while it starts: the line with its short-circuit power, through an autotransformer or a reactor.

An impedance before the stator adds to the stator's own resistance and leakage in every equation of the two-axis machine, its
terms of rotation included, and leaves the torque's formula as it is: ψd iq − ψq id does not change where X i is added to ψ. So
the motor on a weak line is another motor on a stiff one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from engine.arrays import Floats
from engine.case.choices import Starting
from engine.case.data import SupplyRow
from engine.motor.circuit import Circuit
from engine.motor.curves import slip_curves
from engine.numerics.same_bits import modulus, times


@dataclass(frozen=True)
class Source:
    """A voltage behind an impedance."""

    voltage: float = 1.0  #: Over that rated. [1]
    resistance: float = 0.0  #: [pu]
    reactance: float = 0.0  #: [pu]

    @property
    def has_impedance(self) -> bool:
        """Whether its voltage gives way."""
        return bool(self.resistance or self.reactance)

    def before(self, circuit: Circuit) -> Circuit:
        """The motor with the impedance as part of its stator. [pu]"""
        return replace(
            circuit,
            stator_resistance=circuit.stator_resistance + self.resistance,
            stator_leakage=circuit.stator_leakage + self.reactance,
        )

    def terminal_voltage(self, circuit: Circuit, slip: Floats) -> Floats:
        """Voltage of line frequency that it leaves a motor.

        Parameters
        ----------
        circuit : Circuit
            The motor alone. [pu]
        slip : ndarray, shape (n,)
            Slips. [1]

        Returns
        -------
        ndarray, shape (n,)
            Over that rated. [1]
        """
        current = slip_curves(self.before(circuit), slip).line_current
        drop = times(np.full(len(slip), complex(self.resistance, self.reactance)), current)
        return np.asarray(self.voltage * modulus(1.0 - drop))


#: Each round takes the error of a reactor to a hundredth or less. [count]
REACTOR_ROUNDS = 8
#: A line that does not give way.
STIFF = Source()


@dataclass(frozen=True)
class Connection:
    """What feeds a motor up to some speed."""

    until: float  #: Fraction of synchronous speed; infinite = to the end. [1]
    source: Source  #: [pu]
    open_time: float = 0.0  #: How long the motor is off the line before. [s]


def connections_of(
    row: SupplyRow | None, base_power: float, circuit: Circuit
) -> tuple[Connection, ...]:
    """What feeds a motor in its start, one after the other.

    Parameters
    ----------
    row : SupplyRow or None
        Its row of table `Supply`; None = a stiff line. [SI]
    base_power : float
        Apparent power of the motor. [V A]
    circuit : Circuit
        The motor as it starts. [pu]

    Returns
    -------
    tuple of Connection
        The last one is the line itself. [pu]
    """
    if row is None:
        return (Connection(math.inf, STIFF),)
    line = _line(row, base_power)
    through = Connection(math.inf, line)
    if row.tap is None or row.switch_over_speed is None:
        return (through,)
    if row.starting == Starting.REACTOR:
        more = _reactor(circuit, row.tap)
        first = replace(line, reactance=line.reactance + more)
    else:  # seen through its ratio
        square = row.tap * row.tap
        first = Source(row.tap, square * line.resistance, square * line.reactance)
    return Connection(row.switch_over_speed, first), replace(
        through, open_time=row.open_time or 0.0
    )


def _line(row: SupplyRow, base_power: float) -> Source:
    """The line as its short-circuit power says; stiff where that is blank."""
    if row.short_circuit_power is None:
        return STIFF
    impedance = base_power / row.short_circuit_power
    if row.x_r is None:
        return Source(1.0, 0.0, impedance)
    resistance = impedance / math.sqrt(1.0 + row.x_r * row.x_r)
    return Source(1.0, resistance, row.x_r * resistance)


def _reactor(circuit: Circuit, tap: float) -> float:
    """Reactance that leaves the motor at rest a share of the voltage of a stiff line. [pu]

    The impedance that the motor shows depends a little on the reactance, as its axes differ.
    """
    reactance = 0.0
    for _ in range(REACTOR_ROUNDS):
        through = Source(1.0, 0.0, reactance).before(circuit)
        current = complex(slip_curves(through, np.ones(1)).line_current[0])
        own = 1.0 / current - complex(0.0, reactance)
        size = abs(own)
        reactance = math.sqrt(size * size / (tap * tap) - own.real * own.real) - own.imag
    return reactance
