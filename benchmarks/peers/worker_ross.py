"""ROSS's own calls, timed in its own process (run in an environment that has it).

ROSS has no table of inertias and stiffnesses: the first span is a shaft element without mass whose
G·Ip/L is the stiffness wanted, the others are coupling elements, the inertias are disks; two
bearings are needed for a rotor at all. Of the six degrees of freedom of a station the torsional
one is kept. `load` tells how far the resulting matrices are from the wanted ones.
"""

from __future__ import annotations

import math
import time
from importlib.metadata import version
from typing import Any

from protocol import claim_output, serve, timed

ANSWERS = claim_output()
began = time.perf_counter()
import numpy as np  # noqa: E402
import ross  # noqa: E402
from ross.utils import convert_6dof_to_torsional  # noqa: E402

IMPORT_SECONDS = time.perf_counter() - began
SHEAR_MODULUS = 8e10
NEWMARK_TOLERANCE = 1e-2
"""The default of 1e-6 N·m is below the rounding of K·θ once the train turns."""


class Model:
    """The rotor the other calls work on."""

    rotor: Any
    stiffness: Any


def assemble(inertia: list[float], stiffness: list[float], damping: list[float]) -> Any:
    weightless = ross.Material("weightless", rho=1e-9, E=2e11, G_s=SHEAR_MODULUS)
    diameter = (32.0 * stiffness[0] / (SHEAR_MODULUS * math.pi)) ** 0.25
    beta = damping[0] / stiffness[0]
    spans = [
        ross.ShaftElement(
            L=1.0, idl=0.0, odl=diameter, material=weightless, n=0, alpha=0, beta=beta
        )
    ]
    for i in range(1, len(stiffness)):
        spans.append(
            ross.CouplingElement(
                m_l=0, m_r=0, Ip_l=0, Ip_r=0, kr_z=stiffness[i], cr_z=damping[i], n=i
            )
        )
    disks = [ross.DiskElement(n=i, m=1.0, Id=J, Ip=J) for i, J in enumerate(inertia)]
    bearings = [ross.BearingElement(n=n, kxx=1e8, cxx=0) for n in (0, len(inertia) - 1)]
    return convert_6dof_to_torsional(ross.Rotor(spans, disks, bearings))


def load(budget: float, **chain: list[float]) -> dict[str, Any]:
    Model.rotor, laps = timed(lambda: assemble(**chain), budget, 20)
    Model.stiffness = np.array(chain["stiffness"])
    J, k = np.array(chain["inertia"]), Model.stiffness
    B = np.eye(len(k), len(J)) - np.eye(len(k), len(J), 1)
    K = (B.T * k) @ B
    difference = max(
        float(np.max(np.abs(Model.rotor.M() - np.diag(J))) / J.max()),
        float(np.max(np.abs(Model.rotor.K(0.0) - K)) / np.max(np.abs(K))),
    )
    return {"laps": laps, "matrix_difference": difference}


def modes(variant: str, budget: float) -> dict[str, Any]:
    """`run_modal`; the frequencies as ROSS presents them (it leaves out |λ| < 0.1 rad/s)."""

    def call() -> Any:
        return Model.rotor.run_modal(0.0, sparse=variant == "sparse")

    call()
    result, laps = timed(call, budget, 50)
    return {"laps": laps, "omega": np.asarray(result.wn, dtype=float).tolist()}


def response(
    variant: str, step: float, station: int, torque: str, stride: int, out: str, budget: float
) -> dict[str, Any]:
    """`run_time_response`; k·Δθ of all shafts at every `stride`-th sample goes to `out`."""
    samples = np.load(torque)
    times = step * np.arange(len(samples))
    force = np.zeros((len(samples), Model.rotor.ndof))
    force[:, station] = samples
    options: dict[str, Any] = {}
    if variant != "lsim":
        options["method"] = "newmark"
    if variant == "newmark, tol 1e-2":
        options["tol"] = NEWMARK_TOLERANCE

    def call() -> Any:
        return Model.rotor.run_time_response(0.0, force, times, **options)

    result, laps = timed(call, budget, 20)
    angle = np.asarray(result.yout)[::stride]
    np.save(out, Model.stiffness[:, None] * (angle[:, :-1] - angle[:, 1:]).T)
    return {"laps": laps}


