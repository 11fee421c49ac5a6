"""Differences as JSON, and single values and changes in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from addin.contract.json_formats import AUDIT_FORMAT
from addin.contract.tables import find_table
from addin.diff.changes import Change, Differences, Value
from addin.diff.files import ComparedFile
from addin.writing.results_json import storable

#: Changed results shown of each table unless all are asked for. [count]
SHOWN = 12
#: JSON keys of what is stated of either file.
_OF_FILES = {"before": "a", "after": "b", "result_before": "result_a", "result_after": "result_b"}


def in_words(change: Change, value: Value, *, unit: bool = True) -> str:
    """A value of a change as shown.

    Parameters
    ----------
    change : Change
        It.
    value : number, text or None
        Its `before` or `after`. [SI]
    unit : bool
        Put the unit behind a number. [flag]

    Returns
    -------
    str
        Six significant digits; a dash for a blank.
    """
    shown = change.shown(value)
    if shown is None or shown == "":
        return "–"
    if isinstance(shown, bool):
        return "yes" if shown else "no"
    if isinstance(shown, float) and not math.isfinite(shown):
        return str(shown)
    if isinstance(shown, int | float):
        shown = round(shown, 4) + 0.0 if change.unit == "%" else shown
        number = f"{shown:,.6g}" if abs(shown) < 1e6 else f"{shown:.6g}"
        return f"{number} {change.unit if unit and change.unit != '1' else ''}".rstrip()
    return str(shown)


def change_in_words(change: Change) -> str:
    """How much changed.

    Returns
    -------
    str
        ``+5.2 %`` where both are positive; points where the quantity is a percentage itself; else
        the difference in its unit, as −60 % of a negative number could be either way. Empty where
        nothing can be said.
    """
    difference, relative = change.difference, change.relative
    if difference is None:
        _, _, done = change.kind.partition("row ")
        return done
    if change.unit == "%":
        return f"{change.shown(difference):+.3g} points"
    positive = _size(change.before) > 0.0 and _size(change.after) > 0.0
    if relative is None or not positive:
        shown = float(change.shown(difference) or 0.0)
        number = f"{shown:+,.4g}" if not 1e4 <= abs(shown) < 1e6 else f"{shown:+,.0f}"
        return f"{number} {change.unit if change.unit != '1' else ''}".rstrip()
    return f"{100.0 * relative:+.3g} %" if abs(relative) < 10.0 else f"× {1.0 + relative:.3g}"


def telling(name: str, changes: Sequence[Change]) -> list[Change]:
    """The changes of a result table that an engineer asks for first."""
    spec = find_table(name)
    columns = () if spec is None else spec.changes_shown
    shown = [change for change in changes if change.column in columns and change.kind == "changed"]
    if name == "SeparationMargins":  # the margin nearest to the line
        shown.sort(key=lambda change: min(_size(change.before), _size(change.after)))
    elif name == "SteadyState":  # the most stressed
        shown.sort(key=lambda change: -max(_size(change.before), _size(change.after)))
    return shown[:SHOWN]


def _size(value: Value) -> float:
    return float(value) if isinstance(value, int | float) else 0.0


def as_json(differences: Differences) -> dict[str, Any]:
    """Everything that differs as a JSON object."""
    inputs, studies = differences.inputs, differences.studies
    return {
        "format": AUDIT_FORMAT,
        "a": _side(differences.first),
        "b": _side(differences.second),
        "same_inputs": differences.same_inputs,
        "same_results": differences.same_results,
        "verdicts": [
            {_OF_FILES.get(name, name): value for name, value in vars(check).items()}
            | {"changed": check.changed}
            for check in differences.verdicts
        ],
        "inputs": None if inputs is None else [_change(change) for change in inputs],
        "results": [_change(change) for change in differences.results],
        "studies": {
            "notes": list(studies.notes),
            "same_inputs": studies.same_inputs,
            "same_results": studies.same_results,
            "inputs": [_change(change) for change in studies.inputs],
            "results": [_change(change) for change in studies.results],
        },
    }


def _side(side: ComparedFile) -> dict[str, Any]:
    return {
        "file": str(side.source),
        "revision": side.revision,
        "case_sha256": side.digest,
        "software": side.software,
        "results": side.results_from,
        "settings": dict(side.settings),
    }


def _change(change: Change) -> dict[str, Any]:
    return {
        "kind": change.kind.replace(" ", "_"),
        "table": change.table,
        "row": change.row,
        "column": change.column,
        "a": storable(change.before),
        "b": storable(change.after),
        "difference": change.difference,
        "relative": change.relative,
        "shown_unit": change.unit,
        "administrative": change.administrative,
    }
