"""Repeat the numerical tests as other machines would calculate them.

    other_machines.py [--oldest] [words for pytest...]

OpenBLAS chooses its routines by the processor, numpy by the vector instructions it finds. Each choice
rounds differently. The tests must not depend on it: they run once for each processor whose routines
this one can run, and once without any of numpy's vector instructions. With `--oldest` they run only once,
with the routines of the oldest processor and without vector instructions. What was loaded is printed,
and must be what was asked for. Exit status 1 when a test failed or a choice had no effect.
"""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

#: What is repeated when nothing else is asked for.
NUMERICAL = ("tests/properties", "tests/numerics", "tests/validation", "tests/engine")

#: Processor of OpenBLAS: name that it reports when loaded, and the instructions it needs, by
#: numpy's names. Kernels of Prescott are those of all older ones, and report the oldest name.
CORES = {
    "Prescott": ("Katmai", "SSE3"),
    "Nehalem": ("Nehalem", "SSE42"),
    "Haswell": ("Haswell", "AVX2"),
    "SkylakeX": ("SkylakeX", "AVX512BW"),
}


@dataclass(frozen=True)
class Machine:
    """One way to calculate: its name, the variables that choose it, and what must be loaded."""

    name: str
    environment: dict[str, str]
    loaded: dict[str, object]


def loaded() -> dict[str, object]:
    """What numpy and scipy of this process calculate with."""
    import numpy
    import numpy._core._multiarray_umath as umath
    import scipy.linalg

    features = umath.__cpu_features__
    return {
        "numpy's OpenBLAS": _openblas_core(Path(numpy.__file__).parent),
        "scipy's OpenBLAS": _openblas_core(Path(scipy.__file__).parent),
        "numpy's vector instructions": [n for n in umath.__cpu_dispatch__ if features[n]],
        "instructions": [name for name, has in features.items() if has],
    }


def _openblas_core(package: Path) -> str | None:
    """Name of the core that the OpenBLAS of an installed package chose, None without one."""
    folders = (package.with_name(f"{package.name}.libs"), package / ".dylibs")
    for file in (file for folder in folders for file in folder.glob("*openblas*")):
        library = ctypes.CDLL(str(file))  # the copy that is loaded already
        for name in ("scipy_openblas_get_corename64_", "scipy_openblas_get_corename"):
            if hasattr(library, name):
                function = getattr(library, name)
                function.restype = ctypes.c_char_p
                return function().decode()
    return None


def machines(here: dict[str, object]) -> list[Machine]:
    """The ways to calculate that this machine can go."""
    made = []
    for core, (reported, needs) in CORES.items():
        if here["numpy's OpenBLAS"] is None or needs not in here["instructions"]:
            print(f"OPENBLAS_CORETYPE={core}: this machine cannot run it")
            continue
        wanted = {"numpy's OpenBLAS": reported, "scipy's OpenBLAS": reported}
        made.append(Machine(f"OpenBLAS for {core}", {"OPENBLAS_CORETYPE": core}, wanted))
    vectors = here["numpy's vector instructions"]
    if vectors:
        environment = {"NPY_DISABLE_CPU_FEATURES": " ".join(vectors)}
        wanted = {"numpy's vector instructions": []}
        made.append(Machine("numpy without vector instructions", environment, wanted))
    return made


def oldest(machines: Sequence[Machine]) -> Machine:
    """The one machine that differs most from this: the oldest choice of each kind, all at once.

    Machines of one kind are chosen by the same variables, and stand from the oldest on.
    """
    first: dict[tuple[str, ...], Machine] = {}
    for machine in machines:
        first.setdefault(tuple(machine.environment), machine)
    made = Machine(" and ".join(m.name for m in first.values()), {}, {})
    for machine in first.values():
        made.environment.update(machine.environment)
        made.loaded.update(machine.loaded)
    return made


def probe(environment: dict[str, str]) -> dict[str, object]:
    """What a new process with these variables calculates with."""
    text = subprocess.run(
        [sys.executable, __file__, "--loaded"],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    return json.loads(text)


def main(words: list[str]) -> int:
    """The tests on each machine, and a list of what failed."""
    for name in ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES"):
        os.environ.pop(name, None)
    chosen = machines(probe({}))
    if "--oldest" in words:
        words = [word for word in words if word != "--oldest"]
        chosen = [oldest(chosen)]
    if not any(word.startswith("tests") for word in words):
        words = [*NUMERICAL, *words]
    failed = []
    # The slow ones run once, on the machine as it is.
    tests = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rfE", *words]
    for machine in chosen:
        started = time.monotonic()
        choice = " ".join(f'{name}="{value}"' for name, value in machine.environment.items())
        print(f"\n--- {machine.name}: {choice}")
        found = probe(machine.environment)
        for name in list(found)[:3]:
            print(f"{name}: {found[name]}")
        sys.stdout.flush()
        wrong = {k: found[k] for k, wanted in machine.loaded.items() if found[k] != wanted}
        if wrong:
            failed.append(f"{machine.name}: had no effect, loaded {wrong}")
            continue
        environment = os.environ | machine.environment | {"TORSIONBOOK_RUN_SLOW": "0"}
        if subprocess.run(tests, cwd=ROOT, env=environment, check=False).returncode != 0:
            failed.append(f"{machine.name}: tests failed")
        print(f"--- {machine.name}: {time.monotonic() - started:.0f} s")
    print("\n" + ("\n".join(f"FAILED {line}" for line in failed) or "No test failed."))
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--loaded"]:
        print(json.dumps(loaded()))
    else:
        sys.exit(main(sys.argv[1:]))
