"""The forced response with its errors: pieces of distributed shafts, range of damping.

A row knows from its sweep what may be missing between frequencies. Added here: the change from half
as many pieces of shafts with inertia of their own, and the rise of torque at the low end of the range of damping.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK
from engine.case.result_words import Judgement
from engine.model.excitation import Excitation
from engine.model.modal_analysis import ModalAnalysis, in_more_pieces
from engine.model.modal_train import ModalTrain
from engine.model.modes import Modes
from engine.operation.margins import SeparationMargins
from engine.operation.steady_state import (
    SteadyState,
    SteadyStateRow,
    steady_state,
    vibratory_limit,
)

#: No element is taken to be more accurate than this share of the worst under the same excitation.
SHARED_CHANGE = 0.5
#: Rows below this share of the largest torque of the same excitation do not call for more pieces: near an
#: antiresonance a torque is small, and its relative error large, whatever the pieces.
NOTABLE = 0.1
#: Pieces are refined at most so often.
MOST_REFINEMENTS = 2


def forced_response(
    case: CaseData,
    analysis: ModalAnalysis,
    excitations: Sequence[Excitation],
    margins: SeparationMargins,
) -> SteadyState:
    """Forced response with its errors, in as many pieces of shafts as keep them within `TolerancePeak`.

    Its train may have more pieces than that of the start, which keeps every mode where teeth may part.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    analysis : ModalAnalysis
        Its train, modes and damping. [SI]
    excitations : sequence of Excitation
        What shakes it. [SI]
    margins : SeparationMargins
        Its margins. [1]

    Returns
    -------
    SteadyState
        Rows with all of their errors. [N m, Pa]
    """
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    steady = _with_errors(case, analysis, excitations, margins)
    for _ in range(MOST_REFINEMENTS if analysis.rough_reported is not None else 0):
        finer = in_more_pieces(case, analysis, _worst(steady), tolerance)
        if finer is None:
            break
        analysis = finer
        steady = _with_errors(case, analysis, excitations, margins)
    return with_damping_range(steady, case, analysis.reported, excitations, margins)


def _with_errors(
    case: CaseData,
    analysis: ModalAnalysis,
    excitations: Sequence[Excitation],
    margins: SeparationMargins,
) -> SteadyState:
    own = _at_modes(margins, analysis.reported.modes)
    steady = steady_state(case, analysis.reported, excitations, own)
    if analysis.rough_reported is None:
        return steady
    return with_response_error(steady, case, analysis.rough_reported, excitations, own)


def _at_modes(margins: SeparationMargins, modes: Modes) -> SeparationMargins:
    """Margins with the frequencies of other modes of the same train; of those that these have."""
    frequency = modes.elastic_frequency
    rows = tuple(
        replace(row, mode_frequency=float(frequency[row.mode - 1]))
        for row in margins.rows
        if row.mode <= len(frequency)
    )
    return replace(margins, rows=rows)


def _worst(steady: SteadyState) -> float:
    """Largest relative error of a notable torque; zero where none is known. [1]"""
    largest: dict[tuple[str, int | None], float] = {}
    for row in steady.rows:
        what = row.excitation, row.mode
        largest[what] = max(largest.get(what, 0.0), row.torque or 0.0)
    return max(
        (
            row.error or 0.0
            for row in steady.rows
            if (row.torque or 0.0) > NOTABLE * largest[row.excitation, row.mode]
        ),
        default=0.0,
    )


def with_response_error(
    steady: SteadyState,
    case: CaseData,
    rough: ModalTrain,
    excitations: Sequence[Excitation],
    margins: SeparationMargins,
) -> SteadyState:
    """Rows with their error from the pieces of shafts: the change from half as many.

    All of the change, three times the error at second order, since a worst section or a resonance may
    move; and not below a share of the largest of the same excitation, as two may agree by accident.

    Parameters
    ----------
    steady : SteadyState
        Response of the train. [N m, Pa]
    case : CaseData
        The case. [SI]
    rough : ModalTrain
        The train in half as many pieces; a resonance is at its own frequency. [SI]
    excitations : sequence of Excitation
        What shakes it. [SI]
    margins : SeparationMargins
        Margins of the train itself. [1]

    Returns
    -------
    SteadyState
        The same rows with their errors; None where the rough train has no such mode. [1]
    """
    of_rough = steady_state(case, rough, excitations, _at_modes(margins, rough.modes))
    torque = {(r.element, r.excitation, r.mode): r.torque for r in of_rough.rows}

    changes = [
        _change(row, torque.get((row.element, row.excitation, row.mode))) for row in steady.rows
    ]
    largest: dict[tuple[str, int | None], float] = {}
    for row, change in zip(steady.rows, changes, strict=True):
        what = row.excitation, row.mode
        largest[what] = max(largest.get(what, 0.0), change or 0.0)
    rows_with = tuple(
        replace(
            row,
            error=None
            if change is None
            else (row.error or 0.0)
            + max(change, SHARED_CHANGE * largest[row.excitation, row.mode]),
        )
        for row, change in zip(steady.rows, changes, strict=True)
    )
    return replace(steady, rows=rows_with)


def with_damping_range(
    steady: SteadyState,
    case: CaseData,
    modal: ModalTrain,
    excitations: Sequence[Excitation],
    margins: SeparationMargins,
) -> SteadyState:
    """Rows with the rise of their torque where all damping is at the low end of `damping_range`.

    Stated damping, loss factors and dampers of elements, stations and bearings, all by the same share.

    Parameters
    ----------
    steady : SteadyState
        Response at the damping that is stated. [N m, Pa]
    case : CaseData
        The case. [SI]
    modal : ModalTrain
        Its train and modes. [SI]
    excitations : sequence of Excitation
        What shakes it. [SI]
    margins : SeparationMargins
        Its margins. [1]

    Returns
    -------
    SteadyState
        The same rows; their error has the rise in it. [1]
    """
    if not case.damping_range:
        return steady
    share = 1.0 - case.damping_range
    low = replace(
        CaseData(**vars(case)),
        damping_range=None,
        damping_ratio=share * (case.damping_ratio or 0.0),
        mode_damping=tuple(
            replace(m, damping_ratio=share * (m.damping_ratio or 0.0)) for m in case.mode_damping
        ),
    )
    train = replace(
        modal.train,
        loss_factor=share * modal.train.loss_factor,
        viscous=share * modal.train.viscous,
        node_damping=share * modal.train.node_damping,
    )
    less = ModalTrain.of(low, train, modal.modes)
    of_low = steady_state(low, less, excitations, _at_modes(margins, modal.modes))
    torque = {(r.element, r.excitation, r.mode): r.torque for r in of_low.rows}
    rows = []
    for row in steady.rows:
        other = torque.get((row.element, row.excitation, row.mode))
        error = None
        if row.error is not None and row.torque and other is not None:
            error = row.error + max(other / row.torque - 1.0, 0.0)
        rows.append(row if row.torque == 0.0 else replace(row, error=error))
    return replace(steady, rows=tuple(rows))


def _change(row: SteadyStateRow, other: float | None) -> float | None:
    """Relative change of a torque; None where one of the two is not known. [1]"""
    return abs(other / row.torque - 1.0) if row.torque and other is not None else None


def only_within_error(
    steady: SteadyState, case: CaseData
) -> frozenset[tuple[str, str, int | None]]:
    """Rows that pass, but not at the unfavourable end of their error.

    Parameters
    ----------
    steady : SteadyState
        Rows with all of their errors. [N m, Pa]
    case : CaseData
        Their case. [SI]

    Returns
    -------
    frozenset of tuple
        Element, excitation and mode of each. [names, 1]
    """
    limits = {str(e.element): vibratory_limit(case, e) for e in case.elements}
    return frozenset(
        (row.element, row.excitation, row.mode)
        for row in steady.rows
        if row.verdict == Judgement.PASS
        and limits[row.element].verdict((row.torque or 0.0) * (1.0 + (row.error or 0.0)))
        != Judgement.PASS
    )
