"""Derivatives against each other, against closed forms, and where there are none."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import (
    CaseData,
    EffectChoiceRow,
    ElementRow,
    FatigueFactorRow,
    MeshRow,
    StationRow,
)
from engine.case.effect import StartEffects
from engine.model.build_train import build_train
from engine.model.frequency_derivatives import clusters, frequency_derivatives
from engine.model.modes import modes_of
from engine.run import run
from engine.start.settings import PLAIN_START
from engine.start.start import run_start
from engine.start.start_fatigue import sn_slope
from engine.studies.sensitivities.differences import differences
from engine.studies.sensitivities.plan import derivative_units, plan_derivatives
from engine.studies.sensitivities.sensitivities import AGREED, Derivatives, gather_derivatives
from engine.studies.sensitivities.tables import derivative_rows, element_rows, frequency_rows
from engine.studies.sensitivities.tangent import tangent_of
from engine.studies.variation import Change, varied_case
from tests.engine.start.test_machine_damping import ANSWERING, case_from_data, modal_of
from tests.sample_case import sample_case
from tests.trains import geared
from tests.whole_studies import derivatives

#: Multiplying all of these by one number multiplies every torque by it and changes no motion.
TORQUE_LIKE = (
    "stiffness",
    "inertia",
    "damping",
    "average torque",
    "pulsating torque",
    "load torque",
)


@pytest.fixture(scope="module")
def short() -> Case:
    """The paper's train, whose starts are counted down to small cycles, so that none comes or goes."""
    case = sample_case("proposed")
    smooth = tuple(replace(m, below_endurance="same slope") for m in case.materials)
    return Case(**{**vars(case), "materials": smooth})


def geared_and_judged(short: Case) -> Case:
    """A train of four stations with a start of 2 s, its shafts of the paper's steel."""
    diameters = {"Low-speed shaft": 0.09, "High-speed shaft": 0.05}
    elements = tuple(
        replace(e, stress_diameter=diameters[str(e.element)], scf=2.0, material="alloy steel")
        if e.element in diameters
        else replace(e, stiffness=5e7)
        for e in geared().elements
    )
    return geared(
        elements=elements,
        materials=short.materials,
        sn_points=short.sn_points,
        end_speed=0.9 * 60.0 * np.pi,
    )


@pytest.fixture(scope="module", params=["geared", pytest.param("paper", marks=pytest.mark.slow)])
def judged(request: pytest.FixtureRequest, short: Case) -> Case:
    return short if request.param == "paper" else geared_and_judged(short)


@pytest.fixture(scope="module")
def found(judged: Case) -> Derivatives:
    return derivatives(judged)


# --- frequencies ----------------------------------------------------------------------------------


def _relative_change(case: CaseData, quantity: str, name: str, small: float = 1e-5) -> np.ndarray:
    low, high = (
        modes_of(
            build_train(varied_case(case, [Change(quantity, name, 1.0 + s)]))
        ).elastic_frequency
        for s in (-small, small)
    )
    return np.log(high / low) / (np.log1p(small) - np.log1p(-small))


def test_frequencies_follow_their_energies() -> None:
    """A gear train with a rigid mesh, whose stations share one referred inertia."""
    case = sample_case("proposed")
    rigid = tuple(replace(e, stiffness=None) if e.kind == "gear mesh" else e for e in case.elements)
    case = replace(CaseData(**vars(case)), elements=rigid)
    train = build_train(case)
    got = frequency_derivatives(case, train, modes_of(train))
    for row in got.rows:
        assert row.value == pytest.approx(
            _relative_change(case, row.quantity, row.name), abs=1e-6
        ), row.name
    assert got.of("stiffness", "Mesh") is None


def test_half_a_shafts_own_inertia_is_not_the_stations() -> None:
    case = CaseData(
        stations=(StationRow("A", None, 1.0), StationRow("B", None, 2.0)),
        elements=(
            ElementRow(
                "S", "shaft", "A", "B", od=0.2, length=1.5, shear_modulus=8e10, density=7850.0
            ),
        ),
    )
    train = build_train(case, {"S": 6})
    got = frequency_derivatives(case, train, modes_of(train))
    for name in ("A", "B"):
        low, high = (
            modes_of(build_train(varied_case(case, [Change("inertia", name, f)]), {"S": 6}))
            for f in (1.0 - 1e-5, 1.0 + 1e-5)
        )
        expected = np.log(high.elastic_frequency / low.elastic_frequency) / 2e-5
        assert got.of("inertia", name) == pytest.approx(expected, abs=1e-6)
    assert float(got.unnamed.max()) > 0.1


