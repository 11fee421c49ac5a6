"""The page docs/results.md and the rows of sheet `Trace`, made from the table of fields.

``python -m addin.contract.trace_table`` writes the page.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from addin.contract.result_tables import GROUPS
from addin.contract.studies.registry import STUDY_CAPTIONS
from addin.contract.tables import (
    RESULT_TABLES,
    STUDY_RESULT_TABLES,
    WORKBOOK_TABLES,
    Field,
    TableSpec,
)
from addin.contract.texts import CAPTIONS

__all__ = ["PAGE", "TRACE_HEADERS", "page", "trace_groups", "trace_rows", "traced_columns"]

#: Where the page stands.
PAGE = Path(__file__).resolve().parents[2] / "docs" / "results.md"

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

_HEAD = """# Results: what each number is, and where it comes from

Made from the table of fields by `python -m addin.contract.trace_table`; do not edit.

For every column of every result sheet: what it is, by which equation or rule, after which source, and
from which inputs and results. The same stands on sheet Trace of each workbook and behind each header
cell, and is asked for a single cell, with the places and values of its inputs, by

    torsionbook verify train.out.xlsx --trace 'Steady state!H9'

*From the row* are inputs and results of the very element, station, mode, excitation or material that the row
is about; *from the case* those of all of them. Symbols are those of the
[nomenclature](nomenclature.md); how it is done numerically is on the page on the [method](method.md).
A unit in brackets is that of the SI template; a workbook shows its own above the column.

Inputs that go together are named once:
"""

_CAPTIONS = {**CAPTIONS, **STUDY_CAPTIONS}


def traced_columns(spec: TableSpec) -> tuple[Field, ...]:
    """Columns of a result table in the order of the workbook, a repeated one once."""
    repeated = () if spec.repeated is None else (spec.repeated,)
    return (*spec.columns, *repeated, *spec.extra_columns)


def trace_rows(*, studies: bool = False) -> Iterator[tuple[str, ...]]:
    """Rows of sheet `Trace`, one a result column."""
    more = STUDY_RESULT_TABLES if studies else ()
    for spec in (*RESULT_TABLES, *WORKBOOK_TABLES, *more):
        for field in traced_columns(spec):
            assert field.trace is not None
            yield (
                spec.sheet,
                _CAPTIONS[spec.name],
                field.name,
                field.help,
                field.trace.equation,
                field.trace.source,
                _grouped(field.trace.of_row),
                _shortly(field.trace.of_case),
            )


def trace_groups() -> Iterator[tuple[str, str]]:
    """Groups of inputs that go together."""
    for name, members in GROUPS.items():
        yield name, _grouped(members)


def _grouped(names: tuple[str, ...]) -> str:
    """Scalars, then columns by their table: ``LineFrequency; Elements: OD, ID``."""
    tables: dict[str, list[str]] = {}
    for name in names:
        table, _, column = name.rpartition(".")
        tables.setdefault(table, []).append(column)
    scalars = tables.pop("", [])
    parts = [", ".join(scalars)] if scalars else []
    return "; ".join([*parts, *(f"{table}: {', '.join(c)}" for table, c in tables.items())])


def page() -> str:
    """The page."""
    groups = "".join(f"- *{name}*: {members}\n" for name, members in trace_groups())
    head = f"{_HEAD}\n{groups}"
    return head + "".join(
        _section(spec) for spec in (*RESULT_TABLES, *WORKBOOK_TABLES, *STUDY_RESULT_TABLES)
    )


def _section(spec: TableSpec) -> str:
    lines = [
        f"\n## {_CAPTIONS[spec.name]} (`{spec.name}`, sheet {spec.sheet})\n\n{spec.help}\n\n",
        "| column | what it is | equation or rule | source | from the row | from the case |\n",
        "|---|---|---|---|---|---|\n",
    ]
    for field in traced_columns(spec):
        trace = field.trace
        assert trace is not None
        unit = f" [{field.unit_si}]" if field.unit_si and field.unit_si != "1" else ""
        name = f"{field.name}{' 1, 2, …' if field is spec.repeated else ''}{unit}"
        cells = (name, field.help, trace.equation, trace.source,
                 _grouped(trace.of_row), _shortly(trace.of_case, "*"))  # fmt: skip
        lines.append("| " + " | ".join(_plain(cell) for cell in cells) + " |\n")
    return "".join(lines)


def _shortly(names: tuple[str, ...], mark: str = "") -> str:
    """Inputs of the case, the usual groups by their names in `GROUPS`."""
    left, found = list(names), []
    for group, members in GROUPS.items():
        if set(members) <= set(left):
            found.append(f"{mark}{group}{mark}")
            left = [name for name in left if name not in members]
    return "; ".join([*found, *filter(None, [_grouped(tuple(left))])])


def _plain(text: str) -> str:
    """Text that Markdown does not take for its own signs."""
    return text.replace("|", "\\|")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
