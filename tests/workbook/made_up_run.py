"""Results of realistic size and shape, made up: what the writer is tested with, without an engine.

Only simple arithmetic that live formulas repeat (margins, % speed, UTS/25, 1/q) is consistent.
"""

from __future__ import annotations

import datetime as dt
import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from addin.calculation.calculation import RunView
from addin.contract.shipped import template_path
from addin.template.examples import EXAMPLES, example_case
from addin.writing.workbook import RunStamp
from engine.case.data import CaseData
from engine.case.effects import EFFECTS
from engine.start.start import ForceHistories

#: The workbook that results are written into, and what is said of the run.
SOURCE = template_path("example_proposed.xlsx")
STAMP = RunStamp("torsionbook 0.1.0", dt.datetime(2026, 11, 21, 7, 30), "0123456789abcdef" * 4)

FREQUENCIES = (30.0, 53.0, 86.0, 1067.38681, 1212.89755, 1264.60205, 1279.68229, 1452.8642)
LINE = 60.0
PSI = 6894.757293168361
UTS = 110000.0 * PSI
RPM = math.pi / 30.0
PULL_IN = {
    "field_time": 7.93, "field_slip": 0.03, "synchronised": True, "pole_slips": 1,
    "pull_in_time": 8.41, "load_angle": 0.423, "swing_frequency": 2.31,
}  # fmt: skip
PLANS = (
    {"number": 1, "reason": "from the linear analyses"},
    {"number": 2, "reason": "the run of plan 1 showed a torque reversal of -51,900 N m at Mesh, "
     "which its run-up had not: the clearance is modelled"},
)  # fmt: skip
DAMAGES = {"HP compressor shaft": 1.0 / 448.3, "Motor shaft": 0.0}


def made_up_run(case: CaseData | None = None) -> RunView:
    """Results for the example `proposed`, or for another case of at least one element."""
    case = case or _example()
    elements = [row.element or "" for row in case.elements]
    return RunView(
        case=case,
        tables={
            "Verdicts": _verdicts(),
            "NaturalFrequencies": _frequencies(elements),
            "ModeShapes": _shapes([row.station or "" for row in case.stations]),
            "SeparationMargins": _margins(),
            "SteadyState": _steady(elements),
            "StartupPeaks": _peaks(elements),
            "StartupCrossings": _crossings(elements),
            "TorqueReversals": _reversals(),
            "AllowableStarts": _starts(),
            "Effects": _effects(),
            "AccuracyCost": _accuracy(),
            "Audit": [
                {"item": f"Item {k}", "value": "some words of an equation " * (1 + 5 * (k % 3))}
                for k in range(20)
            ],
        },
        startup={"outcome": "reached", "time": 8.061, "end_speed": 182.8,
                 "sentence": "97 % speed reached after 8.06 s",
                 "pull_in": PULL_IN, "bearing_forces": _bearing_forces()},
        speed_time=(_time(), _speed(_time())),
        histories=_histories(elements),
        interference=_interference(),
        cycles=(("HP compressor shaft", *_cycles()),),
        plans=PLANS,
        contact_law="limited",
        forces=_forces(elements),
        load_angle=_load_angle(),
    )  # fmt: skip


def _example() -> CaseData:
    return example_case(EXAMPLES["proposed"], "us")


def _verdicts() -> list[dict[str, Any]]:
    words = (
        ("Overall", None, "text", None, "fail", "see Separation margin, Allowable starts"),
        ("Separation margin, mode 1", 0.0, "fraction", 0.2, "fail", "1× motor at 1,800 rpm"),
        ("Separation margin, mode 2", 0.11667, "fraction", 0.2, "accepted by forced response",
         "1× line frequency"),
        ("Separation margin, mode 3", 0.28333, "fraction", 0.2, "pass", "2× line frequency"),
        ("Steady-state stress", 5.1e7, "pressure", UTS / 25.0, "fail",
         "HP compressor shaft, peak-to-peak"),
        ("Peak stress in the start", 1.6e8, "pressure", None, "not judged",
         "no yield strength is given"),
        ("Allowable starts", 448.0, None, 2000.0, "fail", "HP compressor shaft"),
        ("End of the start", "reached", None, "97 % speed", "pass", "8.06 s"),
    )  # fmt: skip
    keys = ("check", "result", "dimension", "limit", "verdict", "where")
    return [dict(zip(keys, row, strict=True)) for row in words]


def _percent(frequency: float) -> float | None:
    return 1.0 - frequency / (2.0 * LINE) if frequency < 2.0 * LINE else None


