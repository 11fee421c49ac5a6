"""Calibration: the least change of the uncertain quantities that explains what was measured.

Uncertain are the rows of `Scatter` for stiffness, inertia and, where peak torques are measured,
damping; their spread is the prior. A blank table means every stiffness ±10 % (normal). What the
measurements then say, `engine.studies.calibration.least_squares` finds; here it is told in an engineer's words: which
quantities the measurements determine and which they cannot, which measurements no change within the
spread explains, and whether the margins may be judged as of measured frequencies.

**When `MarginBasis` becomes measured.** The paper asks for 10 % where a natural frequency "is
determined by actual measurement" and adds as much again "for calculation inaccuracies which can
easily arise in the determination of shaft stiffness, mass inertia, degree of coupling-to-shaft fit".
Those inaccuracies are what a calibration takes away, but only from the modes it reaches. So each mode
whose margin is below the 20 % of calculated ones (for the others both rules agree) must be *known*:

- measured directly to 2 % or better, or its prior variance reduced to a quarter or less by the
  measurements,
- and in either case known to a posterior standard deviation of at most 2 %: then the ten points given
  up are five standard deviations of what is still unknown;

and nothing that was measured may be left unexplained, as a model that contradicts a measurement says
nothing of the modes between; nor may a measurement fit another mode almost as well. `MarginRequired` overrules either basis, as it does everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from engine.arrays import Floats
from engine.case.case import Case
from engine.case.data import CaseData
from engine.case.study_inputs import StudyInputs, study_digest
from engine.operation.margins import SeparationMargins
from engine.operation.standards import profile_of
from engine.run import at_speed
from engine.studies.calibration.inputs import CalibrationPlan, plan_calibration
from engine.studies.calibration.least_squares import (
    GATE,
    EachStart,
    FrequencyModel,
    PeakModel,
    Reading,
    Rivals,
    Solution,
    Unknowns,
    best_assignment,
    distances,
    match_modes_by_mac,
    solution_at,
    solve,
    unknowns_of,
)
from engine.studies.calibration.optima import Posterior, exchanged, posterior_of, quantiles
from engine.studies.calibration.records import (
    CalibratedFrequency,
    CalibratedParameter,
    Calibration,
    CalibrationSolution,
    Measurement,
)
from engine.studies.scatter import NORMAL, Factor
from engine.studies.variation import nominal_value

#: Share of the prior variance that measurements take away: from here on they determine a quantity,
#: below the other they say next to nothing of it. [1]
DETERMINED, UNTOUCHED = 0.75, 0.10
#: Posterior standard deviation of a frequency that counts as known. [1]
KNOWN_FREQUENCY = 0.02
#: A residual of more standard deviations is not explained; nor is the whole below this probability.
UNEXPLAINED, IMPROBABLE = 3.0, 0.01
#: Two quantities correlated more than this are determined only together. [1]
ONLY_TOGETHER = 0.9
#: Modes that are shown beside those that are measured or decide a margin. [count]
SHOWN_MODES = 10
#: An assignment whose rival fits almost as well: difference of S, two standard deviations. [1]
AMBIGUOUS = 4.0
#: Ends of a 95 % interval. [1]
ENDS = (0.025, 0.975)
#: So near an end of its range, in widths, a change is at the end. [1]
AT_END = 0.01
#: A solution is better than another if its misfit is smaller by more. [1]
BETTER = 1e-6


# --- the calibration ------------------------------------------------------------------------------


def calibrate(
    case: CaseData,
    studies: StudyInputs,
    *,
    each_start: EachStart = map,
) -> Calibration:
    """The least change of the uncertain quantities that explains the measurements.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Its checked rows. [SI]
    each_start : callable, optional
        Does what `map` does with `maximum_torques`, perhaps in several processes.

    Returns
    -------
    Calibration
        Complete. [SI]
    """
    plan = plan_calibration(case, studies)
    unknowns = unknowns_of(plan.factors)
    highest = max((f.frequency for f in plan.frequencies), default=0.0)
    model = FrequencyModel(case, unknowns, highest)
    (solution, rivals), peaks = best_assignment(model, plan.frequencies), None
    if plan.peaks:
        peaks = PeakModel(case, unknowns, plan.peaks, each_start)
        solution = solve(model, plan.frequencies, solution.modes, peaks, solution.z)
    posterior = posterior_of(model, plan.frequencies, solution)
    best = posterior.optima[0]
    if best.misfit < solution.least - BETTER:
        taken = dict(zip(sorted(solution.modes), best.mode, strict=True))
        solution, rivals = solution_at(model, plan.frequencies, best.z, taken), {}
        if peaks is not None:
            solution = solve(model, plan.frequencies, solution.modes, peaks, best.z)
            posterior = posterior_of(model, plan.frequencies, solution)
    rivals = _other_modes(model, plan.frequencies, solution, posterior, rivals)
    estimate = _Estimate(case, plan, unknowns, model, solution, peaks, posterior)
    return estimate.result(studies, rivals)


def _other_modes(
    model: FrequencyModel,
    readings: Sequence[Reading],
    solution: Solution,
    posterior: Posterior,
    rivals: Rivals,
) -> Rivals:
    """Which other mode each reading could be, also in the other solutions."""
    found, used = dict(rivals), sorted(solution.modes)
    for optimum in posterior.optima[1:]:
        taken = dict(zip(used, optimum.mode, strict=True))
        other = solution_at(model, readings, optimum.z, taken)
        worse = optimum.misfit - posterior.optima[0].misfit
        for i, mode in solution.modes.items():
            if other.modes[i] != mode and worse < found.get(i, (None, math.inf))[1]:
                found[i] = (other.modes[i], worse)
    return found


class _Estimate:
    """A solution, told."""

    def __init__(
        self,
        case: CaseData,
        plan: CalibrationPlan,
        unknowns: Unknowns,
        model: FrequencyModel,
        solution: Solution,
        peaks: PeakModel | None,
        posterior: Posterior,
    ) -> None:
        self.case, self.plan, self.unknowns = case, plan, unknowns
        self.model, self.solution, self.peaks = model, solution, peaks
        self.covariance, self.samples = solution.covariance, posterior
        self.factor, self.own_reduction = unknowns.factor(posterior.z), solution.own_reduction
        #: Whether there are more measurements than unknowns: else no misfit can show.
        self.judged = len(solution.residual) > unknowns.number
        self.probability = _tail(solution.least, len(solution.residual))
        #: Whether some train within the spreads explains the measurements: else no sample of the
        #: posterior says anything of the machine.
        self.intervals_hold = self.probability >= IMPROBABLE
        self.prior = model.at(np.zeros(unknowns.number))
        order = match_modes_by_mac(model.base.vectors, self.prior.vectors)
        self.prior_spread = model.prior_spread(self.prior)[order]
        self.posterior = _deviation(np.log(posterior.frequency), posterior.weight)[solution.order]
        mac = (model.base.vectors.T @ solution.state.vectors) ** 2
        self.mac = mac[np.arange(len(solution.order)), solution.order]
        self.used, self.left_out = sorted(solution.modes), solution.left_out_residual

    def result(self, studies: StudyInputs, rivals: Rivals) -> Calibration:
        """The complete result."""
        solution, case = self.solution, self.case
        measurements = (*self._frequencies_measured(rivals), *self._peaks_measured())
        chi_square, degrees = solution.least, len(solution.residual)
        contradicted = not measurements or any(m.explained is False for m in measurements)
        contradicted = contradicted or not self.intervals_hold
        explained = False if contradicted else (True if self.judged else None)
        changed = self.unknowns.varied_case(case, solution.z)
        calculated = at_speed(Case(**(vars(changed) | {"margin_basis": "calculated"})))
        frequencies = self._frequencies(calculated.margins)
        doubt = self._doubt(rivals)
        justified, reason = _basis(case, frequencies, calculated.margins, not contradicted, doubt)
        calibrated = replace(changed, margin_basis="measured") if justified else changed
        before, after = at_speed(Case(**vars(case))), at_speed(Case(**vars(calibrated)))
        parameters = self._parameters()
        return Calibration(
            parameters=parameters,
            frequencies=frequencies,
            measurements=measurements,
            chi_square=chi_square,
            degrees=degrees,
            probability=self.probability,
            explained=explained,
            intervals_hold=self.intervals_hold,
            solutions=tuple(self._solutions()),
            margins_before=before.margins.rows,
            margins_after=after.margins.rows,
            basis=calibrated.margin_basis or "calculated",
            basis_justified=justified,
            basis_reason=reason,
            calibrated=calibrated,
            starts=0 if self.peaks is None else self.peaks.starts,
            sentence=" ".join(
                (
                    _sentence(parameters, measurements, explained, self.probability),
                    *self._several(explained),
                )
            ),
            notes=self.plan.notes,
            study_sha256=study_digest(
                *studies.scatter, *studies.measured_frequencies, *studies.measured_peaks
            ),
        )

    # --- parameters -------------------------------------------------------------------------------

    def _parameters(self) -> tuple[CalibratedParameter, ...]:
        """In the order of the plan."""
        place = {f: j for j, f in enumerate(self.unknowns.factors)}
        return tuple(self._parameter(place[f]) for f in self.plan.factors if f in place)

    def _parameter(self, j: int) -> CalibratedParameter:
        factor, sigma = self.unknowns.factors[j], float(self.unknowns.deviation[j])
        z, times = float(self.solution.z[j]), float(self.unknowns.factor(self.solution.z)[j])
        posterior = float(_deviation(self.factor[:, j : j + 1], self.samples.weight)[0]) / times
        reduction = min(max(1.0 - (posterior / sigma) ** 2, 0.0), 1.0)
        low, high = quantiles(self.factor[:, j], self.samples.weight, ENDS)
        single = len(factor.names) == 1
        before = nominal_value(self.case, factor.names[0], factor.quantity) if single else None
        return CalibratedParameter(
            quantity=factor.quantity,
            name=", ".join(factor.names) or "all modes",
            before=before,
            after=None if before is None else before * times,
            change=times - 1.0,
            change_low=low - 1.0,
            change_high=high - 1.0,
            prior_deviation=sigma,
            posterior_deviation=posterior,
            reduction=reduction,
            pull=z,
            determined=_determined(
                min(reduction, float(self.own_reduction[j])) if self.intervals_hold else 0.0
            ),
            note=" ".join(self._notes(j, factor, times, reduction)),
        )

    def _notes(self, j: int, factor: Factor, times: float, reduction: float) -> Iterator[str]:
        low, high = factor.ends
        if (
            factor.distribution != NORMAL
            and not AT_END < (times - low) / (high - low) < 1.0 - AT_END
        ):
            yield (
                f"The change is at the end of the range of table Scatter ({low - 1.0:+.0%} to "
                f"{high - 1.0:+.0%}): check the data, or the measurement."
            )
        elif abs(float(self.solution.z[j])) > 2.0:
            yield (
                "The change exceeds two standard deviations of table Scatter: check the data of this "
                "quantity."
            )
        if not self.intervals_hold:
            yield (
                "Not determined and without an interval, as no change within the spread explains the "
                "measurements."
            )
            return
        partner = self._partner(j)
        if partner:
            yield (
                f"Strongly correlated with {partner}: the measurements determine the two together, "
                "not separately."
            )
        if reduction < UNTOUCHED:
            yield "The measurements hardly determine it."
        elif self.own_reduction[j] < DETERMINED <= reduction:
            yield (
                "Its interval holds only if the spreads of the other quantities do: the measurements "
                "alone do not determine it."
            )

    def _solutions(self) -> Iterator[CalibrationSolution]:
        """Every quantity in every solution, where there are several."""
        optima, unknowns = self.samples.optima, self.unknowns
        if len(optima) < 2:
            return
        place = {f: j for j, f in enumerate(unknowns.factors)}
        for i, optimum in enumerate(optima):
            weight = self.samples.around(i)
            factor, note = unknowns.factor(optimum.z), self._relation(i)
            for f in self.plan.factors:
                if f not in place:
                    continue
                j = place[f]
                low, high = quantiles(self.factor[:, j], weight, ENDS)
                yield CalibrationSolution(
                    solution=i + 1,
                    misfit=optimum.misfit,
                    probability=float(weight.sum()),
                    quantity=f.quantity,
                    name=", ".join(f.names) or "all modes",
                    change=float(factor[j]) - 1.0,
                    change_low=low - 1.0,
                    change_high=high - 1.0,
                    note=note,
                )

    def _relation(self, i: int) -> str:
        """How a solution differs from the first."""
        first, other = self.samples.optima[0], self.samples.optima[i]
        if i == 0:
            return "The smallest misfit: the changes above."
        pairs = exchanged(self.model, first.z, other.z)
        if pairs:
            names = ["/".join(self.unknowns.factors[j].names) for j in range(len(first.z))]
            listed = ", ".join(f"{names[j]} and {names[k]}" for j, k in pairs)
            return (
                f"Mirror solution, with {listed} exchanged: left and right end cannot be told apart by "
                "these measurements."
            )
        if other.mode != first.mode:
            moved = [
                f"{self.plan.frequencies[r].frequency:.4g} Hz is mode {b + 1} instead of {a + 1}"
                for r, a, b in zip(self.used, first.mode, other.mode, strict=True)
                if a != b
            ]
            return f"Other modes measured: {', '.join(moved)} (numbers after calibration)."
        j = int(np.argmax(np.abs(other.z - first.z)))
        return f"Differs most in {self.unknowns.factors[j].label}."

    def _several(self, explained: bool | None) -> Iterator[str]:
        """That there are several solutions, if there are."""
        optima = self.samples.optima
        if len(optima) < 2:
            return
        shares = [float(self.samples.around(i).sum()) for i in range(len(optima))]
        do = "come about equally near" if explained is False else "explain"
        if self.intervals_hold:
            yield (
                f"{len(optima)} solutions {do} the measurements, with probabilities "
                f"{', '.join(f'{share:.0%}' for share in shares)}; intervals cover all of them."
            )
        else:
            yield (
                f"{len(optima)} solutions {do} the measurements, with misfits "
                f"{', '.join(f'{o.misfit:.1f}' for o in optima)}; none explains them."
            )
        mirrors = (self._relation(i) for i in range(1, len(optima)))
        yield from dict.fromkeys(m for m in mirrors if m.startswith("Mirror"))

    def _partner(self, j: int) -> str:
        """The quantity it is most correlated with after measuring, if strongly."""
        root = np.sqrt(np.diag(self.covariance))
        correlation = np.abs(self.covariance[j] / (root * root[j]))
        correlation[j] = 0.0
        k = int(np.argmax(correlation)) if len(correlation) else 0
        return self.unknowns.factors[k].label if correlation[k] > ONLY_TOGETHER else ""

    # --- modes ------------------------------------------------------------------------------------

    def _frequencies(self, margins: SeparationMargins) -> tuple[CalibratedFrequency, ...]:
        measured = {mode: self.plan.frequencies[i] for i, mode in self.solution.modes.items()}
        number = {int(at) + 1: mode for mode, at in enumerate(self.solution.order)}
        deciding = {
            number[r.mode] for r in margins.rows if r.margin < margins.required and r.mode in number
        }
        twists = self.model.base.modes.twists[self.model.base.modes.n_rigid :]
        first = [int(m) for m in np.flatnonzero(twists)[:SHOWN_MODES]]
        return tuple(
            self._frequency(mode, measured.get(mode))
            for mode in sorted({*first, *measured, *deciding})
        )

    def _frequency(self, mode: int, reading: Reading | None) -> CalibratedFrequency:
        at = int(self.solution.order[mode])
        prior, posterior = float(self.prior_spread[mode]), float(self.posterior[mode])
        reduction = 1.0 - (posterior / prior) ** 2 if prior > 0.0 else 0.0
        uncertainty = None if reading is None else reading.uncertainty
        known, why = _known(uncertainty, posterior, reduction)
        if not self.intervals_hold:
            how = "not measured" if reading is None else "measured"
            known, why = False, f"{how}, but not known, as the measurements are not explained"
        return CalibratedFrequency(
            mode=mode + 1,
            calibrated_mode=at + 1,
            before=float(self.model.base.frequency[mode]),
            after=float(self.solution.state.frequency[at]),
            prior_deviation=prior,
            posterior_deviation=posterior,
            measured=None if reading is None else reading.frequency,
            uncertainty=None if reading is None else reading.uncertainty,
            mac=min(float(self.mac[mode]), 1.0),
            known=known,
            why=why,
        )

    def _doubt(self, rivals: Rivals) -> str:
        """Which measurement could be of another mode as well; empty where none could."""
        doubts = [
            f"the {self.plan.frequencies[i].frequency:.4g} Hz of row "
            f"{self.plan.frequencies[i].row} may belong to mode {rival + 1} or to mode {mode + 1}"
            for i, mode in sorted(self.solution.modes.items())
            if (rival := rivals.get(i, (None, math.inf))[0]) is not None
            and rivals[i][1] < AMBIGUOUS
        ]
        return "; ".join(doubts)

    # --- measurements -----------------------------------------------------------------------------

    def _frequencies_measured(self, rivals: Rivals) -> Iterator[Measurement]:
        by_row = sorted(
            range(len(self.plan.frequencies)), key=lambda i: self.plan.frequencies[i].row
        )
        for i in by_row:
            reading = self.plan.frequencies[i]
            plain = Measurement(
                "frequency", reading.row, "", reading.frequency, reading.uncertainty
            )
            if i not in self.solution.modes:
                yield replace(plain, note=self._why_unused(reading))
                continue
            mode = self.solution.modes[i]
            row = self._compared(
                replace(plain, of=f"mode {mode + 1}"),
                float(self.model.base.frequency[mode]),
                float(self.solution.state.frequency[self.solution.order[mode]]),
                self.used.index(i),
            )
            yield replace(row, note=" ".join(self._of_a_mode(i, mode, row, rivals)))

    def _compared(self, plain: Measurement, before: float, after: float, place: int) -> Measurement:
        """A measurement beside what is calculated."""
        own = float(self.left_out[place])
        return replace(
            plain,
            before=before,
            after=after,
            residual_before=(before / plain.measured - 1.0) / plain.uncertainty,
            residual=float(self.solution.residual[place]),
            left_out_residual=own,
            used=True,
            explained=False if abs(own) > UNEXPLAINED else (True if self.judged else None),
        )

    def _of_a_mode(self, i: int, mode: int, row: Measurement, rivals: Rivals) -> Iterator[str]:
        if row.explained is False and row.left_out_residual is not None:
            yield (
                f"Not explained: {abs(row.left_out_residual):.1f} standard deviations from the value "
                "expected from the other measurements and the spread. Check its mode and its value, or "
                "widen Scatter."
            )
        at = int(self.solution.order[mode])
        if at != mode:
            yield f"After calibration this mode shape is that of mode {at + 1}."
        if self.mac[mode] < 0.5:
            yield "Its mode shape has changed strongly (MAC below 0.5): check which mode was measured."
        rival, worse = rivals.get(i, (None, math.inf))
        if worse < AMBIGUOUS and rival is not None:
            yield (
                f"It may also be mode {rival + 1}: the misfit would increase by only {worse:.1f}. "
                "State its mode, from measured phases or sensor location."
            )

    def _why_unused(self, reading: Reading) -> str:
        """The nearest mode it could have been, and what is against it."""
        base = self.model.base
        order = match_modes_by_mac(base.vectors, self.prior.vectors)
        near = distances([reading], self.prior.frequency[order], self.prior_spread)[0]
        candidates = np.flatnonzero(base.modes.twists[base.modes.n_rigid :]).tolist()
        if reading.mode is not None:
            candidates = [reading.mode]
        if not candidates:
            return "Not used: the train has no elastic mode."
        mode = int(min(candidates, key=lambda m: float(near[m])))
        calculated, off = f"{base.frequency[mode]:.4g} Hz", f"{near[mode]:.1f} standard deviations"
        if reading.mode is not None:
            return (
                f"Not used: mode {mode + 1} is calculated at {calculated}, and no change within the "
                f"spread reaches the measured value ({off}). Correct Mode or Frequency, or widen "
                "Scatter."
            )
        if near[mode] <= GATE:
            taken = next((k for k, m in self.solution.modes.items() if m == mode), None)
            if taken is None:
                return (
                    f"Not used: the nearest mode, mode {mode + 1}, is calculated at {calculated} ({off}). "
                    "The changes needed to match it together with the other measurements are less likely "
                    "than a wrong value. Check the value, state its mode, or widen Scatter."
                )
            other = self.plan.frequencies[taken]
            return (
                f"Not used: the nearest mode, mode {mode + 1} at {calculated}, is already assigned to "
                f"the {other.frequency:.4g} Hz of row {other.row}, which fits better. Delete one of "
                "them, or state its mode."
            )
        if reading.frequency > float(np.max(base.frequency)):
            return (
                f"Not used: it is above the highest mode of the model, mode {len(base.frequency)} at "
                f"{base.frequency[-1]:.4g} Hz. For higher modes give shafts a Density, or "
                "delete the row."
            )
        return (
            f"Not used: no mode can have this frequency. The nearest, mode {mode + 1}, is "
            f"calculated at {calculated}, and no change within the spread reaches it ({off}). "
            "Check that it is a torsional natural frequency, or widen Scatter of the least "
            "certain input."
        )

    def _peaks_measured(self) -> Iterator[Measurement]:
        if self.peaks is None:
            return
        base = self.peaks.of_case()
        for place in sorted(range(len(self.plan.peaks)), key=lambda i: self.plan.peaks[i].row):
            reading = self.plan.peaks[place]
            plain = Measurement(
                "peak torque", reading.row, reading.element, reading.torque, reading.uncertainty
            )
            before, after = float(base[place]), float(self.solution.torque[place])
            row = self._compared(plain, before, after, len(self.used) + place)
            if row.explained is False and row.left_out_residual is not None:
                note = (
                    f"Not explained: {abs(row.left_out_residual):.1f} standard deviations from the value "
                    "expected from the other measurements and the spread. Torque curves, voltage or "
                    "damping may differ from the case; they are calibrated only where Scatter names "
                    "damping."
                )
                row = replace(row, note=note)
            yield row


def _deviation(values: Floats, weight: Floats) -> Floats:
    """Standard deviation of each column of weighted samples."""
    mean = weight @ values
    return np.asarray(np.sqrt(weight @ (values - mean) ** 2))


def _determined(reduction: float) -> str:
    if reduction >= DETERMINED:
        return "determined"
    return "partly" if reduction >= UNTOUCHED else "not determined"


def _known(uncertainty: float | None, deviation: float, reduction: float) -> tuple[bool, str]:
    """Whether a mode counts as measured, and why; a small prior spread alone makes none known."""
    sure, measured = f"known to ±{100.0 * deviation:.2g} %", uncertainty is not None
    close = uncertainty is not None and uncertainty <= KNOWN_FREQUENCY
    how = "measured" if measured else "determined by the other measurements"
    if close or reduction >= DETERMINED:
        if deviation <= KNOWN_FREQUENCY:
            return True, f"{how}, {sure}"
        return False, f"{how}, but {sure} only"
    if uncertainty is None:
        return False, f"not measured, {sure}"
    if deviation > KNOWN_FREQUENCY:
        return False, f"measured, but {sure} only"
    return False, f"measured to ±{100.0 * uncertainty:.2g} % only; {sure} from table Scatter alone"


def _tail(chi_square: float, degrees: int) -> float:
    """Probability that χ² of so many degrees is as large by chance."""
    from scipy.special import gammaincc

    return float(gammaincc(0.5 * degrees, 0.5 * chi_square)) if degrees else 1.0


def _basis(
    case: CaseData,
    frequencies: Sequence[CalibratedFrequency],
    margins: SeparationMargins,
    consistent: bool,
    doubt: str,
) -> tuple[bool, str]:
    """Whether MarginBasis becomes measured, and why."""
    if case.margin_required is not None:
        return False, f"MarginRequired is {case.margin_required:.1%} and overrides MarginBasis."
    limit, measured = margins.required, profile_of(case).margins["measured"]
    if limit == measured:
        return False, (
            f"MarginBasis changes nothing: {profile_of(case).name} requires {limit:.0%} of calculated and of measured "
            "frequencies."
        )
    at = {f.calibrated_mode: f for f in frequencies}
    least: dict[int, float] = {}
    for row in margins.rows:
        if row.margin < limit:
            least[row.mode] = min(row.margin, least.get(row.mode, math.inf))
    stays = "MarginBasis is unchanged"
    if case.margin_basis == "measured":
        stays = "The case has MarginBasis measured, which this calibration does not confirm"
    if not consistent:
        return False, (
            f"{stays}: a measurement is not explained, so the model is not reliable for the other "
            "modes either."
        )
    if not least:
        return False, (
            f"MarginBasis is unchanged: every margin meets the {limit:.0%} required for "
            "calculated frequencies."
        )
    if doubt:
        return (
            False,
            f"{stays}: {doubt}. State its mode, from measured phases or sensor location.",
        )
    reasons = [
        f"mode {at[m].mode} ({at[m].after:.4g} Hz, margin {margin:.1%}): {at[m].why}"
        for m, margin in sorted(least.items())
    ]
    unknown = [m for m in least if not at[m].known]
    if unknown:
        which = ", ".join(str(at[m].mode) for m in sorted(unknown))
        return False, (
            f"{stays}: {'; '.join(reasons)}. A more accurate measurement is needed of mode {which} "
            f"to apply the margin of {measured:.0%}."
        )
    already = "is confirmed" if case.margin_basis == "measured" else "becomes measured"
    return True, (
        f"MarginBasis {already}: every mode with a margin below {limit:.0%} is known within "
        f"{KNOWN_FREQUENCY:.0%}, and all measurements are explained: {'; '.join(reasons)}."
    )


def _sentence(
    parameters: Sequence[CalibratedParameter],
    measurements: Sequence[Measurement],
    explained: bool | None,
    probability: float,
) -> str:
    used = [m for m in measurements if m.used]
    if not used:
        return "Nothing was calibrated: no measurement could be used. See the notes of the measurements."
    if not parameters:
        return "Nothing was calibrated: no stiffness, inertia or damping is uncertain."
    largest = max(parameters, key=lambda p: abs(p.change))
    sure = [p for p in parameters if p.determined == "determined"]
    sentences = [
        f"{len(used)} of {len(measurements)} measurement"
        f"{' is' if len(measurements) == 1 else 's are'} used.",
        f"Largest change: {largest.quantity} of {largest.name}, {largest.change:+.1%}."
        if abs(largest.change) >= 5e-4
        else "No quantity changes by 0.05 % or more.",
        f"The measurements determine {len(sure)} of {len(parameters)} uncertain quantities.",
    ]
    if explained:
        sentences.append(
            f"All measurements are explained within the spread (χ² test: {probability:.0%})."
        )
    elif probability < IMPROBABLE:
        sentences.append(
            "Not explained: a misfit this large occurs by chance only once in "
            f"{1.0 / max(probability, 1e-9):.2g} times (χ² test). So no quantity is determined, and "
            "no interval is given. See the notes of the measurements."
        )
    elif explained is False:
        sentences.append("Some measurements are not explained; see their notes.")
    if len(used) <= len(parameters):
        sentences.append(
            f"The misfit cannot be judged by itself: {len(used)} measurement{'s' * (len(used) != 1)} "
            f"cannot contradict {len(parameters)} uncertain quantit{'ies' if len(parameters) > 1 else 'y'}"
            ", only their spreads, so errors larger than their stated uncertainty may not show."
        )
    return " ".join(sentences)
