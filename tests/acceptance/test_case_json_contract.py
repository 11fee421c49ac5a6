"""Case JSON as an outside user knows it from the contract alone, through the command line."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.reference.json_schemas import results_schema

TRAIN: dict[str, Any] = {
    "format": 1,
    "line_frequency": 60,
    "poles": 4,
    "rated_torque": 1000,
    "damping_ratio": 0.02,
    "stations": [
        {"station": "M", "inertia": 5.0},
        {"station": "G1", "inertia": 1.0},
        {"station": "G2", "inertia": 0.02, "speed_ratio": 5},
        {"station": "C", "inertia": 0.15, "speed_ratio": 5},
    ],
    "elements": [
        {"element": "s1", "kind": "shaft", "from": "M", "to": "G1", "stiffness": 2e5},
        {"element": "m", "kind": "gear mesh", "from": "G1", "to": "G2", "stiffness": 5e7},
        {"element": "s2", "kind": "shaft", "from": "G2", "to": "C", "stiffness": 1.5e4},
    ],
    "motor_torque": [
        {"station": "M", "speed": x, "average": a, "pulsating": p}
        for x, a, p in ((0, 600, 150), (0.5, 800, 140), (0.9, 1000, 100), (1.0, 0, 110))
    ],
    "load_torque": [
        {"station": "C", "speed": x, "torque": t} for x, t in ((0, 0), (0.5, 10), (1.0, 60))
    ],
}


def train(**changes: Any) -> dict[str, Any]:
    """The train with some keys replaced."""
    return {**copy.deepcopy(TRAIN), **changes}


def results(folder: Path, case: dict[str, Any] | str) -> dict[str, Any]:
    """What `recalc case.json --json out.json` writes; it must exit with 0."""
    status, out = recalculated(folder, case)
    assert status == 0, out
    return out


def recalculated(folder: Path, case: dict[str, Any] | str) -> tuple[int, dict[str, Any]]:
    """Exit status and JSON of one recalculation."""
    source, target = folder / "case.json", folder / "out.json"
    source.write_text(case if isinstance(case, str) else json.dumps(case), encoding="utf-8")
    done = CliRunner().invoke(app, ["recalc", str(source), "--json", str(target)])
    assert done.exception is None or isinstance(done.exception, SystemExit), repr(done.exception)
    return done.exit_code, json.loads(target.read_text(encoding="utf-8"))


def peak(out: dict[str, Any], element: str) -> float:
    """Largest torque of an element in the start. [N m]"""
    return next(r["maximum_torque"] for r in out["startup_peaks"] if r["element"] == element)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("inertia", [1e-6, 1e-7, 1e-9])
def test_load_on_a_very_light_station_is_not_lost(tmp_path: Path, inertia: float) -> None:
    """The shaft must carry the load whatever the station weighs: 55.8 N m, as with 1e-5 kg m²."""
    stations = [*TRAIN["stations"][:3], {"station": "C", "inertia": inertia, "speed_ratio": 5}]
    out = results(tmp_path, train(stations=stations))
    assert peak(out, "s2") == pytest.approx(55.83, rel=2e-3)
    assert out["startup"]["time"] == pytest.approx(1.7118, rel=5e-3)


def test_results_of_a_prescribed_torque_fit_the_shipped_schema(tmp_path: Path) -> None:
    """A train with TorqueTime only has an outcome the schema knows."""
    case = {
        "format": 1,
        "stations": [{"station": "a", "inertia": 2}, {"station": "b", "inertia": 6}],
        "elements": [{"element": "s", "kind": "shaft", "from": "a", "to": "b", "stiffness": 3e5}],
        "torque_time": [
            {"station": "a", "time": 0, "torque": 1000},
            {"station": "a", "time": 1, "torque": 1000},
        ],
    }
    out = results(tmp_path, case)
    jsonschema.Draft202012Validator(results_schema()).validate(out)
    assert peak(out, "s") == pytest.approx(1500, rel=1e-6)


def test_rounding_is_no_torque_reversal(tmp_path: Path) -> None:
    """A start that breaks no load away leaves −3e-7 N m at the mesh; that is zero."""
    load = [{"station": "C", "speed": x, "torque": t} for x, t in ((0, 200), (1, 60))]
    out = results(tmp_path, train(load_torque=load))
    assert out["outcome"] == "no breakaway"
    reversal = next(v for v in out["verdicts"] if v["check"] == "Torque reversal")
    assert "torque reverses" not in reversal["where"]


def test_mesh_stiffness_that_is_used_is_not_called_unused(tmp_path: Path) -> None:
    """Mesh stiffness along the line of action enters the modes; no note may deny it."""
    elements = copy.deepcopy(TRAIN["elements"])
    del elements[1]["stiffness"]
    mesh = {
        "element": "m", "pitch_radius_drive": 0.25, "pitch_radius_driven": 0.05,
        "pressure_angle": "20 deg", "helix_angle": "15 deg", "mesh_stiffness": 1e9,
    }  # fmt: skip
    out = results(tmp_path, train(elements=elements, meshes=[mesh]))
    assert out["natural_frequencies"][3]["frequency"] == pytest.approx(1981.74, rel=1e-5)
    assert not [w for w in out["warnings"] if "mesh_stiffness" in w and "not used" in w]


@pytest.mark.parametrize(
    "curve",
    [((0, 600, 150), (0.8, 1000, 100)), ((0.1, 600, 150), (0.9, 1000, 100), (1.0, 0, 100))],
    ids=["ends at 80 %", "begins at 10 %"],
)
def test_motor_curve_that_does_not_cover_the_start_is_told(tmp_path: Path, curve: Any) -> None:
    """Held constant outside its points: the engineer must be told that numbers were made up."""
    motor = [{"station": "M", "speed": x, "average": a, "pulsating": p} for x, a, p in curve]
    _, out = recalculated(tmp_path, train(motor_torque=motor))
    said = [*out["warnings"], *(e["message"] for e in out["errors"])]
    assert any("MotorTorque" in s and "%" in s for s in said), said


def test_integer_of_five_thousand_digits_is_an_input_error(tmp_path: Path) -> None:
    """Python refuses such an integer with a ValueError; the user gets a sentence."""
    text = json.dumps(TRAIN).replace('"inertia": 5.0', '"inertia": ' + "9" * 5000)
    status, out = recalculated(tmp_path, text)
    assert status == 1
    assert out["errors"][0]["message"]


def test_voltage_of_eighty_is_questioned(tmp_path: Path) -> None:
    """A plain 80 is 8000 % of rated; motor torques would be multiplied by 6400."""
    status, out = recalculated(tmp_path, train(voltage=80))
    assert status == 1
    assert out["errors"][0]["column"] == "Voltage"


@pytest.mark.slow
def test_start_that_would_take_hours_ends_in_time(tmp_path: Path) -> None:
    """An inertia typed in the wrong unit must not hang the command: time out, or an error."""
    stations = [*TRAIN["stations"][:3], {"station": "C", "inertia": 1e4, "speed_ratio": 5}]
    case = train(stations=stations)
    del case["load_torque"]
    source, target = tmp_path / "case.json", tmp_path / "out.json"
    source.write_text(json.dumps(case), encoding="utf-8")
    import subprocess
    import sys

    subprocess.run(
        [sys.executable, "-m", "addin.cli", "recalc", str(source), "--json", str(target)],
        timeout=60, check=False, capture_output=True, cwd=Path(__file__).resolve().parents[2],
    )  # fmt: skip
    out = json.loads(target.read_text(encoding="utf-8"))
    assert out["errors"] or out["outcome"] == "time out"
