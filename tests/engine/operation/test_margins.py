"""Separation margins, their verdicts and the interference diagram."""

import math
from dataclasses import replace

import numpy as np
import pytest
from sample_case import sample_case

from engine.case.case import Case
from engine.case.data import ElementRow, ExcitationRow, LoadTorqueRow, MotorTorqueRow, StationRow
from engine.case.result_words import Judgement
from engine.model.build_train import build_train
from engine.model.excitation import (
    Excitation,
    excitation_places,
    excitations_of,
    operating_range,
    transmitted_torque,
)
from engine.model.modes import modes_of
from engine.operation.margins import interference, percent_speed, separation_margins
from engine.run import at_speed

RPM = math.pi / 30.0


def two_disks(frequency=50.0, **scalars):
    """Two equal disks with one natural frequency: ω² = 2 k / J."""
    k = 0.5 * 10.0 * (2.0 * math.pi * frequency) ** 2
    stations = (StationRow("A", None, 10.0), StationRow("B", None, 10.0))
    return Case(stations=stations, elements=(ElementRow("Shaft", "shaft", "A", "B", k),), **scalars)


def margins_of(case):
    train = build_train(case)
    modes = modes_of(train)
    return separation_margins(case, train, modes, excitations_of(case, train))


def names_of(case):
    return [x.name for x in excitations_of(case, build_train(case))]


# --- what shakes the train ------------------------------------------------------------------------


def test_the_default_excitations_of_the_sample():
    assert names_of(sample_case("proposed")) == [
        "1× motor speed",
        "2× motor speed",
        "1× Pinion speed",
        "2× Pinion speed",
        "1× line",
        "2× line",
    ]


def test_the_default_frequencies_of_the_sample():
    case = sample_case("proposed")
    speed = case.ratings.synchronous_speed
    frequencies = [x.frequency_at(speed) for x in excitations_of(case, build_train(case))]
    assert frequencies == pytest.approx([30.0, 60.0, 168.0, 336.0, 60.0, 120.0], rel=1e-14)


def test_no_line_frequency_no_line_excitation():
    case = two_disks(synchronous_speed=1800 * RPM)
    assert names_of(case) == ["1× motor speed", "2× motor speed"]
    assert any("LineFrequency" in w for w in margins_of(case).warnings)


def test_every_distinct_shaft_speed_once():
    stations = [StationRow(n, None, 1.0, r) for n, r in zip("ABCD", (1, 3, 3, 0.5), strict=True)]
    elements = (
        ElementRow("M1", "gear mesh", "A", "B"),
        ElementRow("S", "shaft", "B", "C", 1e5),
        ElementRow("M2", "gear mesh", "A", "D", 1e6),
    )
    case = Case(stations=tuple(stations), elements=elements)
    assert names_of(case) == [f"{n}× {what} speed" for what in ("motor", "B", "D") for n in (1, 2)]


def test_the_table_replaces_the_default():
    case = replace(
        sample_case("proposed"),
        excitations=(
            ExcitationRow(
                "vane pass", order=7.0, of_station="LP comp", station="LP comp", torque=5.0
            ),
            ExcitationRow("drive", frequency=25.0, torque_share=0.02),
            ExcitationRow("half", order=0.5),
        ),
    )
    a, b, c = excitations_of(case, build_train(case))
    assert (a.order, a.ratio, a.station, a.torque) == (7.0, 5.6, "LP comp", 5.0)
    assert (b.order, b.frequency, b.torque_share) == (None, 25.0, 0.02)
    assert (c.order, c.ratio, c.of_station) == (0.5, 1.0, None)


# --- transmitted torque ---------------------------------------------------------------------------


def test_the_torque_the_sample_transmits():
    case = sample_case("proposed")
    train = build_train(case)
    t = transmitted_torque(case, train)
    rated = 58400.0
    expected = [rated] * 4 + [rated / 5.6] * 3 + [0.4 * rated / 5.6] * 3
    assert t.element == pytest.approx(expected, rel=1e-12)
    assert t.load[train.stations.index("LP comp")] == pytest.approx(0.6 * rated / 5.6)
    assert t.warnings == ()


