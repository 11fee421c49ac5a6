"""Differences as tables on the terminal."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from addin.contract.tables import table
from addin.diff.changes import Change, Differences, VerdictChange
from addin.diff.files import ComparedFile
from addin.diff.wording import change_in_words, in_words, telling

#: Width below which tables are not squeezed. [characters]
_WIDTH = 120


def show(found: Differences, everything: bool = False) -> None:
    """Print the differences: verdicts first, then inputs, then results."""
    console = Console(width=max(Console().width, _WIDTH))
    for letter, side in (("A", found.first), ("B", found.second)):
        console.print(_about(letter, side))
    console.print()
    _verdicts(console, found)
    _inputs(console, found)
    _results(console, found, everything)
    _studies(console, found, everything)


def _about(letter: str, side: ComparedFile) -> Text:
    text = Text(f"{letter}  {side.source}", style="bold")
    if side.revision:
        text.append(f"   {side.revision}")
    text.append(f"\n   results {side.results_from}; {side.software}", style="dim")
    if side.settings:
        words = ", ".join(f"{name} = {value}" for name, value in side.settings.items())
        text.append(f"; with {words}", style="dim")
    return text


def _table(title: str, *headers: str, right: Collection[int] = ()) -> Table:
    table = Table(
        title=title, title_justify="left", title_style="bold", show_edge=False, pad_edge=False
    )
    for k, header in enumerate(headers):
        table.add_column(header, justify="right" if k in right else "left", overflow="fold")
    return table


def _colour(verdict: str) -> str:
    if verdict.startswith(("fail", "unbounded")):
        return "red"
    return "green" if verdict.startswith("pass") else "yellow" if verdict else ""


def _verdicts(console: Console, found: Differences) -> None:
    checks = [one for one in found.verdicts if one.table == "Verdicts"]
    others = [one for one in found.verdicts if one.table != "Verdicts"]
    table = _table("Checks", "Check", "A", "B", "Limit", "Verdict A", "Verdict B", right=(1, 2, 3))
    for one in sorted(checks, key=lambda check: not check.changed):
        table.add_row(*_check(one))
    if checks:
        console.print(table, "")
    table = _table("Other verdicts that changed", "Table", "Row", "Verdict A", "Verdict B")
    for one in others:
        verdicts = (Text(verdict, _colour(verdict)) for verdict in (one.before, one.after))
        table.add_row(one.table, one.row, *verdicts)
    if others:
        console.print(table, "")


def _check(one: VerdictChange) -> list[str | Text]:
    weight = "bold " if one.changed else ""
    return [
        Text(one.row, weight.strip()),
        one.result_before,
        one.result_after,
        one.limit,
        Text(one.before or "–", f"{weight}{_colour(one.before)}".strip()),
        Text(one.after or "–", f"{weight}{_colour(one.after)}".strip()),
    ]


def _inputs(console: Console, found: Differences) -> None:
    if found.inputs is None:
        console.print("Inputs: not compared, because a result JSON contains none.\n")
        return
    if not found.inputs:
        console.print(f"Inputs: no difference in {found.same_inputs} quantities.\n")
        return
    title = f"Inputs that differ ({found.same_inputs} quantities are the same)"
    console.print(_changes(title, found.inputs), "")


def _changes(title: str, changes: Sequence[Change]) -> Table:
    table = _table(title, "Table", "Row", "Column", "A", "B", "Change", right=(3, 4, 5))
    for one in changes:
        style = "dim" if one.administrative else ""
        table.add_row(
            one.table, one.row, one.column, in_words(one, one.before), in_words(one, one.after),
            change_in_words(one), style=style,
        )  # fmt: skip
    return table


def _results(console: Console, found: Differences, everything: bool) -> None:
    if not found.results:
        console.print(f"Results: no difference in {found.same_results} quantities.")
        return
    left = _by_table(console, found.results, everything)
    console.print(f"{found.same_results} results are the same.{_further(left)}")


def _by_table(console: Console, results: Sequence[Change], everything: bool) -> int:
    """Results table by table; how many are not shown."""
    by_table: dict[str, list[Change]] = {}
    for one in results:
        by_table.setdefault(one.table, []).append(one)
    told = 0
    for name, changes in by_table.items():
        shown = changes if everything else telling(name, changes)
        told += len(shown)
        if shown:
            console.print(_changes(_of_table(name, changes, shown), shown), "")
    return len(results) - told


def _further(left: int) -> str:
    if not left:
        return ""
    return f" {left} further differences: --all shows them; --xlsx and --json write them."


def _studies(console: Console, found: Differences, everything: bool) -> None:
    """What differs on the study sheets; nothing where no file has any."""
    studies = found.studies
    if not (studies.anything or studies.same_results):
        return
    console.print()
    for note in studies.notes:
        console.print(f"Studies: {note}", highlight=False)
    if studies.inputs:
        title = f"Study inputs that differ ({studies.same_inputs} quantities are the same)"
        console.print(_changes(title, studies.inputs), "")
    left = _by_table(console, studies.results, everything)
    console.print(f"{studies.same_results} results of studies are the same.{_further(left)}")


def _of_table(name: str, changes: Sequence[Change], shown: Sequence[Change]) -> str:
    """Title of a table of results."""
    parts = [f"{table(name).caption}: {len(changes)} differences"]
    for kind, words in (("row removed", "only in A"), ("row added", "only in B")):
        count = sum(one.kind == kind for one in changes)
        if count:
            parts.append(f"{count} rows {words}")
    if len(shown) < len(changes):
        parts.append(f"{len(shown)} shown")
    return ", ".join(parts)
