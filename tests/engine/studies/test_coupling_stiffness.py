"""Couplings that keep every margin, against the closed form of two and three discs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, ExcitationRow, StationRow
from engine.studies.coupling_stiffness import FACTORS, changed_couplings

INERTIA, EXCITED = 2.0, 60.0
#: Of two equal discs f = √(2 k / J) / 2π: in resonance with the excitation.
STIFFNESS = 0.5 * INERTIA * (2.0 * math.pi * EXCITED) ** 2


def two_discs(kind: str = "coupling") -> Case:
    return Case(
        stations=(StationRow("A", inertia=INERTIA), StationRow("B", inertia=INERTIA)),
        elements=(ElementRow("K", kind, "A", "B", stiffness=STIFFNESS),),
        excitations=(ExcitationRow("E", frequency=EXCITED),),
    )


def test_two_discs_in_resonance() -> None:
    """20 % of the frequency is a factor of 0.8² = 0.64 or 1.2² = 1.44: of those tried 0.6 and 1.5, the smaller change first."""
    found = changed_couplings(two_discs())
    assert [[(c.element, c.factor) for c in one.changes] for one in found] == [
        [("K", 1.5)],
        [("K", 0.6)],
    ]
    for one in found:
        ((change,), factor) = one.changes, one.changes[0].factor
        assert one.keeps_all
        assert change.stiffness == pytest.approx(factor * STIFFNESS, rel=1e-12)
        assert one.worst.mode_frequency == pytest.approx(EXCITED * math.sqrt(factor), rel=1e-9)
        assert one.worst.margin == pytest.approx(abs(math.sqrt(factor) - 1.0), abs=1e-9)


def test_nothing_to_change() -> None:
    assert changed_couplings(two_discs("shaft")) == ()
    kept = replace(CaseData(**vars(two_discs())), margin_required=0.0)
    assert changed_couplings(kept) == ()


def test_two_couplings_where_one_is_not_enough() -> None:
    """Three equal discs, both modes in resonance: frequencies are those of 3 × 3 matrices."""
    first, second = (math.sqrt(n * 2.0 * STIFFNESS / INERTIA) / 2.0 / math.pi for n in (0.5, 1.5))
    case = Case(
        stations=tuple(StationRow(n, inertia=INERTIA) for n in "ABC"),
        elements=(
            ElementRow("K1", "coupling", "A", "B", stiffness=STIFFNESS),
            ElementRow("K2", "coupling", "B", "C", stiffness=STIFFNESS),
        ),
        excitations=tuple(ExcitationRow(f"E{f:.0f}", frequency=f) for f in (first, second)),
    )

    def least(k1: float, k2: float) -> float:
        matrix = np.array([[k1, -k1, 0.0], [-k1, k1 + k2, -k2], [0.0, -k2, k2]]) / INERTIA
        modes = np.sqrt(np.linalg.eigvalsh(matrix)[1:]) / 2.0 / math.pi
        return min(abs(f - e) / e for f in modes for e in (first, second))

    (found,) = changed_couplings(case)
    k1, k2 = (c.stiffness for c in found.changes)
    assert found.keeps_all
    assert found.worst.margin == pytest.approx(least(k1, k2), rel=1e-6)
    assert least(k1, k2) >= 0.2
    assert max(least(n * STIFFNESS, STIFFNESS) for n in FACTORS) < 0.2
