"""What a sample says of an answer: percentiles, shares and drivers, each with its sampling error.

Percentiles have intervals from order statistics, shares those of Clopper and Pearson: nothing is
assumed of how the answer is distributed, and infinite values (unlimited starts) keep their place.

References
----------
Conover, Practical Nonparametric Statistics (order statistics); Clopper and Pearson, Biometrika 26
(1934) 404; Iman and Conover, Technometrics 21 (1979) 499 (rank regression); Pratt (1987), the
product β·r as the part of R² that belongs to one input.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats

#: Confidence of every interval. [1]
CONFIDENCE = 0.95
#: A percentile is settled where its interval reaches no further than this from it. [1]
SETTLED = 0.10
#: Fewer samples than these bound no P10.
FEWEST_SAMPLES = 30
#: Samples that a regression needs beyond one for each factor.
SPARE_SAMPLES = 10


@dataclass(frozen=True)
class Percentile:
    """One percentile with its interval; infinite = unlimited starts."""

    probability: float  #: Which percentile. [1]
    value: float  #: It. [as the quantity]
    #: Its interval; None = more samples would be needed to bound it. [as the quantity]
    low: float | None
    high: float | None  #: Likewise. [as the quantity]


def percentile_interval(ordered: Floats, probability: float) -> Percentile:
    """A percentile and its interval from the order statistics of independent samples.

    The l-th and u-th smallest values enclose the percentile where l − 1 and u are quantiles of the
    binomial distribution; nothing is assumed of the distribution of the answer.

    Parameters
    ----------
    ordered : ndarray, shape (n,)
        Values in rising order; may end in infinite ones. [any unit]
    probability : float
        Which percentile. [1]

    Returns
    -------
    Percentile
        An actual value of the sample, and its interval. [as given]
    """
    from scipy.stats import binom

    n, tail = len(ordered), 0.5 * (1.0 - CONFIDENCE)
    place = min(max(math.ceil(n * probability - 1e-9), 1), n)
    low = int(binom.ppf(tail, n, probability))
    high = int(binom.ppf(1.0 - tail, n, probability)) + 1
    return Percentile(
        probability,
        float(ordered[place - 1]),
        float(ordered[low - 1]) if low >= 1 else None,
        float(ordered[high - 1]) if high <= n else None,
    )


def share_interval(met: int, of: int) -> tuple[float, float]:
    """Interval of a probability from a share of samples (Clopper and Pearson, exact).

    Parameters
    ----------
    met, of : int
        Samples that meet a demand, and all samples. [count]

    Returns
    -------
    low, high : float
        Ends of the interval. [1]
    """
    from scipy.stats import binomtest

    interval = binomtest(met, of).proportion_ci(CONFIDENCE, method="exact")
    return float(interval.low), float(interval.high)


@dataclass(frozen=True, eq=False)
class RankRegression:
    """Linear regression of the ranks of an answer on the ranks of its inputs."""

    coefficient: Floats  #: Standardized coefficients β. [1] Shape (n_inputs,).
    #: Partial rank correlation: with the part of all other inputs taken out. [1] Shape
    #: (n_inputs,).
    partial: Floats
    share: Floats  #: β·r, the part of R² of each input. [1] Shape (n_inputs,).
    explained: float  #: R², the sum of the shares. [1]


def rank_regression(inputs: Floats, answer: Floats) -> RankRegression | None:
    """What drives an answer, from a sample.

    Parameters
    ----------
    inputs : ndarray, shape (n, n_inputs)
        Inputs; one that does not vary has no part. [1]
    answer : ndarray, shape (n,)
        Answers; may be infinite. [any unit]

    Returns
    -------
    RankRegression or None
        None where there are too few samples, or nothing varies. [1]
    """
    from scipy.stats import rankdata

    n, d = inputs.shape
    varies = np.array([np.ptp(inputs[:, i]) > 0.0 for i in range(d)], dtype=np.bool_)
    if n < d + SPARE_SAMPLES or not np.any(varies) or len(np.unique(answer)) < 2:
        return None
    x = rankdata(inputs[:, varies], axis=0)
    y = rankdata(answer)
    x = (x - x.mean(axis=0)) / x.std(axis=0)
    y = (y - y.mean()) / y.std()
    own = np.linalg.lstsq(x, y, rcond=None)[0]
    simple = x.T @ y / n
    together = np.column_stack([x, y])
    inverse = np.linalg.pinv(together.T @ together / n)
    scale = np.sqrt(np.maximum(np.diag(inverse)[:-1] * inverse[-1, -1], 1e-300))

    def all_inputs(values: Floats) -> Floats:
        whole = np.zeros(d)
        whole[varies] = values
        return whole

    return RankRegression(
        all_inputs(own),
        all_inputs(-inverse[:-1, -1] / scale),
        all_inputs(own * simple),
        float(own @ simple),
    )


@dataclass(frozen=True)
class Convergence:
    """Whether a sample was large enough."""

    reached: bool  #: Whether it was.
    sentence: str  #: With the numbers that decided it.


def convergence(values: Floats, what: str, probability: float = 0.1) -> Convergence:
    """Whether a sample was large enough: by the interval of a percentile, and by its two halves.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The answer in the order of the samples; may be infinite. [any unit]
    what : str
        Its name. [words]
    probability : float, optional
        The percentile at its harmful end. [1]

    Returns
    -------
    Convergence
        Verdict and sentence. [flag]
    """
    if len(values) < FEWEST_SAMPLES:
        return Convergence(
            False, f"Not converged: only {len(values)} samples determine the {what}."
        )
    whole = percentile_interval(np.sort(values), probability)
    unbounded = math.isinf(whole.value) and whole.low is None
    if np.all(values == values[0]) and not unbounded:
        return Convergence(
            True, f"Converged: the {what} of every sample is the same, {_number(float(values[0]))}."
        )
    half = len(values) // 2
    first, second = (
        percentile_interval(np.sort(part), probability) for part in (values[:half], values[half:])
    )
    width, agree = _reach(whole), _overlap(first, second)
    reached = width <= SETTLED and agree
    interval = (
        (
            f"its {100.0 * CONFIDENCE:.0f} % interval extends up to {_percent(width)} away from "
            "this value"
        )
        if math.isfinite(width)
        else "there are too few samples to bound its interval"
    )
    return Convergence(
        reached,
        f"{'Converged' if reached else 'Not converged'}: P{100.0 * probability:.0f} of the {what} is "
        f"{_number(whole.value)}; {interval} (allowed {_percent(SETTLED)}). The two halves of "
        f"the sample give {_number(first.value)} and {_number(second.value)}, whose intervals "
        f"{'overlap' if agree else 'do not overlap'}."
        + ("" if reached else " Take four times as many samples to halve the interval."),
    )


def _reach(p: Percentile) -> float:
    """How far the interval of a percentile reaches from it, over its size."""
    if p.low is not None and p.low == p.value == p.high:
        return 0.0  # unlimited from end to end, too
    if p.low is None or p.high is None or math.isinf(p.high) or p.value == 0.0:
        return math.inf
    return max(p.high - p.value, p.value - p.low) / abs(p.value)


def _overlap(a: Percentile, b: Percentile) -> bool:
    def ends(p: Percentile) -> tuple[float, float]:
        return -math.inf if p.low is None else p.low, math.inf if p.high is None else p.high

    (low, high), (other_low, other_high) = ends(a), ends(b)
    return low <= other_high and other_low <= high


def _number(value: float) -> str:
    return "unlimited" if math.isinf(value) else f"{float(f'{value:.4g}'):,g}"


def _percent(share: float) -> str:
    return f"{float(f'{100.0 * share:.2g}'):g} %"
