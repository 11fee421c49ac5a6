"""The plan: which effects a case calls for, each with the number that decided it.

Evidence is cheap: modes with and without bearings, damping, the rigid-body run-up, then the linear
start. Each effect of `engine.case.effects.EFFECTS` gets one decision with its number, the limit it was
compared with, and a bound on what leaving it out may change of the reported answers (peak torques
and allowable starts, relative). A plan is frozen: a run that finds it wrong makes a new one,
`revised_plan`, and both are recorded.

The limits are the tolerance over a *gain*, the largest relative change of an answer per unit of the
deciding number. The gains were measured on random trains calculated both ways and are taken several
times as large as the largest found (tests/properties/test_plan_properties.py, which also checks
that every bound holds).

The tolerance of a plan is that of the peaks, or that of the starts over the steepest slope of the
S-N lines if this is less: life falls with a power of the stress.

Times of effects that are off, or are part of the linear start, are estimates: shares of the wall
time of the linear start from a simple model of what each adds (modes, steps, simulated time).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from engine.case.data import CaseData
from engine.case.effects import CONTACT_LAWS, EFFECTS, EffectDecision, StartEffects
from engine.plan.evidence import NEARLY_REACHED, ElementMinimum, Evidence
from engine.start.crossings import INITIAL_SHOCK_ZONE
from engine.start.outcome import Outcome

__all__ = ["Plan", "first_plan", "revised_plan", "with_times"]

#: Relative change of an answer per unit of `Evidence.bearing_number`: largest seen 9.
BEARING_GAIN = 50.0
#: Relative change of an answer per unit of `Evidence.coupling`: largest seen 19.
COUPLING_GAIN = 50.0
#: Relative change of an answer per depth of a reversal over the largest torque: the lowest torque
#: itself is wrong by that depth; largest seen 2.
BACKLASH_GAIN = 5.0
#: Wall time of each effect over that of the linear start (docs/benchmarks.md; a start with backlash
#: takes at most ten times the linear one).
EVENT_COST, COUPLING_COST, SHOCK_COST, COAST_COST = 10.0, 0.3, 0.2, 1.0
#: Wall time of reading crossings and of counting cycles over that of the linear start.
SWEEP_COST, COUNTING_COST = 0.02, 0.5

#: What a reader of an empty table of bearing forces needs to know.
NO_FORCES = (
    "Table BearingForces stays empty while bearings are off in the start: choose on for bearings "
    "in EffectChoices to have the forces."
)


@dataclass(frozen=True)
class Plan:
    """What is simulated, and why."""

    number: int  #: 1 for the first plan of a run.
    reason: str  #: Why this plan was made.
    decisions: tuple[EffectDecision, ...]  #: One an effect, in the order of `EFFECTS`. [mixed]
    effects: StartEffects  #: What the start simulates.
    lateral: bool  #: Whether gears move sideways on their bearings in the start.
    cycle_counting: bool  #: Whether cycles are counted.
    sweep: bool  #: Whether crossings of the modes are evaluated.
    warnings: tuple[str, ...] = ()  #: Choices that go against the evidence.

    def decision(self, effect: str) -> EffectDecision:
        """The decision on one effect.

        Parameters
        ----------
        effect : str
            One of `EFFECTS`. [name]

        Returns
        -------
        EffectDecision
            Its line. [mixed]
        """
        return next(d for d in self.decisions if d.effect == effect)

    @property
    def events(self) -> bool:
        """Whether the start needs the event-driven simulation. [flag]

        Gears that move sideways do: it alone gives the forces of their bearings.
        """
        e = self.effects
        return bool(e.clearances) or e.pull_in or e.aborted_start or self.lateral


# --- plans ----------------------------------------------------------------------------------------


def first_plan(case: CaseData, evidence: Evidence) -> Plan:
    """The plan that cheap evidence calls for.

    Without a linear start in the evidence it says how to calculate that one: what depends on it
    (backlash, cycle counting) is then undecided.

    Parameters
    ----------
    case : CaseData
        The case, for the choices of its user. [SI]
    evidence : Evidence
        What is known. [SI]

    Returns
    -------
    Plan
        Number 1. [mixed]
    """
    reason = "Modes, damping and rigid-body run-up."
    if evidence.linear is not None:
        reason = "Modes, damping, rigid-body run-up and the linear start."
    return _plan(case, evidence, 1, reason, ())


def revised_plan(case: CaseData, plan: Plan, evidence: Evidence) -> Plan:
    """A new plan where a run has found the old one wrong; the same plan where it has not.

    Parameters
    ----------
    case : CaseData
        The case, for the choices of its user. [SI]
    plan : Plan
        The plan that was run. [mixed]
    evidence : Evidence
        With the start of that run as `event`. [SI]

    Returns
    -------
    Plan
        With every clearance of the old one and those whose elements reversed. [mixed]
    """
    if evidence.event is None:
        return plan
    modelled, reasons = plan.effects.clearances, []
    found = [
        m
        for m in _called_for(evidence.event.minima, evidence.tolerance)
        if m.element not in modelled
    ]
    if found and plan.decision("backlash").choice != "off":
        names = ", ".join(f"'{m.element}' ({m.lowest:.2g} of its largest torque)" for m in found)
        reasons.append(f"torque reversed where no gap was modelled: {names}")
        modelled = (*modelled, *(m.element for m in found))
    counting = plan.decision("cycle counting")
    if evidence.event.must_count and not counting.on and counting.choice == "auto":
        reasons.append("stresses rose above endurance, so cycles must be counted")
    if not reasons:
        return plan
    reason = f"In the run of plan {plan.number} " + "; ".join(reasons) + "."
    return _plan(case, evidence, plan.number + 1, reason, modelled)


def with_times(plan: Plan, times: Mapping[str, float]) -> Plan:
    """The plan with measured times of its effects in place of the estimates.

    Parameters
    ----------
    plan : Plan
        The plan that was run. [mixed]
    times : mapping of str to float
        Effect → wall time measured in this run. [s]

    Returns
    -------
    Plan
        A new record; nothing else differs. [mixed]
    """
    measured = tuple(
        replace(d, time=times[d.effect]) if d.effect in times else d for d in plan.decisions
    )
    return replace(plan, decisions=measured)


def _called_for(minima: Sequence[ElementMinimum], tolerance: float) -> list[ElementMinimum]:
    """Elements with a clearance whose torque may reverse so far that it matters."""
    return [m for m in minima if m.clearance and m.lowest < -tolerance / BACKLASH_GAIN]


@dataclass(frozen=True)
class _Finding:
    """What the evidence says of one effect, before the user's choice."""

    wanted: bool
    possible: bool  # data for it is there
    number: float | None
    limit: float | None
    bound: float | None  # while it is off
    cost: float  # wall time over that of the linear start
    why: str


