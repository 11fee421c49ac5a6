"""The S-N line of a material in torsion: log-log through points, endurance, bending halved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from engine.arrays import Floats, Mask
from engine.case.choices import BelowEndurance, SNBasis
from engine.case.data import MaterialRow, SNPointRow
from engine.errors import InternalError, ModelError
from engine.fatigue.cycle_counting import read_only
from engine.fatigue.stress import BENDING_TO_TORSION, in_megapascals
from engine.numerics.same_bits import log, power

#: An endurance limit this little above the last S-N stress is that stress, typed in another unit.
_SAME_STRESS = 1.0 + 1e-9


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
    below_endurance: str = BelowEndurance.NONE
    notes: tuple[str, ...] = ()  #: What was assumed in building it.
    extended: int = 0  #: Points before the first of the data, on its extension. [count]

    def __post_init__(self) -> None:
        cycles, stress = read_only(self.cycles), read_only(self.stress)
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
            raise ModelError(
                "The stress of an S-N line must fall from point to point as the cycles rise."
            )
        if self.endurance > stress[-1] * _SAME_STRESS:
            raise ModelError(
                f"Endurance is {in_megapascals(self.endurance)}; it must not lie above the lowest S-N stress "
                f"{in_megapascals(stress[-1])}. Correct it, or drop the S-N points below it."
            )
        if self.below_endurance not in tuple(BelowEndurance):
            raise ModelError(
                f"Below endurance is '{self.below_endurance}'; allowed is one of "
                f"{', '.join(BelowEndurance)}."
            )
        if self.below_endurance == BelowEndurance.HAIBACH and self.slope[-1] <= 0.5:
            raise ModelError(
                f"The S-N exponent k at the endurance limit is {self.slope[-1]:.4g}; the rule "
                "2k-1 needs k of more than 0.5. Choose another rule or correct the points."
            )

    @cached_property
    def slope(self) -> Floats:
        """Exponent k of each segment, N ∝ S^−k. [1]"""
        return np.asarray(-np.diff(log(self.cycles)) / np.diff(log(self.stress)))

    @property
    def knee_cycles(self) -> float:
        """Life at the endurance limit. [1]"""
        return float(self.cycles[-1] * power(self.stress[-1] / self.endurance, self.slope[-1]))

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
        k, over = self.slope, self.endurance < S
        life = np.full(S.shape, np.inf)
        # Segment i serves stress[i] >= S > stress[i+1]; the outer ones go on outwards.
        i = np.clip(np.searchsorted(-self.stress, -S[over], side="right") - 1, 0, k.size - 1)
        # From the last point down, take that point, so that the knee and the last point agree.
        near = np.where(self.stress[-1] >= S[over], self.stress.size - 1, i)
        with np.errstate(divide="ignore", over="ignore"):
            life[over] = self.cycles[near] * power(self.stress[near] / S[over], k[i])
            if self.below_endurance != BelowEndurance.NONE:
                same = self.below_endurance == BelowEndurance.SAME_SLOPE
                k2 = float(k[-1] if same else 2.0 * k[-1] - 1.0)
                life[~over] = self.knee_cycles * power(self.endurance / S[~over], k2)
        return life

    def above_first_point(self, amplitude: ArrayLike) -> Mask:
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
        return np.asarray(np.asarray(amplitude, float) > self.first_stress)

    @property
    def first_stress(self) -> float:
        """Stress of the first point of the data. [Pa]"""
        return float(self.stress[self.extended])


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
    basis = material.basis or SNBasis.TORSION
    notes: list[str] = []
    try:
        if basis not in tuple(SNBasis):
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
        if basis == SNBasis.BENDING:
            stress, endurance = BENDING_TO_TORSION * stress, BENDING_TO_TORSION * endurance
            notes.append(
                f"S-N data of '{material.material}' are from bending: endurance and every point "
                "halved for torsion (maximum shear theory)."
            )
        below = material.below_endurance or BelowEndurance.NONE
        return SNCurve(cycles, stress, endurance, below, tuple(notes))
    except ModelError as problem:
        raise ModelError(f"Material '{material.material}': {problem}") from None
