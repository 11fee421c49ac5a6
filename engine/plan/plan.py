"""The plan: which effects a case calls for, each with the number that decided it.

Evidence is cheap: modes with and without bearings, damping, the rigid-body run-up, then the linear
start. Each effect of `engine.case.effects` gets one decision with its number, the limit it was
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

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from engine.case.choices import ContactLaw
from engine.case.data import CaseData
from engine.case.effect import StartEffects
from engine.case.effects import EFFECTS, choice_of
from engine.case.effects.electrical_damping import ELECTRICAL_DAMPING
from engine.numerics.same_bits import total
from engine.plan.decision import EffectDecision, Finding, decide, percent, quoted
from engine.plan.effects import FINDINGS
from engine.plan.evidence import Evidence, reversing_minima

#: Effects whose numbers are those of the latest run.
OF_THE_RUN = ("fast modes", "cycle counting")


@dataclass(frozen=True)
class Plan:
    """What is simulated, and why."""

    number: int  #: 1 for the first plan of a run.
    reason: str  #: Why this plan was made.
    decisions: tuple[EffectDecision, ...]  #: One an effect, in the order of `EFFECTS`. [mixed]
    effects: StartEffects  #: What the start simulates.
    warnings: tuple[str, ...] = ()  #: Choices that go against the evidence.
    #: Effects that are off though the train has their data, and may change an answer.
    left_out: tuple[str, ...] = ()
    #: Estimated relative change by what is not simulated of electrical damping, where nothing bounds it. [1]
    estimate: float = 0.0

    @property
    def left_out_bound(self) -> float | None:
        """Sum of the bounds of the effects left out; None = one of them has none. [1]"""
        bounds = [self.decision(name).bound for name in self.left_out]
        known = [bound for bound in bounds if bound is not None]
        return total(known) if len(known) == len(bounds) else None

    def decision(self, effect: str) -> EffectDecision:
        """The decision on one effect, by its name in `EFFECTS`."""
        return next(d for d in self.decisions if d.effect == effect)

    @property
    def lateral(self) -> bool:
        """Whether gears move laterally on their bearings in the start. [flag]"""
        return self.decision("bearings").on

    @property
    def cycle_counting(self) -> bool:
        """Whether cycles are counted. [flag]"""
        return self.decision("cycle counting").on

    @property
    def sweep(self) -> bool:
        """Whether crossings of the modes are evaluated. [flag]"""
        return self.decision("resonance sweep").on

    @property
    def events(self) -> bool:
        """Whether the start needs the event-driven simulation. [flag]

        Gears that move laterally do: it alone gives the forces of their bearings.
        """
        return self.effects.need_events or self.lateral


#: Effects whose bound is no part of `Plan.left_out`: modes left out are in the error, what a run does not go on
#: to is not left out of it, and counting changes no torque (without it there are no starts at all).
NOT_LEFT_OUT = frozenset({"fast modes", "run length", "cycle counting"})

# --- plans ----------------------------------------------------------------------------------------


def first_plan(case: CaseData, evidence: Evidence) -> Plan:
    """The plan that cheap evidence calls for, number 1.

    Without a linear start in the evidence it says how to calculate that one: what depends on it
    (backlash, cycle counting) is then undecided.
    """
    reason = "Modes, damping and rigid-body run-up."
    if evidence.linear is not None:
        reason = "Modes, damping, rigid-body run-up and the linear start."
    return _plan(case, evidence, 1, reason, ())


def revised_plan(case: CaseData, plan: Plan, evidence: Evidence) -> Plan:
    """A new plan where a run has found the old one wrong; else the same, with stresses and modes of that run.

    The evidence holds the start of that run as `event`. A new plan has every clearance, if the old one had
    or an element with one reversed.
    """
    if evidence.event is None:
        return plan
    modelled, reasons = plan.effects.clearances, []
    minima = reversing_minima(evidence.event, evidence.tolerance)
    reversed_since = [] if modelled else minima
    if reversed_since and plan.decision("backlash").choice != "off":
        names = ", ".join(
            f"'{m.element}' ({m.lowest:.2g} of its largest torque)" for m in reversed_since
        )
        reasons.append(f"torque reversed without a modelled clearance: {names}")
        modelled = tuple(m.element for m in reversed_since)
    counting = plan.decision("cycle counting")
    if evidence.event.must_count and not counting.on and counting.choice == "auto":
        reasons.append("stresses rose above endurance, so cycles must be counted")
    if not reasons:
        decisions = tuple(
            _again(case, evidence, d, modelled) if d.effect in OF_THE_RUN else d
            for d in plan.decisions
        )
        return replace(plan, decisions=decisions)
    reason = f"In the run of plan {plan.number}: " + "; ".join(reasons) + "."
    return _plan(case, evidence, plan.number + 1, reason, modelled)


def _again(
    case: CaseData, evidence: Evidence, decision: EffectDecision, modelled: tuple[str, ...]
) -> EffectDecision:
    """The same decision by what the latest run has found."""
    finding = FINDINGS[decision.effect](case, evidence, modelled)
    latest, _ = decide(EFFECTS[decision.effect], decision.choice, finding, None)
    return replace(latest, time=decision.time)


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


def _plan(
    case: CaseData, evidence: Evidence, number: int, reason: str, modelled: tuple[str, ...]
) -> Plan:
    """Findings and choices together; `modelled` are clearances known to part, or those of the plan before."""
    wall_time = evidence.linear.wall_time if evidence.linear is not None else None
    decisions, warnings, left_out = [], [], []
    for name, effect in EFFECTS.items():
        if evidence.start or not effect.of_the_start:
            finding = FINDINGS[name](case, evidence, modelled)
        else:
            finding = Finding.impossible("Neither a motor curve nor a prescribed torque: no start.")
        decision, warning = decide(effect, choice_of(case, name), finding, wall_time)
        decisions.append(decision)
        has_data = finding.number is not None and name not in NOT_LEFT_OUT
        if has_data and not decision.on and decision.bound != 0.0:
            left_out.append(name)
        if warning:
            warnings.append(warning)
    on = {decision.effect: decision.on for decision in decisions}
    # all of them: one whose teeth only come near parting limits its damping, too, and costs no time
    clearances = evidence.clearances if on["backlash"] else ()
    flags = {effect.flag: on[name] for name, effect in EFFECTS.items() if effect.flag}
    law = case.contact_law or ContactLaw.LIMITED
    effects = StartEffects(
        clearances=clearances,
        contact_law=law,
        most_modes=evidence.most_modes,
        switch_over=evidence.start and bool(case.switch_over_speeds),
        **flags,
    )
    return Plan(
        number, reason, tuple(decisions), effects, tuple(warnings), left_out=tuple(left_out)
    )


def effects_with(plan: Plan, evidence: Evidence, names: Iterable[str]) -> StartEffects:
    """The effects of a plan and some more.

    Parameters
    ----------
    plan : Plan
        The plan. [mixed]
    evidence : Evidence
        What it was made from. [SI]
    names : iterable of str
        Effects to be on, besides those of the plan. [names]

    Returns
    -------
    StartEffects
        Bearings have no flag: they are in the train that is simulated. [flags]
    """
    on = set(names)
    flags = {flag: True for name in on if (flag := EFFECTS[name].flag)}
    clearances = evidence.clearances if "backlash" in on else plan.effects.clearances
    law = plan.effects.contact_law
    return replace(plan.effects, clearances=clearances, contact_law=law, **flags)


def with_estimate(case: CaseData, plan: Plan, change: float) -> Plan:
    """The plan with an estimate of what its start has not of electrical damping.

    Without data that is what the speed changes at which motor curves are read; with the effect on, the shift of the
    frequencies.

    Parameters
    ----------
    case : CaseData
        The case, for `TorqueFollows`. [SI]
    plan : Plan
        The plan. [mixed]
    change : float
        Largest relative change of a peak. [1]

    Returns
    -------
    Plan
        The same with its estimate, in place of a bound where the effect is off. [mixed]
    """
    other, own = ("mean", "own") if case.reads_own_speed else ("own", "mean")
    what = f"curves read at the {other} speed instead of the {own} speed change"
    if plan.effects.electrical_damping:
        what = "the frequencies that the motors give the modes (Im K), which this start has not, change"
    said = f"An estimate, measured by one more start: {what} a peak by {percent(change)}."
    decisions = tuple(
        replace(d, bound=None if d.on else change, why=f"{d.why} {said}")
        if d.effect == ELECTRICAL_DAMPING.name
        else d
        for d in plan.decisions
    )
    return replace(plan, decisions=decisions, estimate=change)


def with_measured(plan: Plan, change: float | None, on: bool) -> Plan:
    """The plan with what its effects left out change together, measured by one more start.

    Parameters
    ----------
    plan : Plan
        A plan with clearances or other events. [mixed]
    change : float or None
        Largest relative change of a peak; None = it could not be measured. [1]
    on : bool
        Whether they are simulated from now on. [flag]

    Returns
    -------
    Plan
        The same, or one more where they are on. [mixed]
    """
    if change is None:
        said = "In a start with events no bound is known."
    else:
        said = f"Measured by a start with events and all such effects together: {percent(change)}."
    decisions = tuple(
        replace(d, on=on, bound=None if on else change, why=f"{d.why} {said}")
        if d.effect in plan.left_out and d.bound is not None
        else d
        for d in plan.decisions
    )
    if not on:
        return replace(plan, decisions=decisions)
    names = quoted(plan.left_out)
    reason = f"In the run of plan {plan.number}: {names} together change a peak by {percent(change or 0.0)}."
    return replace(plan, number=plan.number + 1, reason=reason, decisions=decisions, left_out=())