def _plan(
    case: CaseData, evidence: Evidence, number: int, reason: str, kept: tuple[str, ...]
) -> Plan:
    """Findings and choices together."""
    chosen = {str(c.effect).strip().casefold(): c.choice for c in case.effect_choices if c.choice}
    wall = evidence.linear.wall_time if evidence.linear is not None else None
    decisions, warnings = [], []
    for effect, finding in _findings(case, evidence, kept, chosen):
        decision, warning = _decided(effect, chosen.get(effect) or "auto", finding, wall)
        if effect == "bearings" and finding.possible and evidence.start and not decision.on:
            decision = replace(decision, why=f"{decision.why} {NO_FORCES}")
        decisions.append(decision)
        warnings += warning
    on = {d.effect: d.on for d in decisions}
    clearances: tuple[str, ...] = ()
    if on["backlash"]:
        clearances = kept or _clearances(evidence)
        if chosen.get("backlash") == "on":
            clearances = evidence.clearances
    effects = StartEffects(
        clearances=clearances,
        breaker_closing=on["breaker closing"],
        pull_in=on["pull-in"],
        aborted_start=on["aborted start"],
        coupled_damping=on["coupled damping"],
        fast_modes=on["fast modes"],
        full_length=on["run length"],
        contact_law=case.contact_law or CONTACT_LAWS[0],
    )
    return Plan(
        number, reason, tuple(decisions), effects, on["bearings"], on["cycle counting"],
        on["resonance sweep"], tuple(warnings),
    )  # fmt: skip


def _clearances(evidence: Evidence) -> tuple[str, ...]:
    """Clearances that the linear start calls for."""
    minima = evidence.linear.minima if evidence.linear is not None else ()
    return tuple(m.element for m in _called_for(minima, evidence.tolerance))


