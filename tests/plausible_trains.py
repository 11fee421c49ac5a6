"""Random trains as they are built: 0.5 to 30 MW, direct or through a gear, with what engineers know of them.

Everything follows from power and speed by rules of design: shaft diameters from a rated shear stress of
15 to 60 MPa, couplings from their twist, inertias from the inertia constants of motors and machines, gears
from their pitch line velocity, strengths of shaft steels, catalogue limits of couplings and gears.
"""

from __future__ import annotations

import math

import numpy as np

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    ExcitationRow,
    LoadTorqueRow,
    MaterialRow,
    MeshRow,
    ModeDampingRow,
    MotorTorqueRow,
    SNPointRow,
    StationRow,
)

SPEEDS = (0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 1.0)
STEEL = 80e9
DENSITY = 7850.0


def plausible_train(seed: int) -> Case:
    """A motor, its coupling, perhaps a gear and a second coupling, and one or two machines."""
    rng = np.random.default_rng((seed, 1978))
    line = float(rng.choice([50.0, 60.0]))
    poles = int(rng.choice([2, 4, 6, 8, 10, 12]))
    speed = 4.0 * math.pi * line / poles
    power = float(10.0 ** rng.uniform(math.log10(0.5e6), math.log10(30e6)))
    torque = power / speed
    is_geared = poles >= 4 and rng.random() < 0.6
    ratio = float(rng.uniform(1.5, min(8.0, 1500.0 / speed))) if is_geared else 1.0
    n_machines = int(rng.integers(1, 3))
    machine_share = (
        [1.0] if n_machines == 1 else [float(x := rng.uniform(0.4, 0.7)), 1.0 - float(x)]
    )
    # energies over power: motors 0.4 to 1.5 s, machines 0.2 to 4 s (large for fans), gear 0.02 to 0.2 s
    energy = 2.0 * power / speed**2
    stations, elements, meshes = [], [], []

    def station(name: str, constant: float, at: float = 1.0, load: float | None = None) -> str:
        inertia = constant * energy / at**2
        stations.append(StationRow(name, None, float(inertia), at, running_load=load))
        return name

    def shaft(name: str, start: str, end: str, carried: float) -> None:
        stress = float(rng.uniform(15e6, 60e6))
        bore = float(rng.uniform(0.2, 0.5)) if rng.random() < 0.1 else 0.0
        d = (16.0 * carried / (math.pi * stress * (1.0 - bore**4))) ** (1.0 / 3.0)
        length = d * float(rng.uniform(1.0, 12.0))
        k = STEEL * math.pi * d**4 * (1.0 - bore**4) / (32.0 * length)
        by_geometry = rng.random() < 0.5
        has_both = rng.random() < 0.2
        thin = d * float(rng.uniform(0.8, 1.0))
        elements.append(
            ElementRow(
                name, "shaft", start, end,
                float(k * rng.uniform(0.6, 1.1)) if has_both or not by_geometry else None,
                od=d if by_geometry or has_both else None,
                id=bore * d if (by_geometry or has_both) and bore else None,
                length=length if by_geometry or has_both else None,
                shear_modulus=float(rng.uniform(77e9, 83e9)) if by_geometry or has_both else None,
                density=DENSITY if by_geometry and rng.random() < 0.2 else None,
                stress_diameter=thin, stress_bore=bore * d or None, scf=float(rng.uniform(1.3, 3.5)),
                material="steel",
            )
        )  # fmt: skip

    def coupling(name: str, start: str, end: str, carried: float) -> None:
        is_rubber = rng.random() < 0.15
        twist = math.radians(
            float(rng.uniform(2.0, 12.0) if is_rubber else 10.0 ** rng.uniform(-1.4, 0.2))
        )
        rated = carried * float(rng.uniform(1.3, 3.0))
        elements.append(
            ElementRow(
                name, "coupling", start, end, carried / twist,
                loss_factor=float(rng.uniform(0.05, 0.18)) if is_rubber else None,
                rated_torque=rated, peak_torque_limit=rated * float(rng.uniform(2.0, 3.0)),
                vibratory_limit=rated * float(rng.uniform(0.2, 0.4)),
            )
        )  # fmt: skip

    load_share = float(rng.uniform(0.75, 1.0))
    running = [load_share * torque / ratio * s for s in machine_share]
    types_running_load = rng.random() < 0.5
    near = station("Motor", float(rng.uniform(0.4, 1.5)))
    hub = station("Motor hub", float(rng.uniform(0.002, 0.02)))
    shaft("Motor shaft", near, hub, torque)
    near = station("Driven hub", float(rng.uniform(0.002, 0.02)))
    coupling("Main coupling", hub, near, torque)
    if is_geared:
        velocity = float(rng.uniform(30.0, 130.0))
        drive = velocity / speed
        wheel = station("Wheel", float(rng.uniform(0.02, 0.2)))
        pinion = station("Pinion", float(rng.uniform(0.01, 0.08)), ratio)
        shaft("Wheel shaft", near, wheel, torque)
        is_elastic = rng.random() < 0.5
        tooth = float(rng.uniform(5e-6, 40e-6))
        on_bearings = is_elastic and rng.random() < 0.4
        mass = [0.0, 0.0]
        if on_bearings:
            gyration = rng.uniform(0.6, 0.85, 2)
            mass = [
                float(stations[-2].inertia or 0.0) / (float(gyration[0]) * drive) ** 2,
                float(stations[-1].inertia or 0.0) / (float(gyration[1]) * drive / ratio) ** 2,
            ]
        stiff = [m * (2.0 * math.pi * float(rng.uniform(30.0, 300.0))) ** 2 for m in mass]
        damp = [
            2.0 * float(rng.uniform(0.05, 0.5)) * math.sqrt(k * m)
            for k, m in zip(stiff, mass, strict=True)
        ]
        elements.append(
            ElementRow(
                "Mesh", "gear mesh", wheel, pinion, torque * drive / tooth if is_elastic else None,
                rated_torque=torque * float(rng.uniform(1.2, 2.0)),
                peak_torque_limit=torque * float(rng.uniform(2.5, 5.0)),
                reversal_limit=torque * float(rng.uniform(0.2, 1.0)),
            )
        )  # fmt: skip
        meshes.append(
            MeshRow(
                "Mesh", None, drive, drive / ratio, math.radians(float(rng.choice([20.0, 22.5, 25.0]))),
                math.radians(float(rng.uniform(0.0, 30.0))),
                mass_drive=mass[0] or None, mass_driven=mass[1] or None,
                bearing_stiffness_drive=stiff[0] or None, bearing_stiffness_driven=stiff[1] or None,
                bearing_damping_drive=damp[0] or None, bearing_damping_driven=damp[1] or None,
            )
        )  # fmt: skip
        hub = station("Pinion hub", float(rng.uniform(0.001, 0.01)), ratio)
        shaft("Pinion shaft", pinion, hub, torque / ratio)
        near = station("Machine hub", float(rng.uniform(0.001, 0.01)), ratio)
        coupling("Fast coupling", hub, near, torque / ratio)
    left = 1.0
    for i, part in enumerate(machine_share):
        carried = torque / ratio * left
        constant = float(rng.uniform(0.2, 3.0)) * part
        name = f"Machine {i + 1}"
        machine = station(name, constant, ratio, running[i] if types_running_load else None)
        shaft(f"{name} shaft", near, machine, carried)
        left -= part
        if i + 1 < n_machines:
            hub = station(f"{name} hub", float(rng.uniform(0.001, 0.01)), ratio)
            shaft(f"{name} far shaft", machine, hub, torque / ratio * left)
            near = station("Last hub", float(rng.uniform(0.001, 0.01)), ratio)
            coupling("Last coupling", hub, near, torque / ratio * left)
    uts = float(rng.uniform(600e6, 1150e6))
    is_bending = rng.random() < 0.5
    endurance = uts * float(rng.uniform(0.3, 0.5) if is_bending else rng.uniform(0.12, 0.28))
    pull_up = float(rng.uniform(0.4, 0.9))
    average = np.array(
        [pull_up, pull_up, 1.02 * pull_up, 1.1 * pull_up, 1.3 * pull_up, 1.6, 1.2, 0.0]
    )
    pulsating = float(rng.uniform(0.1, 0.35)) * np.array([1.0, 1.0, 1.0, 0.95, 0.9, 0.8, 0.8, 0.8])
    at_full = float(rng.uniform(0.15, 0.4))
    breakaway = float(rng.uniform(0.03, 0.12))
    load = [max(breakaway * (x < 0.05), at_full * x**2) + 0.01 for x in SPEEDS]
    excitations: tuple[ExcitationRow, ...] = ()
    if rng.random() < 0.4:
        excitations = (
            ExcitationRow("Motor 1x", 1.0, "Motor", torque_share=0.01),
            ExcitationRow("Motor 2x", 2.0, "Motor", torque_share=0.01),
            ExcitationRow("Machine 1x", 1.0, "Machine 1", torque_share=0.01),
            ExcitationRow("Line", frequency=line, station="Motor", torque_share=0.01),
            ExcitationRow("Twice line", frequency=2.0 * line, station="Motor", torque_share=0.01),
        )
    return Case(
        line_frequency=line,
        poles=poles,
        rated_power=power,
        damping_ratio=float(rng.uniform(0.005, 0.03)),
        mode_damping=(ModeDampingRow(1, float(rng.uniform(0.01, 0.04))),) if rng.random() < 0.3 else (),
        margin_required=float(rng.choice([0.1, 0.15, 0.2])) if rng.random() < 0.3 else None,
        minimum_speed=float(rng.uniform(0.5, 0.97)) * speed if rng.random() < 0.2 else None,
        end_speed=float(rng.uniform(0.95, 0.98)) * speed if rng.random() < 0.5 else None,
        starts_required=float(rng.choice([500.0, 1000.0, 5000.0])),
        starts_factor=float(rng.choice([1.0, 2.0, 3.0])) if rng.random() < 0.5 else None,
        voltage=float(rng.uniform(0.8, 1.0)) if rng.random() < 0.3 else None,
        stations=tuple(stations),
        elements=tuple(elements),
        meshes=tuple(meshes),
        motor_torque=tuple(
            MotorTorqueRow("Motor", x, float(torque * a), float(torque * b))
            for x, a, b in zip(SPEEDS, average, pulsating, strict=True)
        ),
        load_torque=tuple(
            LoadTorqueRow(f"Machine {i + 1}", x, float(torque / ratio * part * y))
            for i, part in enumerate(machine_share)
            for x, y in zip(SPEEDS, load, strict=True)
        ),
        materials=(
            MaterialRow("steel", uts, uts * float(rng.uniform(0.6, 0.85)), endurance,
                        "bending" if is_bending else "torsion"),
        ),
        sn_points=(
            SNPointRow("steel", 1e3, uts * float(rng.uniform(0.8, 0.95) if is_bending else rng.uniform(0.5, 0.7))),
            SNPointRow("steel", float(10.0 ** rng.uniform(6.0, 7.0)), endurance),
        ),
        excitations=excitations,
    )  # fmt: skip
