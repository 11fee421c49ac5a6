"""Warnings: what a reader must know beside the numbers of a run."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from engine.case.choices import ElementKind, Method, MotorKind, TimeConstantKind
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS
from engine.case.plausibility import implausible
from engine.case.result_words import Outcome
from engine.fatigue.allowable_starts import notes_on_starts
from engine.model.excitation import transmitted_torque
from engine.model.motor import motors_of
from engine.model.sections import sections_of, series_stiffness
from engine.motor.from_case import motor_time_constants, motors_without_curve
from engine.numerics.same_bits import total
from engine.operation.full_speed import full_speed
from engine.operation.plausible_train import unusual_train
from engine.results.implausible_results import (
    LOWEST_MODE,
    RUN_UP,
    implausible_results,
)
from engine.results.results import Results
from engine.start.event_results import CONFIDENCE
from engine.start.start import Start
from engine.start.start_fatigue import judged_shafts
from engine.start.worst_phase import PHASES

#: A first mode below this frequency, and a start longer than this, look like a wrong unit. [Hz, s]
LOW_FREQUENCY, LONG_START = 1.0, 60.0
#: Makers state time constants to about this; below, it does not matter which they are. [1]
NOTABLE_DIFFERENCE = 0.05


def warnings_of(results: Results) -> Iterator[str]:
    """What a reader must know beside the numbers."""
    impossible = implausible_results(results)
    yield from (one.sentence for one in impossible)
    yield from implausible(results.case)
    facts = full_speed(results.case, results.train)
    yield from unusual_train(results.case, results.train, facts)
    yield from _sections(results.case)
    yield from _motor_data(results.case)
    yield from _soft_starts(results)
    yield from results.margins.warnings
    yield from results.steady.warnings
    if not impossible:  # else it is a consequence
        yield from _low_frequency(results)
    yield from _start_warnings(results)
    yield from _inaccurate_starts(results)
    yield from _pulling_teeth(results)
    yield from _event_warnings(results)


def _sections(case: CaseData) -> Iterator[str]:
    """Inertia that sections add to the train, and typed stiffnesses that are used instead of theirs."""
    sections = sections_of(case)
    for e in case.elements:
        own = sections.get(str(e.element))
        if not own:
            continue
        if e.stiffness is not None:
            share = e.stiffness / series_stiffness(own)
            yield (
                f"The Stiffness of '{e.element}' typed in table Elements is used, {share:.3g} × that of its sections; "
                "clear it to use theirs."
            )
        ends = total(s.inertia or 0.0 for s in case.stations if s.station in (e.from_, e.to))
        added = total(s.inertia for s in own)
        if added:
            beside = f", {100.0 * added / ends:.2g} % of that of its stations" if ends else ""
            yield (
                f"The sections of '{e.element}' add their own inertia to the train{beside}: the inertias of its "
                "stations must not contain it. Table SectionResults has the numbers."
            )


def _motor_data(case: CaseData) -> Iterator[str]:
    """Which torques a start uses of a motor with a data sheet, and what they leave out."""
    calculated = motors_without_curve(case)
    for row in case.motor_data:
        if row.station not in calculated:
            yield (
                f"'{row.station}' has a torque curve and a data sheet: the start uses the curve of table "
                "MotorTorque. Table MotorCurves shows the calculated one."
            )
    yield from _time_constants(case)
    for name, motor in calculated.items():
        if (
            motor.sheet.kind != MotorKind.INDUCTION
            and max(len(motor.circuit.dampers_d), len(motor.circuit.dampers_q)) < 2
        ):
            yield (
                f"The torques of '{name}' come from one damper winding in each axis at most, which is no model of "
                "solid poles: ask the maker for measured curves, or for two dampers in each axis (MotorCircuit)."
            )


def _soft_starts(results: Results) -> Iterator[str]:
    """Where soft starters have the voltage that a start from curves reads."""
    if not results.case.soft_starts or results.start is None:
        return
    in_time = results.plans[-1].decision("motor transient").on
    for motor in motors_of(results.case, results.train):
        if motor.soft is None:
            continue
        ramp, voltage, away = motor.soft.ramp, motor.soft.voltage, motor.soft.breaks_away
        name = f"Soft starter of '{results.train.stations[motor.station]}'"
        if math.isinf(away):
            yield f"{name}: full voltage does not break the train away. Check its torque at rest and the load's."
            continue
        full = np.flatnonzero(voltage.cubic[:, 0] >= 1.0)
        ends = (
            f"the voltage is full from {100.0 * float(voltage.knots[full[0]]):.3g} % speed on"
            if len(full)
            else f"the voltage is {100.0 * float(voltage.cubic[-1, 0]):.3g} % at synchronous speed"
        )
        begins = (
            f"it breaks away {away:.3g} s after closing, at {100.0 * ramp.voltage(away):.3g} % voltage; "
            if away
            else ""
        )
        yield f"{name}, in the run-up of the rigid train: {begins}{ends}. " + (
            "The start has the voltage in time."
            if in_time
            else "The start has the voltage at that speed, and its time counts from breaking away; what this changes is not in Error."
        )


def _time_constants(case: CaseData) -> Iterator[str]:
    """Classical and measured time constants that differ by more than makers state them."""
    taken = {
        row.station: row.time_constants or TimeConstantKind.CLASSICAL for row in case.motor_data
    }
    worst: dict[str, dict[str, Any]] = {}
    for row in motor_time_constants(case):
        other = worst.setdefault(row["station"], row)
        if abs(row["difference"]) > abs(other["difference"]):
            worst[row["station"]] = row
    for name, row in worst.items():
        if abs(row["difference"]) > NOTABLE_DIFFERENCE:
            yield (
                f"{row['time_constant']} of '{name}' is {row['classical']:.4g} s by the classical relations, "
                f"{row['measured']:.4g} s as a root of the circuit. It is taken as {taken[name]}: check column Time "
                "constants of MotorData (test reports give measured ones)."
            )


def _unstable_feedback(results: Results) -> Iterator[str]:
    """A torque that rises with speed feeds a mode faster than its damping takes energy away."""
    train, modes, damping = results.train, results.modes, results.damping
    for motor in motors_of(results.case, train):
        rise = float(np.max(motor.average.cubic[:, 1])) / motor.synchronous_speed
        dof, scale = train.node_dof[motor.station], train.node_scale[motor.station]
        fed = rise * np.square(modes.shape[dof] * scale)
        grown = np.flatnonzero((fed > damping.rate) & (modes.omega > 0.0))
        if len(grown):
            mode = int(grown[0])
            yield (
                f"The average torque of '{train.stations[motor.station]}' rises with speed so "
                f"steeply that it can feed mode {mode - modes.n_rigid + 1} "
                f"({modes.frequency[mode]:.4g} Hz) with more energy than its damping dissipates: "
                "if the torque follows the speed oscillation, this mode is self-excited. Check its "
                "damping ratio."
            )


def _low_frequency(results: Results) -> Iterator[str]:
    first = results.modes.elastic_frequency[:1]
    if len(first) and LOWEST_MODE <= first[0] < LOW_FREQUENCY:
        yield (
            f"The first torsional mode at {first[0]:.3g} Hz is unusually low. Check the units of "
            "stiffnesses and inertias."
        )


def _torque_dip(results: Results, start: Start) -> Iterator[str]:
    """Why a start hangs below a speed from which its motors would carry it on."""
    runup, synchronous = start.runup, results.case.ratings.synchronous_speed
    if start.outcome.outcome != Outcome.STALLED or runup is None or synchronous is None:
        return
    carried = runup.speed[(runup.speed > (runup.equilibrium or math.inf)) & (runup.net > 0.0)]
    if len(carried):
        yield (
            f"The start hangs in a dip of the average torque: from {100.0 * float(carried[0]) / synchronous:.3g} % speed on it is "
            "above the load again. A rotor with unlike axes makes one just above half speed (Görges): check the dampers of both "
            "axes in tables MotorData and MotorCircuit, and Discharge resistance. Elsewhere check MotorTorque and LoadTorque; or "
            "start with less load."
        )


def _start_warnings(results: Results) -> Iterator[str]:
    """About the plan, the start and its fatigue."""
    case, start, starts = results.case, results.start, results.starts
    yield from results.plans[-1].warnings
    if start is None:
        yield "No motor torque curve and no prescribed torque: no start was calculated."
        return
    if start.phase is not None:
        yield (
            f"PulsationPhase is worst: peaks and damage are each the worst of {case.turns_of_phase * PHASES} phases and of those between "
            "the worst of them. All else of the start is that of "
            f"{math.degrees(start.phase):.0f} degrees, where the largest peak is."
        )
    tripped = start.outcome.outcome == Outcome.TRIPPED  # its time is that of the coast-down
    if LONG_START < start.outcome.time <= RUN_UP[1] and start.runup is not None and not tripped:
        yield (
            f"The start takes {start.outcome.time:.0f} s; most take less than {LONG_START:.0f} s. "
            "Check inertias and torques."
        )
    yield from _torque_dip(results, start)
    yield from _unstable_feedback(results)
    yield from _run_warnings(start)
    counted = {e.element for _, e in judged_shafts(case)}
    for e in case.elements:
        if e.stress_diameter and e.material and e.element not in counted:
            yield (
                f"'{e.element}' has a stress diameter, but its material '{e.material}' has no S-N "
                "points: its allowable starts were not calculated. Add S-N points."
            )
    wanted = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    if start.left_out is None and start.estimated_error <= wanted and not start.is_sensitive:
        plan = results.plans[-1]
        names = [name for name in plan.left_out if plan.decision(name).bound is None]
        off = [name for name in names if plan.decision(name).choice == "off"]
        yield (
            f"Peaks and starts are those without {', '.join(names) or 'fast modes'}, and how far that "
            "changes them is not known: they pass no check. "
            + (
                f"Take 'off' away from {', '.join(off)} in table EffectChoices."
                if off
                else "See sheet Effects and accuracy for the data that are missing."
            )
        )
    elif not start.met_tolerance:
        yield (
            f"The wanted accuracy of peak torques was not reached: estimated error "
            f"{start.estimated_error:.2g} at a step of {start.step:.3g} s." + _why_not_met(start)
        )
    if case.method == Method.NEWMARK and start.method != Method.NEWMARK:
        yield (
            "Method newmark cannot simulate clearances, field or trip: the reported start was "
            "calculated by the exponential method."
        )
    if starts is None and judged_shafts(case):
        return
    if starts is None:
        yield (
            "No shaft has stress diameter, material and S-N points: allowable starts were not "
            "calculated. Type them to have starts judged."
        )
        return
    yield from notes_on_starts(starts.shafts)
    if 1.0 < (case.starts_factor or 1.0) < math.inf:
        yield f"Allowable starts are divided by StartsFactor {case.starts_factor:g} when judged."


def _why_not_met(start: Start) -> str:
    """What kept a start from a finer step."""
    if start.is_sensitive:  # said elsewhere
        return ""
    bound = (start.left_out or 0.0) - start.estimate
    if bound > start.estimated_error:
        return f" Effects left out may change it by {bound:.2g}: force them on."
    if start.phase is not None:
        return " It holds what other phases of the pulsation may change. Type one phase to see that of a start alone."
    if not start.contacts:
        return ""
    return (
        " A finer step would need more steps than one calculation allows. Raise TolerancePeak, or "
        "check the damping of high modes that tooth impacts excite."
    )


def _inaccurate_starts(results: Results) -> Iterator[str]:
    """Allowable starts that are less accurate than wanted; of a sensitive start that is said."""
    if results.start is None or results.start.is_sensitive:
        return
    wanted = results.case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    for shaft, error in results.starts_error:
        if error is not None and error > wanted:
            yield (
                f"The wanted accuracy of allowable starts of '{shaft}' was not reached: estimated "
                f"error {100.0 * error:.2g} %, wanted {100.0 * wanted:.2g} %. Raise "
                "ToleranceStarts to accept it."
            )


def _pulling_teeth(results: Results) -> Iterator[str]:
    """Teeth without a gap on bearings: a negative torque pulls them along the drive flank."""
    case = results.case
    meshes = {e.element for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    gaps = {m.element for m in case.meshes if m.backlash}
    for r in results.reversals:
        if results.plans[-1].lateral and r.reversals and r.element in meshes - gaps:
            yield (
                f"'{r.element}': the torque falls to {float(f'{r.minimum_torque:.4g}'):,g} N m, but "
                "with Backlash blank or 0 its teeth cannot separate in the calculation: they pull on "
                "the drive flank instead of pushing on the back flank, and the bearing forces have "
                "the wrong direction. Type its Backlash in table Meshes."
            )


def _event_warnings(results: Results) -> Iterator[str]:
    """What an event in operation left open."""
    case = results.case
    wanted = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    in_start = {row.event for row in case.motor_events if row.in_start is not None}
    running = [e for e in results.events if e.name not in in_start]
    if running and not np.any(transmitted_torque(case, results.train).element):
        yield (
            "No running load is known, so events in operation begin with an untwisted train. Type Running load "
            "or LoadTorque."
        )
    for event in results.events:
        if event.note:
            yield event.note
        if event.response is None:
            continue
        yield from (f"Event '{event.name}': {words}" for words in _run_warnings(event.response))
        if event.response.estimated_error > wanted and not event.response.is_sensitive:
            yield (
                f"The wanted accuracy of the peaks of event '{event.name}' was not reached: estimated error "
                f"{event.response.estimated_error:.2g}."
            )


def _run_warnings(start: Start) -> Iterator[str]:
    """What the start itself left open."""
    if start.uncoupled_dampers:
        names = ", ".join(f"'{name}'" for name in start.uncoupled_dampers)
        yield (
            f"Damping of {names} is so high for the inertias it acts on that the start would need "
            "far too short time steps: the start neglects the coupling of modes by it. Check the "
            "damping."
        )
    if start.repeatability is not None and start.repeatability.sensitive:
        yield (
            "Sensitive: a change of the input by 1e-9 may change a peak torque by "
            f"{100.0 * start.repeatability.spread:.2g} % ({100.0 * CONFIDENCE:.0f} % interval from "
            f"{start.repeatability.runs} runs). Peaks are one sample of possible values; verdicts use "
            "the unfavourable end of the range."
        )