def _decided(
    effect: str, choice: str, f: _Finding, wall: float | None
) -> tuple[EffectDecision, list[str]]:
    """A finding after the user's choice, and the warning where they disagree."""
    on = f.possible and (choice == "on" or (choice == "auto" and f.wanted))
    bound, why = f.bound, f.why
    warnings: list[str] = []
    if on:
        bound = None
    if choice == "off" and f.wanted:
        bound, why = None, f"Forced off although called for: {f.why}"
        warnings.append(f"Effect '{effect}' is forced off although it is called for: {f.why}")
    elif choice == "on" and not f.possible:
        why = f"Forced on, but there is nothing to simulate: {f.why}"
        warnings.append(f"Effect '{effect}' is forced on, but cannot be simulated: {f.why}")
    elif choice == "on" and not f.wanted:
        why = f"Forced on; the evidence says off: {f.why}"
    elif choice == "off":
        why = f"Forced off, as the evidence says: {f.why}"
    time = None if wall is None or not f.possible else f.cost * wall
    number = f.number if f.number is not None and math.isfinite(f.number) else None
    return EffectDecision(effect, choice, on, number, f.limit, bound, time, why), warnings


def _findings(
    case: CaseData, evidence: Evidence, kept: tuple[str, ...], chosen: Mapping[str, str | None]
) -> Iterator[tuple[str, _Finding]]:
    """One finding an effect, in the order of `EFFECTS`."""
    bearings = _bearings(evidence)
    choice = chosen.get("bearings")
    sideways = bearings.possible and (choice == "on" or (choice != "off" and bearings.wanted))
    found = {
        "bearings": bearings,
        "coupled damping": _coupled_damping(evidence),
        "fast modes": _fast_modes(evidence, chosen.get("fast modes") == "on"),
        "breaker closing": _breaker_closing(case, evidence),
        "pull-in": _pull_in(case, evidence),
        "aborted start": _aborted_start(case, evidence),
        "backlash": _backlash(evidence, kept, sideways),
        "resonance sweep": _sweep(evidence),
        "cycle counting": _cycle_counting(evidence),
        "run length": _run_length(evidence),
    }
    for effect in EFFECTS:
        finding = found[effect]
        if not evidence.start and effect != "bearings":
            finding = _Finding(
                False, False, None, None, 0.0, 0.0, "Neither motor curve nor prescribed torque."
            )
        yield effect, finding


def _bearings(e: Evidence) -> _Finding:
    if e.bearing_number is None:
        why = "No bearing data in Meshes: gears are held sideways."
        return _Finding(False, False, None, None, None, 0.0, why)
    number, limit = e.bearing_number, e.tolerance / BEARING_GAIN
    wanted = number > limit
    why = (
        f"{_bearing_words(number)}, {'above' if wanted else 'at most'} the limit {_percent(limit)}."
    )
    cost = max(e.n_coupled_modes / max(e.n_modes, 1) - 1.0, 0.0)
    bound = BEARING_GAIN * number
    return _Finding(wanted, True, number, limit, bound if bound < 1.0 else None, cost, why)


def _bearing_words(number: float) -> str:
    """What the bearings do to a mode, from the number that decided."""
    if math.isinf(number):
        return "Bearings damp a mode that has no damping without them"
    if number == 1.0:
        return "Bearings change a mode altogether (100 %: no mode without them is like it)"
    return f"Bearings change the frequency, shape or damping of a mode by up to {_percent(number)}"


def _percent(share: float) -> str:
    """A share in per cent with two digits, without powers of ten down to a millionth."""
    percent = 100.0 * share
    if percent == 0.0 or not 1e-4 <= abs(percent) < 1e4:
        return f"{percent:.2g} %"
    return f"{float(f'{percent:.2g}'):.10f}".rstrip("0").rstrip(".") + " %"


def _coupled_damping(e: Evidence) -> _Finding:
    number, limit = e.coupling, e.tolerance / COUPLING_GAIN
    wanted = number > limit
    if number == 0.0:
        why = "Damping couples no modes."
        return _Finding(False, True, 0.0, limit, 0.0, COUPLING_COST, why)
    why = (
        f"By coupling modes, dampers bring an estimated {number:.2g} of an element's torque, "
        f"{'above' if wanted else 'at most'} the limit {limit:.2g}."
    )
    return _Finding(wanted, True, number, limit, COUPLING_GAIN * number, COUPLING_COST, why)


