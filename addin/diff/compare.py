"""Two files → everything that differs between them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from addin.diff.changes import Change, Differences
from addin.diff.files import ComparedFile, read_compared_file
from addin.diff.inputs import Renamed, compare_inputs
from addin.diff.results import compare_results, compare_verdicts
from addin.diff.studies import compare_studies
from addin.diff.units import Units


def compare_files(
    first: Path,
    second: Path,
    *,
    recalculate: bool = False,
    on_stage: Callable[[str], None] | None = None,
) -> Differences:
    """Two files side by side.

    Raises
    ------
    CannotBeCompared
        When one of them cannot be read or calculated.
    """
    sides = [
        read_compared_file(path, recalculate=recalculate, on_stage=on_stage)
        for path in (first, second)
    ]
    return compare_read_files(*sides)


def compare_read_files(first: ComparedFile, second: ComparedFile) -> Differences:
    """Two sides that have been read."""
    # a case JSON is in SI, which nobody chose: workbooks alone say how numbers are shown
    units = Units([(s.typed, s.units) for s in (second, first) if s.units is not None])
    inputs: tuple[Change, ...] | None = None
    renamed, same_inputs = Renamed(), 0
    if first.data is not None and second.data is not None:
        changes, renamed, same_inputs = compare_inputs(first.data, second.data, units)
        inputs = (*changes, *_settings(first, second))
    results, same_results = compare_results(first.tables, second.tables, units, renamed)
    verdicts = tuple(compare_verdicts(first.tables, second.tables, units, renamed))
    studies = compare_studies(first, second, units, renamed)
    return Differences(
        first, second, verdicts, inputs, tuple(results), same_inputs, same_results, studies
    )


def _settings(first: ComparedFile, second: ComparedFile) -> list[Change]:
    """Settings of the command line with which the results were calculated."""
    names = dict.fromkeys([*first.settings, *second.settings])
    return [
        Change("changed", "Command line", "", name, before, after)
        for name in names
        if (before := first.settings.get(name)) != (after := second.settings.get(name))
    ]