def test_the_paper_s_one_percent_at_motor_gears_and_machines():
    case = sample_case("proposed")
    train = build_train(case)
    places = excitation_places(case, train, transmitted_torque(case, train), Excitation("x", 1.0))
    told = {train.stations[p.station]: p.torque for p in places}
    assert told == pytest.approx(
        {
            "Motor": 584.0,
            "Bull gear": 584.0,
            "Pinion": 584.0 / 5.6,
            "LP comp": 0.6 * 584.0 / 5.6,
            "HP comp": 0.4 * 584.0 / 5.6,
        },
        rel=1e-12,
    )


def test_running_loads_come_before_load_torque():
    case = sample_case("proposed")
    stations = tuple(
        replace(s, running_load=8000.0) if s.station == "HP comp" else s for s in case.stations
    )
    case = replace(case, stations=stations)
    train = build_train(case)
    t = transmitted_torque(case, train)
    assert t.element == pytest.approx([8000.0 * 5.6] * 4 + [8000.0] * 6)
    places = excitation_places(case, train, t, Excitation("x", 1.0))
    told = {train.stations[p.station]: p.torque for p in places}
    assert told == pytest.approx(
        {"Motor": 584.0, "Bull gear": 448.0, "Pinion": 80.0, "HP comp": 80.0}
    )


def test_a_given_place_and_share():
    case = sample_case("proposed")
    train = build_train(case)
    t = transmitted_torque(case, train)

    def at(station, **torque):
        x = Excitation("x", 1.0, station=station, **torque)
        (place,) = excitation_places(case, train, t, x)
        assert train.stations[place.station] == station
        return place.torque

    assert at("HS hub C", torque_share=0.05) == pytest.approx(0.05 * 58400.0 / 5.6)
    assert at("Motor", torque_share=0.05) == pytest.approx(0.05 * 58400.0)
    assert at("LP comp") == pytest.approx(0.01 * 0.6 * 58400.0 / 5.6)
    assert at("HS hub C", torque=77.0) == 77.0


def test_nothing_known_is_said():
    case = two_disks(line_frequency=60.0, poles=4)
    train = build_train(case)
    t = transmitted_torque(case, train)
    assert np.all(t.element == 0.0)
    assert any("Running load" in w for w in t.warnings)
    assert excitation_places(case, train, t, Excitation("x", 1.0)) == ()


def test_two_motors_share_by_their_largest_torque():
    """A 3:1 pair of motors on both ends of one shaft, the load between them."""
    stations = (
        StationRow("M1", None, 10.0),
        StationRow("Load", None, 10.0, running_load=1000.0),
        StationRow("M2", None, 10.0),
    )
    elements = (
        ElementRow("A", "shaft", "M1", "Load", 1e6),
        ElementRow("B", "shaft", "Load", "M2", 1e6),
    )
    motors = tuple(
        MotorTorqueRow(name, x, torque, 0.0)
        for name, torque in (("M1", 900.0), ("M2", 300.0))
        for x in (0.0, 1.0)
    )
    case = Case(
        stations=stations,
        elements=elements,
        motor_torque=motors,
        line_frequency=60.0,
        poles=4,
        rated_torque=1000.0,
    )
    t = transmitted_torque(case, build_train(case))
    assert np.abs(t.element) == pytest.approx([750.0, 250.0])
    assert t.rated == pytest.approx([750.0, 0.0, 250.0])


def test_a_damper_beside_a_spring_transmits_nothing():
    stations = (
        StationRow("A", None, 1.0),
        StationRow("B", None, 1.0, running_load=100.0),
    )
    elements = (
        ElementRow("Spring", "coupling", "A", "B", 3e5),
        ElementRow("Second", "coupling", "A", "B", 1e5),
        ElementRow("Damper", "coupling", "A", "B", 0.0, damping=10.0),
    )
    case = Case(stations=stations, elements=elements)
    t = transmitted_torque(case, build_train(case))
    assert t.element == pytest.approx([75.0, 25.0, 0.0], abs=1e-9)