def _fast_modes(e: Evidence, forced: bool) -> _Finding:
    if e.linear is None:
        why = f"Modes are kept until those left out change peaks by a tenth of {e.tolerance:.2g}."
        return _Finding(False, True, None, e.tolerance, None, 0.0, why)
    number, kept = e.linear.truncation_error, e.linear.kept_modes
    n = max(e.linear.n_modes or 0, kept)
    why = f"{kept} of {n} modes integrated; the others follow statically and add at most {number:.2g}."
    if kept == n:
        why = f"All {n} modes integrated."
    elif forced:
        why += (
            " Although all modes were asked for these are not followed: they are so fast that it "
            "would take absurdly short steps."
        )
    elif number > e.tolerance:
        why += " Following them would take absurdly short steps."
    return _Finding(False, True, number, e.tolerance, number, n / max(kept, 1) - 1.0, why)


def _breaker_closing(case: CaseData, e: Evidence) -> _Finding:
    if e.shock_share is None and case.shock_amplitude and not case.motor_torque:
        why = "No motor curve: there is no breaker to close."
        return _Finding(False, False, None, None, 0.0, SHOCK_COST, why)
    if case.shock_amplitude == 0.0:
        return _Finding(False, False, None, None, 0.0, SHOCK_COST, "ShockAmplitude is 0.")
    if e.shock_share is None:
        why = "ShockAmplitude and ShockTimeConstant are not given: nothing is known of it."
        return _Finding(False, False, None, None, None, SHOCK_COST, why)
    wanted = e.shock_share > e.tolerance
    several = len({p.station for p in case.motor_torque}) > 1
    compared = "least motor torque" if several else "motor torque"
    why = (
        f"At resonance the transient{'s' if several else ''} could bring at most "
        f"{e.shock_share:.2g} times the {compared} at standstill, "
        f"{'above' if wanted else 'at most'} the tolerance {e.tolerance:.2g}."
    )
    return _Finding(wanted, True, e.shock_share, e.tolerance, e.shock_share, SHOCK_COST, why)


def _pull_in(case: CaseData, e: Evidence) -> _Finding:
    if e.field_slip is None or case.field_slip is None:
        why = "FieldSlip and PullOutTorque are not given: the start ends without field."
        if case.field_slip is not None and case.pull_out_torque is not None:
            why = "No motor curve: there is no motor whose field could be applied."
        return _Finding(False, False, None, None, None, EVENT_COST, why)
    limit = case.field_slip
    wanted = e.field_slip <= limit + NEARLY_REACHED
    if wanted and _trips_first(case):
        why = "TripSpeed comes before the speed at which the field is applied."
        return _Finding(False, True, e.field_slip, limit, 0.0, EVENT_COST, why)
    why = (
        f"The rigid train reaches a slip of {e.field_slip:.2%}; the field is applied at "
        f"{limit:.2%}" + ("." if wanted else ", which it does not reach.")
    )
    return _Finding(wanted, True, e.field_slip, limit, 0.0, EVENT_COST, why)


def _trips_first(case: CaseData) -> bool:
    """Whether the motor trips before its field is applied."""
    synchronous = case.ratings.synchronous_speed
    off = any(c.effect == "aborted start" and c.choice == "off" for c in case.effect_choices)
    if off or not case.trip_speed or not synchronous or case.field_slip is None:
        return False
    return case.trip_speed <= (1.0 - case.field_slip) * synchronous


def _aborted_start(case: CaseData, e: Evidence) -> _Finding:
    if e.trip_share is None and case.trip_speed:
        why = "No motor curve: there is no motor that could trip."
        return _Finding(False, False, None, None, 0.0, COAST_COST, why)
    if e.trip_share is None:
        return _Finding(False, False, None, None, 0.0, COAST_COST, "TripSpeed is not given.")
    wanted = e.trip_share >= 1.0 - NEARLY_REACHED
    why = f"The rigid train reaches {e.trip_share:.3f} of the trip speed" + (
        "." if wanted else ", so there is no trip."
    )
    return _Finding(wanted, True, e.trip_share, 1.0, 0.0, COAST_COST, why)


