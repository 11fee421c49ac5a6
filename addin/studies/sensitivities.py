"""Sensitivities: what one per cent of each quantity does to frequencies, peak stress and starts."""

from __future__ import annotations

from addin.contract.studies.sensitivities import SENSITIVITIES as SENSITIVITIES_SPEC
from addin.studies.study import Study, StudyResult, StudyTask
from engine.case.study_inputs import study_digest
from engine.studies.sensitivities.differences import differences
from engine.studies.sensitivities.plan import derivative_units, plan_derivatives
from engine.studies.sensitivities.sensitivities import Derivatives, gather_derivatives
from engine.studies.sensitivities.tables import derivative_rows, element_rows, frequency_rows
from engine.studies.sensitivities.tangent import tangent_of


def _calculate(task: StudyTask) -> StudyResult:
    task.tell("nominal run")
    plan = plan_derivatives(task.case)
    units = derivative_units(plan)
    parts = task.map(differences, units, lambda done: f"{done} of {len(units)} quantities")
    task.tell("tangent equations of the start")
    derivatives = gather_derivatives(plan, parts, tangent_of(plan))
    return StudyResult(
        derivatives,
        {
            "Sensitivities": derivative_rows(derivatives),
            "FrequencySensitivities": frequency_rows(derivatives),
        },
        _sentence(derivatives),
        study_digest(),
        derivatives.sentences,
        {
            "sensitivities_of_elements": element_rows(derivatives),
            "largest_difference_of_two_ways": derivatives.largest_difference,
        },
    )


def _sentence(derivatives: Derivatives) -> str:
    """What matters most, in words."""
    rows = [r for r in derivatives.rows if r.peak_ends is not None][:3]
    if not rows or derivatives.governing is None:
        return derivatives.sentences[0]
    parts = []
    for r in rows:
        whose = f"{r.quantity} of {r.of}" if r.of else r.quantity
        ends = r.starts_ends or r.peak_ends
        assert ends is not None
        parts.append(f"{whose} {100.0 * ends[1]:+.2g} %")
    answer = "allowable starts" if rows[0].starts_ends else "peak stress"
    return (
        f"Effect of + 1 % of each quantity on the {answer} of {derivatives.governing}: {'; '.join(parts)}. "
        + derivatives.sentences[1]
    )


_HELP = """\
Calculate sensitivities of frequencies, peak stress and allowable starts to each quantity.

Derivatives of the frequencies come from the modal energies; those of the start from differences
of complete starts, checked by the tangent equations of the start where it is linear.

Example: `torsionbook sensitivities train.xlsx`"""


#: The study of ``torsionbook sensitivities``.
SENSITIVITIES = Study(
    spec=SENSITIVITIES_SPEC,
    calculate=_calculate,
    help=_HELP,
)  # fmt: skip
