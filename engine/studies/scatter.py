"""How sure a quantity is: table `Scatter` as independent factors, and samples of them.

Every row of `Scatter` becomes one or more *factors*: a number that multiplies what the case says of
one name, or of several together. A factor is distributed about 1:

============  ====================================================================================
normal        standard deviation `spread`, cut at ± 4 standard deviations so that it stays positive
uniform       from 1 − `spread` to 1 + `spread`
triangular    the same ends, most probable at 1
from-to       uniform between `from` and `to`
============  ====================================================================================

A row with a name stands in place of a row with a blank name for that name.

References
----------
McKay, Beckman and Conover, Technometrics 21 (1979) 239 (Latin hypercube); Sobol', USSR Comp. Math.
7 (1967) 86, scrambled after Owen (1995). Both are those of `scipy.stats.qmc`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.checks.find_problems import find_problems
from engine.case.checks.problem import Cells, each_row
from engine.case.data import CaseData
from engine.case.study_inputs import DAMPING_RATIO, SCATTERED, ScatterRow
from engine.errors import Problem
from engine.studies.variation import Change, names_with, refusal, varied_case

NORMAL, UNIFORM, TRIANGULAR, FROM_TO = "normal", "uniform", "triangular", "from-to"
#: What may stand under Distribution; the first is the default.
DISTRIBUTIONS = (NORMAL, UNIFORM, TRIANGULAR, FROM_TO)
EACH, TOGETHER = "each", "together"
#: How samples are drawn: Latin hypercube, scrambled Sobol sequence.
METHODS = ("lhs", "sobol")
#: A normal distribution is cut at so many standard deviations. [1]
CUT = 4.0
#: The table this module reads.
TABLE = "Scatter"


@dataclass(frozen=True)
class Factor:
    """One independent number that multiplies one quantity of one name, or of several together."""

    quantity: str  #: One of `engine.studies.variation.SCATTERED`.
    #: Elements, stations or materials it multiplies; one empty name for the damping ratio.
    names: tuple[str, ...]
    distribution: str  #: One of `DISTRIBUTIONS`.
    spread: float = 0.0  #: Standard deviation, or half width; 0 for ``from-to``. [1]
    from_: float = 1.0  #: Ends for ``from-to``; else 1. [1]
    to: float = 1.0  #: Likewise. [1]

    @property
    def label(self) -> str:
        """What scatters, in words. [text]"""
        if self.quantity == DAMPING_RATIO:
            return self.quantity
        whose = self.names[0] if len(self.names) == 1 else f"all {len(self.names)} together"
        return f"{self.quantity} of {whose}"

    @property
    def scatters(self) -> bool:
        """Whether it is anything but one number. [flag]"""
        return self.spread > 0.0 or self.from_ != self.to

    @property
    def deviation(self) -> float:
        """Standard deviation. [1]"""
        if self.distribution == NORMAL:
            from scipy.stats import truncnorm

            return self.spread * float(truncnorm.std(-CUT, CUT))
        if self.distribution == TRIANGULAR:
            return self.spread / math.sqrt(6.0)
        width = self.to - self.from_ if self.distribution == FROM_TO else 2.0 * self.spread
        return width / math.sqrt(12.0)

    def at(self, probability: Floats | float) -> Floats:
        """Inverse of the cumulative distribution.

        Parameters
        ----------
        probability : float or ndarray
            Between 0 and 1. [1]

        Returns
        -------
        ndarray
            The factor that is not exceeded with this probability. [1]
        """
        u = np.asarray(probability, dtype=float)
        if self.distribution == FROM_TO:
            return np.asarray(self.from_ + u * (self.to - self.from_))
        if self.distribution == UNIFORM:
            return np.asarray(1.0 + self.spread * (2.0 * u - 1.0))
        from scipy.stats import triang, truncnorm

        if self.distribution == TRIANGULAR:
            return np.asarray(1.0 + self.spread * (2.0 * triang.ppf(u, 0.5) - 1.0))
        return np.asarray(1.0 + self.spread * truncnorm.ppf(u, -CUT, CUT))

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest factor. [1]"""
        if self.distribution == FROM_TO:
            return self.from_, self.to
        width = self.spread * (CUT if self.distribution == NORMAL else 1.0)
        return 1.0 - width, 1.0 + width


# --- the table ------------------------------------------------------------------------------------


def scatter_problems(case: CaseData, rows: Sequence[ScatterRow]) -> list[Problem]:
    """Everything wrong with table `Scatter`.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    rows : sequence of ScatterRow
        The table. [1]

    Returns
    -------
    list of Problem
        Empty if it can be sampled.
    """
    if not rows:
        words = "Table Scatter is empty. Give at least one row with Quantity and Spread."
        return [Cells(TABLE).problem("", None, "at least one row", words)]
    problems: list[Problem] = []
    for cells, row in each_row(TABLE, rows):
        problems += [*_row_problems(case, cells, row), *_distribution_problems(cells, row)]
    problems += _repeated(rows)
    return problems or list(_end_problems(case, rows))