def _star(third: float) -> CaseData:
    """Three equal branches on a hub: two modes of one frequency, in which the hub stands still."""
    return CaseData(
        stations=tuple(StationRow(n, None, j) for n, j in zip("HABC", (5.0, 1, 1, 1), strict=True)),
        elements=tuple(
            ElementRow(f"K{n}", "shaft", "H", n, k)
            for n, k in zip("ABC", (1e6, 1e6, third * 1e6), strict=True)
        ),
    )


def test_equal_modes_have_one_sided_derivatives() -> None:
    case = _star(1.0)
    train = build_train(case)
    got = frequency_derivatives(case, train, modes_of(train))
    assert got.clusters == ((1, 2),)
    assert "nearly equal" in got.notes[0]
    small = 1e-4
    for n in "ABC":
        up = modes_of(build_train(varied_case(case, [Change("stiffness", f"K{n}", 1.0 + small)])))
        now = modes_of(train).elastic_frequency
        expected = np.log(up.elastic_frequency / now) / small
        assert got.of("stiffness", f"K{n}") == pytest.approx(expected, abs=2e-4)
    # energies of any one eigenvector of the pair would say something else: the pair moves by 0 and ⅓
    assert got.of("stiffness", "KA")[:2] == pytest.approx([0.0, 1.0 / 3.0], abs=1e-9)  # type: ignore[index]


def test_near_modes_are_named() -> None:
    case = _star(1.01)
    train = build_train(case)
    got = frequency_derivatives(case, train, modes_of(train))
    assert got.clusters == ()
    assert "exchanges their shapes" in got.notes[0]
    assert clusters(np.array([1.0, 2.0, 2.01, 2.02, 9.0]), 0.01) == [[1, 2, 3]]


# --- starts ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_two_ways_agree(found: Derivatives) -> None:
    """Every element's peak and every shaft's starts, by every quantity; tolerance as stated."""
    assert found.tangent is not None
    assert found.largest_difference is not None
    assert found.largest_difference < 0.01
    for own, error, other in (
        (found.peaks, found.peak_errors, found.tangent.peak),
        (found.all_starts, found.starts_errors, found.tangent.starts),
    ):
        scale = np.max(np.abs(own), axis=0)
        assert np.all(np.abs(own - other) <= AGREED * scale + 2.0 * error)
    assert found.tangent.off < 1e-4
    assert all(r.method == "differences, checked by tangent" for r in found.rows)


def test_the_tangent_needs_turning_times_only_to_a_step_error(short: Case) -> None:
    """An envelope holds where the tangent's own torque turns, not where that of a run with other steps does."""
    plan = plan_derivatives(geared_and_judged(short))
    finer = replace(plan, recipe=replace(plan.recipe, step=0.25 * plan.recipe.step))
    one, other = tangent_of(plan), tangent_of(finer)
    assert one is not None
    assert other is not None
    for a, b in ((one.peak, other.peak), (one.starts, other.starts)):
        # at the times of the runs themselves 1e-3 and 6e-4, of the paper's train 4e-3 and 1.5e-2
        assert np.all(np.abs(a - b) <= 2e-5 * np.max(np.abs(b), axis=0))


def test_torques_are_homogeneous(found: Derivatives) -> None:
    """Euler: the derivatives by all that makes torque add up to 1; those of the starts to −k.

    The rated torque enters no start, and the damping is modal. Both ways must obey it.
    """
    rows = [i for i, (q, _) in enumerate(found.parameters) if q in TORQUE_LIKE]
    assert found.tangent is not None
    slope = sn_slope(sample_case("proposed"))  # of a line that is straight from end to end
    for peak, starts, error, share in (
        (found.peaks, found.all_starts, found.peak_errors[rows].sum(axis=0), 0.02),
        (found.tangent.peak, found.tangent.starts, 0.0, 1e-5),
    ):
        assert np.all(np.abs(peak[rows].sum(axis=0) - 1.0) <= share + error)
        assert starts[rows].sum(axis=0) == pytest.approx(-slope, rel=share)
    assert (
        float(np.median(found.peak_errors[rows].sum(axis=0))) < 0.05
    )  # else it would prove little


