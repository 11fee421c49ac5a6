"""Forbidden bands: the same margin as that of every mode, solved for the frequency."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.case.case import Case
from engine.case.data import CaseData
from engine.model.excitation import excitations_of
from engine.operation.margins import Band, forbidden_bands, free_windows, separation_margins
from tests.strategies import cases, example_count
from tests.trains import geared, prepared

TURN = 2.0 * math.pi


def test_bands_of_the_papers_excitations_by_hand() -> None:
    """1800 rpm, 20 %: 1× is 30 Hz, forbidden from 24 to 36 Hz; 1× line from 48 to 72 Hz."""
    case = geared()
    bands = {
        b.excitation: b for b in forbidden_bands(case, excitations_of(case, prepared(case)[0]))
    }
    assert (bands["1× motor speed"].from_, bands["1× motor speed"].to) == pytest.approx((24, 36))
    assert (bands["1× line"].from_, bands["1× line"].to) == pytest.approx((48, 72))
    pinion = bands["2× Pinion speed"]
    assert (pinion.from_, pinion.to) == pytest.approx((0.8 * 180, 1.2 * 180))


def test_a_range_of_speeds_widens_the_band() -> None:
    """1× from 25 to 32 Hz: forbidden from 0.9 × 25 to 1.1 × 32 Hz with the measured margin."""
    case = geared(minimum_speed=25 * TURN, maximum_speed=32 * TURN, margin_basis="measured", end_speed=25 * TURN)  # fmt: skip
    band = next(
        b
        for b in forbidden_bands(case, excitations_of(case, prepared(case)[0]))
        if b.excitation == "1× motor speed"
    )
    assert (band.from_, band.to) == pytest.approx((22.5, 35.2))
    assert (band.lowest, band.highest) == pytest.approx((25.0, 32.0))


def test_windows_are_what_overlapping_bands_leave() -> None:
    bands = [Band(n, a, b, a, b) for n, a, b in (("x", 48, 72), ("y", 24, 36), ("z", 50, 80))]
    found = [(w.from_, w.to) for w in free_windows(bands)]
    assert found == [(0.0, 24), (36, 48), (80, None)]
    assert [(w.from_, w.to) for w in free_windows([])] == [(0.0, None)]


@example_count(60)
@given(case=cases(stations=(2, 12)), low=st.floats(0.3, 1.0), required=st.floats(0.0, 0.9))
def test_a_mode_is_inside_exactly_where_its_margin_is_not_kept(
    case: Case, low: float, required: float
) -> None:
    synchronous = case.ratings.synchronous_speed
    assert synchronous
    data = replace(
        CaseData(**vars(case)), minimum_speed=low * synchronous, margin_required=required
    )
    train, modes, _ = prepared(data)
    excitations = excitations_of(data, train)
    bands = {b.excitation: b for b in forbidden_bands(data, excitations)}
    for row in separation_margins(data, train, modes, excitations).rows:
        band = bands[row.excitation]
        if abs(row.margin - required) < 1e-6:
            continue  # on the edge rounding decides
        assert (band.from_ < row.mode_frequency < band.to) == (not row.kept)
