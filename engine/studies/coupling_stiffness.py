"""Which stiffness of couplings keeps every separation margin: modes alone, without response and start."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.case.study_inputs import STIFFNESS
from engine.model.excitation import excitations_of
from engine.model.modal_analysis import ModalAnalysis, analyse
from engine.operation.margins import MarginRow, SeparationMargins, separation_margins
from engine.studies.variation import Change, names_with, nominal_value, varied_case

#: Multiples of the stiffness that are tried of one coupling, and of two. [1]
FACTORS = (
    *(0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.65, 0.6, 0.55, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25),
    *(1.05, 1.1, 1.15, 1.2, 1.3, 1.4, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0),
)
FACTORS_OF_TWO = (0.25, 0.35, 0.5, 0.7, 0.85, 1.15, 1.4, 2.0, 3.0)
#: Couplings that are tried: those with most of the energy of the modes without their margin.
MOST_COUPLINGS = 4


@dataclass(frozen=True)
class ChangedStiffness:
    """A coupling with another stiffness."""

    element: str  #: The coupling.
    factor: float  #: Multiple of its stiffness. [1]
    stiffness: float  #: What it becomes. [N m/rad]


@dataclass(frozen=True)
class ChangedCouplings:
    """One or two couplings changed, and the margins of the train with them."""

    changes: tuple[ChangedStiffness, ...]  #: One or two.
    worst: MarginRow  #: The least margin. [SI]
    keeps_all: bool  #: Whether every margin is kept.


def changed_couplings(case: CaseData) -> tuple[ChangedCouplings, ...]:
    """Changes of couplings that keep every margin, the smallest first.

    One coupling at a time, the least of `FACTORS` to either side; where none does, the least change of two. Modes
    and margins are those of the changed train, by the code of a calculation.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]

    Returns
    -------
    tuple of ChangedCouplings
        Where nothing keeps every margin the one change with the largest least margin; empty where all are kept as
        typed, without excitation and without couplings. [SI]
    """
    analysis, margins = _margins(case)
    names = _couplings(case, analysis, margins)
    kept: list[ChangedCouplings] = []
    nearest: ChangedCouplings | None = None
    for changes in (*_of_one(names), *_of_two(names)):
        tried = [element for element, _ in changes]
        if kept and (len(tried) > 1 or _is_same_side(kept, changes)):
            continue
        found = _changed(case, changes)
        if found is None:
            return ()
        if found.keeps_all:
            kept.append(found)
            if len(tried) > 1:
                break
        elif nearest is None or found.worst.margin > nearest.worst.margin:
            nearest = found
    return tuple(kept) or (() if nearest is None else (nearest,))


def _of_one(names: Sequence[str]) -> Iterator[tuple[tuple[str, float], ...]]:
    every = [((name, factor),) for name in names for factor in FACTORS]
    yield from sorted(every, key=_size)


def _of_two(names: Sequence[str]) -> Iterator[tuple[tuple[str, float], ...]]:
    every = [
        tuple(zip(pair, factors, strict=True))
        for pair in combinations(names, 2)
        for factors in product(FACTORS_OF_TWO, repeat=2)
    ]
    yield from sorted(every, key=_size)


def _size(changes: tuple[tuple[str, float], ...]) -> float:
    return sum(abs(math.log(factor)) for _, factor in changes)


def _is_same_side(kept: Sequence[ChangedCouplings], changes: tuple[tuple[str, float], ...]) -> bool:
    """Whether a smaller change of the coupling to this side keeps every margin already."""
    ((element, factor),) = changes
    sides = {(c.element, c.factor > 1.0) for found in kept for c in found.changes}
    return (element, factor > 1.0) in sides


def _couplings(
    case: CaseData, analysis: ModalAnalysis, margins: SeparationMargins
) -> tuple[str, ...]:
    """Couplings with a stiffness that carry most of the energy of the modes without their margin."""
    kinds = {row.element: row.kind for row in case.elements}
    train, modes = analysis.reported.train, analysis.reported.modes
    columns = sorted({modes.n_rigid + row.mode - 1 for row in margins.not_kept})
    held = modes.strain_share[:, columns].sum(axis=1)
    shares = dict(zip(train.elements, held.tolist(), strict=True))
    names = [n for n in names_with(case, STIFFNESS) if kinds[n] == ElementKind.COUPLING]
    names.sort(key=lambda name: -shares.get(name, 0.0))
    return tuple(names[:MOST_COUPLINGS]) if columns else ()


def _changed(case: CaseData, changes: tuple[tuple[str, float], ...]) -> ChangedCouplings | None:
    changed = varied_case(case, [Change(STIFFNESS, *change) for change in changes])
    margins = _margins(changed)[1]
    if margins.worst is None:
        return None
    made = tuple(
        ChangedStiffness(element, factor, nominal_value(changed, element, STIFFNESS) or 0.0)
        for element, factor in changes
    )
    return ChangedCouplings(made, margins.worst, not margins.not_kept)


def _margins(case: CaseData) -> tuple[ModalAnalysis, SeparationMargins]:
    analysis = analyse(case)
    train, modes = analysis.reported.train, analysis.reported.modes
    reach = analysis.subdivided.accurate_up_to
    excitations = excitations_of(case, train)
    return analysis, separation_margins(case, train, modes, excitations, reach)