def forced(step: float, torques: str, out: str) -> dict[str, Any]:
    """`run_time_response` as it is by default; extremes of every k·Δθ go to the file `out`."""
    samples = np.load(torques)
    times = step * np.arange(len(samples))
    result = Model.rotor.run_time_response(0.0, samples, times)
    angle = np.asarray(result.yout)
    torque = Model.stiffness[:, None] * (angle[:, :-1] - angle[:, 1:]).T
    np.save(out, np.array([np.max(torque, axis=1), np.min(torque, axis=1)]))
    return {}


class Pair:
    """The gear pair with backlash the calls below work on."""

    data: dict[str, float]


def pair_rotor() -> Any:
    """Two shafts of two nodes: a gear on a bearing, a disk on another; teeth with backlash.

    ROSS keeps what it has seen of the mesh in the model and deletes it after a run, so that every
    run needs a model of its own.
    """
    d = Pair.data
    light = ross.Material("weightless", rho=1e-3, E=2e11, G_s=SHEAR_MODULUS)
    diameter = (32.0 * d["shaft_stiffness"] / (SHEAR_MODULUS * math.pi)) ** 0.25
    rotors = []
    for gear, disk in (("drive", "motor"), ("driven", "load")):
        mass = d[f"{gear}_mass"]
        inertia = d[f"{gear}_inertia"]
        teeth = ross.GearElement(
            n=0, m=mass, Id=inertia, Ip=inertia, n_teeth=50, pr_angle=d["pressure_angle"],
            pitch_diameter=2.0 * d["pitch_radius"],
        )  # fmt: skip
        shaft = ross.ShaftElement(
            L=1.0, idl=0.0, odl=diameter, material=light, n=0, alpha=0, beta=d["shaft_damping_time"]
        )
        rotating = ross.DiskElement(n=1, m=mass, Id=d[f"{disk}_inertia"], Ip=d[f"{disk}_inertia"])
        k = d["bearing_stiffness"]
        bearings = [ross.BearingElement(n=n, kxx=k, cxx=0, kzz=k, czz=0) for n in (0, 1)]
        rotors.append(ross.Rotor([shaft], [teeth, rotating], bearings))
    return ross.MultiRotor(
        *rotors,
        coupled_nodes=(0, 0),
        gear_mesh_stiffness=d["mesh_stiffness"],
        mesh_damping_ratio=d["mesh_damping_ratio"],
        backlash={
            "enable": True, "initial_value": 0.5 * d["gap"], "error_amp": 0.0,
            "smooth_operator": False, "sigma": 1e5,
        },
    )  # fmt: skip


def pair(  # fmt: skip
    variant: str,
    step: float,
    duration: float,
    knots: list[float],
    torque: list[float],
    out: str,
    **data: float,
) -> dict[str, Any]:
    """One run of the gear pair; the mesh force at every step goes to `out`."""
    Pair.data = data
    rotor = pair_rotor()
    times = step * np.arange(round(duration / step) + 1)
    force = np.zeros((len(times), rotor.ndof))
    force[:, 6 + 5] = np.interp(times, knots, torque)
    force[:, 18 + 5] = data["mean_torque"]
    result, laps = timed(
        lambda: rotor.run_time_response(
            data["speed"], force, times, method="newmark", newmark_type=variant
        ),
        0.0,
        1,
    )
    mesh = np.asarray(result.mesh_dynamics["mesh_force"])
    np.save(out, np.stack([times[len(times) - len(mesh) :], mesh]))
    return {"laps": laps, "dof": rotor.ndof}


def hello() -> dict[str, Any]:
    return {
        "versions": {name: version(name) for name in ("ross-rotordynamics", "numpy", "scipy")},
        "import_seconds": IMPORT_SECONDS,
    }


if __name__ == "__main__":
    HANDLERS = {
        "load": load, "modes": modes, "response": response, "forced": forced, "pair": pair,
    }  # fmt: skip
    serve(ANSWERS, hello(), HANDLERS)
