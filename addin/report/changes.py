"""What changed since an earlier revision, and what it did."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace

from addin.contract import tables as contract
from addin.contract.problems import shortened
from addin.contract.tables import STUDY_RESULT_TABLES, find_column
from addin.diff.changes import Change, Differences, Value, VerdictChange
from addin.diff.files import COMPARED
from addin.diff.wording import change_in_words, in_words, telling
from addin.report.document import Block, Column, Facts, Paragraph, Section, Table, section
from addin.report.numbers import clean, of_dimension, pretty_unit, typed
from addin.report.subject import Subject
from addin.report.tables import without_blanks

#: Most changed inputs shown. [count]
_MOST = 120
#: Longest text of a cell. [characters]
_LONGEST = 200
_OTHER_VERDICTS = 12
_RESULTS = frozenset(spec.name for spec in (*COMPARED, *STUDY_RESULT_TABLES))


def earlier_name(differences: Differences) -> str:
    """What the earlier calculation is called.

    Returns
    -------
    str
        Its revision, or its document, where the title block states another one than this; else the
        name of its file. [text]
    """
    before, now = differences.first.data, differences.second.data
    if before is not None and now is not None:
        if before.revision and before.revision != now.revision:
            return f"revision {shortened(clean(before.revision), 20)}"
        if before.document and before.document != now.document:
            return shortened(clean(before.document), 40)
    return clean(differences.first.source.name)


def changes(subject: Subject, differences: Differences) -> Section:
    """Inputs that changed, and what that did to verdicts and results."""
    before, name = differences.first, clean(subject.name)
    facts = (
        ("Compared with", clean(before.source.name)),
        ("Title block of the other file", clean(before.revision) or "blank"),
        ("Inputs of the other file, SHA-256", before.digest or "not recorded"),
        ("Its results", clean(f"{before.results_from}; {before.software}")),
    )
    parts = [_inputs(differences), _verdicts(differences), _results(differences, name)]
    if differences.studies.anything:
        parts.append(_studies(differences, name))
    return section(
        f"Changes since {earlier_name(differences)}",
        Paragraph(_sentence(differences), "lead"),
        Facts(facts),
        parts=parts,
    )


def _sentence(differences: Differences) -> str:
    """How much changed, in numbers."""
    verdicts = sum(v.changed for v in differences.verdicts if v.table == "Verdicts")
    judged = f"{verdicts} verdicts changed"
    if verdicts < 2:
        judged = f"{'One' if verdicts else 'No'} verdict changed"
    if differences.inputs is None:
        return f"{judged}. The file compared with is a result JSON, which contains no inputs."
    inputs = sum(not change.administrative for change in differences.inputs)
    if not inputs:
        return f"All inputs that affect results are the same. {judged}."
    differ = f"{inputs} inputs differ"
    if inputs == 1:
        differ = "1 input differs"
    return f"{differ}, {differences.same_inputs:,} are the same. {judged}."


def _inputs(differences: Differences) -> Section:
    """Inputs before and after; what changes no result in one sentence."""
    title = "Inputs"
    if differences.inputs is None:
        return section(title, Paragraph("Not compared: a result JSON contains no inputs."))
    real = [change for change in differences.inputs if not change.administrative]
    other = [change for change in differences.inputs if change.administrative]
    note = []
    if len(real) > _MOST:
        note.append(f"{_MOST} of {len(real)} are shown; torsionbook diff lists all.")
    if other:
        sentence = "; ".join(
            " ".join(filter(None, (_words(change.row), change.column, _before_after(change))))
            for change in other[:8]
        )
        rest = f"; and {len(other) - 8} more" if len(other) > 8 else ""
        note.append(f"Also changed, without effect on results: {sentence}{rest}.")
    if not real:
        return section(title, Paragraph(" ".join(["No difference.", *note])))
    table = _table("Inputs that changed", real[:_MOST], with_table=True)
    return section(title, replace(table, note=" ".join(note)))


def _before_after(change: Change) -> str:
    return f"({_value(change, change.before)} → {_value(change, change.after)})"


def _table(caption: str, changes: Iterable[Change], with_table: bool = False) -> Table:
    """Changes as lines: where, before, after, by how much."""
    columns = (
        Column("Table"),
        Column("Row", "", "sentence"),
        Column("Quantity"),
        Column("Unit"),
        *(Column(header, "", "number") for header in ("Before", "After", "Change")),
    )
    rows = (
        (
            contract.caption(change.table),
            _words(change.row) or "–",
            change.column or "–",
            pretty_unit(change.unit),
            _value(change, change.before),
            _value(change, change.after),
            _by_how_much(change) or ("–" if change.kind == "changed" else change.kind),
        )
        for change in changes
    )
    first = 0 if with_table else 1
    return Table(caption, columns[first:], tuple(row[first:] for row in rows))


def _by_how_much(change: Change) -> str:
    """The change as printed."""
    number, _, unit = change_in_words(change).partition(" ")
    return _minus(f"{number} {pretty_unit(unit) if unit == change.unit else unit}".rstrip())


def _words(text: str) -> str:
    return shortened(clean(text), _LONGEST)


def _value(change: Change, value: Value) -> str:
    """A value as printed; a blank as a dash."""
    shown = change.shown(value)
    if isinstance(shown, bool) or not isinstance(shown, int | float) or not math.isfinite(shown):
        return _words(in_words(change, value))
    if change.table in _RESULTS:
        field = find_column(change.table, change.column)
        dimension = "none" if field is None else field.dimension
        return of_dimension(float(shown), change.column, dimension, change.unit)
    return typed(float(shown))


def _minus(text: str) -> str:
    return "−" + text[1:] if text.startswith("-") else text


def _verdicts(differences: Differences) -> Section:
    """Every check at a glance before and after, and other verdicts that changed."""
    checks = [check for check in differences.verdicts if check.table == "Verdicts"]
    others = [c for c in differences.verdicts if c.table != "Verdicts" and c.changed]
    blocks: list[Block] = []
    if checks:
        blocks.append(_judged("Checks before and after", checks))
    if others:
        some = [
            replace(check, row=f"{contract.caption(check.table)}: {check.row}")
            for check in others[:_OTHER_VERDICTS]
        ]
        note = f"{len(some)} of {len(others)} are shown." if len(some) < len(others) else ""
        blocks.append(replace(_judged("Other verdicts that changed", some), note=note))
    return section("Verdicts", *blocks or [Paragraph("Neither file holds verdicts.")])


def _judged(caption: str, checks: Sequence[VerdictChange]) -> Table:
    """Verdicts before and after, with the numbers judged where there are any."""
    columns = (
        Column("Check", "", "sentence"),
        *(Column(header, "", "number") for header in ("Before", "After", "Limit")),
        *(Column(header, "", "verdict") for header in ("Verdict before", "Verdict after")),
    )
    rows = []
    for check in checks:
        numbers = (check.result_before, check.result_after, check.limit)
        verdicts = (check.before or "–", check.after or "–")
        rows.append((_words(check.row), *map(_quantity, numbers), *verdicts))
    table = Table(caption, columns, tuple(rows))
    return table if any(any(row[1:4]) for row in rows) else without_blanks(table)


def _quantity(words: str) -> str:
    """A number with its unit as printed."""
    number, _, unit = clean(words).partition(" ")
    if not number.lstrip("-")[:1].isdigit():
        return clean(words)
    return f"{_minus(number)} {pretty_unit(unit)}".rstrip()


def _results(differences: Differences, name: str) -> Section:
    """By table, the results an engineer asks for first."""
    title = "Results"
    if not differences.results:
        sentence = f"No difference in {differences.same_results:,} quantities."
        return section(title, Paragraph(sentence))
    tables, shown = _by_table(differences.results)
    differ = len(differences.results)
    sentence = _how_many(
        differences, "results", differences.same_results, differ, differ - shown, name
    )
    return section(title, Paragraph(sentence), *tables)


def _studies(differences: Differences, name: str) -> Section:
    """Study sheets: rows that changed, and what the studies found where both files hold them."""
    studies = differences.studies
    letters = f"A is {differences.first.source.name}, B this calculation."
    rows = _table("Rows of study sheets that changed", studies.inputs[:_MOST], with_table=True)
    tables, shown = _by_table(studies.results)
    differ = len(studies.results)
    hidden = differ - shown + max(len(studies.inputs) - _MOST, 0)
    sentence = _how_many(
        differences, "results of studies", studies.same_results, differ, hidden, name
    )
    return section(
        "Studies",
        Paragraph(clean(" ".join([*studies.notes, letters]))) if studies.notes else None,
        rows if rows.rows else None,
        Paragraph(sentence),
        *tables,
    )


def _how_many(
    differences: Differences, what: str, same: int, differ: int, left: int, name: str
) -> str:
    """How many are the same and how many differ, and where those stand that are not shown."""
    sentence = f"{same:,} {what} are the same, {differ:,} differ."
    if left:
        sentence += (
            f" The most important rows are shown; all {differ:,} are listed by torsionbook diff "
            f"{_quoted(clean(differences.first.source.name))} {_quoted(name)} --xlsx OUT.xlsx."
        )
    return sentence


def _by_table(results: Iterable[Change]) -> tuple[list[Table], int]:
    """What is asked for first, a table each result table, and how many changes that is."""
    by_table: dict[str, list[Change]] = {}
    for change in results:
        by_table.setdefault(change.table, []).append(change)
    tables: list[Table] = []
    shown = 0
    for name, differing in by_table.items():
        some = telling(name, differing)
        shown += len(some)
        if some:
            kinds = Counter(change.kind for change in differing)
            removed, added = kinds["row removed"], kinds["row added"]
            rows = [f"{removed} only before"] if removed else []
            rows += [f"{added} only now"] if added else []
            note = f"Rows present in one file only: {', '.join(rows)}." if rows else ""
            tables.append(replace(_table(contract.caption(name), some), note=note))
    return tables, shown


def _quoted(name: str) -> str:
    """A name as it is typed on a command line."""
    return f'"{name}"' if " " in name else name