def _frequencies(elements: list[str]) -> list[dict[str, Any]]:
    rigid = {"mode": 0, "frequency": 0.0, "cpm": 0.0}
    return [rigid] + [
        {
            "mode": k,
            "frequency": f,
            "cpm": 60.0 * f,
            "percent_speed": _percent(f),
            "damping_ratio": 0.015,
            "largest_strain_energy": elements[-k % len(elements)],
            "share": 0.35 + 0.05 * k,
        }
        for k, f in enumerate(FREQUENCIES, 1)
    ]


def _shapes(stations: list[str]) -> list[dict[str, Any]]:
    place = np.linspace(0.0, 1.0, len(stations))
    return [
        {"station": name}
        | {f"mode_{k}": float(np.cos(k * np.pi * place[i])) for k in range(1, len(FREQUENCIES) + 1)}
        for i, name in enumerate(stations)
    ]


def _margins() -> list[dict[str, Any]]:
    excitations = {"1× motor": 30.0, "2× motor": 60.0, "1× pinion": 168.0, "2× pinion": 336.0,
                   "1× line": 60.0, "2× line": 120.0}  # fmt: skip
    rows = []
    for mode, f in enumerate(FREQUENCIES, 1):
        for name, excitation in excitations.items():
            margin = abs(f - excitation) / excitation
            verdict = (
                "pass" if margin >= 0.2 else "fail" if mode == 1 else "accepted by forced response"
            )
            rows.append(
                {"mode": mode, "excitation": name, "speed": 1800.0 * RPM,
                 "excitation_frequency": excitation, "margin": margin, "required": 0.2,
                 "verdict": verdict}
            )  # fmt: skip
    return rows


def _steady(elements: list[str]) -> list[dict[str, Any]]:
    return [
        {
            "element": name,
            "excitation": "1× motor" if k % 2 else "1× line",
            "mode": 1 + k % 2,
            "frequency": FREQUENCIES[k % 2],
            "applied_at": "Motor",
            "applied_torque": 584.0,
            "torque": 5840.0 + 100.0 * k,
            "zero_to_peak_stress": 2.5e7 if "shaft" in name else None,
            "peak_to_peak_stress": 5.1e7 if "shaft" in name else None,
            "allowable": UTS / 25.0 if "shaft" in name else None,
            "verdict": "fail" if "shaft" in name else "not judged",
        }
        for k, name in enumerate(elements)
    ]


def _peaks(elements: list[str]) -> list[dict[str, Any]]:
    return [
        {
            "element": name,
            "maximum_torque": 117900.0 / (k + 1),
            "minimum_torque": -51900.0 / (k + 1),
            "peak_to_peak_torque": 169800.0 / (k + 1),
            "peak_to_peak_stress": 29990.0 * PSI if "HP comp" in name else None,
            "time": 5.1 + 0.01 * k,
            "percent_speed": 0.75,
            "error": 2.4e-4,
        }
        for k, name in enumerate(elements)
    ]


def _crossings(elements: list[str]) -> list[dict[str, Any]]:
    return [
        {
            "mode": mode,
            "frequency": f,
            "percent_speed": _percent(f),
            "time": 8.0 * (1.0 - f / 120.0) ** 0.9,
            "average_torque": 47000.0,
            "pulsating_torque": 7700.0,
            "load_torque": 9100.0,
            "acceleration": 24.0,
            "sweep_rate": 15.3,
            "governing_element": elements[-1],
            "peak_to_peak_torque": 12000.0,
            "peak_to_peak_stress": 2.06e8,
            "mesh_minimum_torque": -51900.0,
            "note": "33.3 × dwelling, 18 × swept undamped: acceleration takes off 46%. Mesh torque "
            "here reverses.",
        }
        for mode, f in enumerate(FREQUENCIES[:3], 1)
    ]


def _reversals() -> list[dict[str, Any]]:
    mesh = {
        "element": "Mesh",
        "minimum_torque": -51900.0,
        "reversals": 15,
        "time_unloaded": 0.0713,
        "impacts": 28,
        "recontact_speed": 0.0924,
        "tooth_force": 281000.0,
        "longest_reversal": 0.00712,
        "first_time": 4.981,
        "slip_frequency": 30.2,
        "transmitted_torque": 14600.0,
        "margin": -51900.0 / 14600.0,
        "limit": None,
        "verdict": "not judged",
        "recontact_speed_angular": 0.234,
        "model": "clearance",
        "note": "Mesh: torque reverses; no Reversal limit entered (15 reversals from 4.981 s on, "
        "the longest 7.12 ms, deepest at a 2 × slip frequency of 30.2 Hz)",
    }
    coupling = dict(mesh, element="LS coupling", minimum_torque=2100.0, reversals=0, impacts=None,
                    time_unloaded=0.0, recontact_speed=None, tooth_force=None, first_time=None,
                    longest_reversal=0.0, margin=2100.0 / 14600.0, limit=5000.0, verdict="pass",
                    recontact_speed_angular=None, model="linear",
                    note="LS coupling: torque stays positive")  # fmt: skip
    return [mesh, coupling]