def _row_problems(case: CaseData, cells: Cells, row: ScatterRow) -> Iterator[Problem]:
    quantities = ", ".join(SCATTERED)
    if row.quantity is None:
        yield cells.problem(
            "Quantity", None, quantities, f"Quantity is blank; give one of {quantities}."
        )
    elif row.quantity not in SCATTERED:
        words = f"Quantity is '{row.quantity}'; choose one of {quantities}."
        yield cells.problem("Quantity", row.quantity, quantities, words)
    elif row.quantity == DAMPING_RATIO and row.name:
        words = f"the damping ratio applies to all modes, but Name is '{row.name}'. Clear Name."
        yield cells.problem("Name", row.name, "blank", words)
    elif row.name and (reason := refusal(case, row.name, row.quantity)):
        yield cells.problem("Name", row.name, "a name that has the quantity", reason)
    elif not row.name and not names_with(case, row.quantity):
        words = (
            f"the case gives no {row.quantity} to scale. Delete the row, or type a value in the "
            "case first."
        )
        yield cells.problem("Quantity", row.quantity, "a quantity that the case has", words)
    if row.together is not None and row.together not in (EACH, TOGETHER):
        words = f"Together is '{row.together}'; choose {EACH} or {TOGETHER}."
        yield cells.problem("Together", row.together, f"{EACH} or {TOGETHER}", words)


def _distribution_problems(cells: Cells, row: ScatterRow) -> Iterator[Problem]:
    """Distribution, spread and ends of one row."""
    kind = _distribution(row)
    ends = (("From", row.from_), ("To", row.to))
    if kind not in DISTRIBUTIONS:
        allowed = ", ".join(DISTRIBUTIONS)
        words = f"Distribution is '{kind}'; choose one of {allowed}."
        yield cells.problem("Distribution", kind, allowed, words)
    elif kind == FROM_TO:
        for column, value in ends:
            if value is None or not (math.isfinite(value) and value > 0.0):
                content = "blank" if value is None else _percent(value)
                words = f"{column} is {content}; from-to needs two positive factors, such as 90 % and 120 %."
                yield cells.problem(column, value, "above 0", words)
        if row.from_ is not None and row.to is not None and row.from_ > row.to > 0.0:
            words = f"To is {_percent(row.to)}, below From, {_percent(row.from_)}. Swap them."
            yield cells.problem("To", row.to, "at least From", words)
        if row.spread is not None:
            words = (
                f"Spread is {_percent(row.spread)}, but From and To are also given. Clear Spread, or "
                "choose another distribution."
            )
            yield cells.problem("Spread", row.spread, "blank with from-to", words)
    else:
        for column, value in ends:
            if value is not None:
                words = (
                    f"{column} is {_percent(value)}, but the distribution is {kind}. Clear it, or choose "
                    "from-to."
                )
                yield cells.problem(column, value, "blank unless Distribution is from-to", words)
        limit = 1.0 / CUT if kind == NORMAL else 1.0
        words = _wrong_spread(row.spread, kind, limit)
        if words:
            yield cells.problem("Spread", row.spread, f"from 0 to below {limit:g}", words)


def _wrong_spread(spread: float | None, kind: str, limit: float) -> str:
    """What is wrong with a spread; empty where nothing is."""
    if spread is None:
        return "Spread is blank; type it relative to the value in the case, such as 5 %."
    if spread < 0.0:
        return f"Spread is {_percent(spread)}; it must not be negative. Type zero or more."
    if spread < limit:
        return ""
    why = (
        f"the normal distribution is cut off at {CUT:g} standard deviations, so a spread of "
        f"{100.0 * limit:g} % or more reaches zero"
        if kind == NORMAL
        else "a spread of 100 % or more reaches zero"
    )
    return (
        f"Spread is {_percent(spread)}; {why}. Give a smaller one, or from-to with two "
        "positive factors."
    )


def _percent(share: float) -> str:
    return f"{100.0 * share:.10g} %"


def _distribution(row: ScatterRow) -> str:
    """What the row says, or what is meant where it says nothing."""
    if row.distribution is None:
        ends_only = row.spread is None and (row.from_ is not None or row.to is not None)
        return FROM_TO if ends_only else NORMAL
    return row.distribution


