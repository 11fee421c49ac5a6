"""No function of the engine rounds in its own way on each machine, but for a listed few that no linear train needs."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2] / "engine"

#: Of numpy: what C libraries, vector units, BLAS and LAPACK round each in their own way.
OF_NUMPY = {
    "exp", "expm1", "exp2", "log", "log2", "log10", "log1p", "sin", "cos", "tan", "arcsin", "arccos", "arctan",
    "arctan2", "sinh", "cosh", "tanh", "hypot", "power", "float_power", "cbrt", "angle", "logaddexp", "dot", "vdot",
    "inner", "matmul", "einsum", "tensordot", "convolve", "correlate", "interp", "polyfit", "polyval", "roots", "cov",
    "corrcoef", "hanning", "hamming", "geomspace", "logspace", "fft", "linalg", "sinc", "kron",
}  # fmt: skip
OF_MATH = {
    "exp", "expm1", "exp2", "log", "log2", "log10", "log1p", "sin", "cos", "tan", "asin", "acos", "atan", "atan2",
    "sinh", "cosh", "tanh", "hypot", "pow", "dist", "cbrt", "gamma", "lgamma", "erf", "erfc",
}  # fmt: skip
#: Who may, and why.
ALLOWED = {
    "numerics/same_bits.py": "products of more than 512 rows",
    "numerics/singular_values.py": "LAPACK from 400 degrees of freedom on",
    "numerics/sample_statistics.py": "statistics of a sample",
    "model/frequency_derivatives.py": "sensitivities of frequencies that are equal",
    "start/event_results.py": "quantile of Student's distribution, for starts with clearances",
    "studies": "studies",
}


def uses(tree: ast.AST) -> Counter[str]:
    """What a file has of it: names as they stand, `@`, powers of a name that is no array to the eye."""
    found: Counter[str] = Counter()
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            found["@"] += 1
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            exponent = node.right
            if not (isinstance(exponent, ast.Constant) and exponent.value == 2):
                found["** other than 2"] += 1
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id == "np" and node.attr in OF_NUMPY:
                found[f"np.{node.attr}"] += 1
            if node.value.id in ("math", "cmath") and node.attr in OF_MATH:
                found[f"{node.value.id}.{node.attr}"] += 1
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("scipy"):
            found[f"{node.module}"] += 1
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr == "dot":
                found[".dot"] += 1
    return found


#: Whole powers of two, and powers of time in texts: exact.
POWERS_OF_TWO = {"start/simulation.py", "backlash/event_start.py"}


def test_only_the_listed_files_use_them():
    wrong = {}
    for path in sorted(ROOT.rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        if name in ALLOWED or name.split("/")[0] in ALLOWED:
            continue
        found = uses(ast.parse(path.read_text(encoding="utf-8")))
        if name in POWERS_OF_TWO:
            found.pop("** other than 2", None)
        if found:
            wrong[name] = dict(found)
    assert not wrong, "use engine/numerics/same_bits.py instead"


def test_no_permission_is_left_over():
    for name in ALLOWED:
        path = ROOT / name
        files = path.rglob("*.py") if path.is_dir() else [path]
        assert any(uses(ast.parse(f.read_text(encoding="utf-8"))) for f in files), name
