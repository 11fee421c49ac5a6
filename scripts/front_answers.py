"""What every worksheet function answers here, to the bit: `python scripts/front_answers.py FILE`.

The calls are those that tests/libreoffice/test_every_front.py sends through each front. Doubles are written in base 16.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / room) for room in ("", "libreoffice", "worksheet", "server")]

from sheet_ranges import model_arguments, with_conditions, with_event  # noqa: E402
from test_calc_workbook import every_call  # noqa: E402

from addin.worksheet.registry import call  # noqa: E402

#: The one column that is measured and not calculated.
MEASURED = ("TV_EFFECTS", "Time [ms]")


def answers() -> list[tuple[str, list[list[Any]]]]:
    """Functions with the rows that each call gives, the model first."""
    arguments = with_conditions(with_event(model_arguments()))
    made = call("TV_MODEL", arguments)
    found = [("TV_MODEL", made)]
    found += [(name, call(name, raw)) for name, _, raw in every_call(made[0][0])]
    return [(name, _in_bits(name, rows)) for name, rows in found]


def _in_bits(name: str, rows: list[list[Any]]) -> list[list[Any]]:
    at = rows[0].index(MEASURED[1]) if name == MEASURED[0] else None
    return [
        [one.hex() if isinstance(one, float) else one for j, one in enumerate(row) if j != at]
        for row in rows
    ]


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(answers()), encoding="utf-8")
