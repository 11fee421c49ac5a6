"""Sections in series: cylinders, steps, hubs and keyways against closed forms; modes of a stepped shaft."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq
from strategies import example_count

from engine.case.case import Case
from engine.case.data import (
    CaseData,
    ElementRow,
    MeshRow,
    SectionMaterialRow,
    SectionRow,
    StationRow,
)
from engine.model.build_train import build_train
from engine.model.links import link_of
from engine.model.modes import modes_of
from engine.model.sections import keyway_loss, sections_of, series_stiffness, step_length
from engine.model.subdivision import natural_modes
from engine.results.tables import result_tables
from engine.run import run

G, RHO = 79.3e9, 7850.0
FEW = example_count(60)


def train(*rows: SectionRow, materials: tuple[SectionMaterialRow, ...] = (), **element) -> CaseData:
    """Two discs joined by one stepped shaft."""
    return Case(
        stations=(StationRow("left", inertia=10.0), StationRow("right", inertia=20.0)),
        elements=(ElementRow("rotor", "shaft", "left", "right", **element),),
        sections=rows,
        section_materials=materials,
    )


def section(length: float, od: float, **more) -> SectionRow:
    return SectionRow("rotor", length=length, od=od, **more)


def polar(od: float, bore: float = 0.0) -> float:
    return math.pi * (od**4 - bore**4) / 32.0


def stiffness(*rows: SectionRow, **more) -> float:
    return series_stiffness(sections_of(train(*rows, **more))["rotor"])


# --- closed forms ---------------------------------------------------------------------------------


@pytest.mark.parametrize("bore", [None, 0.04])
def test_a_cylinder(bore: float | None) -> None:
    (only,) = sections_of(train(section(0.7, 0.1, id=bore)))["rotor"]
    area = polar(0.1, bore or 0.0)
    assert only.effective_length == pytest.approx(0.7, rel=1e-15)
    assert only.stiffness == pytest.approx(G * area / 0.7, rel=1e-14)
    assert only.inertia == pytest.approx(RHO * area * 0.7, rel=1e-14)


def test_a_step_lengthens_the_thinner_shaft_and_shortens_the_thicker() -> None:
    """The sum as it is published: 1/k = Σ L/GJ with λ taken from the thicker and given to the thinner shaft."""
    thin, thick, fillet = 0.1, 0.16, 0.008
    added = thin * step_length(thick / thin, fillet / thin)
    twist = (0.4 + added) / polar(thin) + (0.3 - added) / polar(thick)
    assert stiffness(section(0.4, thin, fillet=fillet), section(0.3, thick)) == pytest.approx(
        G / twist, rel=1e-13
    )
    sections = sections_of(train(section(0.4, thin, fillet=fillet), section(0.3, thick)))["rotor"]
    assert sections[0].effective_length == 0.4
    assert sections[1].effective_length > 0.3


def test_bores_that_change_add_nothing() -> None:
    twist = 0.4 / polar(0.1, 0.05) + 0.3 / polar(0.1)
    assert stiffness(section(0.4, 0.1, id=0.05), section(0.3, 0.1)) == pytest.approx(
        G / twist, rel=1e-13
    )


@pytest.mark.parametrize("length", [1e-6, 1e-3, 1e-2])
def test_a_thin_collar_is_as_stiff_as_the_shaft_it_sits_on(length: float) -> None:
    plain = stiffness(section(1.0 + length, 0.1))
    collar = stiffness(section(0.5, 0.1), section(length, 0.3), section(0.5, 0.1))
    assert collar == pytest.approx(plain, rel=1e-12)


def test_a_long_collar_stiffens() -> None:
    collar = stiffness(section(0.4, 0.1), section(0.2, 0.3), section(0.4, 0.1))
    assert stiffness(section(1.0, 0.1)) < collar < stiffness(section(0.8, 0.1))


def test_a_third_of_a_section_in_a_hub_twists() -> None:
    free, hub = 0.5, 0.15
    found = stiffness(section(free, 0.1), section(hub, 0.1, penetration=1.0 / 3.0))
    assert found == pytest.approx(G * polar(0.1) / (free + hub / 3.0), rel=1e-13)
    whole, _ = sections_of(train(section(free, 0.1), section(hub, 0.1, penetration=0.2)))["rotor"]
    inertia = sum(
        s.inertia for s in sections_of(train(section(hub, 0.1, penetration=0.2)))["rotor"]
    )
    assert inertia == pytest.approx(RHO * polar(0.1) * hub, rel=1e-14)
    assert whole.effective_length == free


def test_a_keyway_takes_its_share_of_the_solid_section() -> None:
    plain = section(0.5, 0.1, id=0.03)
    keyed = replace(plain, keyway_width=0.028, keyway_depth=0.01)
    share = 1.0 - keyway_loss(0.28, 0.1) * polar(0.1) / polar(0.1, 0.03)
    assert stiffness(keyed) == pytest.approx(share * stiffness(plain), rel=1e-13)
    assert 0.85 < share < 0.92


@pytest.mark.parametrize(("first", "last"), [(0.1, 0.15), (0.3, 0.12)])
@pytest.mark.parametrize("bore", [0.0, 0.05])
def test_a_taper(first: float, last: float, bore: float) -> None:
    """Integrals along it; of a solid one ∫ dx/J = 32 L (1/d³ − 1/D³) / 3π (D − d)."""

    def area(share: float) -> float:
        return polar(first + (last - first) * share, bore)

    only = sections_of(train(section(0.6, first, end_od=last, id=bore)))["rotor"][0]
    twist = 0.6 * quad(lambda share: 1.0 / area(share), 0.0, 1.0)[0]
    assert only.stiffness == pytest.approx(G / twist, rel=1e-6)
    assert only.inertia == pytest.approx(RHO * 0.6 * quad(area, 0.0, 1.0)[0], rel=1e-9)
    assert only.effective_length == pytest.approx(twist * polar(first, bore), rel=1e-6)
    if not bore:
        closed = 32.0 * 0.6 * (first**-3 - last**-3) / (3.0 * math.pi * (last - first))
        assert only.stiffness == pytest.approx(G / closed, rel=1e-6)
    slices = only.slices if last > first else only.slices[::-1]
    assert [a[0] for a in slices] == sorted((a[0] for a in slices), reverse=True)


def test_a_taper_without_shoulders_has_no_step() -> None:
    whole = stiffness(section(0.3, 0.1), section(0.4, 0.1, end_od=0.2), section(0.3, 0.2))
    parts = (
        stiffness(section(0.3, 0.1)),
        stiffness(section(0.4, 0.1, end_od=0.2)),
        stiffness(section(0.3, 0.2)),
    )
    assert 1.0 / whole == pytest.approx(sum(1.0 / k for k in parts), rel=1e-12)


def test_a_step_beside_a_taper_is_that_of_the_diameters_there() -> None:
    step = 0.1 * step_length(1.5) * (1.0 / polar(0.1) - 1.0 / polar(0.15))
    whole = stiffness(section(0.4, 0.1), section(0.4, 0.15, end_od=0.2))
    parts = (stiffness(section(0.4, 0.1)), stiffness(section(0.4, 0.15, end_od=0.2)))
    assert 1.0 / whole == pytest.approx(sum(1.0 / k for k in parts) + step / G, rel=1e-12)


def test_material_of_a_section() -> None:
    bronze = SectionMaterialRow("bronze", 45e9, 8800.0)
    light = SectionMaterialRow("massless", 79.3e9, 0.0)
    rows = (section(0.5, 0.1, material="bronze"), section(0.5, 0.1, material="massless"))
    first, second = sections_of(train(*rows, materials=(bronze, light)))["rotor"]
    assert first.stiffness == pytest.approx(45e9 * polar(0.1) / 0.5, rel=1e-14)
    assert first.inertia == pytest.approx(8800.0 * polar(0.1) * 0.5, rel=1e-14)
    assert second.inertia == 0.0
    alone = train(section(0.5, 0.1, material="massless"), materials=(bronze, light))
    assert natural_modes(alone).segments == ()
    assert build_train(alone).n_dof == 2


# --- what holds of any shaft ----------------------------------------------------------------------


@st.composite
def stepped(draw) -> tuple[SectionRow, ...]:
    """Sections of ratios up to 3, some hollow, in a hub or keyed, fillets that fit."""
    rows = []
    for _ in range(draw(st.integers(1, 25))):
        length, od = draw(st.floats(0.01, 1.0)), draw(st.floats(0.1, 0.3))
        taper = (
            draw(st.sampled_from([0.0, 1.0]))
            * draw(st.floats(-1.0, 1.0))
            * min(0.2 * od, 0.49 * length)
        )
        bore = draw(st.sampled_from([None, 0.3 * od, 0.6 * od]))
        hub = draw(st.sampled_from([None, 1.0 / 3.0]))
        rows.append(
            section(length, od, end_od=od + taper if taper else None, id=bore, penetration=hub)
        )
    for i, (a, b) in enumerate(pairwise(rows)):
        if a.last_od != b.od and draw(st.booleans()):
            rows[i] = replace(a, fillet=draw(st.floats(0.0, 0.5)) * 0.5 * abs(a.last_od - b.od))
    return tuple(rows)


def turned(rows: tuple[SectionRow, ...]) -> tuple[SectionRow, ...]:
    """Seen from the other end; a fillet stands in the row before its step."""
    fillets = [row.fillet for row in rows[:-1]]
    return tuple(
        replace(row, fillet=fillet, od=row.last_od, end_od=row.od)
        for row, fillet in zip(rows[::-1], [*fillets[::-1], None], strict=True)
    )


@FEW
@given(stepped())
def test_the_same_from_either_end(rows: tuple[SectionRow, ...]) -> None:
    assert stiffness(*turned(rows)) == pytest.approx(stiffness(*rows), rel=1e-12)


@FEW
@given(stepped())
def test_between_the_thinnest_shaft_and_the_sum_of_cylinders(rows: tuple[SectionRow, ...]) -> None:
    """A step makes it softer than its cylinders, and never softer than if all were the thinnest of its solid parts."""
    twist = sum(
        row.length * (row.penetration or 1.0) / polar(max(row.od, row.last_od), row.id or 0.0)
        for row in rows
    )
    found = stiffness(*rows)
    assert found <= G / twist * (1.0 + 1e-12)
    least = min(polar(min(row.od, row.last_od), row.id or 0.0) for row in rows)
    longest = sum(row.length for row in rows)
    assert found >= G * least / longest * (1.0 - 1e-12)


@FEW
@given(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=25), st.sampled_from([None, 0.05]))
def test_cutting_a_shaft_changes_nothing(lengths: list[float], bore: float | None) -> None:
    whole, cut = (
        train(section(math.fsum(lengths), 0.1, id=bore)),
        train(*(section(length, 0.1, id=bore) for length in lengths)),
    )
    found = [sections_of(case)["rotor"] for case in (whole, cut)]
    assert series_stiffness(found[1]) == pytest.approx(series_stiffness(found[0]), rel=1e-12)
    assert math.fsum(s.inertia for s in found[1]) == pytest.approx(found[0][0].inertia, rel=1e-12)


@FEW
@given(stepped(), st.sampled_from([1, 8, 60]))
def test_a_train_of_sections_has_their_stiffness_and_inertia(
    rows: tuple[SectionRow, ...], pieces: int
) -> None:
    case = train(*rows)
    own = sections_of(case)["rotor"]
    built = build_train(case, {"rotor": pieces})
    assert 1.0 / float(np.sum(1.0 / built.stiffness)) == pytest.approx(
        series_stiffness(own), rel=1e-10
    )
    assert float(np.sum(built.inertia)) == pytest.approx(
        30.0 + sum(s.inertia for s in own), rel=1e-12
    )


# --- in a train -----------------------------------------------------------------------------------


def test_frequencies_are_those_of_two_rods_in_series() -> None:
    """Exact: each rod passes angle and torque by sines and cosines of ω L / c; both ends carry a disc."""
    lengths, bores, od = (0.9, 0.6), (0.0, 0.14), 0.2
    case = train(
        *(section(length, od, id=bore) for length, bore in zip(lengths, bores, strict=True))
    )
    speed = math.sqrt(G / RHO)

    def remainder(omega: float) -> float:
        angle, torque = 1.0, -10.0 * omega * omega  # torque of the shaft behind the left disc
        for length, bore in zip(lengths, bores, strict=True):
            z, phase = math.sqrt(G * RHO) * polar(od, bore), omega * length / speed
            angle, torque = (
                angle * math.cos(phase) + torque * math.sin(phase) / (omega * z),
                torque * math.cos(phase) - angle * omega * z * math.sin(phase),
            )
        return torque + 20.0 * omega * omega * angle * -1.0

    grid = 2.0 * math.pi * np.linspace(5.0, 6000.0, 6000)
    values = [remainder(omega) for omega in grid]
    exact = [
        brentq(remainder, a, b)
        for a, b, x, y in zip(grid, grid[1:], values, values[1:], strict=False)
        if x * y < 0
    ]
    modes = natural_modes(case, 5000.0, 1e-4)
    count = 4
    assert modes.modes.elastic_frequency[:count] == pytest.approx(
        np.array(exact[:count]) / (2 * math.pi), rel=2e-4
    )
    assert modes.frequency_error <= 1e-4


def test_sections_are_finer_where_a_wave_takes_longer() -> None:
    case = train(section(0.1, 0.1), section(0.9, 0.1))
    profile = link_of(case.elements[0], None, sections_of(case)["rotor"]).profile
    assert profile.pieces == (1, 2)
    ((_, pieces),) = natural_modes(case, 500.0).segments
    assert pieces % 3 == 0


def test_a_typed_stiffness_is_used_and_spread_like_the_sections() -> None:
    rows = (section(0.5, 0.1), section(0.5, 0.2))
    typed = train(*rows, stiffness=1e6)
    built = build_train(typed, {"rotor": 2})
    assert 1.0 / float(np.sum(1.0 / built.stiffness)) == pytest.approx(1e6, rel=1e-12)
    own = build_train(train(*rows), {"rotor": 2})
    ratio = built.stiffness / own.stiffness
    assert ratio == pytest.approx(np.full(len(ratio), ratio[0]))


def test_a_coupling_that_separates_stays_one_piece() -> None:
    plain = train(section(0.5, 0.1), section(0.5, 0.2))
    coupling = replace(plain.elements[0], kind="coupling")
    case = Case(
        **vars(plain)
        | {"elements": (coupling,), "meshes": (MeshRow("rotor", angular_backlash=1e-3),)}
    )
    assert natural_modes(case).segments == ()
    assert len(build_train(case).stiffness) == 1
    assert modes_of(build_train(case)).n_modes == 2


def test_table_of_the_results_and_notes() -> None:
    rows = (section(0.5, 0.1, section="journal"), section(0.5, 0.2))
    results = run(train(*rows))
    table = result_tables(results)["SectionResults"]
    assert [row["section"] for row in table] == ["journal", "2", "whole"]
    assert table[2]["inertia"] == pytest.approx(
        table[0]["inertia"] + table[1]["inertia"], rel=1e-12
    )
    assert 1.0 / table[2]["stiffness"] == pytest.approx(
        1.0 / table[0]["stiffness"] + 1.0 / table[1]["stiffness"], rel=1e-12
    )
    (note,) = [note for note in results.warnings if "sections of 'rotor'" in note]
    assert "must not contain it" in note
    (note,) = [
        note
        for note in run(train(*rows, stiffness=1e6)).warnings
        if "typed in table Elements" in note
    ]
    share = 1e6 / table[2]["stiffness"]
    assert f"{share:.3g} ×" in note
