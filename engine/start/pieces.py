"""What the pieces of distributed shafts do to the torques of a start, and how many it needs.

The same start is simulated once with the train and once with half as many pieces, at one step. The
change falls with the square of their number, so a third of it is the error; see `RICHARDSON`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS
from engine.errors import ModelError
from engine.model.modal_analysis import ModalAnalysis, analyse, in_more_pieces
from engine.model.modal_train import ModalTrain
from engine.model.subdivision import RICHARDSON
from engine.numerics.distinct import distinct
from engine.start.prescribed import run_prescribed
from engine.start.settings import has_start
from engine.start.start import Start, prepared_start
from engine.start.start_fatigue import judged_shafts, largest_damage, sn_slope
from engine.start.start_model import usual_step

#: Share of a tolerance that the pieces may take; steps and modes left out take the rest. [1]
SHARE = 0.3
#: No shaft is taken to be more accurate than this share of the worst. [1]
SHARED_ERROR = 0.3
#: Pieces are refined at most so often.
MOST_REFINEMENTS = 3
#: Tolerance of the simulations that are compared: both have nearly the same error of the step. [1]
COMPARED_AT = 1e-3


def analysis_for_start(case: CaseData) -> ModalAnalysis:
    """Natural modes of a case, with as many pieces of shafts as frequencies and the start need.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    ModalAnalysis
        With the error of the torques from the pieces; that of `analyse` where there is no start, or no
        shaft with inertia of its own. [SI]
    """
    analysis = analyse(case)
    if analysis.rough_torsional is None or not (has_start(case) or case.torque_time_from_rest):
        return analysis
    try:
        return refined(case, analysis, partial(_errors, case))
    except ModelError:  # a train that cannot start says so when it is to
        return analysis


def refined(
    case: CaseData,
    analysis: ModalAnalysis,
    errors_of: Callable[[ModalAnalysis], dict[str, float]],
) -> ModalAnalysis:
    """A train in so many pieces that they take no more than their share of the tolerances, if it may have so many.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    analysis : ModalAnalysis
        Its train, with shafts in pieces. [SI]
    errors_of : callable
        Relative errors of torques from the pieces of an analysis, by element. [1]

    Returns
    -------
    ModalAnalysis
        With these errors. [SI]
    """
    peak = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    starts = case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    wanted = SHARE * min(peak, starts / max(sn_slope(case), 1.0))
    for _ in range(MOST_REFINEMENTS):
        errors = errors_of(analysis)
        analysis = replace(analysis, pieces_error=tuple(errors.items()))
        finer = in_more_pieces(case, analysis, max(errors.values(), default=0.0), wanted)
        if finer is None:
            return analysis
        analysis = finer
    return replace(analysis, pieces_error=tuple(errors_of(analysis).items()))


def _errors(case: CaseData, analysis: ModalAnalysis) -> dict[str, float]:
    """Relative error of the torque of each element: the change from half as many pieces, and less.

    Of the highest and lowest torque and the largest range over its length, wherever they are, and not
    below a share of the worst element's, so that an accidental agreement is not taken for accuracy. Of a
    judged shaft also what would change its damage as much as the pieces do.
    """
    assert analysis.rough_torsional is not None
    fine, rough = (_simulated(case, m) for m in (analysis.torsional, analysis.rough_torsional))
    return _compared(case, fine, rough)


def pieces_errors(case: CaseData, fine: Start, rough: Start) -> dict[str, float]:
    """Relative error of the torque of each element, from responses in all pieces and in half as many.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    fine, rough : Start
        Responses to prescribed torques, at about `COMPARED_AT`. [SI]

    Returns
    -------
    dict of str to float
        By element. [1]
    """
    return _compared(case, _of_response(case, fine), _of_response(case, rough))


#: Highest and lowest torque and half the largest range [N m], and damage, of each element.
_Sizes = dict[str, tuple[Floats, float]]


def _compared(case: CaseData, fine: _Sizes, rough: _Sizes) -> dict[str, float]:
    errors = {}
    for name, (values, damage) in fine.items():
        other, other_damage = rough[name]
        size = float(np.max(np.abs(values)))
        if size > 0.0:
            errors[name] = float(np.max(np.abs(values - other))) / size / RICHARDSON
        if damage > 0.0:
            off = abs(other_damage / damage - 1.0) / max(sn_slope(case), 1.0)
            errors[name] = max(errors[name], off / RICHARDSON)
    least = SHARED_ERROR * max(errors.values(), default=0.0)
    return {name: max(error, least) for name, error in errors.items()}


def _simulated(case: CaseData, modal: ModalTrain) -> _Sizes:
    """A linear start of a case with one train or the other."""
    loose = replace(CaseData(**vars(case)), tolerance_peak=COMPARED_AT)
    if not has_start(case):
        return _of_response(case, run_prescribed(loose, modal))
    prepared = prepared_start(loose, modal)
    step = usual_step(COMPARED_AT, prepared.model.pulsation_omega)
    step = min(step, prepared.model.largest_step)
    _, run = prepared.to_its_end(step, histories=False)
    element_of = run.trajectory.output_element
    histories = {
        e: [run.turning[i][1] for i in np.flatnonzero(element_of == e)]
        for e in distinct(element_of[element_of >= 0]).tolist()
    }
    return _sizes(case, histories)


def _of_response(case: CaseData, start: Start) -> _Sizes:
    sections = start.sections
    return _sizes(
        case,
        {
            e: [fine[1] for fine, _ in sections.get(e, ())] or [turning[1]]
            for e, turning in start.turning_of_element().items()
        },
    )


def _sizes(case: CaseData, histories: Mapping[int, list[Floats]]) -> _Sizes:
    """From the torques at the turning points of each section of each element."""
    damage = {e: largest_damage(case, row, histories[e]) for e, row in judged_shafts(case)}
    return {
        str(case.elements[e].element): (
            np.array(
                [
                    max(h.max() for h in own),
                    min(h.min() for h in own),
                    0.5 * max(np.ptp(h) for h in own),
                ]
            ),
            damage.get(e, 0.0),
        )
        for e, own in histories.items()
    }


def with_pieces_error(start: Start, errors: Mapping[str, float], tolerance: float) -> Start:
    """A start whose errors cover the pieces of its shafts.

    Parameters
    ----------
    start : Start
        A start. [SI]
    errors : mapping of str to float
        By element, relative error from the pieces. [1]
    tolerance : float
        Wanted relative error of peak torques. [1]

    Returns
    -------
    Start
        The same where there are none. [SI]
    """
    if not errors:
        return start
    peaks = tuple(p.with_error(errors.get(p.element, 0.0) * p.size) for p in start.peaks)
    error = start.estimated_error + max(errors.values())
    return replace(
        start,
        peaks=peaks,
        estimated_error=error,
        met_tolerance=start.met_tolerance and error <= tolerance,
        pieces_error=tuple(errors.items()),
    )