def test_load_torque_without_rating_is_taken_as_it_is():
    case = two_disks(
        line_frequency=60.0,
        poles=4,
        load_torque=(LoadTorqueRow("B", 0.5, 100.0), LoadTorqueRow("B", 1.0, 400.0)),
    )
    t = transmitted_torque(case, build_train(case))
    assert t.element == pytest.approx([400.0])
    assert any("RatedTorque" in w for w in t.warnings)


# --- margins --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("design", "expected"),
    [
        (
            "proposed",
            {(30, "1× motor speed"): 0.0, (53, "2× motor speed"): 7 / 60, (53, "1× line"): 7 / 60},
        ),
        ("modified", {(69, "2× motor speed"): 0.15, (69, "1× line"): 0.15}),
    ],
)
def test_the_margins_the_sample_misses(design, expected):
    """Proposed: 0 % at 30 Hz, 11.7 % at 53 Hz; modified: 15.0 % at 69 Hz. Not to be tuned away."""
    margins = margins_of(sample_case(design))
    missed = {(round(r.mode_frequency), r.excitation): r.margin for r in margins.not_kept}
    assert missed.keys() == expected.keys()
    for key, value in expected.items():
        assert missed[key] == pytest.approx(value, abs=1e-6)
    assert {r.required for r in margins.rows} == {0.2}
    assert len(margins.rows) == 10 * 6
    assert [r.mode for r in margins.rows[::6]] == list(range(1, 11))
    assert margins.worst == min(margins.rows, key=lambda r: r.margin)


def test_measured_frequencies_need_ten_percent():
    """69 Hz keeps 15 % and 53 Hz keeps 11.7 %: both pass where they were measured."""
    assert margins_of(sample_case("modified", margin_basis="measured")).not_kept == ()
    missed = margins_of(sample_case("proposed", margin_basis="measured")).not_kept
    assert {round(r.mode_frequency) for r in missed} == {30}


def test_a_margin_of_one_s_own_comes_first():
    case = sample_case("modified", margin_basis="measured", margin_required=0.16)
    assert {round(r.mode_frequency) for r in margins_of(case).not_kept} == {69}


@pytest.mark.parametrize(
    ("low", "high", "margin", "at"),
    [
        (1000, 2000, 2 / 3, 2000),  # the range ends below
        (2500, 3500, 0.0, 3000),  # it crosses: 3000 rpm = 50 Hz
        (3000, 3600, 0.0, 3000),  # it touches
        (4000, 5000, 0.25, 4000),  # it begins above
        (1500, 1500, 1.0, 1500),  # one speed
    ],
)
def test_the_least_margin_over_the_speed_range(low, high, margin, at):
    case = two_disks(
        minimum_speed=low * RPM,
        maximum_speed=high * RPM,
        excitations=(ExcitationRow("1x", order=1.0),),
    )
    (row,) = margins_of(case).rows
    if margin == 2 / 3:
        margin = abs(50.0 - 2000 / 60) / (2000 / 60)
    assert row.margin == pytest.approx(margin, abs=1e-12)
    assert row.speed == pytest.approx(at * RPM, rel=1e-12)
    assert row.excitation_frequency == pytest.approx(at / 60, rel=1e-12)


def test_the_margin_is_the_least_of_a_fine_sweep():
    rng = np.random.default_rng(3)
    case = sample_case("proposed", minimum_speed=1500 * RPM, maximum_speed=1850 * RPM)
    train = build_train(case)
    excitations = {x.name: x for x in excitations_of(case, train)}
    speeds = np.linspace(1500 * RPM, 1850 * RPM, 40001)
    for row in rng.choice(np.array(margins_of(case).rows, dtype=object), 20, replace=False):
        x = excitations[row.excitation]
        swept = np.array([x.frequency_at(s) for s in speeds])
        least = np.min(np.abs(row.mode_frequency - swept) / swept)
        assert row.margin == pytest.approx(least, abs=3e-6)


def test_an_order_of_a_geared_shaft():
    case = sample_case(
        "proposed",
        excitations=(ExcitationRow("x", order=0.5, of_station="HP comp"),),
        minimum_speed=1000 * RPM,
        maximum_speed=1300 * RPM,
    )
    row = margins_of(case).rows[1]  # 53 Hz = 0.5 · 5.6 · 1135.7 rpm
    assert row.margin == 0.0
    assert row.speed / RPM == pytest.approx(53.0 * 60 / (0.5 * 5.6), rel=1e-6)


