"""Margins that are not kept, and what a forced response at the resonance makes of them.

"If the margin cannot be attained, a forced vibration analysis" (Szenasi & von Nimitz, 1978, "Steady
state torsional analysis"). It shows something only where the elements that the mode strains were
judged. Stress follows strain energy in shafts; a stiff coupling or a key carries the same torque with
little energy, so elements count by their torque too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.case.result_words import Judgement
from engine.model.excitation import transmitted_torque
from engine.model.modes import Modes
from engine.model.train import Train
from engine.numerics.same_bits import modulus
from engine.operation.margins import MarginRow, SeparationMargins
from engine.operation.steady_state import SteadyStateRow, modal_element_torque

#: Share of a mode's strain energy that judged elements must hold. [1]
ENERGY_JUDGED = 0.9
#: An element counts where its torque over its rated one is this share of the largest in the mode. [1]
TORQUE_JUDGED = 0.5


@dataclass(frozen=True, eq=False)
class ModeParts:
    """How much of each mode an element is."""

    names: tuple[str, ...]  #: Elements, then the bearings of gears.
    energy: Floats  #: Share of the strain energy. [1] Shape (n_names, n_elastic).
    #: Modal torque over rated or transmitted torque, the largest of a mode = 1; 0 of a bearing. [1]
    #: Shape (n_names, n_elastic).
    torque: Floats


def mode_parts(case: CaseData, train: Train, modes: Modes) -> ModeParts:
    """Shares of the elastic modes.

    The torque of an element is divided by its Rated torque, else by what it transmits, else by
    RatedTorque at its speed.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    ModeParts
        Their shares. [1]
    """
    names = (*train.elements, *(f"bearing of {train.stations[b.station]}" for b in train.bodies))
    energy = np.concatenate([modes.strain_share, modes.bearing_share])[:, modes.n_rigid :]
    transmitted = modulus(transmitted_torque(case, train).element)
    ratios = case.element_speed_ratios
    reference = np.array(
        [
            e.rated_torque or carried or (case.ratings.rated_torque or 1.0) / ratios[e.element]
            for e, carried in zip(case.elements, transmitted.tolist(), strict=True)
        ]
    )
    torque = np.zeros(energy.shape)
    torque[: len(reference)] = (
        modal_element_torque(train, modes)[:, modes.n_rigid :] / reference[:, None]
    )
    largest = np.max(torque, axis=0, initial=0.0)
    return ModeParts(names, energy, torque / np.where(largest > 0.0, largest, 1.0))


def judge(
    margins: SeparationMargins,
    responses: Sequence[SteadyStateRow],
    parts: ModeParts,
    frequency_error: float = 0.0,
    unsure: Set[tuple[str, str, int | None]] = frozenset(),
) -> SeparationMargins:
    """Margins with their final verdicts.

    ``pass``: the margin is kept, or equal to the required one to 1e-9; ``pass within its error``:
    by less than the error of the frequency. ``accepted by forced response``: it is not kept, but at
    the resonance with this excitation these are judged and within their limits: elements that hold
    `ENERGY_JUDGED` of the strain energy, the one that holds most, and every one whose modal torque
    over its rated torque is `TORQUE_JUDGED` of the largest. ``not judged``: some are, and within their
    limits, but not all of these, or not at the unfavourable end of their error. ``fail``: the rest.

    Parameters
    ----------
    margins : SeparationMargins
        Margins. [1]
    responses : sequence of SteadyStateRow
        Rows of the steady-state response. [rows]
    parts : ModeParts
        What the modes consist of. [1]
    frequency_error : float, optional
        Relative error of the natural frequencies. [1]
    unsure : set of tuple, optional
        Element, excitation and mode of rows that pass only within their error. [names, 1]

    Returns
    -------
    SeparationMargins
        The same rows with their verdicts and what is not judged. [1]
    """
    verdicts: dict[tuple[int, str], dict[str, Judgement]] = {}
    for r in responses:
        if r.mode is not None:
            is_unsure = (r.element, r.excitation, r.mode) in unsure
            verdict = Judgement.WITHIN_ERROR if is_unsure else r.verdict
            verdicts.setdefault((r.mode, r.excitation), {})[r.element] = verdict
    rows = []
    for row in margins.rows:
        if row.verdict == Judgement.NOT_JUDGED:  # its frequency is not accurate
            rows.append(row)
            continue
        if row.kept:
            error = (1.0 + row.margin) * frequency_error
            is_sure = row.margin - row.required >= error
            verdict, open_ = Judgement.PASS if is_sure else Judgement.WITHIN_ERROR, None
        else:
            verdict, open_ = _accepted(row, verdicts.get((row.mode, row.excitation), {}), parts)
        rows.append(replace(row, verdict=verdict, not_judged=open_))
    return replace(margins, rows=tuple(rows))


def _accepted(
    row: MarginRow, verdicts: Mapping[str, Judgement], parts: ModeParts
) -> tuple[Judgement, str | None]:
    """Verdict of a margin that is not kept, and the elements that keep it from being accepted."""
    found = set(verdicts.values()) - {Judgement.NOT_JUDGED}
    if not found or found - {Judgement.PASS, Judgement.WITHIN_ERROR}:
        return Judgement.FAIL, None
    unsure = [
        f"{name} (beyond its limit at the unfavourable end: error of its torque, and DampingRange)"
        for name, verdict in verdicts.items()
        if verdict == Judgement.WITHIN_ERROR
    ]
    open_ = unsure + _not_judged(row.mode - 1, verdicts, parts)
    return (Judgement.NOT_JUDGED if open_ else Judgement.ACCEPTED), "; ".join(open_) or None


def _not_judged(mode: int, verdicts: Mapping[str, Judgement], parts: ModeParts) -> list[str]:
    """Elements of a mode that must be judged and are not, each with its shares."""
    energy, torque = parts.energy[:, mode], parts.torque[:, mode]
    is_judged = np.array([verdicts.get(name) == Judgement.PASS for name in parts.names])
    needed = torque >= TORQUE_JUDGED
    needed[int(np.argmax(energy))] = True
    held = float(energy[is_judged | needed].sum())
    for i in np.argsort(-energy, kind="stable").tolist():  # the largest first, until enough is held
        if held >= ENERGY_JUDGED:
            break
        if not (is_judged[i] or needed[i]):
            needed[i] = True
            held += float(energy[i])
    return [
        f"{parts.names[i]} ({energy[i]:.0%} of the strain energy, modal torque {torque[i]:.0%} of the "
        "largest)"
        for i in np.argsort(-energy, kind="stable").tolist()
        if needed[i] and not is_judged[i] and verdicts.get(parts.names[i]) != Judgement.WITHIN_ERROR
    ]
