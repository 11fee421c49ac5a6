"""One combination of a tuning study, calculated: what a designer compares couplings by.

A full run of the changed case, reduced to its answers. A combination that makes an impossible case
has a sentence instead of answers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from engine.case.case import Case
from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.case.result_words import Judgement
from engine.errors import CaseError, TorsionError
from engine.fatigue.shaft_strength import notch_effect
from engine.fatigue.stress import stress_of_unit_torque
from engine.model.excitation import transmitted_torque
from engine.results.results import Results, Verdict
from engine.results.verdicts import overall_verdict
from engine.run import run
from engine.start.by_turns import by_turns
from engine.start.crossings import Crossing
from engine.start.start_fatigue import is_counted
from engine.studies.tuning.options import Combination, with_options

#: Elastic modes that are kept of each combination. [count]
MODES = 10


@dataclass(frozen=True)
class KeyAnswers:
    """What one run says of a design."""

    modes: tuple[float, ...]  #: Elastic modes, `MODES` at most. [Hz]
    worst_margin: float | None  #: Least separation margin; None where none could be judged. [1]
    margin_where: str  #: Its mode and excitation.
    margin_verdict: Judgement  #: Of the check of separation margins.
    #: Modes inside the forbidden band of an excitation. [count, name]
    too_near: tuple[tuple[int, str], ...]
    outcome: str  #: How the start ended, or ``calculated`` without one.
    whole: bool  #: Whether the start came to an end that can be counted, or there is none.
    sentence: str  #: How the start ended, with its numbers.
    crossings: tuple[Crossing, ...]  #: Where 2 × slip crosses the modes. [SI]
    #: Mode whose crossing stresses the train most: by nominal stress, where none is known by
    #: torque at motor speed; None where none is crossed.
    governing_mode: int | None
    #: Nominal peak-to-peak stress of the shaft with the largest stress with SCF. [Pa]
    peak_stress: float | None
    peak_stress_scf: float | None  #: The same times SCF. [Pa]
    peak_stress_where: str  #: Its element.
    peak_torque: float | None  #: Largest torque at motor speed, a magnitude. [N m]
    peak_over_rated: float | None  #: The same over RatedTorque. [1]
    peak_torque_where: str  #: Its element.
    #: Lowest torque of a gear mesh, at its From side; of several the lowest at motor speed. [N m]
    mesh_minimum_torque: float | None
    impacts: int | None  #: Recontacts of all teeth; None where no clearance was modelled.
    #: Allowable starts of the governing shaft; None = unlimited or not judged. [1]
    starts: float | None
    unlimited: bool  #: Shafts are judged and none is damaged.
    starts_error: float | None  #: Estimated relative error of the starts. [1]
    starts_where: str  #: Governing shaft.
    #: Every check but the overall one, and that of rated torques. [rows]
    checks: tuple[Verdict, ...]
    warnings: tuple[str, ...]  #: What a reader must know beside the numbers.

    @property
    def broken(self) -> tuple[str, ...]:
        """Checks that fail; one that is made of several elements is named for each. [names]"""
        return tuple(c.check for c in self.checks if c.verdict == Judgement.FAIL)

    @property
    def verdict(self) -> str:
        """The worst of the checks, as the overall verdict of a calculation."""
        return overall_verdict(c.verdict for c in self.checks)

    @property
    def governing(self) -> Crossing | None:
        """The crossing of `governing_mode`. [SI]"""
        return next((c for c in self.crossings if c.mode == self.governing_mode), None)


@dataclass(frozen=True)
class EvaluatedCombination:
    """A combination and what became of it."""

    combination: Combination  #: What was chosen. [SI]
    answers: KeyAnswers | None  #: What the run says; None where there is no such case. [SI]
    problem: str = ""  #: Why not; empty where it was calculated.


def calculate_combinations(
    case: CaseData, combinations: Sequence[Combination]
) -> list[EvaluatedCombination]:
    """A full run of each combination; their linear starts run side by side.

    Parameters
    ----------
    case : CaseData
        The unchanged case. [SI]
    combinations : sequence of Combination
        What is chosen. [SI]

    Returns
    -------
    list of EvaluatedCombination
        KeyAnswers, or the sentence that says why there are none. [SI]
    """
    return by_turns([partial(_calculated, case, one) for one in combinations])


def _calculated(case: CaseData, combination: Combination) -> EvaluatedCombination:
    try:
        return EvaluatedCombination(
            combination, answers_of(run(Case(**vars(with_options(case, combination.options)))))
        )
    except CaseError as error:
        return EvaluatedCombination(combination, None, " ".join(_placed(p.table, p.row, p.column, p.message) for p in error.problems))  # fmt: skip
    except TorsionError as error:
        return EvaluatedCombination(combination, None, str(error))


def _placed(table: str, row: int | None, column: str, message: str) -> str:
    place = column if row is None else f"{table}, row {row}, {column}"
    return f"{place or table}: {message}"


def answers_of(results: Results) -> KeyAnswers:
    """What a designer compares, out of a complete run.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    KeyAnswers
        Plain numbers and words. [SI]
    """
    case = results.case
    ratio = case.element_speed_ratios
    worst = results.margins.worst
    stress, stress_scf, stressed = _stress(results)
    torque, torqued = _peak(results, ratio)
    rated = case.ratings.rated_torque
    meshes = {e.element for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    lowest = min(
        (r for r in results.reversals if r.element in meshes),
        key=lambda r: r.minimum_torque * ratio[r.element],
        default=None,
    )
    counted = [r.impacts for r in results.reversals if r.impacts is not None]
    starts = results.starts if results.starts is not None and results.starts.shafts else None
    whole = is_counted(results.start)
    number = starts.starts if starts is not None and whole else None
    error_of = dict(results.starts_error)
    checks = (*results.verdicts[1:], *_rated(results))
    return KeyAnswers(
        modes=tuple(float(f) for f in results.modes.elastic_frequency[:MODES]),
        worst_margin=None if worst is None else float(worst.margin),
        margin_where="" if worst is None else f"mode {worst.mode} against {worst.excitation}",
        margin_verdict=results.verdicts[1].verdict,
        too_near=tuple((r.mode, r.excitation) for r in results.margins.not_kept),
        outcome=results.outcome,
        whole=whole,
        sentence="" if results.start is None else results.start.outcome.sentence,
        crossings=results.crossings,
        governing_mode=_governing(results.crossings, ratio),
        peak_stress=stress,
        peak_stress_scf=stress_scf,
        peak_stress_where=stressed,
        peak_torque=torque,
        peak_over_rated=torque / rated if torque is not None and rated else None,
        peak_torque_where=torqued,
        mesh_minimum_torque=None if lowest is None else lowest.minimum_torque,
        impacts=sum(counted) if counted else None,
        starts=number,
        unlimited=starts is not None and whole and starts.unlimited,
        starts_error=error_of.get(starts.governing or "")
        if starts and number is not None
        else None,
        starts_where="" if starts is None or not whole else starts.governing or "",
        checks=checks,
        warnings=results.warnings,
    )


def _governing(crossings: Iterable[Crossing], ratio: Mapping[str | None, float]) -> int | None:
    """Mode of the crossing with the largest stress range, else with the largest torque range."""

    def severity(c: Crossing) -> tuple[float, float, int]:
        torque = (c.peak_to_peak_torque or 0.0) * ratio.get(c.governing_element, 1.0)
        return c.peak_to_peak_stress or 0.0, torque, -c.mode

    passed = [c for c in crossings if c.time is not None]
    return max(passed, key=severity).mode if passed else None


def _stress(results: Results) -> tuple[float | None, float | None, str]:
    """Nominal range and range with SCF of the shaft where the latter is largest."""
    if results.start is None:
        return None, None, ""
    rows = {e.element: e for e in results.case.elements}
    ranges: list[tuple[float, float, str]] = []
    for p in results.start.peaks:
        e = rows[p.element]
        if e.stress_diameter:
            nominal = p.peak_to_peak * stress_of_unit_torque(e)
            kt = notch_effect(results.case, e).concentration.value
            ranges.append((nominal * kt, nominal, p.element))
    if not ranges:
        return None, None, ""
    local, nominal, where = max(ranges, key=lambda f: f[0])
    return nominal, local, where


def _peak(results: Results, ratio: Mapping[str | None, float]) -> tuple[float | None, str]:
    """Largest torque at motor speed, and its element."""
    if results.start is None:
        return None, ""
    peak, torque = results.start.largest_peak(ratio)
    return (None, "") if peak is None else (torque, peak.element)


def _rated(results: Results) -> tuple[Verdict, ...]:
    """Torque in continuous operation against the makers' rated torque: all that it exceeds, else the worst."""
    transmitted = transmitted_torque(results.case, results.train).element.tolist()
    rows = [
        (abs(torque), e.rated_torque, str(e.element))
        for e, torque in zip(results.case.elements, transmitted, strict=True)
        if e.rated_torque and torque
    ]
    if not rows:
        return ()
    exceeded = [r for r in rows if r[0] > r[1]]
    named = exceeded or [max(rows, key=lambda r: r[0] / r[1])]
    verdict = Judgement.FAIL if exceeded else Judgement.PASS
    return tuple(Verdict("Rated torque", *r[:2], "torque", verdict, r[2]) for r in named)