def _backlash(e: Evidence, kept: tuple[str, ...], sideways: bool) -> _Finding:
    possible = bool(e.clearances)
    if e.linear is None:
        why = "Decided by the lowest torques of the linear start."
        return _Finding(False, possible, None, 0.0, None, EVENT_COST, why)
    minima = e.linear.minima
    if not minima:
        return _Finding(
            False, False, None, None, 0.0, EVENT_COST, "No gear mesh and no geared coupling."
        )
    worst, limit = min(minima, key=lambda m: m.lowest), -e.tolerance / BACKLASH_GAIN
    bound: float | None
    # without any gap the linear train is the answer
    depth = max((-m.lowest for m in minima if not m.tight), default=0.0)
    number, bound = worst.lowest, BACKLASH_GAIN * max(depth, 0.0)
    why = f"Lowest torque less its error: {number:.3g} of the largest, at '{worst.element}'"
    names = kept or tuple(m.element for m in _called_for(minima, e.tolerance))
    if names:
        why += f"; teeth part at {_quoted(names)}."
        return _Finding(True, possible, number, limit, None, EVENT_COST, why)
    if number >= 0.0:
        why += ": no reversal, so the linear solution holds with every clearance."
    elif number >= limit:
        why += f", not below the limit {limit:.2g}: teeth do not part for long enough to matter."
    else:
        deep = [m for m in minima if m.lowest < limit]
        tight = [m.element for m in deep if m.tight]
        blank = [m.element for m in deep if not m.tight]
        if tight and sideways:  # the back flank pushes along a line of its own, whatever the gap
            bound = None
            why += (
                f"; the clearance given for {_quoted(tight)} is 0, so that its teeth do not part but "
                "pull along the drive flank; with gears on bearings that is not the push of the "
                "back flank: give a small clearance"
            )
        elif tight:
            why += (
                f"; the clearance given for {_quoted(tight)} is 0, so that without a gap the linear "
                "solution holds there"
            )
        if blank:
            bound = None
            why += (
                f"; no clearance is given for {_quoted(blank)}: fill Backlash (or Angular backlash)"
                " and a mesh stiffness to model it"
            )
        why += "."
    return _Finding(False, possible, number, limit, bound, EVENT_COST, why)


def _quoted(names: Iterable[str]) -> str:
    """Names in a sentence."""
    return ", ".join(f"'{name}'" for name in names)


def _sweep(e: Evidence) -> _Finding:
    if e.first_frequency is None or not e.line_frequency:
        why = "No elastic mode, or the line frequency is unknown."
        return _Finding(False, False, None, None, 0.0, SWEEP_COST, why)
    number, limit = e.first_frequency / (2.0 * e.line_frequency), 1.0 + INITIAL_SHOCK_ZONE
    wanted = number <= limit and e.runup_time is not None
    why = (
        f"The lowest mode is at {number:.3g} × (2 × line), "
        f"{'within' if number <= limit else 'above'} reach of the falling 2 × slip frequency."
    )
    return _Finding(wanted, e.runup_time is not None, number, limit, 0.0, SWEEP_COST, why)


def _cycle_counting(e: Evidence) -> _Finding:
    if not e.judged:
        why = "No shaft has stress diameter, material and S-N points."
        return _Finding(False, False, None, None, 0.0, COUNTING_COST, why)
    latest = e.event or e.linear
    if latest is None or latest.stress_ratio is None:
        why = "Decided by the stresses of the start."
        return _Finding(True, True, None, 1.0, None, COUNTING_COST, why)
    number, wanted = latest.stress_ratio, latest.must_count
    why = (
        "The largest possible stress amplitude of the linear start, with its error, is "
        f"{number:.3g} of endurance"
    )
    if wanted and number <= 1.0:
        why += ", but the material is damaged below endurance."
    else:
        why += ": cycles are counted." if wanted else ": no cycle damages."
    return _Finding(wanted, True, number, 1.0, 0.0, COUNTING_COST, why)


def _run_length(e: Evidence) -> _Finding:
    number = e.runup_time
    if number is None:
        why = "Prescribed torques are followed to their end."
        return _Finding(False, False, None, None, 0.0, 0.0, why)
    finite = number if math.isfinite(number) else None
    taken = f"needs {number:.3g} s" if finite is not None else "never reaches the end speed"
    why = f"The rigid train {taken}; the run ends when it is there or has settled"
    settled = e.linear is not None and e.linear.outcome != Outcome.REACHED
    why += "." if not settled else ", and cycles counted are those until then."
    if not settled:
        why += " Forced on it changes nothing in a start that reaches its end speed."
    cost = max(e.longest_time / e.linear.time - 1.0, 0.0) if e.linear and e.linear.time else 0.0
    return _Finding(False, True, finite, e.longest_time, None if settled else 0.0, cost, why)