def _repeated(rows: Sequence[ScatterRow]) -> Iterator[Problem]:
    """Two rows for the same name and quantity."""
    first: dict[tuple[str, str], int | None] = {}
    for cells, row in each_row(TABLE, rows):
        key = (row.name or "", row.quantity or "")
        if key[1] and key in first:
            whose = f"'{row.name}'" if row.name else "a blank name"
            words = f"{row.quantity} of {whose} has a row already, row {first[key]}. Delete one of them."
            yield cells.problem("Name", row.name, "one row for each name and quantity", words)
        first.setdefault(key, cells.row)


def _end_problems(case: CaseData, rows: Sequence[ScatterRow]) -> Iterator[Problem]:
    """Rows whose least or largest factors make a case that would be refused if it were typed in."""
    for cells, (row, factors) in each_row(TABLE, _by_row(case, rows)):
        for column, at in (("From", 0.0), ("To", 1.0)):
            values = [float(factor.at(at)) for factor in factors]
            problems = find_problems(varied_case(case, changes_of(factors, values)))
            if not problems:
                continue
            from_to = _distribution(row) == FROM_TO
            yield cells.problem(
                column if from_to else "Spread",
                (row.to if at else row.from_) if from_to else row.spread,
                "what the table itself would take",
                f"multiplied by {values[0]:.6g}, its {'largest' if at else 'least'} factor, the value "
                f"is not valid: {problems[0].message} Reduce its spread.",
            )


def factors_of(case: CaseData, rows: Sequence[ScatterRow]) -> tuple[Factor, ...]:
    """The independent factors that a table stands for.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    rows : sequence of ScatterRow
        Rows without problems. [1]

    Returns
    -------
    tuple of Factor
        In the order of the rows, then of the names in their tables. [1]
    """
    return tuple(factor for _, factors in _by_row(case, rows) for factor in factors)


def _by_row(
    case: CaseData, rows: Sequence[ScatterRow]
) -> Iterator[tuple[ScatterRow, tuple[Factor, ...]]]:
    named = {(row.quantity, row.name) for row in rows if row.name}
    for row in rows:
        quantity = str(row.quantity)
        if row.name or quantity == DAMPING_RATIO:
            yield row, (_factor(row, quantity, (row.name or "",)),)
            continue
        unnamed = tuple(n for n in names_with(case, quantity) if (quantity, n) not in named)
        if row.together != TOGETHER:
            yield row, tuple(_factor(row, quantity, (name,)) for name in unnamed)
        else:
            yield row, (_factor(row, quantity, unnamed),) if unnamed else ()


def _factor(row: ScatterRow, quantity: str, names: tuple[str, ...]) -> Factor:
    kind = _distribution(row)
    if kind == FROM_TO:
        return Factor(quantity, names, kind, from_=float(row.from_ or 0.0), to=float(row.to or 0.0))
    return Factor(quantity, names, kind, spread=float(row.spread or 0.0))


def changes_of(factors: Sequence[Factor], values: Sequence[float] | Floats) -> list[Change]:
    """What one sample changes of the case.

    Parameters
    ----------
    factors : sequence of Factor
        The factors. [1]
    values : sequence of float, shape (n_factors,)
        Their values in this sample. [1]

    Returns
    -------
    list of Change
        One for each name. [1]
    """
    return [
        Change(factor.quantity, name, float(value))
        for factor, value in zip(factors, values, strict=True)
        for name in factor.names
    ]


# --- samples --------------------------------------------------------------------------------------


def sample_size(samples: int, method: str) -> int:
    """How many samples are drawn where so many are asked for.

    Parameters
    ----------
    samples : int
        Wanted. [count]
    method : str
        One of `METHODS`; a Sobol sequence is balanced at powers of two only. [word]

    Returns
    -------
    int
        The same, or the next power of two. [count]
    """
    return 1 << (samples - 1).bit_length() if method == "sobol" else samples


def sampled(factors: Sequence[Factor], samples: int, seed: int, method: str = "lhs") -> Floats:
    """Samples of all factors, made at once so that no division of the work changes them.

    Parameters
    ----------
    factors : sequence of Factor
        The factors. [1]
    samples : int
        Wanted; see `sample_size`. [count]
    seed : int
        The same seed gives the same samples. [count]
    method : str, optional
        One of `METHODS`. [word]

    Returns
    -------
    ndarray, shape (n_samples, n_factors)
        Value of each factor in each sample. [1]
    """
    from scipy.stats import qmc  # half a second that only this study pays

    n, d = sample_size(samples, method), len(factors)
    if d == 0:
        return np.ones((n, 0))
    generator = np.random.default_rng(seed)
    if method == "sobol":
        unit = qmc.Sobol(d, scramble=True, seed=generator).random(n)
    else:
        unit = qmc.LatinHypercube(d, seed=generator).random(n)
    return np.stack([factor.at(unit[:, i]) for i, factor in enumerate(factors)], axis=1)
