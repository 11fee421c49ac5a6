"""How frequencies, peak torques and allowable starts follow each quantity of a case.

Frequencies: from the energies of the modes (`engine.model.frequency_derivatives`).

Starts: every quantity is changed by ± 0.02 % and ± 0.01 %, one at a time, all steps of the calculation
held fast. Richardson's extrapolation of the two central differences is the derivative, the difference
of the two its error. What ± 1 % really does is told beside it: a peak depends on the phase in which
the pulsation meets a mode, which a change of inertia or torque turns by more than a whole cycle per
cent, so a derivative may hold for a small part of that only. A linear start is differentiated a second, independent way, by its tangent
(`engine.studies.sensitivities.linear_start`), and the two are compared. The allowable starts follow from the turning points:
d ln q = Σ (n/N) k d ln S / q over the counted cycles, with the slope k of the S-N line at each.

Derivatives are relative: ∂ln(answer)/∂ln(quantity), the change in per cent for each per cent. A start
that is sensitive has no derivative and is not judged.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engine.case.data import CaseData, case_digest
from engine.case.study_inputs import INERTIA, STIFFNESS
from engine.model.frequency_derivatives import FrequencyDerivatives, frequency_derivatives
from engine.start.start_fatigue import judged_shafts
from engine.studies.nearby_start import (
    LINEAR,
    unit_stress,
)
from engine.studies.sensitivities.differences import Differences, differences
from engine.studies.sensitivities.plan import (
    NARROW,
    WHOLE,
    WIDE,
    DerivativePlan,
    Floats,
    Parameter,
    derivative_units,
    plan_derivatives,
)
from engine.studies.sensitivities.tangent import TangentDerivatives, tangent_of

#: The two ways agree if they differ by at most this share of the largest derivative of the answer,
#: beside the error of the differences. The differences carry the step's error in the phase, about
#: 2 % on the paper's sample; the tangent fulfils the homogeneity of torques to 1e-7 there.
AGREED = 0.03
#: A derivative whose error, or whose deviation at ± 1 %, exceeds this share of it (and `AGREED` of
#: the largest) is noted.
DOUBTFUL = 0.1
#: A deviation at ± 1 % smaller than this is not worth a note. [1]
SEEN = 1e-3
#: Modes whose derivatives are listed at least, where the train has so many. [count]
LISTED_MODES = 10
#: Words of the column Method.
ENERGIES = "energies"
BY_DIFFERENCES = "differences"
BOTH = "differences, checked by tangent"


@dataclass(frozen=True)
class DerivativeRow:
    """What one quantity does."""

    quantity: str  #: Quantity, and whose.
    of: str  #: Likewise.
    frequency: tuple[float, ...]  #: ∂ln f/∂ln of it, elastic mode by mode. [1]
    peak: float | None  #: ∂ln(peak stress of the governing element); None = not judged. [1]
    peak_error: float | None  #: Its error. [1]
    #: ∂ln(allowable starts of the governing shaft); None = unlimited or not judged. [1]
    starts: float | None
    starts_error: float | None  #: Its error. [1]
    #: Relative change of either answer at − 1 % and at + 1 %. [1]
    peak_ends: tuple[float, float] | None
    starts_ends: tuple[float, float] | None  #: Likewise. [1]
    method: str  #: ``energies``, ``differences`` or ``differences, checked by tangent``.
    note: str  #: What must be known of this row.


@dataclass(frozen=True, eq=False)
class Derivatives:
    """How the answers of a case follow its quantities."""

    case_sha256: str  #: Of the case. [hash]
    frequencies: tuple[float, ...]  #: Elastic frequencies that are differentiated. [Hz]
    energies: FrequencyDerivatives  #: Derivatives of all frequencies. [1]
    rows: tuple[DerivativeRow, ...]  #: The quantity that matters most first. [1]
    governing: str | None  #: Element whose peak, and shaft whose starts, the rows tell.
    peak: float | None  #: Largest torque of that element. [N m]
    starts: float | None  #: Its allowable starts; None = unlimited or not judged. [1]
    parameters: tuple[Parameter, ...]  #: In the order of the arrays below.
    elements: tuple[str, ...]  #: Likewise.
    shafts: tuple[str, ...]  #: Likewise.
    #: ∂ln(largest torque)/∂ln p of every element, and errors. [1] Shape (n_parameters,
    #: n_elements).
    peaks: Floats
    peak_errors: Floats  #: Likewise. [1] Shape (n_parameters, n_elements).
    #: ∂ln(starts)/∂ln p of every judged shaft, and errors. [1] Shape (n_parameters, n_shafts).
    all_starts: Floats
    starts_errors: Floats  #: Likewise. [1] Shape (n_parameters, n_shafts).
    tangent: TangentDerivatives | None  #: The second way; None where there is none. [1]
    #: Largest difference of the two ways over the largest derivative of the answer. [1]
    largest_difference: float | None
    sentences: tuple[str, ...]  #: What a reader must know.


# --- together -------------------------------------------------------------------------------------


def gather_derivatives(
    plan: DerivativePlan, found: Sequence[Differences], tangent: TangentDerivatives | None
) -> Derivatives:
    """The whole result from whatever parameters were differentiated.

    Parameters
    ----------
    plan : DerivativePlan
        The plan. [mixed]
    found : sequence of Differences
        In any order. [1]
    tangent : TangentDerivatives or None
        The second way. [1]

    Returns
    -------
    Derivatives
        Rows and arrays. [1]
    """
    case, nominal = plan.case, plan.nominal
    energies = frequency_derivatives(case, nominal.train, nominal.modes)
    by_index = {d.index: d for d in found}
    judged = judged_shafts(case)
    shape = len(plan.parameters), len(case.elements)
    peaks, peak_errors = np.zeros(shape), np.zeros(shape)
    starts, starts_errors = (np.zeros((shape[0], len(judged))) for _ in range(2))
    for i, d in by_index.items():
        peaks[i], peak_errors[i] = d.peak, d.peak_error
        starts[i], starts_errors[i] = d.starts, d.starts_error
    element, shaft = _governing(plan)
    rows = _Rows(
        plan, energies, by_index, tangent, element, shaft, peaks, peak_errors, starts, starts_errors
    )
    made = sorted(rows.all(), key=lambda r: -_weight(r))
    worst = rows.largest_difference()
    peak = None
    if element is not None and nominal.start is not None:
        name = case.elements[element].element
        peak = max(p.size for p in nominal.start.peaks if p.element == name)
    limit = None
    if shaft is not None and nominal.starts is not None:
        limit = nominal.starts.shafts[shaft].allowable_starts
    return Derivatives(
        case_digest(case),
        tuple(nominal.modes.elastic_frequency[: plan.recipe.n_modes].tolist()),
        energies,
        tuple(made),
        None if element is None else str(case.elements[element].element),
        peak,
        limit,
        plan.parameters,
        tuple(str(e.element) for e in case.elements),
        tuple(str(e.element) for _, e in judged),
        peaks,
        peak_errors,
        starts,
        starts_errors,
        tangent,
        worst,
        tuple(_sentences(plan, energies, tangent, worst, rows)),
    )


def _weight(row: DerivativeRow) -> float:
    """What rows are sorted by: what ± 1 % does to the starts, else to the peak, else frequencies."""
    ends = row.starts_ends or row.peak_ends
    if ends is not None:
        return max(abs(e) for e in ends) + 1e3
    return max((abs(f) for f in row.frequency), default=0.0)


def _governing(plan: DerivativePlan) -> tuple[int | None, int | None]:
    """Element whose peak is told, and its place among the judged shafts."""
    nominal, case = plan.nominal, plan.case
    if plan.reason or nominal.start is None:
        return None, None
    judged = [i for i, _ in judged_shafts(case)]
    names = [str(e.element) for e in case.elements]
    if nominal.starts is not None and nominal.starts.governing in names:
        element = names.index(str(nominal.starts.governing))
        return element, judged.index(element)
    largest = {p.element: p.size for p in nominal.start.peaks}
    unit = unit_stress(case)
    weight = unit if np.any(unit) else np.ones(len(unit))
    element = int(np.argmax([w * largest.get(n, 0.0) for w, n in zip(weight, names, strict=True)]))
    return element, judged.index(element) if element in judged else None


@dataclass(frozen=True, eq=False)
class _Rows:
    """Everything rows are made from."""

    plan: DerivativePlan
    energies: FrequencyDerivatives
    found: Mapping[int, Differences]
    tangent: TangentDerivatives | None
    element: int | None
    shaft: int | None
    peaks: Floats
    peak_errors: Floats
    starts: Floats
    starts_errors: Floats

    def all(self) -> Iterator[DerivativeRow]:
        n_modes = self.plan.recipe.n_modes
        still = (0.0,) * n_modes
        done = set()
        for i, (quantity, name) in enumerate(self.plan.parameters):
            own = self.energies.of(quantity, name)
            frequency = still if own is None else tuple(own[:n_modes].tolist())
            done.add((quantity, name))
            yield self._row(i, quantity, name, frequency)
        for r in self.energies.rows:
            if (r.quantity, r.name) not in done:
                yield DerivativeRow(
                    r.quantity, r.name, tuple(r.value[:n_modes].tolist()), None, None, None, None,
                    None, None, ENERGIES, "",
                )  # fmt: skip

    def _row(self, i: int, quantity: str, name: str, frequency: tuple[float, ...]) -> DerivativeRow:
        d = self.found.get(i)
        if d is None or self.element is None or d.trouble:
            return DerivativeRow(
                quantity, name, frequency, None, None, None, None, None, None,
                ENERGIES if quantity in (STIFFNESS, INERTIA) else "",
                "" if d is None else d.trouble,
            )  # fmt: skip
        starts = starts_error = None
        if self.shaft is not None and self._limited():
            starts = float(self.starts[i, self.shaft])
            starts_error = float(self.starts_errors[i, self.shaft])
        return DerivativeRow(
            quantity,
            name,
            frequency,
            float(self.peaks[i, self.element]),
            float(self.peak_errors[i, self.element]),
            starts,
            starts_error,
            _ends(d.peak_ends[:, self.element]),
            None if starts is None or self.shaft is None else _ends(d.starts_ends[:, self.shaft]),
            BY_DIFFERENCES if self.tangent is None else BOTH,
            self._note(i, d, starts),
        )

    def _limited(self) -> bool:
        """Whether the governing shaft has a number of starts."""
        nominal = self.plan.nominal.starts
        return (
            nominal is not None
            and self.shaft is not None
            and nominal.shafts[self.shaft].allowable_starts is not None
        )

    def _note(self, i: int, d: Differences, starts: float | None) -> str:
        said: list[str] = []
        answers = [("peak", self.element, self.peaks, self.peak_errors, d.peak_ends)]
        if starts is not None:
            answers.append(("starts", self.shaft, self.starts, self.starts_errors, d.starts_ends))
        for what, j, own, error, ends in answers:
            assert j is not None
            largest = float(np.max(np.abs(own[:, j])))
            doubtful = _doubtful(own, error, i, j)
            edge = 0.0 if self.tangent is None or what == "peak" else float(self.tangent.edge[j])
            if doubtful:
                why = "cycles come and go at the endurance limit, " if edge else ""
                said.append(f"The two differences of the {what} differ: {why}no one derivative.")
            straight = WHOLE * own[i, j] * np.array([-1.0, 1.0])
            bend = float(np.max(np.abs(ends[:, j] - straight)))
            if bend > max(DOUBTFUL * WHOLE * abs(own[i, j]), AGREED * WHOLE * largest, SEEN):
                said.append(
                    f"Within ± 1 % the {what} do{'es' if what == 'peak' else ''} not follow the "
                    f"derivative: {_signed(ends[0, j])} and {_signed(ends[1, j])}."
                )
            if self.tangent is not None:
                other = self.tangent.peak if what == "peak" else self.tangent.starts
                if abs(own[i, j] - other[i, j]) > allowed_difference(own, error, i, j):
                    said.append(
                        f"Per + 1 % the tangent gives {_signed(WHOLE * other[i, j])} for them."
                    )
        return " ".join(said)

    def largest_difference(self) -> float | None:
        """Largest difference of the two ways over the largest derivative of the answer."""
        if self.tangent is None or self.element is None or not self.found:
            return None
        worst = 0.0
        pairs = [(self.peaks, self.peak_errors, self.tangent.peak, self.element)]
        if self.shaft is not None and self._limited():
            pairs.append((self.starts, self.starts_errors, self.tangent.starts, self.shaft))
        for own, error, other, j in pairs:
            judged = [
                i
                for i, d in self.found.items()
                if not d.trouble and not _doubtful(own, error, i, j)
            ]
            size = float(np.max(np.abs(own[judged, j]), initial=0.0))
            if size > 0.0:
                worst = max(worst, float(np.max(np.abs(own[judged, j] - other[judged, j]))) / size)
        return worst


def _ends(logs: Floats) -> tuple[float, float]:
    """Relative changes from their logarithms."""
    return float(np.expm1(logs[0])), float(np.expm1(logs[1]))


def _signed(log: float) -> str:
    return f"{100.0 * math.expm1(log):+.2g} %"


def _doubtful(own: Floats, error: Floats, i: int, j: int) -> bool:
    """Whether the two differences of an answer are too far apart to be called a derivative."""
    largest = float(np.max(np.abs(own[:, j])))
    return bool(error[i, j] > max(DOUBTFUL * abs(own[i, j]), AGREED * largest))


def allowed_difference(own: Floats, error: Floats, i: int, j: int) -> float:
    """How far the two ways may be apart before it is noted.

    Parameters
    ----------
    own, error : ndarray, shape (n_parameters, n)
        Derivatives by differences, and their errors. [1]
    i, j : int
        Parameter and answer. [indices]

    Returns
    -------
    float
        Largest difference allowed. [1]
    """
    return AGREED * float(np.max(np.abs(own[:, j]), initial=0.0)) + float(error[i, j])


def _sentences(
    plan: DerivativePlan,
    energies: FrequencyDerivatives,
    tangent: TangentDerivatives | None,
    worst: float | None,
    rows: _Rows,
) -> Iterator[str]:
    if plan.reason:
        yield plan.reason
    else:
        yield (
            f"{len(plan.parameters)} quantities, each changed by ± {100 * WIDE:g} % and "
            f"± {100 * NARROW:g} % for its derivative, whose error is the difference of the two, and by "
            f"± {100 * WHOLE:g} % to see how far it holds."
        )
        if tangent is not None and worst is not None:
            yield (
                "The tangent of the start, a second way with another integrator, differs by at most "
                f"{100.0 * worst:.2g} % of the largest derivative where the differences tell one "
                f"(allowed {100 * AGREED:g} % beside their error; where it is more, the row says so)."
            )
        elif plan.recipe.start != LINEAR:
            yield (
                "The start has events, so its derivatives are differences of whole starts alone: "
                "where teeth meet again at another moment their errors are large."
            )
        else:
            yield "There is no tangent to check with: modes mix, or change places, too near."
    yield from energies.notes
    own = float(np.max(energies.unnamed, initial=0.0))
    if own > 1e-6:
        yield (
            f"Up to {100.0 * own:.2g} % of the kinetic energy of a mode is in the shafts' own "
            "inertia, which follows from their geometry and has no row."
        )


# --- all in one process; rows ---------------------------------------------------------------------


def derivatives(
    case: CaseData,
    *,
    on_progress: Callable[[int, int], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> Derivatives:
    """Differentiate everything in this process.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    on_progress : callable, optional
        Called with the parameters done and the parameters in all. [count]
    should_stop : callable, optional
        Asked between parameters; True ends the study with what is known so far. [flag]

    Returns
    -------
    Derivatives
        The result. [1]

    Raises
    ------
    ModelError
        If the train cannot be calculated.
    """
    plan = plan_derivatives(case)
    units = derivative_units(plan)
    results = []
    for unit in units:
        if should_stop is not None and should_stop():
            break
        results.append(differences(unit))
        if on_progress is not None:
            on_progress(len(results), len(units))
    return gather_derivatives(
        plan, results, tangent_of(plan) if len(results) == len(units) else None
    )
