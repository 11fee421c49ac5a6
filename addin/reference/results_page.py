"""The pages docs/results*.md: what each result is, and where it comes from."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from addin.contract.field import TableSpec
from addin.contract.studies.registry import STUDIES
from addin.contract.tables import RESULT_TABLES, WORKBOOK_TABLES
from addin.contract.trace_table import grouped, shortly, trace_groups

#: The page that lists all tables.
INDEX = "results.md"

_HEAD = """# Results: meaning, equation and inputs of each number

Made from the records of the tables by `make generated`; do not edit.

For every column of every result table: its meaning, its equation or rule, the source, and the inputs and
results that it uses. Each row of a page is a column of a table. Sheet Notes of each workbook and the help of each header cell give the same. For a
single cell, with the places and values of its inputs:

    torsionbook verify train.out.xlsx --trace 'Results!AW9'

*From the row* are inputs and results of the element, station, mode, excitation or material of that row;
*from the case* those of all of them. Symbols: see the [nomenclature](nomenclature.md); numerical methods:
see the [theory](method.md).
A unit in brackets is that of the SI template; a workbook shows its own above the column.

| page | tables |
|---|---|
"""

_GROUPS = """
## Inputs that belong together

They are named once, and stand in the tables as *the start*, *train* and so on:

"""


@dataclass(frozen=True)
class _Page:
    """One page: its file, its heading, and the tables named on it."""

    file: str
    title: str
    tables: tuple[str, ...] = ()
    studies: tuple[str, ...] = ()


#: In the order of the menu. The first takes the tables that no page names, the last the studies.
_PAGES = (
    _Page("results-checks.md", "Results: verdicts, effects, accuracy and audit"),
    _Page(
        "results-train.md", "Results: the train and its motor",
        ("NaturalFrequencies", "ModeShapes", "EnergyShares", "SectionResults", "MotorCurves",
         "MotorTimeConstants", "ElectricalDamping"),
    ),
    _Page(
        "results-operation.md", "Results: continuous operation and events",
        ("SeparationMargins", "StandardRequirements", "SteadyState", "EventPeaks", "AirGapTorque"),
    ),
    _Page(
        "results-start.md", "Results: the start and its fatigue",
        ("StartupPeaks", "StartupCrossings", "TorqueReversals", "MakerSheet", "BearingForces",
         "AllowableStarts", "FatigueLimits", "StartCycles"),
    ),
    _Page("results-tuning.md", "Results: tuning", studies=("tuning",)),
    _Page(
        "results-tolerances.md", "Results: tolerances and sensitivities",
        studies=("tolerances", "sensitivities"),
    ),
    _Page("results-studies.md", "Results: start matrix, damage ledger and calibration"),
)  # fmt: skip


def results_pages() -> dict[str, str]:
    """Text of each page by its file."""
    filled = {page.file: _page(page, specs) for page, specs in _divided()}
    groups = "".join(f"- *{name}*: {members}\n" for name, members in trace_groups())
    rows = "".join(
        f"| [{page.title.removeprefix('Results: ')}]({page.file}) | "
        + ", ".join(f"[{spec.name}]({page.file}#{spec.name.casefold()})" for spec in specs)
        + " |\n"
        for page, specs in _divided()
    )
    return {INDEX: f"{_HEAD}{rows}{_GROUPS}{groups}"} | filled


def _divided() -> Iterator[tuple[_Page, list[TableSpec]]]:
    """Each page with its tables, in the order of the records."""
    ordinary = (*RESULT_TABLES, *WORKBOOK_TABLES)
    named = {name for page in _PAGES for name in page.tables}
    of_a_page = {name for page in _PAGES for name in page.studies}
    for page in _PAGES:
        specs = [spec for spec in ordinary if spec.name in page.tables]
        if page is _PAGES[0]:
            specs = [spec for spec in ordinary if spec.name not in named]
        for study in STUDIES:
            others = page is _PAGES[-1] and study.key not in of_a_page
            if study.key in page.studies or others:
                specs += study.results
        yield page, specs


def _page(page: _Page, specs: list[TableSpec]) -> str:
    head = (
        f"# {page.title}\n\nMade from the records of the tables by `make generated`; do not edit. "
        f"What the columns mean: [results]({INDEX}).\n"
    )
    return head + "".join(_section(spec) for spec in specs)


def _section(spec: TableSpec) -> str:
    lines = [
        f"\n## {spec.name}\n\n*{spec.caption}*, sheet {spec.sheet}. {spec.help}\n\n",
        "| column | what it is, *rule* | source, inputs |\n|---|---|---|\n",
    ]
    for field in spec.every_column:
        trace = field.trace
        assert trace is not None
        unit = f" [{field.unit_si}]" if field.unit_si and field.unit_si != "1" else ""
        name = f"{field.name}{' 1, 2, …' if field is spec.repeated else ''}{unit}"
        inputs = (
            f"{kind}: {_plain(names)}"
            for kind, names in (
                ("From the row", grouped(trace.of_row)),
                ("From the case", shortly(trace.of_case, "*")),
            )
            if names
        )
        rule = f"{_plain(field.help)}<br>*Rule:* {_plain(trace.equation)}"
        lines.append(f"| {name} | {rule} | {'<br>'.join((_linked(trace.source), *inputs))} |\n")
    return "".join(lines)


def _linked(source: str) -> str:
    """The source, its pages of this documentation as links."""
    return re.sub(
        r"docs/([\w-]+\.md)(?:, ([^;]+))?",
        lambda m: f"[{m[2] or m[1].removesuffix('.md').replace('-', ' ')}]({m[1]})",
        _plain(source),
    )


def _plain(text: str) -> str:
    """Text that Markdown does not take for its own signs."""
    return text.replace("|", "\\|")
