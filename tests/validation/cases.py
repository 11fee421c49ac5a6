"""The published and analytic cases in `cases/`: what each test takes from which is in its README."""

import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent / "cases"


def case_path(case_id: str, suffix: str = ".json") -> Path:
    """The one file whose name is `case_id` or begins with it and an underscore."""
    found = [
        path
        for path in sorted(FOLDER.glob(f"*{suffix}"))
        if path.stem == case_id or path.stem.startswith(f"{case_id}_")
    ]
    if len(found) != 1:
        raise LookupError(f"{case_id}: {[path.name for path in found]}")
    return found[0]


def load_case(case_id: str) -> dict[str, Any]:
    """A case by its number (`"W01"`) or, where a number has several files, its full name."""
    return json.loads(case_path(case_id).read_text(encoding="utf-8"))
