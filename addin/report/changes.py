"""What changed since an earlier revision, and what it did."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from addin.contract import tables as contract
from addin.contract.problems import shortened
from addin.contract.tables import STUDY_RESULT_TABLES
from addin.diff.changes import Change, Differences, Value, VerdictChange
from addin.diff.files import COMPARED
from addin.diff.wording import change_in_words, in_words, telling
from addin.report.document import Block, Column, Facts, Paragraph, Section, Table
from addin.report.numbers import clean, of_dimension, pretty_unit, typed
from addin.report.subject import Subject

#: Most changed inputs shown. [count]
_MOST = 120
#: Longest text of a cell. [characters]
_LONGEST = 200
_OTHER_VERDICTS = 12
#: Dimension of each column of the results, by table.
_DIMENSIONS: Mapping[str, Mapping[str, str]] = {
    spec.name: {field.name: field.dimension for field in spec.columns}
    for spec in (*COMPARED, *STUDY_RESULT_TABLES)
}


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
    before = differences.first
    facts = [
        ("Compared with", clean(before.source.name)),
        ("Title block there", clean(before.revision) or "blank"),
        ("Its inputs, SHA-256", before.digest or "not recorded"),
        ("Its results", clean(f"{before.results_from}; {before.software}")),
    ]
    blocks: list[Block] = [Paragraph(_sentence(differences), "lead"), Facts(tuple(facts))]
    return Section(
        f"Changes since {earlier_name(differences)}",
        tuple(blocks),
        (
            _inputs(differences),
            _verdicts(differences),
            _results(differences, clean(subject.name)),
            *(
                (_studies(differences, clean(subject.name)),)
                if differences.studies.anything
                else ()
            ),
        ),
    )


def _sentence(differences: Differences) -> str:
    """How much changed, in numbers."""
    verdicts = sum(one.changed for one in differences.verdicts if one.table == "Verdicts")
    judged = {0: "No check has another verdict", 1: "One check has another verdict"}.get(
        verdicts, f"{verdicts} checks have another verdict"
    )
    if differences.inputs is None:
        return f"{judged}. The file compared with is a result JSON, which holds no inputs."
    inputs = sum(not one.administrative for one in differences.inputs)
    if not inputs:
        return f"No input that can change a result differs. {judged}."
    differ = (
        "1 entry of the inputs differs" if inputs == 1 else f"{inputs} entries of the inputs differ"
    )
    return f"{differ}, {differences.same_inputs:,} are the same. {judged}."


def _inputs(differences: Differences) -> Section:
    """Inputs before and after; what changes no result in one sentence."""
    title = "Inputs"
    if differences.inputs is None:
        return Section(title, (Paragraph("Not compared: a result JSON holds no inputs."),))
    real = [one for one in differences.inputs if not one.administrative]
    other = [one for one in differences.inputs if one.administrative]
    note = []
    if len(real) > _MOST:
        note.append(f"{_MOST} of {len(real)} are shown; torsionbook diff lists all.")
    if other:
        sentence = "; ".join(
            " ".join(filter(None, (_words(one.row), one.column, _before_after(one))))
            for one in other[:8]
        )
        rest = f"; and {len(other) - 8} more" if len(other) > 8 else ""
        note.append(f"Also changed, without any bearing on results: {sentence}{rest}.")
    if not real:
        return Section(title, (Paragraph(" ".join(["No difference.", *note])),))
    table = _table("Inputs that changed", real[:_MOST], with_table=True)
    return Section(title, (replace(table, note=" ".join(note)),))


def _before_after(one: Change) -> str:
    return f"({_value(one, one.before)} → {_value(one, one.after)})"


def _table(caption: str, found: Iterable[Change], with_table: bool = False) -> Table:
    """Changes as lines: where, before, after, by how much."""
    columns = (
        *((Column("Table"),) if with_table else ()),
        Column("Row", "", "sentence"),
        Column("Quantity"),
        Column("Unit"),
        Column("Before", "", "number"),
        Column("After", "", "number"),
        Column("Change", "", "number"),
    )
    rows = []
    for one in found:
        table = (contract.caption(one.table),) if with_table else ()
        unit = pretty_unit(one.unit)
        rows.append(
            (
                *table,
                _words(one.row) or "–",
                one.column or "–",
                unit,
                _value(one, one.before),
                _value(one, one.after),
                _by_how_much(one) or ("–" if one.kind == "changed" else one.kind),
            )
        )
    return Table(caption, columns, tuple(rows))


def _by_how_much(one: Change) -> str:
    """The change as printed."""
    number, _, unit = change_in_words(one).partition(" ")
    return _minus(f"{number} {pretty_unit(unit) if unit == one.unit else unit}".rstrip())


def _words(text: str) -> str:
    return shortened(clean(text), _LONGEST)


def _value(one: Change, value: Value) -> str:
    """A value as printed; a blank as a dash."""
    shown = one.shown(value)
    if isinstance(shown, bool) or not isinstance(shown, int | float) or not math.isfinite(shown):
        return _words(in_words(one, value))
    if one.table in _DIMENSIONS:
        dimension = _DIMENSIONS[one.table].get(one.column, "none")
        return of_dimension(float(shown), one.column, dimension, one.unit)
    return typed(float(shown))


def _minus(text: str) -> str:
    return "−" + text[1:] if text.startswith("-") else text


def _verdicts(differences: Differences) -> Section:
    """Every check at a glance before and after, and other verdicts that changed."""
    checks = [one for one in differences.verdicts if one.table == "Verdicts"]
    others = [one for one in differences.verdicts if one.table != "Verdicts" and one.changed]
    blocks: list[Block] = []
    if checks:
        blocks.append(_judged("Checks before and after", checks))
    if others:
        some = [
            replace(one, row=f"{contract.caption(one.table)}: {one.row}")
            for one in others[:_OTHER_VERDICTS]
        ]
        table = _judged("Other verdicts that changed", some)
        left = len(others) - len(some)
        note = f"{len(some)} of {len(others)} are shown." if left else ""
        blocks.append(replace(table, note=note))
    return Section("Verdicts", tuple(blocks) or (Paragraph("Neither file holds verdicts."),))


def _judged(caption: str, found: Sequence[VerdictChange]) -> Table:
    columns = (
        Column("Check", "", "sentence"),
        Column("Before", "", "number"),
        Column("After", "", "number"),
        Column("Limit", "", "number"),
        Column("Verdict before", "", "verdict"),
        Column("Verdict after", "", "verdict"),
    )
    rows = tuple(
        (
            _words(one.row),
            _quantity(one.result_before),
            _quantity(one.result_after),
            _quantity(one.limit),
            one.before or "–",
            one.after or "–",
        )
        for one in found
    )
    numbers = any(row[1] or row[2] or row[3] for row in rows)
    if numbers:
        return Table(caption, columns, rows)
    return Table(caption, (columns[0], *columns[4:]), tuple((row[0], *row[4:]) for row in rows))


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
        return Section(title, (Paragraph(sentence),))
    blocks, shown = _by_table(differences.results)
    differ = len(differences.results)
    sentence = _how_many(
        differences, "results", differences.same_results, differ, differ - shown, name
    )
    return Section(title, (Paragraph(sentence), *blocks))


def _studies(differences: Differences, name: str) -> Section:
    """Study sheets: rows that changed, and what the studies found where both files hold them."""
    there = differences.studies
    letters = f"A is {differences.first.source.name}, B this calculation."
    notes = [Paragraph(clean(" ".join([*there.notes, letters])))] if there.notes else []
    asked = [_table("Rows of study sheets that changed", there.inputs[:_MOST], with_table=True)]
    blocks, shown = _by_table(there.results)
    differ = len(there.results)
    left = differ - shown + max(len(there.inputs) - _MOST, 0)
    sentence = _how_many(differences, "results of studies", there.same_results, differ, left, name)
    return Section(
        "Studies", (*notes, *(asked if there.inputs else ()), Paragraph(sentence), *blocks)
    )


def _how_many(
    differences: Differences, what: str, same: int, differ: int, left: int, name: str
) -> str:
    """How many are the same and how many differ, and where those stand that are not shown."""
    sentence = f"{same:,} {what} are the same, {differ:,} differ."
    if left:
        sentence += (
            f" Shown is what is asked for first; all {differ:,} are listed by "
            f"torsionbook diff {_quoted(clean(differences.first.source.name))} {_quoted(name)} --xlsx OUT.xlsx."
        )
    return sentence


def _by_table(results: Iterable[Change]) -> tuple[list[Block], int]:
    """What is asked for first, a table each result table, and how many changes that is."""
    by_table: dict[str, list[Change]] = {}
    for one in results:
        by_table.setdefault(one.table, []).append(one)
    blocks: list[Block] = []
    shown = 0
    for table, differing in by_table.items():
        some = telling(table, differing)
        shown += len(some)
        if some:
            rows = [
                f"{sum(one.kind == kind for one in differing)} {words}"
                for kind, words in (("row removed", "only before"), ("row added", "only now"))
                if any(one.kind == kind for one in differing)
            ]
            note = f"Rows that have no counterpart: {', '.join(rows)}." if rows else ""
            blocks.append(replace(_table(contract.caption(table), some), note=note))
    return blocks, shown


def _quoted(name: str) -> str:
    """A name as it is typed on a command line."""
    return f'"{name}"' if " " in name else name
