"""What the examples of docs/functions.md answer, as the tests of that page calculate it."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests" / "worksheet")]

import test_documented_formulas as documented  # noqa: E402  (found through the lines above)

#: Its answer is a digest.
WITHOUT = ("TV_MODEL",)


def function_answers() -> Mapping[str, Sequence[Sequence[object]]]:
    """Rows of each example, the headers first."""
    limit, documented.studies.TIME_LIMIT = (
        documented.studies.TIME_LIMIT,
        600.0,
    )  # on a busy machine, too
    try:
        handle = documented.call("TV_MODEL", documented.model_arguments())[0][0]
        return {
            name: documented.answer_of_the_example(name, handle)
            for name in documented.FUNCTIONS
            if name not in WITHOUT
        }
    finally:
        documented.studies.TIME_LIMIT = limit
