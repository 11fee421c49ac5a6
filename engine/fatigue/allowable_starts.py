"""Stress history → cycles → damage → permitted starts.

==================  ============================================================================
stress              torque over the section modulus, `shear_stress`
S-N line            `SNCurve`, `sn_curve_for`: log-log through points, endurance, bending halved
counting            `count_cycles` (rainflow), `paper_count` (cycle by cycle, Figure 3)
damage              `miner_damage`, `damage_interval`, `starts_from_damage`
one shaft, a train  `shaft_fatigue`, `allowable_starts`
==================  ============================================================================

SI: torque in N m, stress in Pa, diameters in m. A stress amplitude is half a range; the mean
stress is ignored. Torques are actual, at the shaft's own speed.

"The paper" is Szenasi and von Nimitz, Transient analyses of synchronous motor trains (1978):
section "Stress criterion" and Figure 3, q = Σ nᵢ/Nᵢ and 1/q starts.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import rainflow
from numpy.typing import ArrayLike, NDArray

from engine.case.data import ElementRow, MaterialRow, SNPointRow
from engine.errors import InternalError, ModelError

__all__ = [
    "BELOW_ENDURANCE",
    "RESIDUES",
    "AllowableStarts",
    "CycleCount",
    "SNCurve",
    "ShaftFatigue",
    "allowable_starts",
    "count_cycles",
    "counted_history",
    "damage_interval",
    "half_cycle_points",
    "miner_damage",
    "needs_counting",
    "paper_count",
    "shaft_fatigue",
    "shear_stress",
    "sn_curve_for",
    "starts_from_damage",
    "turning_points",
]

Floats = NDArray[np.float64]

#: What may stand under "Below endurance"; the first is the default.
BELOW_ENDURANCE = ("none", "same slope", "2k-1")

#: What may be done with the residue of the rainflow count; the first is the default.
RESIDUES = ("half cycles", "repeated")

#: Torsional over bending strength: the maximum shear theory, as the paper takes it. [1]
BENDING_TO_TORSION = 0.5

#: Shear yield over tensile yield: the maximum shear theory. [1]
SHEAR_YIELD_RATIO = 0.5

#: An endurance limit this little above the last S-N stress is that stress, typed in another unit.
_SAME_STRESS = 1.0 + 1e-9


# --- stress ---------------------------------------------------------------------------------------


def shear_stress(torque: ArrayLike, diameter: float, bore: float = 0.0) -> Floats:
    """Nominal shear stress at the surface of a round shaft, 16 T D / (π (D⁴ − d⁴)).

    Parameters
    ----------
    torque : array_like
        Torque at the shaft's own speed; the stress takes its sign. [N m]
    diameter, bore : float
        Outer and inner diameter of the judged section. [m]

    Returns
    -------
    ndarray
        Stress, without any concentration factor. [Pa]

    Raises
    ------
    ModelError
        When the bore is negative or not smaller than the diameter.
    """
    if not 0.0 <= bore < diameter:
        raise ModelError(
            f"Stress diameter is {diameter:.6g} m with a bore of {bore:.6g} m; the diameter must "
            "be positive and the bore smaller than it. Correct one of them."
        )
    D, d = diameter, bore
    return np.asarray(torque, float) * (16.0 * D / (math.pi * (D**4 - d**4)))


# --- S-N line -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class SNCurve:
    """Life against stress amplitude: straight lines in log-log through points, then endurance.

    Between points i and i+1, N = Nᵢ (Sᵢ/S)^kᵢ. The last slope continues from the last point down
    to the endurance limit, the knee; below it the rule decides. Above the first point the first
    slope continues, and whoever uses it says so (`above_first_point`).

    Raises
    ------
    ModelError
        When no falling line through two points or more results.
    """

    cycles: Floats  #: Cycles to failure, rising. [1] Shape (n_points,).
    stress: Floats  #: Stress amplitude in torsion, falling. [Pa] Shape (n_points,).
    endurance: float  #: Endurance limit in torsion. [Pa]
    #: ``none``: no damage at or below the limit; ``same slope``: the last slope k goes on;
    #: ``2k-1``: slope 2k−1 below the knee (Haibach).
    below_endurance: str = BELOW_ENDURANCE[0]
    notes: tuple[str, ...] = ()  #: What was assumed in building it.

    def __post_init__(self) -> None:
        cycles, stress = _read_only(self.cycles), _read_only(self.stress)
        object.__setattr__(self, "cycles", cycles)
        object.__setattr__(self, "stress", stress)
        if cycles.ndim != 1 or cycles.shape != stress.shape or cycles.size < 2:
            raise ModelError(
                f"The S-N line has {stress.size} point(s); it needs two or more to have a slope. "
                "Add points to table SNPoints."
            )
        values = np.concatenate([cycles, stress, [self.endurance]])
        if not (np.all(np.isfinite(values)) and np.all(values > 0.0)):
            raise ModelError("Cycles, stresses and endurance of an S-N line must be positive.")
        if np.any(np.diff(cycles) <= 0.0) or np.any(np.diff(stress) >= 0.0):
            raise ModelError("An S-N line must fall: more cycles at less stress, point by point.")
        if self.endurance > stress[-1] * _SAME_STRESS:
            raise ModelError(
                f"Endurance is {_mpa(self.endurance)}; it must not lie above the lowest S-N stress "
                f"{_mpa(stress[-1])}. Correct it, or drop the S-N points below it."
            )
        if self.below_endurance not in BELOW_ENDURANCE:
            raise ModelError(
                f"Below endurance is '{self.below_endurance}'; allowed is one of "
                f"{', '.join(BELOW_ENDURANCE)}."
            )
        if self.below_endurance == "2k-1" and self.slope[-1] <= 0.5:
            raise ModelError(
                f"The S-N exponent k at the endurance limit is {self.slope[-1]:.4g}; the rule 2k-1 "
                "needs more than 0.5. Choose another rule or correct the points."
            )

    @property
    def slope(self) -> Floats:
        """Exponent k of each segment, N ∝ S^−k. [1]"""
        return -np.diff(np.log(self.cycles)) / np.diff(np.log(self.stress))

    @property
    def knee_cycles(self) -> float:
        """Life at the endurance limit. [1]"""
        return float(self.cycles[-1] * (self.stress[-1] / self.endurance) ** self.slope[-1])

    def cycles_to_failure(self, amplitude: ArrayLike) -> Floats:
        """Life at a constant stress amplitude.

        Parameters
        ----------
        amplitude : array_like
            Stress amplitude, zero-to-peak, with SCF; zero or more. [Pa]

        Returns
        -------
        ndarray
            Cycles to failure, of the same shape; inf where there is no damage. [1]

        Raises
        ------
        InternalError
            When an amplitude is negative or not a number.
        """
        S = np.asarray(amplitude, float)
        if not np.all(S >= 0.0):
            raise InternalError("a stress amplitude is negative or not a number")
        k = self.slope
        # Segment i serves stress[i] >= S > stress[i+1]; the outer ones go on outwards.
        i = np.clip(np.searchsorted(-self.stress, -S, side="right") - 1, 0, k.size - 1)
        # From the last point down, take that point, so that the knee and the last point agree.
        near = np.where(self.stress[-1] >= S, self.stress.size - 1, i)
        with np.errstate(divide="ignore", over="ignore"):
            life = self.cycles[near] * (self.stress[near] / S) ** k[i]
            if self.below_endurance == "none":
                below = np.full(S.shape, np.inf)
            else:
                k2 = k[-1] if self.below_endurance == "same slope" else 2.0 * k[-1] - 1.0
                below = self.knee_cycles * (self.endurance / S) ** k2
        return np.asarray(np.where(self.endurance >= S, below, life))

    def above_first_point(self, amplitude: ArrayLike) -> NDArray[np.bool_]:
        """Where the life is the first slope extended upwards, not tested data.

        Parameters
        ----------
        amplitude : array_like
            Stress amplitude, zero-to-peak, with SCF. [Pa]

        Returns
        -------
        ndarray of bool
            True above the first S-N point.
        """
        return np.asarray(np.asarray(amplitude, float) > self.stress[0])


def sn_curve_for(material: MaterialRow, points: Sequence[SNPointRow]) -> SNCurve:
    """The S-N line of a material in torsion, from the tables `Materials` and `SNPoints`.

    Basis ``bending`` halves the endurance limit and every point (the paper: maximum shear theory).
    A blank endurance limit is taken as the lowest S-N stress, and the line says so.

    Parameters
    ----------
    material : MaterialRow
        The material. [Pa]
    points : sequence of SNPointRow
        S-N points; those of other materials are passed over. [1, Pa]

    Returns
    -------
    SNCurve
        The line, all stresses in torsion. [Pa]

    Raises
    ------
    ModelError
        When the points do not make a line; the sentence names the material.
    """
    own = [p for p in points if p.material == material.material]
    pairs = [(p.cycles, p.stress) for p in own if p.cycles is not None and p.stress is not None]
    basis = material.basis or "torsion"
    notes: list[str] = []
    try:
        if basis not in ("torsion", "bending"):
            raise ModelError(f"Basis is '{basis}'; allowed is torsion or bending.")
        if len(pairs) < 2 or len(pairs) < len(own):
            raise ModelError(
                f"It has {len(pairs)} complete S-N point(s) of {len(own)}; a line needs two or "
                "more, each with cycles and stress. Complete table SNPoints."
            )
        cycles, stress = np.array(pairs, float).T
        endurance = material.endurance
        if endurance is None:
            endurance = float(stress[-1])
            notes.append(
                f"Endurance of '{material.material}' is blank: the stress of the last S-N point "
                "is taken as the limit."
            )
        if basis == "bending":
            stress, endurance = BENDING_TO_TORSION * stress, BENDING_TO_TORSION * endurance
            notes.append(
                f"S-N data of '{material.material}' are from bending: endurance and every point "
                "halved for torsion (maximum shear theory)."
            )
        below = material.below_endurance or BELOW_ENDURANCE[0]
        return SNCurve(cycles, stress, endurance, below, tuple(notes))
    except ModelError as problem:
        raise ModelError(f"Material '{material.material}': {problem}") from None


# --- counting -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class CycleCount:
    """Counted cycles of one history, one entry a cycle or half cycle."""

    range: Floats  #: Peak to valley. [as the history] Shape (n_cycles,).
    mean: Floats  #: Half way between. [as the history] Shape (n_cycles,).
    count: Floats  #: 1 for a cycle, 0.5 for a half cycle. [1] Shape (n_cycles,).

    def __post_init__(self) -> None:
        for name in ("range", "mean", "count"):
            object.__setattr__(self, name, _read_only(getattr(self, name)))

    @property
    def amplitude(self) -> Floats:
        """Half of each range. [as the history]"""
        return 0.5 * self.range

    def scaled(self, factor: float) -> CycleCount:
        """The count of the history times a factor.

        Parameters
        ----------
        factor : float
            Positive, such as stress over torque. [1, or the new unit over the old]

        Returns
        -------
        CycleCount
            The same cycles in the new unit. [as the factor makes it]
        """
        return CycleCount(self.range * factor, self.mean * factor, self.count)


def turning_points(history: ArrayLike) -> Floats:
    """The first and the last point of a history and the reversals between them.

    Parameters
    ----------
    history : array_like, shape (n,)
        Values in order of time; repeats and points on the way are dropped. [any unit]

    Returns
    -------
    ndarray, shape (m,)
        Alternating peaks and valleys. [as the history]

    Raises
    ------
    InternalError
        When a value is not finite.
    """
    x: Floats = np.asarray(history, float).ravel()
    if not np.all(np.isfinite(x)):
        raise InternalError("a history to be counted holds a value that is not finite")
    x = x[np.diff(x, prepend=np.nan) != 0.0]  # the first point stays: nan is not zero
    if x.size < 2:
        return x
    rising = x[1:] > x[:-1]
    reversal: NDArray[np.bool_] = np.concatenate([[True], rising[1:] != rising[:-1], [True]])
    return np.asarray(x[reversal])


def counted_history(history: ArrayLike) -> Floats:
    """The whole start as it is counted: from rest, and closed by a return to zero.

    Parameters
    ----------
    history : array_like, shape (n,)
        Turning points of the start. [any unit]

    Returns
    -------
    ndarray, shape (m,)
        Turning points from 0 to 0. [as the history]
    """
    return turning_points(np.concatenate([[0.0], np.asarray(history, float).ravel(), [0.0]]))


def count_cycles(history: ArrayLike, residue: str = RESIDUES[0]) -> CycleCount:
    """Rainflow count by the published library `rainflow` (ASTM E1049-85, 5.4.4, three points).

    What does not close is counted as half cycles (ASTM) or, with ``repeated``, the history is
    taken to repeat: it is rearranged to begin and end at its absolute maximum (E1049 5.4.5), which
    closes every cycle and equals AFNOR's count of the doubled residue. Nothing is prepended or
    appended here; `counted_history` does that for a start.

    Parameters
    ----------
    history : array_like, shape (n,)
        Turning points or any finer history. [any unit]
    residue : str
        ``half cycles`` or ``repeated``. [word]

    Returns
    -------
    CycleCount
        In the order in which cycles close; pairs of halves are joined when repeated. [as given]

    Raises
    ------
    ModelError
        When the residue rule is unknown.
    """
    if residue not in RESIDUES:
        raise ModelError(f"Rainflow residue is '{residue}'; allowed is {' or '.join(RESIDUES)}.")
    points = turning_points(history)
    if points.size < 2:
        return CycleCount(*np.empty((3, 0)))
    if residue == "repeated":
        top = int(np.argmax(np.abs(points)))
        points = turning_points(np.concatenate([points[top:], points[: top + 1]]))
    # Plain floats count faster than numpy's; the first point twice, because the library's
    # `reversals` would lose the second of two points.
    series = [float(points[0]), *points.tolist()]
    table = np.fromiter(chain.from_iterable(rainflow.extract_cycles(series)), float).reshape(-1, 5)
    cycles, mean, count = table[:, 0], table[:, 1], table[:, 2]
    if residue == "repeated":
        half = count == 0.5
        joined, pairs = np.unique(table[half, :2], axis=0, return_counts=True)
        cycles = np.concatenate([cycles[~half], joined[:, 0]])
        mean = np.concatenate([mean[~half], joined[:, 1]])
        count = np.concatenate([count[~half], 0.5 * pairs])
    return CycleCount(cycles, mean, count)


def half_cycle_points(points: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    """Which turning points each rainflow cycle lies between: what a count is differentiated by.

    Parameters
    ----------
    points : array_like, shape (n,)
        Turning points, as `turning_points` gives them; residue as half cycles. [any unit]

    Returns
    -------
    first, second : ndarray of int, shape (n_cycles,)
        Indices of the two ends. [indices]
    count : ndarray, shape (n_cycles,)
        1 for a cycle, 0.5 for a half cycle. [1]
    """
    x = np.asarray(points, float)
    if x.size < 2:
        none = np.zeros(0, dtype=np.int64)
        return none, none, np.zeros(0)
    series = [float(x[0]), *x.tolist()]  # the first twice, as in `count_cycles`
    table = np.array(list(rainflow.extract_cycles(series)), float).reshape(-1, 5)
    first, second = (np.maximum(table[:, c].astype(np.int64) - 1, 0) for c in (3, 4))
    return first, second, np.asarray(table[:, 2])


def paper_count(history: ArrayLike) -> CycleCount:
    """The paper's count, cycle by cycle (Figure 3): each turning point to the next is half a cycle.

    The paper prints no rule beyond "for each cycle"; here each successive range counts one half
    cycle of amplitude range/2. It sees the vibration but not the slow rise and fall under it,
    which rainflow counts as the largest cycle. On a free decay about zero it equals the ASTM count.
    The other reading, one whole cycle of its own amplitude for each positive peak, is not taken:
    it gives 13 % more damage in the free decay of validation case A10, which has both.

    Parameters
    ----------
    history : array_like, shape (n,)
        Turning points or any finer history. [any unit]

    Returns
    -------
    CycleCount
        One half cycle between each two turning points, in order of time. [as given]
    """
    points = turning_points(history)
    ranges = np.abs(np.diff(points))
    return CycleCount(ranges, 0.5 * (points[1:] + points[:-1]), np.full(ranges.shape, 0.5))


# --- damage ---------------------------------------------------------------------------------------


def miner_damage(amplitude: ArrayLike, count: ArrayLike, curve: SNCurve) -> float:
    """Palmgren-Miner sum q = Σ nᵢ/Nᵢ.

    Parameters
    ----------
    amplitude : array_like, shape (n,)
        Stress amplitudes, zero-to-peak, with SCF. [Pa]
    count : array_like, shape (n,)
        Cycles at each. [1]
    curve : SNCurve
        The S-N line. [Pa]

    Returns
    -------
    float
        Damage; 1 is failure. [1]
    """
    with np.errstate(divide="ignore", over="ignore"):
        return float(np.sum(np.asarray(count, float) / curve.cycles_to_failure(amplitude)))


def damage_interval(
    cycles: CycleCount, curve: SNCurve, stress_error: float, relative_error: float = 0.0
) -> tuple[float, float]:
    """Least and largest damage when each turning point may be off by an error.

    Turning points within ± e move every counted amplitude by at most e: rainflow ranges are
    persistences of the history, of the history and its mirror image for ASTM half cycles, and those
    are stable in that sense (Cohen-Steiner, Edelsbrunner and Harer, Stability of persistence
    diagrams, 2007). Cycles of less than e that the error hides altogether cannot be known; they
    matter only where so small an amplitude damages.

    Parameters
    ----------
    cycles : CycleCount
        Counted stress cycles, with SCF. [Pa]
    curve : SNCurve
        The S-N line. [Pa]
    stress_error : float
        Bound of the absolute error of each turning point. [Pa]
    relative_error : float
        Bound of an error in proportion to each turning point, added to the other. [1]

    Returns
    -------
    float
        Damage with every amplitude less its error. [1]
    float
        Damage with every amplitude plus its error. [1]

    Raises
    ------
    InternalError
        When an error bound is negative or not finite.
    """
    for bound in (stress_error, relative_error):
        if not (math.isfinite(bound) and bound >= 0.0):
            raise InternalError(f"an error bound of {bound} cannot bound a damage")
    a = cycles.amplitude
    # Half the sum of |peak| and |valley| is the larger of |mean| and amplitude.
    e = stress_error + relative_error * np.maximum(np.abs(cycles.mean), a)
    low = miner_damage(np.maximum(a - e, 0.0), cycles.count, curve)
    return low, miner_damage(a + e, cycles.count, curve)


def starts_from_damage(damage: float) -> float | None:
    """Allowable starts 1/q.

    Parameters
    ----------
    damage : float
        Damage of one start. [1]

    Returns
    -------
    float or None
        Starts to failure; None when there is no damage: unlimited. [1]
    """
    if damage == 0.0 or math.isinf(1.0 / damage):
        return None
    return 1.0 / damage


def needs_counting(largest_amplitude: float, curve: SNCurve, stress_error: float = 0.0) -> bool:
    """Whether any cycle of a history can damage: the cheap evidence before counting.

    No counted range exceeds maximum minus minimum, so half of that at or below the endurance limit
    settles the matter where nothing below the limit damages.

    Parameters
    ----------
    largest_amplitude : float
        Half of maximum minus minimum, rest included, with SCF. [Pa]
    curve : SNCurve
        The S-N line. [Pa]
    stress_error : float
        Bound of the error of that amplitude. [Pa]

    Returns
    -------
    bool
        False when the starts are unlimited without counting.
    """
    return curve.below_endurance != "none" or largest_amplitude + stress_error > curve.endurance


# --- one shaft, a train ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ShaftFatigue:
    """What one start does to one shaft. None for a number of starts means unlimited."""

    element: str  #: Row of `Elements`.
    damage: float  #: Miner sum of one start, rainflow count. [1]
    damage_low: float  #: The same at the ends of the error of the history. [1]
    damage_high: float  #: Likewise. [1]
    allowable_starts: float | None  #: 1/damage. [1]
    unlimited: bool  #: No damage.
    starts_low: float | None  #: Interval of the allowable starts from the error of the history. [1]
    starts_high: float | None  #: Likewise. [1]
    paper_damage: float  #: Miner sum of one start, the paper's count. [1]
    paper_starts: float | None  #: 1/paper_damage. [1]
    cycles: CycleCount  #: Rainflow cycles of local stress, with SCF; empty when not counted. [Pa]
    counted: bool  #: False when `largest_amplitude` alone settled it.
    residue: str  #: Rule of the rainflow residue.
    #: Half of maximum minus minimum local stress, rest included, with SCF. [Pa]
    largest_amplitude: float
    endurance: float  #: Endurance limit in torsion it is compared with. [Pa]
    peak_nominal_stress: float  #: Largest absolute nominal stress, without SCF. [Pa]
    #: Cycles a start above the first S-N point, where the line is extended. [1]
    above_first_point: float
    above_shear_yield: bool | None  #: Nominal peak above Yield/2; None when Yield is blank.
    notes: tuple[str, ...]  #: What a reader must know.

    @property
    def starts_error(self) -> float | None:
        """Larger side of the interval over the allowable starts; None when it is unlimited. [1]"""
        return _starts_error(self.allowable_starts, self.starts_low, self.starts_high)


def shaft_fatigue(
    element: ElementRow,
    torque_turning_points: ArrayLike,
    sn_curve: SNCurve,
    material: MaterialRow,
    residue: str = RESIDUES[0],
    torque_error: float = 0.0,
    *,
    relative_torque_error: float = 0.0,
    always_count: bool = False,
) -> ShaftFatigue:
    """Damage and allowable starts of one shaft from its torque during one start.

    The history is counted from rest and closed by a return to zero. Local stress is SCF times
    nominal; amplitude is half a range; the mean is ignored.

    Parameters
    ----------
    element : ElementRow
        The shaft, with stress diameter; bore and SCF as given (blank: 0 and 1). [m, 1]
    torque_turning_points : array_like, shape (n,)
        Turning points of its torque, at its own speed, in order of time. [N m]
    sn_curve : SNCurve
        S-N line of its material in torsion. [Pa]
    material : MaterialRow
        Its material, for the yield strength. [Pa]
    residue : str
        ``half cycles`` or ``repeated``. [word]
    torque_error : float
        Bound of the absolute error of each turning point. [N m]
    relative_torque_error : float
        Bound of an error in proportion to each turning point, added to the other. [1]
    always_count : bool
        Count even where the largest amplitude is at or below the endurance limit.

    Returns
    -------
    ShaftFatigue
        Complete result. [Pa, 1]

    Raises
    ------
    ModelError
        When the element has no stress diameter or an SCF that is not positive.
    """
    name = element.element or "unnamed element"
    if element.stress_diameter is None:
        raise ModelError(
            f"Element '{name}' has no stress diameter, so no stress can be judged. Type it in "
            "table Elements."
        )
    scf = 1.0 if element.scf is None else element.scf
    if not scf > 0.0:
        raise ModelError(f"SCF of element '{name}' is {scf:.6g}; it must be positive.")
    history = counted_history(torque_turning_points)
    unit_stress = float(shear_stress(1.0, element.stress_diameter, element.stress_bore or 0.0))
    local = scf * unit_stress
    peak = unit_stress * float(np.max(np.abs(history)))
    largest = 0.5 * local * float(np.ptp(history))
    stress_error = local * torque_error
    bound = stress_error + relative_torque_error * scf * peak

    counted = always_count or needs_counting(largest, sn_curve, bound)
    cycles = count_cycles(history if counted else (), residue).scaled(local)
    by_paper = paper_count(history if counted else ()).scaled(local)
    damage = miner_damage(cycles.amplitude, cycles.count, sn_curve)
    low, high = damage_interval(cycles, sn_curve, stress_error, relative_torque_error)
    paper_damage = miner_damage(by_paper.amplitude, by_paper.count, sn_curve)
    above = float(np.sum(cycles.count[sn_curve.above_first_point(cycles.amplitude)]))
    starts = starts_from_damage(damage)
    shear_yield = None if material.yield_ is None else SHEAR_YIELD_RATIO * material.yield_
    shaft = ShaftFatigue(
        element=name,
        damage=damage,
        damage_low=low,
        damage_high=high,
        allowable_starts=starts,
        unlimited=starts is None,
        starts_low=starts_from_damage(high),
        starts_high=starts_from_damage(low),
        paper_damage=paper_damage,
        paper_starts=starts_from_damage(paper_damage),
        cycles=cycles,
        counted=counted,
        residue=residue,
        largest_amplitude=largest,
        endurance=sn_curve.endurance,
        peak_nominal_stress=peak,
        above_first_point=above,
        above_shear_yield=None if shear_yield is None else peak > shear_yield,
        notes=sn_curve.notes,
    )
    return replace(shaft, notes=(*shaft.notes, *_notes(shaft, sn_curve, scf, shear_yield)))


def _notes(
    shaft: ShaftFatigue, curve: SNCurve, scf: float, shear_yield: float | None
) -> tuple[str, ...]:
    """The sentences a reader must see beside the numbers of one shaft."""
    said: list[str] = []
    name, peak = shaft.element, shaft.peak_nominal_stress
    if not shaft.counted:
        said.append(
            f"{name}: no cycle can exceed an amplitude of {_mpa(shaft.largest_amplitude)}, not "
            f"above the endurance limit {_mpa(curve.endurance)}: no cycle damages, none is counted."
        )
    if shaft.above_first_point:
        said.append(
            f"{name}: {shaft.above_first_point:g} cycles a start lie above the first S-N point "
            f"({_mpa(float(curve.stress[0]))}); their life is its slope extended upwards, not "
            "test data. Add S-N points at higher stress."
        )
    if shear_yield is not None and peak > shear_yield:
        said.append(
            f"{name}: the nominal peak {_mpa(peak)} is above the shear yield Yield/2 = "
            f"{_mpa(shear_yield)} (maximum shear theory): the shaft yields, and starts counted "
            "from elastic stress do not hold."
        )
    elif shear_yield is not None and scf * peak > shear_yield:
        said.append(
            f"{name}: SCF times the nominal peak, {_mpa(scf * peak)}, is above the shear yield "
            f"Yield/2 = {_mpa(shear_yield)}: local yielding at the notch (a note, not a verdict)."
        )
    if (shaft.damage_low == 0.0) != (shaft.damage_high == 0.0):
        said.append(
            f"{name}: within the error of the history every cycle may lie at or below the "
            f"endurance limit {_mpa(curve.endurance)}, so the interval of the starts ends at "
            "unlimited."
        )
    return tuple(said)


@dataclass(frozen=True, eq=False)
class AllowableStarts:
    """Fatigue of all judged shafts and the one that governs. None means unlimited."""

    shafts: tuple[ShaftFatigue, ...]  #: One entry a judged shaft. [rows]
    #: Shaft with the fewest starts; None when none is damaged or none is judged.
    governing: str | None
    starts: float | None  #: Allowable starts of the governing shaft, 1/q. [1]
    unlimited: bool  #: Shafts are judged and none is damaged.
    starts_low: float | None  #: Interval of the least starts over all shafts. [1]
    starts_high: float | None  #: Likewise. [1]
    starts_factor: float  #: What the starts are divided by before they are judged. [1]
    judged_starts: float | None  #: `starts` over `starts_factor`. [1]

    @property
    def starts_error(self) -> float | None:
        """Larger side of the interval over the starts; None when it is unlimited. [1]"""
        return _starts_error(self.starts, self.starts_low, self.starts_high)


def allowable_starts(
    shafts: Sequence[ShaftFatigue], starts_factor: float | None = None
) -> AllowableStarts:
    """The train's allowable starts: those of its worst shaft.

    Parameters
    ----------
    shafts : sequence of ShaftFatigue
        Every judged shaft. [Pa, 1]
    starts_factor : float or None
        Allowable starts are divided by it before they are judged; None = 1. [1]

    Returns
    -------
    AllowableStarts
        With the governing shaft: fewest starts, then the lowest end of the interval. [1]

    Raises
    ------
    ModelError
        When the factor is not positive.
    """
    factor = 1.0 if starts_factor is None else starts_factor
    if not (math.isfinite(factor) and factor > 0.0):
        raise ModelError(f"StartsFactor is {factor:.6g}; it must be positive.")

    def order(shaft: ShaftFatigue) -> tuple[float, float]:
        return _or_inf(shaft.allowable_starts), _or_inf(shaft.starts_low)

    worst = min(shafts, key=order, default=None)
    starts = None if worst is None else worst.allowable_starts
    limited = worst is not None and order(worst) != (math.inf, math.inf)
    return AllowableStarts(
        shafts=tuple(shafts),
        governing=worst.element if worst is not None and limited else None,
        starts=starts,
        unlimited=worst is not None and starts is None,
        starts_low=_least(shaft.starts_low for shaft in shafts),
        starts_high=_least(shaft.starts_high for shaft in shafts),
        starts_factor=factor,
        judged_starts=None if starts is None else starts / factor,
    )


# --- small things ---------------------------------------------------------------------------------


def _read_only(values: ArrayLike) -> Floats:
    """A copy that cannot be written to."""
    copy = np.array(values, float)
    copy.setflags(write=False)
    return copy


def _mpa(stress: float) -> str:
    """A stress for readers of either system; sentences cannot follow a sheet's units. [Pa]"""
    return f"{stress / 1e6:.4g} MPa ({stress / 6894757.293168361:.4g} ksi)"


def _or_inf(starts: float | None) -> float:
    return math.inf if starts is None else starts


def _least(starts: Iterable[float | None]) -> float | None:
    least = min(map(_or_inf, starts), default=math.inf)
    return None if math.isinf(least) else least


def _starts_error(starts: float | None, low: float | None, high: float | None) -> float | None:
    if starts is None or low is None or high is None or starts == 0.0:
        return None
    return max(high / starts - 1.0, 1.0 - low / starts)
