"""The page docs/functions.md: the worksheet functions, made from their registry."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence

from addin.contract.sheets import range_of
from addin.worksheet.functions.model import CASE
from addin.worksheet.registry import FUNCTIONS, Argument, Function

KINDS = {
    "block": "range with headers and units",
    "model": "handle",
    "number": "number",
    "numbers": "number or range",
    "text": "text",
    "flag": "TRUE or FALSE",
    "count": "whole number",
}

#: What follows an example.
MORE = {
    "TV_MODEL": f"""Without the start, which modes and margins do not need, the call for the same workbook is shorter:
`=TV_MODEL({range_of("Stations")}, {range_of("Elements")}, {CASE}, , , , , , {range_of("Materials")})`. It includes Materials
because a shaft refers to one.""",
}

HEAD = """# Worksheet functions

Made from the registry by `make generated`; do not edit.

The same functions work in desktop Excel, through the calculation server, in LibreOffice Calc and in
Python, with identical results. `TV_MODEL` checks the tables and returns a *handle*, a short
text made of the digest of the inputs; every other function of a train takes the cell with it. A start
is calculated once, for all cells that use it. The cell of `TV_MODEL` shows the errors of the tables,
with table, row and column; a blank is never read as zero.

A range for `TV_MODEL` is the table with its headers **and the row of units above them**, such as
`Train!B6:G22`: units are not guessed. The ranges of the examples are those of the shipped examples
(`torsionbook new train.xlsx --example proposed`) and of the blank template; a table that has grown has
more rows. Workbooks for one of these programs (`torsionbook new train.xlsm`, `--for server`, `--for calc`) have a
sheet `Live` with the formula ready, its ranges growing with the tables: the name `LiveModel` is its
cell, so that `=TV_PEAKS(LiveModel)` works anywhere in the book. Results are tables with one row of headers; they spill in Excel
365 and 2021, and are entered as array formulas (Ctrl+Shift+Enter) in older Excel and in Calc. *Units*
is `SI` or `US`, blank means as the tables are typed; *Headers* `FALSE` omits the header row.

**Do not type the per cent sign where the unit is `%` already.** A cell that shows `1.5%` holds 0.015, and a
spreadsheet program hands a function that number without its format. With the unit `%` it is read as
0.015 %, a hundred times too small, in all these programs: the functions cannot detect it, and no error
is shown. This applies to all inputs in per cent: damping ratios, margins, tolerances, voltage,
and speeds and torques relative to the rated ones. Type 1.5 in a cell formatted as Number; or keep the
per cent format and write 1 as the unit. `torsionbook check train.xlsx` and `recalc` read the saved file
with its formats and report such a cell as an error: run `check` once where numbers were pasted or come
from another workbook. (If the format was changed afterwards and the cell shows 0.015, the error cannot
be detected.)

| function | result | calculates a start |
|---|---|---|
"""


#: Of the answer of an example, so much is shown. [count]
ROWS, COLUMNS = 4, 6
#: Computing times differ from run to run; times of a start are in s.
WALL_TIME = "Time [ms]"
#: Functions of tables that the shipped example leaves blank: their examples are answered with rows typed in.
TYPED_IN = ("TV_EVENTS", "TV_CASE_VERDICTS", "TV_SECTIONS", "TV_MOTOR_CIRCUIT", "TV_MOTOR_CURVES")


def functions_page(answers: Mapping[str, Sequence[Sequence[object]]]) -> str:
    """The page.

    Parameters
    ----------
    answers : mapping of str to rows
        What the example of each function answers, a row of headers first; none of a function whose answer
        says nothing on paper.

    Returns
    -------
    str
        Text of docs/functions.md.
    """
    rows = [
        f"| [`{f.name}`](#{f.name.casefold()}) | {_first(f.help)} | {'yes' if f.long else ''} |\n"
        for f in FUNCTIONS.values()
    ]
    return (
        HEAD
        + "".join(rows)
        + "".join(_section(f, answers.get(f.name, ())) for f in FUNCTIONS.values())
    )


def _section(function: Function, answer: Sequence[Sequence[object]]) -> str:
    text = inspect.getdoc(function.answer) or ""
    lines = [f"\n## {function.name}\n", f"\n`{_call(function)}`\n", f"\n{text}\n"]
    lines += ["\n| argument | kind | what to give |\n|---|---|---|\n"]
    ranges = " or range" if function.by_cell else ""
    lines += [f"| {_named(a)} | {KINDS[a.kind]}{ranges} | {a.help} |\n" for a in function.arguments]
    lines += ["\nRanges have one answer a cell.\n"] if ranges else []
    lines += [f"\nExample: `{function.example}`\n"]
    heading = "Answer, with rows typed into the table:" if function.name in TYPED_IN else "Answer:"
    lines += _answer(heading, answer)
    lines += [f"\n{MORE[function.name]}\n"] if function.name in MORE else []
    return "".join(lines)


def _answer(heading: str, rows: Sequence[Sequence[object]]) -> list[str]:
    """The first rows and columns of an answer, as a table, or the one value."""
    if not rows:
        return []
    if len(rows) == 1 and len(rows[0]) == 1:
        return [f"\n{heading} {_cell(rows[0][0])}\n"]
    timed = [k for k, header in enumerate(rows[0]) if header == WALL_TIME]
    rows = [[cell for k, cell in enumerate(row) if k not in timed] for row in rows]
    wide = len(rows[0]) > COLUMNS
    table = [
        "| " + " | ".join(map(_cell, row[:COLUMNS])) + f"{' | …' if wide else ''} |\n"
        for row in rows
    ]
    rule = "|---" * (min(len(rows[0]), COLUMNS) + wide) + "|\n"
    left = len(rows) - 1 - ROWS
    more = [f"\n{left} more row{'s' if left > 1 else ''}.\n"] if left > 0 else []
    return [f"\n{heading}\n\n", table[0], rule, *table[1 : 1 + ROWS], *more]


def _cell(value: object) -> str:
    """A value with the digits that a reader compares."""
    if isinstance(value, float):
        return f"{value:.6g}"
    return "" if value is None else str(value).replace("|", "\\|")


def _call(function: Function) -> str:
    return f"{function.name}({', '.join(_named(a) for a in function.arguments)})"


def _named(argument: Argument) -> str:
    return f"[{argument.name}]" if argument.optional else argument.name


def _first(text: str) -> str:
    """The first sentence, or the text to its colon."""
    return text.split(": ")[0].split(". ")[0].rstrip(".")