@pytest.mark.parametrize("share", [0.2, 0.1, 0.15])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_margin_equal_to_the_required_one_passes(share, side):
    """Whatever rounding does to a frequency typed to keep the margin exactly."""
    for f_exc in (7.0, 30.0, 60.0, 61.7, 333.3):
        case = two_disks(
            f_exc * (1.0 + side * share),
            margin_required=share,
            excitations=(ExcitationRow("x", frequency=f_exc),),
        )
        assert [r.verdict for r in margins_of(case).rows] == [Judgement.PASS]
        missed = replace(case, margin_required=share + 1e-6)
        assert [r.verdict for r in margins_of(missed).rows] == [Judgement.FAIL]


def test_without_a_speed_only_fixed_frequencies_are_judged():
    case = two_disks(line_frequency=60.0)
    margins = margins_of(case)
    assert {r.excitation for r in margins.rows} == {"1× line", "2× line"}
    assert operating_range(case) is None
    assert margins.speed_range is None
    (warning,) = margins.warnings
    assert "1× motor speed" in warning
    assert "SynchronousSpeed" in warning


def test_a_train_without_elastic_modes_has_no_margins():
    case = Case(stations=(StationRow("Only", None, 1.0),), line_frequency=60.0, poles=4)
    margins = margins_of(case)
    assert margins.rows == ()
    assert margins.worst is None


# --- interference diagram -------------------------------------------------------------------------


def test_percent_speed_of_table_1():
    """Rounded half up, as the paper prints: 82.5 → 83."""
    table = {30: 75, 53: 56, 86: 28, 21: 83, 39: 68, 69: 43}
    for frequency, percent in table.items():
        assert math.floor(percent_speed(frequency, 60.0) + 0.5) == percent
    assert percent_speed(120.0, 60.0) == 0.0
    assert percent_speed(120.1, 60.0) is None


def test_the_lines_of_the_interference_diagram():
    case = sample_case("modified")
    train = build_train(case)
    d = interference(case, modes_of(train), excitations_of(case, train))
    assert d.highest_speed == pytest.approx(1.1 * case.ratings.synchronous_speed, rel=1e-12)
    assert [name for name, _ in d.orders] == [n for n in names_of(case) if "speed" in n]
    assert [f for _, f in d.orders] == pytest.approx([33.0, 66.0, 184.8, 369.6])
    assert d.fixed == (("1× line", 60.0), ("2× line", 120.0))


@pytest.mark.parametrize(("share", "reach"), [(0.8, 1.1), (1.0, 1.1), (1.3, 1.43)])
def test_the_interference_diagram_reaches_beyond_the_highest_speed(share, reach):
    """A tenth beyond synchronous speed, or beyond the highest of operation if that is higher."""
    synchronous = 60.0 * math.pi
    case = sample_case(
        "modified", minimum_speed=0.5 * synchronous, maximum_speed=share * synchronous
    )
    train = build_train(case)
    d = interference(case, modes_of(train), excitations_of(case, train))
    assert d.highest_speed == pytest.approx(reach * synchronous, rel=1e-12)
    assert d.orders[0][1] == pytest.approx(reach * 30.0, rel=1e-12)


def test_the_interference_diagram_of_a_case_without_speeds():
    case = two_disks()
    train = build_train(case)
    d = interference(case, modes_of(train), excitations_of(case, train))
    assert d.highest_speed is None
    assert [f for _, f in d.orders] == [0.0, 0.0]


def test_two_names_of_one_frequency_have_one_margin():
    """1 × line and 2 × motor speed of a four-pole motor are both 60 Hz, whatever rounding says."""
    rows = at_speed(sample_case("modified")).margins.rows
    for mode in {row.mode for row in rows}:
        of = {row.excitation: row for row in rows if row.mode == mode}
        assert of["1× line"].margin == of["2× motor speed"].margin
        assert of["1× line"].excitation_frequency == of["2× motor speed"].excitation_frequency
