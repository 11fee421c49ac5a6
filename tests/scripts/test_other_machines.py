"""`scripts/other_machines.py`: the machine that differs most from this one."""

from __future__ import annotations

from script_modules import script_module

other_machines = script_module("other_machines")

HERE = {
    "numpy's OpenBLAS": "SkylakeX",
    "scipy's OpenBLAS": "SkylakeX",
    "numpy's vector instructions": ["X86_V3", "X86_V4"],
    "instructions": ["SSE3", "SSE42", "AVX2", "AVX512BW"],
}


def test_the_oldest_machine_has_the_oldest_routines_and_no_vector_instructions():
    machine = other_machines.oldest(other_machines.machines(HERE))
    assert machine.environment == {
        "OPENBLAS_CORETYPE": "Prescott",
        "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4",
    }
    assert machine.loaded == {
        "numpy's OpenBLAS": "Katmai",
        "scipy's OpenBLAS": "Katmai",
        "numpy's vector instructions": [],
    }


def test_without_openblas_the_oldest_machine_has_no_vector_instructions():
    without = HERE | {"numpy's OpenBLAS": None, "scipy's OpenBLAS": None}
    machine = other_machines.oldest(other_machines.machines(without))
    assert machine.environment == {"NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4"}
