"""The sample case of the paper as a `Case`, from tests/validation/cases (read its provenance)."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    LoadTorqueRow,
    MaterialRow,
    MeshRow,
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


#: Stress diameter of shafts [m]; peak torque, vibratory and reversal limits of the others [N m].
DIAMETERS = {
    "Motor shaft": 0.25,
    "Gear shaft": 0.24,
    "Pinion shaft": 0.13,
    "LP shaft, drive end": 0.125,
    "LP shaft, far end": 0.095,
    "HP compressor shaft": 0.07,
}
LIMITS = {
    "LS coupling": (237e3, 25e3, None),
    "Mesh": (175e3, 15e3, 25e3),
    "HS coupling": (50e3, 5e3, None),
    "Intermediate coupling": (25e3, 2.5e3, None),
}


def with_limits(case: Case) -> Case:
    """The sample with what an engineer knows of every element, so that every check is judged.

    Without any backlash the linear start is the answer, whatever its mesh torque does.
    """
    elements = []
    for e in case.elements:
        peak, vibratory, reversal = LIMITS.get(str(e.element), (None, None, None))
        limited = replace(
            e, peak_torque_limit=peak, vibratory_limit=vibratory, reversal_limit=reversal
        )
        if e.element in DIAMETERS:
            diameter = DIAMETERS[str(e.element)]
            limited = replace(
                limited, stress_diameter=diameter, scf=e.scf or 2.0, material="alloy steel"
            )
        elements.append(limited)
    materials = (replace(case.materials[0], yield_=586e6),)
    tight = tuple(replace(m, backlash=0.0) for m in case.meshes) or (MeshRow("Mesh", backlash=0.0),)
    known = {
        "meshes": tight,
        "elements": tuple(elements),
        "materials": materials,
        "starts_required": 2000.0,
    }
    return Case(**(vars(case) | known))


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
