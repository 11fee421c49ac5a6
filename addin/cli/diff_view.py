"""Differences as tables on the terminal."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from addin.cli.terminal import plain_console, show_table
from addin.contract.tables import table
from addin.diff.changes import Change, Differences, VerdictChange
from addin.diff.files import ComparedFile
from addin.diff.wording import change_in_words, in_words, telling

#: Width below which tables are not squeezed. [characters]
_WIDTH = 120


def show(differences: Differences, everything: bool = False) -> None:
    """Print the differences: verdicts first, then inputs, then results."""
    console = plain_console(width=max(plain_console().width, _WIDTH))
    for letter, side in (("A", differences.first), ("B", differences.second)):
        console.print(_about(letter, side), soft_wrap=True)
    console.print()
    _verdicts(console, differences)
    _inputs(console, differences)
    _results(console, differences, everything)
    _studies(console, differences, everything)


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


def _show(console: Console, table: Table) -> None:
    show_table(table, _WIDTH)
    console.print()


def _colour(verdict: str) -> str:
    if verdict.startswith(("fail", "unbounded", "check")):
        return "red"
    return "green" if verdict == "pass" else "yellow" if verdict else ""


def _verdicts(console: Console, differences: Differences) -> None:
    checks = [change for change in differences.verdicts if change.table == "Verdicts"]
    others = [change for change in differences.verdicts if change.table != "Verdicts"]
    table = _table("Checks", "Check", "A", "B", "Limit", "Verdict A", "Verdict B", right=(1, 2, 3))
    for change in sorted(checks, key=lambda check: not check.changed):
        table.add_row(*_check(change))
    if checks:
        _show(console, table)
    table = _table("Other verdicts that changed", "Table", "Row", "Verdict A", "Verdict B")
    for change in others:
        verdicts = (Text(verdict, _colour(verdict)) for verdict in (change.before, change.after))
        table.add_row(change.table, change.row, *verdicts)
    if others:
        _show(console, table)


def _check(change: VerdictChange) -> list[str | Text]:
    weight = "bold " if change.changed else ""
    return [
        Text(change.row, weight.strip()),
        change.result_before,
        change.result_after,
        change.limit,
        Text(change.before or "–", f"{weight}{_colour(change.before)}".strip()),
        Text(change.after or "–", f"{weight}{_colour(change.after)}".strip()),
    ]


def _inputs(console: Console, differences: Differences) -> None:
    if differences.inputs is None:
        console.print("Inputs: not compared, because a result JSON contains none.\n")
        return
    if not differences.inputs:
        console.print(f"Inputs: no difference in {differences.same_inputs} quantities.\n")
        return
    title = f"Inputs that differ ({differences.same_inputs} quantities are the same)"
    _show(console, _changes(title, differences.inputs))


def _changes(title: str, changes: Sequence[Change]) -> Table:
    table = _table(title, "Table", "Row", "Column", "A", "B", "Change", right=(3, 4, 5))
    for change in changes:
        style = "dim" if change.administrative else ""
        table.add_row(
            change.table, change.row, change.column, in_words(change, change.before),
            in_words(change, change.after), change_in_words(change), style=style,
        )  # fmt: skip
    return table


def _results(console: Console, differences: Differences, everything: bool) -> None:
    if not differences.results:
        console.print(f"Results: no difference in {differences.same_results} quantities.")
        return
    left = _by_table(console, differences.results, everything)
    console.print(f"{differences.same_results} results are the same.{_further(left)}")


def _by_table(console: Console, results: Sequence[Change], everything: bool) -> int:
    """Results table by table; how many are not shown."""
    by_table: dict[str, list[Change]] = {}
    for change in results:
        by_table.setdefault(change.table, []).append(change)
    listed = 0
    for name, changes in by_table.items():
        shown = changes if everything else telling(name, changes)
        listed += len(shown)
        if shown:
            _show(console, _changes(_of_table(name, changes, shown), shown))
    return len(results) - listed


def _further(left: int) -> str:
    if not left:
        return ""
    return f" {left} further differences: --all shows them; --xlsx and --json write them."


def _studies(console: Console, differences: Differences, everything: bool) -> None:
    """What differs on the study sheets; nothing where no file has any."""
    studies = differences.studies
    if not (studies.anything or studies.same_results):
        return
    console.print()
    for note in studies.notes:
        console.print(f"Studies: {note}", highlight=False, soft_wrap=True)
    if studies.inputs:
        title = f"Study inputs that differ ({studies.same_inputs} quantities are the same)"
        _show(console, _changes(title, studies.inputs))
    left = _by_table(console, studies.results, everything)
    console.print(f"{studies.same_results} results of studies are the same.{_further(left)}")


def _of_table(name: str, changes: Sequence[Change], shown: Sequence[Change]) -> str:
    """Title of a table of results."""
    parts = [f"{table(name).caption}: {len(changes)} differences"]
    for kind, words in (("row removed", "only in A"), ("row added", "only in B")):
        count = sum(change.kind == kind for change in changes)
        if count:
            parts.append(f"{count} rows {words}")
    if len(shown) < len(changes):
        parts.append(f"{len(shown)} shown")
    return ", ".join(parts)
