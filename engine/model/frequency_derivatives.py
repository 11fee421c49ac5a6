"""How natural frequencies follow stiffnesses and inertias, from the energies of the modes.

∂ln f/∂ln k = ½ × the share of the strain energy in k, ∂ln f/∂ln J = −½ × the share of the kinetic
energy in J. Of a station whose inertia a rigid mesh merges with others, or to which half of a shaft's
own inertia is added, only the part that is stated under its name counts. Bearings and lateral masses
of gears have shares like any other.

Where modes are as good as equal an eigenvector is any mixture of theirs, and its energies are no
derivative. Then the frequencies of the cluster move by the eigenvalues of the change projected on it
(the one-sided derivative; the lowest goes to the lowest mode), and the modes are named.

References
----------
Rayleigh, Theory of Sound I, § 88; for repeated roots Lancaster, Numer. Math. 6 (1964) 377.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.case.study_inputs import INERTIA, STIFFNESS
from engine.model.modes import Modes
from engine.model.train import Train
from engine.numerics.same_bits import product

#: Neighbouring modes closer than this are as good as equal: rounding may mix them. [1]
AS_GOOD_AS_EQUAL = 1e-6
#: Neighbouring modes closer than this exchange their shapes within changes of a few per cent. [1]
NEAR = 0.02
#: Bearings and lateral masses of gears, beside the quantities of `engine.case.study_inputs`.
BEARING_STIFFNESS, MASS = "bearing stiffness", "lateral mass"


@dataclass(frozen=True, eq=False)
class FrequencyDerivative:
    """What one quantity does to all elastic frequencies."""

    quantity: str  #: ``stiffness``, ``inertia``, ``bearing stiffness`` or ``lateral mass``.
    name: str  #: Element or station.
    value: Floats  #: ∂ln f/∂ln of the quantity. [1] Shape (n_elastic,).


@dataclass(frozen=True, eq=False)
class FrequencyDerivatives:
    """What every quantity does to all elastic frequencies."""

    #: Stiffnesses of elements and bearings, then inertias and masses. [1]
    rows: tuple[FrequencyDerivative, ...]
    #: Elastic modes, counted from 1, that are as good as equal.
    clusters: tuple[tuple[int, ...], ...]
    notes: tuple[str, ...]  #: What must be known of near-equal modes.
    #: Share of the kinetic energy in the shafts' own inertia, which no row stands for. [1] Shape
    #: (n_elastic,).
    unnamed: Floats

    def of(self, quantity: str, name: str) -> Floats | None:
        """One row by its names.

        Parameters
        ----------
        quantity, name : str
            As in the row. [name]

        Returns
        -------
        ndarray, shape (n_elastic,), or None
            ∂ln f/∂ln of the quantity; None where there is no such row. [1]
        """
        return next((r.value for r in self.rows if (r.quantity, r.name) == (quantity, name)), None)


def clusters(frequency: Floats, nearer_than: float) -> list[list[int]]:
    """Runs of neighbouring frequencies that are closer than a share of themselves.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Rising. [Hz]
    nearer_than : float
        Share. [1]

    Returns
    -------
    list of list of int
        Indices of each run of two or more. [indices]
    """
    groups: list[list[int]] = []
    for i in range(1, len(frequency)):
        if frequency[i] - frequency[i - 1] <= nearer_than * frequency[i]:
            if groups and groups[-1][-1] == i - 1:
                groups[-1].append(i)
            else:
                groups.append([i - 1, i])
    return groups


def frequency_derivatives(case: CaseData, train: Train, modes: Modes) -> FrequencyDerivatives:
    """Derivatives of all elastic frequencies with respect to every stiffness and inertia.

    Parameters
    ----------
    case : CaseData
        The case, for the inertias that are stated. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    FrequencyDerivatives
        Rows and notes. [1]
    """
    elastic = slice(modes.n_rigid, None)
    frequency = modes.frequency[elastic]
    equal = clusters(frequency, AS_GOOD_AS_EQUAL)
    rows = []
    for quantity, name, motion, weight in _parts(case, train, modes):
        # the share of each mode is w·(its motion)², summed over the parts of the quantity
        own = motion[:, elastic]
        share = np.sum(weight[:, None] * own**2, axis=0)
        sign = 0.5 if quantity in (STIFFNESS, BEARING_STIFFNESS) else -0.5
        value = sign * share
        for group in equal:
            shared = product(own[:, group].T * weight, own[:, group])
            value[group] = np.sort(sign * np.linalg.eigvalsh(shared))
        rows.append(FrequencyDerivative(quantity, name, value))
    near = [g for g in clusters(frequency, NEAR) if g not in equal]
    kinetic = sum(
        (r.value for r in rows if r.quantity in (INERTIA, MASS)), np.zeros(len(frequency))
    )
    return FrequencyDerivatives(
        tuple(rows),
        tuple(tuple(i + 1 for i in g) for g in equal),
        tuple(_notes(frequency, equal, near)),
        np.maximum(1.0 + 2.0 * kinetic, 0.0),
    )


def _parts(case: CaseData, train: Train, modes: Modes) -> Iterator[tuple[str, str, Floats, Floats]]:
    """Quantity, name, motion of its parts in every mode, and the weight of each part.

    Motions are scaled so that weight × motion² is a share of the energy of the mode.
    """
    safe = np.where(modes.omega > 0.0, modes.omega, np.inf)
    twist = modes.row_twist / safe
    for i, element in enumerate(train.elements):
        rows = np.flatnonzero((train.row_element == i) & (train.stiffness > 0.0))
        if len(rows):
            yield STIFFNESS, element, twist[rows], train.stiffness[rows]
    for body in train.bodies:
        rows = np.array([body.row_x, body.row_y])
        yield BEARING_STIFFNESS, train.stations[body.station], twist[rows], train.stiffness[rows]
    angle = train.node_scale[:, None] * modes.shape[train.node_dof]
    for i, row in enumerate(case.stations):
        if row.inertia:
            yield INERTIA, str(row.station), angle[[i]], np.array([row.inertia])
    for body in train.bodies:
        nodes = [body.node_x, body.node_y]
        yield MASS, train.stations[body.station], angle[nodes], np.full(2, body.mass)


def _notes(frequency: Floats, equal: list[list[int]], near: list[list[int]]) -> Iterator[str]:
    for group in equal:
        yield (
            f"Modes {_listed(group)} are nearly equal ({frequency[group[0]]:.4g} Hz): their "
            "derivatives are one-sided, each for an increase of one quantity alone, the lowest "
            "derivative given to the lowest mode; derivatives for several quantities must not be "
            "added."
        )
    for group in near:
        apart = float(frequency[group[-1]] / frequency[group[0]] - 1.0)
        yield (
            f"Modes {_listed(group)} lie {100.0 * apart:.2g} % apart: a small change of a "
            "stiffness or inertia exchanges their shapes. Their derivatives hold only for changes "
            "that shift a frequency by much less than this distance."
        )


def _listed(group: list[int]) -> str:
    names = [str(i + 1) for i in group]
    return ", ".join(names[:-1]) + f" and {names[-1]}"
