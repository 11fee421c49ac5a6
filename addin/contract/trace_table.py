"""The rows of sheet `Trace`: what each result is, by which equation, from what."""

from __future__ import annotations

from collections.abc import Iterator

from addin.contract.sources import GROUPS
from addin.contract.tables import RESULT_TABLES, STUDY_RESULT_TABLES, WORKBOOK_TABLES

#: Headers of sheet `Trace`.
TRACE_HEADERS = (
    "Sheet",
    "Table",
    "Column",
    "What it is",
    "Equation",
    "Source",
    "From the same row",
    "From the whole case",
)


def trace_rows(*, studies: bool = False) -> Iterator[tuple[str, ...]]:
    """Rows of sheet `Trace`, one a result column."""
    more = STUDY_RESULT_TABLES if studies else ()
    for spec in (*RESULT_TABLES, *WORKBOOK_TABLES, *more):
        for field in spec.every_column:
            assert field.trace is not None
            yield (
                spec.sheet,
                spec.caption,
                field.name,
                field.help,
                field.trace.equation,
                field.trace.source,
                grouped(field.trace.of_row),
                shortly(field.trace.of_case),
            )


def trace_groups() -> Iterator[tuple[str, str]]:
    """Groups of inputs that go together."""
    for name, members in GROUPS.items():
        yield name, grouped(members)


def grouped(names: tuple[str, ...]) -> str:
    """Scalars, then columns by their table: ``LineFrequency; Elements: OD, ID``."""
    tables: dict[str, list[str]] = {}
    for name in names:
        table, _, column = name.rpartition(".")
        tables.setdefault(table, []).append(column)
    scalars = tables.pop("", [])
    parts = [", ".join(scalars)] if scalars else []
    return "; ".join([*parts, *(f"{table}: {', '.join(c)}" for table, c in tables.items())])


def shortly(names: tuple[str, ...], mark: str = "") -> str:
    """Inputs of the case, the usual groups by their names in `GROUPS`."""
    others, groups = list(names), []
    for group, members in GROUPS.items():
        if set(members) <= set(others):
            groups.append(f"{mark}{group}{mark}")
            others = [name for name in others if name not in members]
    return "; ".join([*groups, *filter(None, [grouped(tuple(others))])])
