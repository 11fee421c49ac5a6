"""Faults and switching of a motor in operation: rows of table `MotorEvents`, by the two-axis machine in time.

Before it the motor balances the running loads: one with a field runs in step, excited by its power factor, an
induction motor at the slip of that torque. A motor that is closed out of phase runs without current, and the loads
decelerate the train. What the line does is written
as voltages that turn with it and against it, so that every kind of event is a short list of supplies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from engine.arrays import Floats, Mask
from engine.backlash.current_zeros import clearing_by_phase
from engine.backlash.event_start import StartEvent
from engine.backlash.machines import MachineInTime
from engine.case.choices import Clearing, MotorEventKind
from engine.case.data import CaseData, MotorEventRow
from engine.case.defaults import LEAST_PEAK_ERROR
from engine.errors import InternalError
from engine.model.excitation import transmitted_torque
from engine.model.modal_train import ModalTrain
from engine.model.motor import Motor
from engine.model.train import Train
from engine.motor.circuit import Circuit, line_omega, starting_circuit
from engine.motor.curves import running_slip, stalls_at
from engine.motor.fault_torques import largest_line_to_line, largest_of_constant_fluxes
from engine.motor.from_case import MotorFromData, motors_from_data
from engine.motor.supply import STIFF, Source
from engine.motor.two_axis import (
    MachineState,
    flux_system,
    open_circuit_state,
    residual_voltage,
    running_state,
    slipping_state,
    with_same_currents,
)
from engine.numerics.same_bits import atan2, cos, hypot, product, sin
from engine.numerics.torque_curve import TorqueCurve
from engine.start.machine_motion import (
    Balance,
    Machine,
    MachineMotion,
    Supply,
    machine_motion,
    switched,
)
from engine.start.prescribed import SAMPLES_PER_PERIOD, Drive
from engine.start.start import Start
from engine.start.time_response import ModalSystem, TimeResponse, modal_system
from engine.start.torque_outputs import force_reach
from engine.stepping.linear_loop import turning_points

#: Largest phase of the line in a step: the fluxes of the stator turn so far in the rotor's axes. [rad]
LINE_PHASE = 0.15
#: The slip at the end of an event is the mean over this share of it. [1]
LAST_PART = 0.1
#: An event of a motor is followed so long after the last change of its supply: several swings of the rotor, whose
#: frequency is 1 to 10 Hz. [s]
MOTOR_FOLLOWED = 2.0


@dataclass(frozen=True, eq=False)
class MotorEvent:
    """An event as the machine in time takes it."""

    machine: Machine  #: The motor. [pu, SI]
    station: int  #: Where it acts. [index]
    supplies: tuple[Supply, ...]  #: What its stator is connected to. [pu]
    state: MachineState  #: Its fluxes just before. [pu]
    held: float  #: Its torque in operation, with which the train is in balance. [N m]
    released: bool  #: Whether it gives no torque before the event. [flag]
    slip: float  #: In operation; 0 in step. [1]
    #: Axes of the currents that must pass zero before a phase clears; empty: all clear at once. [rad]
    poles: tuple[float, ...] = ()

    def beginning(self, system: ModalSystem) -> tuple[tuple[Floats, Floats], MachineState]:
        """Modal positions and velocities at the event, and the state of the motor there.

        Parameters
        ----------
        system : ModalSystem
            The train under the torque of the motor. [SI]

        Returns
        -------
        before : tuple of ndarray, shape (n_kept,)
            Of a released motor those of the train without its torque. [SI]
        state : MachineState
            Its angle is that of the train in balance. [pu, rad]
        """
        none = np.zeros(len(system.omega))
        if not self.released:
            return (none, none), self.state
        stiff = np.where(system.omega > 0.0, system.omega, np.inf)
        twisted = -self.held * system.reach[:, 0] / (stiff * stiff)
        turned = self.machine.pole_pairs * float(product(system.reach[:, 0], twisted))
        return (twisted, none), replace(self.state, angle=self.state.angle - turned)

    def supplies_of(self, system: ModalSystem) -> tuple[Supply, ...]:
        """What the stator is connected to, with the zeros of current at which phases clear. [pu]

        Parameters
        ----------
        system : ModalSystem
            The train under the torque of the motor. [SI]
        """
        if not self.poles:
            return self.supplies
        before, state = self.beginning(system)
        return clearing_by_phase(
            system, self.machine, self.supplies[0], self.last_change, self.poles, state, before,
            self.balance,
        )  # fmt: skip

    @property
    def balance(self) -> Balance:
        """Torque and speed of the motor with which the train is in balance."""
        return Balance(self.held, 1.0 - self.slip)

    @property
    def last_change(self) -> float:
        """When its supply changes for the last time. [s]"""
        return self.supplies[-1].begins


@dataclass(frozen=True)
class AirGapTorque:
    """Torque of the motor in an event."""

    largest: float  #: The largest in magnitude; negative brakes. [N m]
    time: float  #: When. [s]
    error: float  #: Change of its magnitude from spacing h to h/2, relative. [1]
    #: Largest magnitude in the first cycle without any resistance, the speed kept; None where the angle of closing
    #: follows from the motion. [N m]
    closed_form: float | None
    #: Turns by which the rotor has lost its step against a line with voltage; 0: it stays in step. [count]
    slipped: int
    #: From when on the rotor is more than half a turn from where it was; infinite: never. [s]
    slips_from: float
    slip: (
        float | None
    )  #: In operation, before the event; 0 in step; None: it begins in a start. [1]
    #: Slip at the end of an induction motor that does not return to its speed; None: it does, or it has a field. [1]
    stalled: float | None


@dataclass(frozen=True, eq=False)
class MotorDrive(Drive):
    """The torque of the motor as what drives the train, and what it was."""

    event: MotorEvent  #: [mixed]
    motions: list[MachineMotion] = field(default_factory=list)  #: Of the last two runs. [SI]


def motor_event(case: CaseData, train: Train, row: MotorEventRow) -> MotorEvent:
    """A row of `MotorEvents` as supplies and a state.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]
    train : Train
        Its train. [SI]
    row : MotorEventRow
        The event. [pu, rad, s]

    Returns
    -------
    MotorEvent
        [mixed]

    Raises
    ------
    ModelError
        If the motor does not carry its running torque.
    """
    motor = _motor_of(case, row.station)
    sheet = motor.sheet
    circuit = starting_circuit(
        motor.circuit, factor=1.0 if sheet.start_factor is None else sheet.start_factor
    )
    machine = Machine(
        circuit,
        motor.torque_base,
        motor.synchronous_speed,
        line_omega(case.ratings.line_frequency or 0.0),
    )
    station = train.stations.index(motor.station)
    held = float(transmitted_torque(case, train).motor[station])
    released, slip = row.is_off_the_line, 0.0
    if circuit.field is None:
        slip = running_slip(circuit, held / motor.torque_base)
        state = slipping_state(circuit, slip)
    elif released:
        voltage = 1.0 if row.residual_voltage is None else row.residual_voltage
        state = open_circuit_state(circuit, voltage, number(row.angle) or 0.0)
    else:
        # its current leads unless typed otherwise: a synchronous motor is rated with an excited field
        state = running_state(circuit, held / motor.torque_base, -(sheet.power_factor or 1.0))
    if not released:
        machine, state = _behind_line(machine, state, motor.stages[-1].connection.source)
    else:
        machine = replace(machine, source=motor.stages[-1].connection.source)
    supplies = _supplies(row, 1.0 - slip, machine.source)
    return MotorEvent(machine, station, supplies, state, held, released, slip, _poles(row))


def _motor_of(case: CaseData, station: str | None) -> MotorFromData:
    for motor in motors_from_data(case):
        if motor.station == station:
            return motor
    raise InternalError(f"an event of station '{station}' without a data sheet was not refused")


def _behind_line(
    machine: Machine, state: MachineState, source: Source
) -> tuple[Machine, MachineState]:
    """A running motor whose terminals have rated voltage, behind a line: its voltage, and the angle ahead of that."""
    if source == STIFF:
        return machine, state
    system = flux_system(machine.circuit, 1.0, 0.0, 0.0, is_open=False)
    i_d, i_q = (float(i) for i in product(system.stator_current, state.flux))
    c, s = cos(state.angle), sin(state.angle)
    active, reactive = i_d * c - i_q * s, i_d * s + i_q * c
    real = 1.0 + source.resistance * active - source.reactance * reactive
    imag = source.resistance * reactive + source.reactance * active
    machine = replace(machine, source=replace(source, voltage=hypot(real, imag)))
    return machine, replace(state, angle=state.angle - atan2(imag, real))


def _supplies(row: MotorEventRow, speed: float, source: Source = STIFF) -> tuple[Supply, ...]:
    """What the line does, with the phase `row.phase` of the healthy phase, or of the one that changes.

    Of a motor off the line the phase is that of its own voltage.

    The voltage of an open stator is that of its fluxes times the speed of the rotor, over synchronous speed.
    """
    clears = number(row.clears_after)
    if row.is_off_the_line and row.kind == MotorEventKind.LINE_TO_LINE_FAULT:
        return (Supply(0.0, (0.0, 0.0), axis=-(number(row.phase) or 0.0)),)
    if row.kind == MotorEventKind.LINE_TO_LINE_FAULT and source.has_impedance:
        fed = Supply(0.0, axis=-(number(row.phase) or 0.0))
        return (fed,) if clears is None else (fed, Supply(clears))
    match row.kind:
        case MotorEventKind.OUT_OF_PHASE_CLOSING:
            return (Supply(0.0),)
        case MotorEventKind.RECLOSING:
            residual = None if row.residual_voltage is None else row.residual_voltage / speed
            closing = Supply(clears or 0.0, residual=residual, ahead=number(row.angle))
            return Supply(0.0, is_open=True), closing
        case MotorEventKind.THREE_PHASE_FAULT:
            left, against = 0.0, 0.0
        case MotorEventKind.LINE_TO_LINE_FAULT:  # cos(ω₀t + φ) along the axis of the healthy phase
            left, against = 0.5, 0.5
        case MotorEventKind.VOLTAGE_DIP:
            left, against = row.residual_voltage or 0.0, 0.0
        case _:  # one phase with a share of its voltage
            lost = (1.0 - (row.residual_voltage or 0.0)) / 3.0
            left, against = 1.0 - lost, -lost
    changed = Supply(
        0.0, (left, 0.0), (against, -2.0 * (number(row.phase) or 0.0)),
        at_terminals=row.kind == MotorEventKind.THREE_PHASE_FAULT,
    )  # fmt: skip
    return (changed,) if clears is None else (changed, Supply(clears))


def _poles(row: MotorEventRow) -> tuple[float, ...]:
    """Axes of the phases whose currents must pass zero; of a line-to-line fault, of what flows between the two."""
    if row.clearing != Clearing.ZEROS:
        return ()
    first = -(number(row.phase) or 0.0)
    if row.kind == MotorEventKind.LINE_TO_LINE_FAULT:
        return (first + 0.5 * math.pi,)
    return tuple(first + k * 2.0 * math.pi / 3.0 for k in range(3))


def start_event(case: CaseData, train: Train, row: MotorEventRow) -> StartEvent:
    """A row of `MotorEvents` that begins while the motor starts.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]
    train : Train
        Its train. [SI]
    row : MotorEventRow
        The event. [pu, rad, s]

    Returns
    -------
    StartEvent
        [s, pu, rad]
    """
    begins, omega = row.in_start or 0.0, line_omega(case.ratings.line_frequency or 0.0)
    sources = [stage.connection.source for stage in _motor_of(case, row.station).stages]
    behind = next((source for source in sources if source.has_impedance), STIFF)
    # its voltages turn from the event on, those of the start from breaker closing on
    supplies = tuple(
        replace(s.turned_by(omega * begins), begins=begins + s.begins)
        for s in _supplies(row, 1.0, behind)  # it takes no residual voltage
    )
    return StartEvent(train.stations.index(str(row.station)), supplies, MOTOR_FOLLOWED, _poles(row))


def number(value: float | str | None) -> float | None:
    """A number of a row of which no worst value is looked for any more.

    Parameters
    ----------
    value : float, str or None
        Phase, angle or clearing time. [rad, s]

    Returns
    -------
    float or None
        [as given]
    """
    if isinstance(value, str):
        raise InternalError(f"an event has '{value}' in the place of a number")
    return value


def motor_drive(modal: ModalTrain, event: MotorEvent) -> MotorDrive:
    """The torque of the motor as what drives the train, for `follow`.

    Parameters
    ----------
    modal : ModalTrain
        The train. [SI]
    event : MotorEvent
        The event. [mixed]

    Returns
    -------
    MotorDrive
        [SI]
    """
    train, modes, damping = modal
    machine = event.machine
    stations = np.array([event.station], dtype=np.int64)
    omega = np.where(modes.omega > 0.0, modes.omega, np.inf)
    reach = np.abs(force_reach(train, modes, stations)).sum(axis=1)
    motions: list[MachineMotion] = []
    supplies: list[Supply] = []

    def respond(end: float, count: int, kept: Mask) -> TimeResponse:
        system = modal_system(train, modes, stations, damping.structural, kept)
        before, state = event.beginning(system)
        if not supplies:  # at one place whatever the step
            supplies.extend(event.supplies_of(system))
        motion = machine_motion(
            system, machine, supplies, state, end, end / count,
            balance=event.balance, before=before,
        )  # fmt: skip
        motions[:] = [*motions[-1:], motion]
        return motion.response(system, event.held)

    # a torque of this size that turns with twice the line's frequency; it jumps only where the breaker opens
    largest = 2.0 * machine.torque_base / _subtransient(machine.circuit)
    opens = any(s.is_open for s in event.supplies)
    ringing = reach * (opens * abs(event.held) + 2.0 * machine.line_omega * largest / omega)
    fastest = machine.line_omega / (LINE_PHASE * SAMPLES_PER_PERIOD)
    return MotorDrive(stations, reach, ringing, fastest, respond, event, motions)


def _subtransient(circuit: Circuit) -> float:
    """The smaller subtransient reactance. [pu]"""
    system = flux_system(circuit, 1.0, 0.0, 0.0, is_open=False)
    return 1.0 / max(float(system.current[0, 0]), float(system.current[system.q, system.q]))


def air_gap_torque_of(drive: MotorDrive) -> AirGapTorque:
    """What the torque of the motor was in the runs that were made.

    Parameters
    ----------
    drive : MotorDrive
        After `follow`. [SI]

    Returns
    -------
    AirGapTorque
        [N m, s]
    """
    coarse, fine = (_turning(motion) for motion in drive.motions)
    largest, time = _largest(*fine)
    # of both extremes: one alone may agree by chance
    change = max(abs(float(f(fine[1]) - f(coarse[1]))) for f in (np.max, np.min))
    change /= abs(largest) or 1.0
    motion, event = drive.motions[-1], drive.event
    machine = event.machine
    lag = event.slip * machine.line_omega * motion.time - machine.pole_pairs * motion.rotor
    return AirGapTorque(
        largest, time, max(change, LEAST_PEAK_ERROR),
        _closed_form(event), *_slip(event, motion.time, lag), event.slip, _stalled(event, motion.time, lag),
    )  # fmt: skip


def with_teeth_apart(air_gap: AirGapTorque, event: MotorEvent, response: Start) -> AirGapTorque:
    """What the torque of the motor was where teeth separated.

    Parameters
    ----------
    air_gap : AirGapTorque
        With all teeth in contact. [SI]
    event : MotorEvent
        The event. [mixed]
    response : Start
        Of the train with its clearances. [SI]

    Returns
    -------
    AirGapTorque
        [N m, s]
    """
    (torque,), when = response.machines, response.trajectory.time
    turns, since = _slip(event, when, torque.lag)
    return replace(
        air_gap, largest=torque.largest, time=torque.time, error=torque.error, slipped=turns,
        slips_from=since, stalled=_stalled(event, when, torque.lag),
    )  # fmt: skip


def machine_in_time(event: MotorEvent) -> tuple[Motor, MachineInTime]:
    """The motor of an event as the loop with events takes it.

    Parameters
    ----------
    event : MotorEvent
        The event. [mixed]

    Returns
    -------
    Motor, MachineInTime
        One without curves, and its fluxes. [SI, pu]
    """
    machine, state = event.machine, event.state
    nothing = TorqueCurve(np.zeros(1), np.zeros((1, 4)))
    motor = Motor(
        event.station, nothing, nothing, machine.synchronous_speed, machine.pole_pairs, -2.0 * state.angle
    )  # fmt: skip
    return motor, MachineInTime(
        machine, event.supplies, state.flux, state.field_voltage, poles=event.poles,
        sources=(machine.source,),
    )  # fmt: skip


def _slip(event: MotorEvent, time: Floats, lag: Floats) -> tuple[int, float]:
    """Turns of the rotor against a line with voltage since its last change, in electrical angle, and when half one is done.

    An induction motor has no step to lose.
    """
    if event.supplies[-1].forward[0] == 0.0 or event.machine.circuit.field is None:
        return 0, math.inf
    since = time >= event.last_change
    turned = np.abs(lag[since] - lag[since][:1])
    beyond = time[since][turned > math.pi]
    turns = round(float(turned[-1]) / (2.0 * math.pi)) if len(turned) else 0
    return turns, float(beyond[0]) if len(beyond) else math.inf


def _stalled(event: MotorEvent, time: Floats, lag: Floats) -> float | None:
    """Mean slip of an induction motor over the last part of an event, if its line no longer carries its load there."""
    machine, voltage = event.machine, event.supplies[-1].forward[0]
    if machine.circuit.field is not None or voltage == 0.0:
        return None
    late = time >= (1.0 - LAST_PART) * time[-1]
    turned, lasted = (float(a[late][-1] - a[late][0]) for a in (lag, time))
    slip = turned / (lasted * machine.line_omega)
    voltage *= machine.source.voltage
    needed = event.held / (machine.torque_base * voltage * voltage)
    return slip if stalls_at(machine.source.before(machine.circuit), slip, needed) else None


def _turning(motion: MachineMotion) -> tuple[Floats, Floats]:
    """Times and values of the turning points of the torque, also between samples, and its ends."""
    when, value = turning_points(motion.time, motion.torque, motion.torque_rate)
    ends = [0, -1]
    return np.append(when, motion.time[ends]), np.append(value, motion.torque[ends])


def _largest(when: Floats, value: Floats) -> tuple[float, float]:
    """Largest torque in magnitude, and when."""
    i = int(np.argmax(np.abs(value)))
    return float(value[i]), float(when[i])


def _closed_form(event: MotorEvent) -> float | None:
    """Largest torque of constant flux linkages: no resistance, one speed. [N m]"""
    machine, state, flux = event.machine, event.state, event.state.flux
    supply, *then = event.supplies
    if supply.axis is not None and supply.forward[0]:
        return None  # of no such formula: the axes of the stator are unlike
    if supply.axis is not None:
        system = flux_system(machine.circuit, 1.0, 0.0, 0.0, is_open=False)
        voltage, _ = residual_voltage(machine.circuit, flux)
        largest = largest_line_to_line(
            1.0 / float(system.current[0, 0]), 1.0 / float(system.current[system.q, system.q]),
            0.5 * math.pi - supply.axis,
        )  # fmt: skip
        return machine.torque_base * voltage * voltage * largest
    if supply.is_open:
        closing = replace(then[0], begins=0.0)
        if closing.ahead is None and then[0].begins > 0.0:
            return None
        _, flux = switched(machine, supply, state, flux)
        supply, flux = switched(machine, closing, state, flux)
    circuit, voltage = machine.behind(supply), machine.source.voltage
    (with_line, ahead), (against, back) = supply.forward, supply.backward
    return machine.torque_base * largest_of_constant_fluxes(
        circuit, with_same_currents(machine.circuit, circuit, flux),
        (voltage * with_line, ahead - state.angle), (voltage * against, back - state.angle),
    )  # fmt: skip