def _effects() -> list[dict[str, Any]]:
    """Alternately on and off, with short and long reasons."""
    return [
        {
            "effect": name,
            "choice": "on" if name == "backlash" else "auto",
            "on": k % 2 == 0,
            "deciding_number": None if k == 3 else -0.889 + 0.1 * k,
            "limit": None if k == 3 else 1e-4 * k,
            "bound": None if k % 2 == 0 else 0.0 if k == 3 else 2.4e-4,
            "time": 0.0021 * (k + 1),
            "why": f"{effect.sentence}; " * (1 + k % 3) + "decided by the number beside",
        }
        for k, (name, effect) in enumerate(EFFECTS.items())
    ]


def _accuracy() -> list[dict[str, Any]]:
    """A study: second order against sixth."""
    rows = []
    for method, rate, cost in (("exponential", 6, 0.008), ("newmark", 2, 0.02)):
        for k in range(6):
            rows.append(
                {"method": method, "setting": f"step {1.6 / 2**k:g} ms",
                 "error_peak": 2e-2 / 2.0 ** (rate * k), "error_starts": 0.15 / 2.0 ** (rate * k),
                 "time": cost * 2.0**k}
            )  # fmt: skip
    return rows


def _bearing_forces() -> list[dict[str, Any]]:
    return [
        {"station": "Bull gear", "force": 312e3, "time": 5.213},
        {"station": "Pinion", "force": 305e3, "time": 5.214},
    ]


def _forces(elements: list[str]) -> ForceHistories:
    """Tooth force in proportion to the torque of the mesh, bearing forces half as large."""
    torque = _histories(elements).get("Mesh", (_time(), np.zeros(_time().size)))[1]
    tooth = torque * (281000.0 / np.max(np.abs(torque))) if torque.any() else torque
    bearing = np.abs(np.vstack([0.5 * tooth, 0.45 * tooth]))
    return ForceHistories(("Mesh",), tooth[None, :], ("Bull gear", "Pinion"), bearing)


def _load_angle() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A motor that turns through 260 cycles and comes to rest at 0.423 rad."""
    time = _time()
    angle = 0.423 + 2.0 * np.pi * 260.0 - 40.0 * np.maximum(7.95 - time, 0.0)
    return time, angle, np.where(time < 7.95, 0.03, 0.0)


def _starts() -> list[dict[str, Any]]:
    return [
        {
            "element": name,
            "damage": damage,
            "allowable_starts": 1.0 / damage if damage else None,
            "unlimited": damage == 0.0,
            "paper_count": 1.1 / damage if damage else None,
            "error": 0.012 if damage else None,
            "governing": "yes" if damage else None,
        }
        for name, damage in DAMAGES.items()
    ]


def _time() -> np.ndarray:
    return np.linspace(0.0, 8.061, 40001)


def _speed(time: np.ndarray) -> np.ndarray:
    return 182.8 * (0.72 * time / 8.061 + 0.28 * (time / 8.061) ** 2)


def _histories(elements: list[str]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    time = _time()
    bursts = ((70e3, 5.2, 0.18, 30.0), (25e3, 3.6, 0.1, 53.0), (12e3, 1.7, 0.08, 86.0),
              (30e3, 0.0, 0.02, 86.0))  # fmt: skip
    ring = sum(
        size * np.exp(-((time - at) ** 2) / width) * np.sin(2.0 * np.pi * f * time)
        for size, at, width, f in bursts
    )
    torque = 40000.0 + 3500.0 * time + ring
    return {name: (time, torque / (1.0 + k)) for k, name in enumerate(elements)}


def _interference() -> Any:
    highest = 1.1 * 1800.0 * RPM
    orders = {"1× motor": 1.0, "2× motor": 2.0, "1× pinion": 5.6, "2× pinion": 11.2}
    hertz = highest / (2.0 * np.pi)
    return SimpleNamespace(
        highest_speed=highest,
        mode_frequency=np.array(FREQUENCIES),
        orders=tuple((name, order * hertz) for name, order in orders.items()),
        fixed=(("1× line", 60.0), ("2× line", 120.0)),
    )


def _cycles() -> tuple[np.ndarray, np.ndarray]:
    amplitude = 310e6 * np.exp(-np.linspace(0.0, 4.0, 900))
    return amplitude, np.ones(amplitude.size)
