"""The sample case of the paper as a `Case`, from tests/validation/cases (read its provenance)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    LoadTorqueRow,
    MaterialRow,
    MotorTorqueRow,
    SNPointRow,
    StationRow,
)

PSI = 6894.757293168361
PATH = Path(__file__).parent / "validation" / "cases" / "SAMPLE_szenasi_von_nimitz.json"


def sample_data() -> dict[str, Any]:
    """The file as it is."""
    return json.loads(PATH.read_text(encoding="utf-8"))


def sample_case(design: str, **scalars: Any) -> Case:
    """The ``proposed`` or ``modified`` design; `scalars` change or add fields of `Case`."""
    d = sample_data()
    scf, uts = d["sn"]["scf"], 110_000 * PSI
    rated, curve = d["rated_torque_nm"], d["torque_speed"]
    speed = curve["speed_fraction"]
    ratio = {s["name"]: s["speed_ratio"] for s in d["stations"]}
    fields: dict[str, Any] = {
        "line_frequency": float(d["line_frequency_hz"]),
        "poles": d["poles"],
        "rated_torque": rated,
        "damping_ratio": d["modal_damping_ratio"],
        "stations": tuple(
            StationRow(s["name"], None, s["inertia"], s["speed_ratio"]) for s in d["stations"]
        ),
        "elements": tuple(_element(e, scf) for e in d["elements"][design]),
        "motor_torque": tuple(
            MotorTorqueRow("Motor", x, average * rated, pulsating * rated)
            for x, average, pulsating in zip(
                speed, curve["motor_average_pu"], curve["motor_pulsating_0pk_pu"], strict=True
            )
        ),
        "load_torque": tuple(
            LoadTorqueRow(name, x, load * rated * share / ratio[name])
            for name, share in curve["load_share"].items()
            for x, load in zip(speed, curve["load_pu_at_motor"], strict=True)
        ),
        "materials": (
            MaterialRow("alloy steel", uts, None, d["sn"]["endurance_psi"] * PSI, "torsion"),
        ),
        "sn_points": tuple(
            SNPointRow("alloy steel", cycles, stress * PSI)
            for stress, cycles in d["sn"]["points_psi_cycles"]
        ),
    }
    return Case(**(fields | scalars))


def _element(e: dict[str, Any], scf: float) -> ElementRow:
    stiffness = e.get("stiffness", e.get("stiffness_referred_to_motor_speed"))
    judged = "stress_diameter_m" in e
    return ElementRow(
        e["name"],
        e["kind"],
        e["from"],
        e["to"],
        stiffness,
        stress_diameter=e.get("stress_diameter_m"),
        scf=scf if judged else None,
        material="alloy steel" if judged else None,
    )
