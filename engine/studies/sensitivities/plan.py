"""What is changed to learn the sensitivities: one unit of work for each input."""

from __future__ import annotations

from dataclasses import dataclass, replace

from engine.case.data import CaseData
from engine.case.study_inputs import SCATTERED
from engine.results.results import Results
from engine.run import run
from engine.start.start import PreparedStart, prepared_start
from engine.start.start_fatigue import is_counted
from engine.studies.nearby_start import (
    LINEAR,
    NO_START,
    FixedDiscretisation,
    NearbyStartPlan,
    near_train,
    recipe_of,
)
from engine.studies.variation import names_with

Parameter = tuple[str, str]

#: Changes of a quantity of which the derivative is taken, in proportion: the wide pair, the narrow
#: one. They are small, because the phase in which the pulsation meets a mode turns by some hundred
#: times as many radians.
WIDE, NARROW = 2e-4, 1e-4
#: The change whose effect is given beside the derivative, since a peak may swing within it. [1]
WHOLE = 0.01


@dataclass(frozen=True, eq=False)
class DerivativePlan:
    """What will be differentiated."""

    case: CaseData  #: The case. [SI]
    nominal: Results  #: Its nominal run. [SI]
    recipe: NearbyStartPlan  #: How changed trains are calculated. [mixed]
    parameters: tuple[Parameter, ...]  #: Quantity and name of each.
    reason: str  #: Why no start is differentiated; empty where one is.


@dataclass(frozen=True)
class DerivativeUnit:
    """One parameter to be differentiated by."""

    case: CaseData  #: The case. [SI]
    recipe: NearbyStartPlan  #: How changed trains are calculated. [mixed]
    index: int  #: Place in the plan.
    parameter: Parameter  #: Quantity and name.


# --- the plan -------------------------------------------------------------------------------------


def plan_derivatives(case: CaseData, *, nominal: Results | None = None) -> DerivativePlan:
    """What of a case can be differentiated, and how its changed trains are calculated.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    nominal : Results, optional
        Its nominal run; calculated if not at hand. [SI]

    Returns
    -------
    DerivativePlan
        Every quantity of the case that has a number. [mixed]

    Raises
    ------
    ModelError
        If the train cannot be calculated.
    """
    nominal = nominal or run(case)
    recipe = recipe_of(case, nominal)
    if recipe.start == LINEAR:
        assert nominal.start is not None
        prepared, _ = prepared_nearby_start(case, recipe).to_its_end(nominal.start.step)
        held = FixedDiscretisation(
            prepared.model.windows, tuple(prepared.model.keep.tolist()), prepared.maximum_time
        )
        # half the step of the nominal run: derivatives carry its error in the phase many times over
        recipe = replace(recipe, step=0.5 * nominal.start.step, held=held)
    parameters = tuple((q, name) for q in SCATTERED for name in names_with(case, q))
    return DerivativePlan(case, nominal, recipe, parameters, _why_no_start(nominal, recipe))


def prepared_nearby_start(case: CaseData, recipe: NearbyStartPlan) -> PreparedStart:
    """The linear start of a nearby train, ready to be run.

    Parameters
    ----------
    case : CaseData
        The case of that train. [SI]
    recipe : NearbyStartPlan
        What the nominal run fixes for nearby trains. [SI]

    Returns
    -------
    PreparedStart
        With its modes. [SI]
    """
    model = near_train(case, recipe).model
    return prepared_start(case, model, recipe.effects)


def _why_no_start(nominal: Results, recipe: NearbyStartPlan) -> str:
    if recipe.start == NO_START or nominal.start is None:
        return (
            "No motor torque curve and no prescribed torque: frequencies alone are differentiated."
        )
    if nominal.start.is_sensitive:
        return (
            "The start is sensitive: a change of its input by 1e-9 changes its peaks, so they "
            "have no derivative. Only frequencies are differentiated."
        )
    if not is_counted(nominal.start):
        return (
            f"The start ended as '{nominal.start.outcome.outcome}' and is incomplete; its peaks "
            "are not differentiated."
        )
    return ""


def derivative_units(plan: DerivativePlan) -> tuple[DerivativeUnit, ...]:
    """The work in pieces, one a parameter.

    Parameters
    ----------
    plan : DerivativePlan
        The plan. [mixed]

    Returns
    -------
    tuple of DerivativeUnit
        Empty where no start is differentiated. [mixed]
    """
    if plan.reason:
        return ()
    return tuple(
        DerivativeUnit(plan.case, plan.recipe, i, p) for i, p in enumerate(plan.parameters)
    )
