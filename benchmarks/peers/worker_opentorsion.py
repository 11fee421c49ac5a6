"""openTorsion's own calls, timed in its own process (run in an environment that has it)."""

from __future__ import annotations

import time
from importlib.metadata import version
from typing import Any

from protocol import claim_output, serve, timed

ANSWERS = claim_output()
began = time.perf_counter()
import numpy as np  # noqa: E402
import opentorsion as ot  # noqa: E402

IMPORT_SECONDS = time.perf_counter() - began


class Model:
    """The assembly the other calls work on."""

    assembly: Any


def assemble(inertia: list[float], stiffness: list[float], damping: list[float]) -> Any:
    shafts = [
        ot.Shaft(i, i + 1, k=k, c=c)
        for i, (k, c) in enumerate(zip(stiffness, damping, strict=True))
    ]
    disks = [ot.Disk(i, I=value) for i, value in enumerate(inertia)]
    return ot.Assembly(shafts, disk_elements=disks)


def load(budget: float, **chain: list[float]) -> dict[str, Any]:
    Model.assembly, laps = timed(lambda: assemble(**chain), budget, 50)
    return {"laps": laps}


def modes(variant: str, budget: float) -> dict[str, Any]:
    """Frequencies in rising order; the smallest stands for the rigid-body mode and is left out."""
    call = getattr(Model.assembly, variant)
    call()
    result, laps = timed(call, budget, 200)
    if variant == "undamped_modal_analysis":
        omega = np.sort(np.sqrt(np.abs(result[0])))
    elif variant == "modal_analysis":
        omega = np.sort(np.real(result[0]))[::2]  # a conjugate pair a mode
    else:
        omega = np.sort(np.abs(result[0]))
    return {"laps": laps, "omega": omega[1:].tolist()}


def response(
    variant: str, step: float, station: int, torque: str, stride: int, out: str, budget: float
) -> dict[str, Any]:
    """`dsim`; torques of all shafts at every `stride`-th sample go to the file `out`."""
    samples = np.load(torque)
    times = step * np.arange(len(samples))

    def call() -> Any:
        excitation = ot.TransientExcitation(len(Model.assembly.M), times)
        excitation.add_transient(station, samples)
        return Model.assembly.dsim(excitation)

    result, laps = timed(call, budget, 20)
    np.save(out, result[0][:, ::stride])
    return {"laps": laps}


def forced(step: float, torques: str, out: str) -> dict[str, Any]:
    """`dsim` under torques on several stations; extremes of every shaft go to the file `out`.

    The answer of `dsim` is whole shaft torque; what the dampers take is not told apart.
    """
    samples = np.load(torques)
    times = step * np.arange(len(samples))
    excitation = ot.TransientExcitation(len(Model.assembly.M), times)
    for station in np.flatnonzero(np.any(samples, axis=0)):
        excitation.add_transient(int(station), samples[:, station])
    torque = Model.assembly.dsim(excitation)[0]
    np.save(out, np.array([np.max(torque, axis=1), np.min(torque, axis=1)]))
    return {}


def hello() -> dict[str, Any]:
    return {
        "versions": {name: version(name) for name in ("opentorsion", "numpy", "scipy")},
        "import_seconds": IMPORT_SECONDS,
    }


if __name__ == "__main__":
    serve(ANSWERS, hello(), {"load": load, "modes": modes, "response": response, "forced": forced})