def test_stated_errors_hold_at_a_fourth_of_the_step_and_are_near(
    judged: Case, found: Derivatives
) -> None:
    plan = plan_derivatives(judged)
    finer = replace(plan.recipe, step=0.25 * plan.recipe.step)
    ratios = []
    for unit in derivative_units(plan):
        if unit.parameter[0] not in ("average torque", "stiffness"):
            continue
        i, true = unit.index, differences(replace(unit, recipe=finer))
        for own, stated, other, doubt in (
            (found.peaks, found.stated_peak_errors, true.peak, true.peak_error),
            (found.all_starts, found.stated_starts_errors, true.starts, true.starts_error),
        ):
            off = np.abs(own[i] - other)
            assert np.all(off <= stated[i] + doubt), unit.parameter
            ratios += list(stated[i] / off)
    # the relative error of the answers times the largest derivative, in place of the measured change, is 1,850
    assert float(np.median(ratios)) < 300.0


def test_starts_follow_the_sn_line_by_its_slope(found: Derivatives) -> None:
    i = found.parameters.index(("S-N line", "alloy steel"))
    slope = sn_slope(sample_case("proposed"))
    assert found.all_starts[i] == pytest.approx(slope, rel=1e-6)
    assert np.all(found.peaks[i] == 0.0)


def _starts_by_differences(case: Case, parameter: tuple[str, str], step: float) -> np.ndarray:
    """d ln(starts)/d ln p of whole runs, each with its own steps."""
    logs = []
    for factor in (1.0 - step, 1.0 + step):
        changed = Case(**vars(varied_case(case, [Change(*parameter, factor)])))
        starts = run(changed).starts
        assert starts is not None
        logs.append([-np.log(shaft.damage) for shaft in starts.shafts])
    low, high = np.array(logs)
    return (high - low) / (np.log1p(step) - np.log1p(-step))


@pytest.mark.slow
def test_starts_with_a_mean_stress_and_factors_follow_whole_runs(short: Case) -> None:
    """Goodman and strength factors: differences of runs, whose own error is seen in steps of 1 and 2 %."""
    rows = tuple(
        FatigueFactorRow(shaft, surface=0.8, size="by diameter", reliability=0.9)
        for shaft in ("Low-speed shaft", "High-speed shaft")
    )
    case = replace(geared_and_judged(short), fatigue_factors=rows, mean_stress="Goodman")
    found = derivatives(case)
    assert found.tangent is not None
    for parameter in (("damping ratio", ""), ("pulsating torque", "Motor"), ("S-N line", "alloy steel")):  # fmt: skip
        i = found.parameters.index(parameter)
        near, far = (_starts_by_differences(case, parameter, step) for step in (0.01, 0.02))
        doubt = np.abs(far - near)
        for own in (found.all_starts[i], found.tangent.starts[i]):
            assert np.all(np.abs(own - near) <= found.stated_starts_errors[i] + doubt), parameter
            assert np.all(np.abs(own - near) <= 1e-3), parameter
    # the mean stress makes torque count for more than the amplitude of the line
    torque = [i for i, (q, _) in enumerate(found.parameters) if q in TORQUE_LIKE]
    line = found.all_starts[found.parameters.index(("S-N line", "alloy steel"))]
    assert np.all(-found.all_starts[torque].sum(axis=0) > line + 0.01)


def test_a_peak_that_swings_is_told(found: Derivatives) -> None:
    """Motor torque turns the phase at the resonance: ± 1 % does not do what the derivative says."""
    row = next(r for r in found.rows if r.quantity == "average torque")
    assert row.peak is not None
    assert row.peak_ends is not None
    assert "not linear within" in row.note
    assert abs(row.peak_ends[1] - 0.01 * row.peak) > 0.01
    # while damping does what it says
    damping = next(r for r in found.rows if r.quantity == "damping ratio")
    assert damping.note == ""
    assert damping.peak_ends is not None
    assert damping.peak_ends[1] == pytest.approx(0.01 * (damping.peak or 0.0), rel=0.02)
    assert damping.peak is not None
    assert damping.peak < 0.0


def test_the_strongest_comes_first_and_rows_are_plain_json(found: Derivatives) -> None:
    rows = derivative_rows(found)
    assert {rows[0]["quantity"], rows[1]["quantity"]} <= {"S-N line", "pulsating torque", "inertia"}
    for told in (rows, element_rows(found), frequency_rows(found)):
        assert json.loads(json.dumps(told, allow_nan=False)) == told
    listed = frequency_rows(found)
    assert max(abs(v) for r in listed for v in list(r.values())[2:]) < 0.5
    elastic = len(found.energies.rows[0].value)
    for k in range(
        1, min(elastic, 10) + 1
    ):  # every mode that there is, not those of the start alone
        of_mode = [r[f"mode_{k}"] for r in listed if r["quantity"] == "stiffness"]
        assert sum(of_mode) == pytest.approx(0.5, abs=1e-9), k
    assert len(element_rows(found)) == len(found.parameters) * len(found.elements)


