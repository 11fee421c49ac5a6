"""The page docs/results.md: what each result is, and where it comes from."""

from __future__ import annotations

from addin.contract.field import TableSpec
from addin.contract.tables import RESULT_TABLES, STUDY_RESULT_TABLES, WORKBOOK_TABLES
from addin.contract.trace_table import grouped, shortly, trace_groups

_HEAD = """# Results: meaning, equation and inputs of each number

Made from the records of the tables by `make generated`; do not edit.

For every column of every result sheet: its meaning, its equation or rule, the source, and the inputs and
results that it uses. Sheet Notes of each workbook and the help of each header cell give the same. For a
single cell, with the places and values of its inputs:

    torsionbook verify train.out.xlsx --trace 'Results!AW9'

*From the row* are inputs and results of the element, station, mode, excitation or material of that row;
*from the case* those of all of them. Symbols: see the [nomenclature](nomenclature.md); numerical methods:
see the [method](method.md).
A unit in brackets is that of the SI template; a workbook shows its own above the column.

Inputs that belong together are named once:
"""


def results_page() -> str:
    """The page."""
    groups = "".join(f"- *{name}*: {members}\n" for name, members in trace_groups())
    head = f"{_HEAD}\n{groups}"
    return head + "".join(
        _section(spec) for spec in (*RESULT_TABLES, *WORKBOOK_TABLES, *STUDY_RESULT_TABLES)
    )


def _section(spec: TableSpec) -> str:
    lines = [
        f"\n## {spec.caption} (`{spec.name}`, sheet {spec.sheet})\n\n{spec.help}\n\n",
        "| column | what it is | equation or rule | source | from the row | from the case |\n",
        "|---|---|---|---|---|---|\n",
    ]
    for field in spec.every_column:
        trace = field.trace
        assert trace is not None
        unit = f" [{field.unit_si}]" if field.unit_si and field.unit_si != "1" else ""
        name = f"{field.name}{' 1, 2, …' if field is spec.repeated else ''}{unit}"
        cells = (name, field.help, trace.equation, trace.source,
                 grouped(trace.of_row), shortly(trace.of_case, "*"))  # fmt: skip
        lines.append("| " + " | ".join(_plain(cell) for cell in cells) + " |\n")
    return "".join(lines)


def _plain(text: str) -> str:
    """Text that Markdown does not take for its own signs."""
    return text.replace("|", "\\|")
