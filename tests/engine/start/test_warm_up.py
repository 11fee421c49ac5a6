"""After the routines are loaded, a start compiles nothing: its time is that of its calculation."""

import subprocess
import sys

CODE = """
from addin.reading.workbook import read_workbook
from addin.contract.shipped import template_path
from engine.run import run
from engine.start.warm_up import load_routines
from engine.stepping import linear_loop as kernels

def loaded():
    return {n: list(k.signatures) for n, k in vars(kernels).items() if hasattr(k, "py_func")}

before = loaded()
assert not any(before.values()), "nothing is loaded by an import"
load_routines()
after = loaded()
assert after["advance_start"]
run(read_workbook(template_path("example_proposed.xlsx")).case())
assert loaded() == after
print("as loaded")
"""


def test_a_start_compiles_nothing_that_was_not_loaded() -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.stdout.strip() == "as loaded", done.stderr