def test_the_order_of_the_work_changes_nothing(short: Case) -> None:
    plan = plan_derivatives(short)
    done = [differences(u) for u in derivative_units(plan)[:4]]
    one, two = (gather_derivatives(plan, d, None) for d in (done, done[::-1]))
    assert np.array_equal(one.peaks, two.peaks)
    assert one.rows == two.rows
    assert sum(r.peak is not None for r in one.rows) == 4


# --- where there is no derivative -----------------------------------------------------------------


def test_without_a_start_frequencies_alone_are_differentiated(short: Case) -> None:
    still = Case(**{**vars(short), "motor_torque": (), "load_torque": ()})
    got = derivatives(still)
    assert all(r.peak is None and r.starts is None for r in got.rows)
    assert "No motor torque curve" in got.sentences[0]
    stiff = next(r for r in got.rows if r.quantity == "stiffness")
    assert stiff.method == "energies"
    assert max(stiff.frequency) > 0.0


def test_a_stalled_start_is_not_differentiated(short: Case) -> None:
    weak = tuple(replace(p, average=0.25 * (p.average or 0.0)) for p in short.motor_torque)
    got = derivatives(Case(**{**vars(short), "motor_torque": weak}))
    assert "The start ended as" in got.sentences[0]
    assert all(r.peak is None for r in got.rows)


def test_unlimited_starts_have_no_derivative(short: Case) -> None:
    strong = replace(
        CaseData(**vars(short)),
        sn_points=tuple(replace(p, stress=5.0 * (p.stress or 0.0)) for p in short.sn_points),
        materials=tuple(
            replace(m, endurance=5.0 * (m.endurance or 0.0), below_endurance="none")
            for m in short.materials
        ),
    )
    plan = plan_derivatives(Case(**vars(strong)))
    got = gather_derivatives(plan, [differences(derivative_units(plan)[0])], None)
    assert all(r.starts is None for r in got.rows)
    assert any(r.peak is not None for r in got.rows)


def test_a_start_with_teeth_that_part_has_differences_alone() -> None:
    case = sample_case("proposed")
    mesh = next(e for e in case.elements if e.kind == "gear mesh")
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    driven = 0.3 * ratio[mesh.from_] / ratio[mesh.to]
    row = MeshRow(mesh.element, None, 0.3, driven, backlash=5e-4)
    softer = tuple(replace(p, pulsating=0.5 * (p.pulsating or 0.0)) for p in case.motor_torque)
    plan = plan_derivatives(Case(**{**vars(case), "meshes": (row,), "motor_torque": softer}))
    assert plan.recipe.start == "planned"
    assert tangent_of(plan) is None
    unit = next(u for u in derivative_units(plan) if u.parameter[0] == "damping ratio")
    got = gather_derivatives(plan, [differences(unit)], None)
    told = next(r for r in got.rows if r.quantity == "damping ratio")
    assert told.method == "differences"
    assert told.peak is not None
    assert told.peak_error is not None
    assert any("only from differences of complete starts" in s for s in got.sentences)


def test_a_motor_that_answers_to_vibration_has_differences_alone() -> None:
    """They are those of complete starts 0.05 % to either side; the tangent has not what the motor answers."""
    curves = (EffectChoiceRow("motor transient", "off"),)
    case = case_from_data(tolerance_peak=1e-6, damping_ratio=0.002, effect_choices=curves)
    plan = plan_derivatives(case)
    assert plan.recipe.effects.electrical_damping
    assert tangent_of(plan) is None
    shaft = str(case.elements[0].element)
    unit = next(u for u in derivative_units(plan) if u.parameter == ("stiffness", shaft))
    got = differences(unit)
    said = gather_derivatives(plan, [got], None).sentences
    assert any("the motor answers oscillations (effect electrical damping)" in s for s in said)
    assert not any("modes are too close" in s for s in said)

    def by_hand(effects: StartEffects) -> np.ndarray:
        size = []
        for factor in (0.9995, 1.0005):
            varied = Case(**vars(varied_case(case, [Change("stiffness", shaft, factor)])))
            size.append([p.size for p in run_start(varied, modal_of(varied), effects).peaks])
        return np.log(np.divide(*size)) / np.log(0.9995 / 1.0005)

    expected = by_hand(ANSWERING)
    assert np.all(np.abs(got.peak - expected) <= got.peak_error + 5e-4 * np.max(np.abs(expected)))
    # and it matters: without the answer the derivatives are others
    assert np.max(np.abs(by_hand(PLAIN_START) - expected)) > 0.02
