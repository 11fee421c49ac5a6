"""Live formulas of a workbook: typed over, rewritten, or showing an old value."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from addin.contract.banner import (
    CHANGED_CELL,
    CHANGED_WORDS,
    DOCUMENT_AT,
    OVERALL_WITHOUT_COPY,
    bare,
    is_changed,
    is_earlier_banner,
    overall_formula,
)
from addin.contract.input_copy import CHANGED_FORMULA, CHECKS, COPY_ROW
from addin.contract.problems import shortened
from addin.contract.sheets import (
    BLANK_TEXT,
    CYCLE_FACTS,
    FACT_LINES,
    KEY_NUMBERS,
    STRIP,
    TITLE_BLOCK,
    part_named,
)
from addin.contract.tables import INPUT_TABLES, RESULT_TABLES, WORKBOOK_TABLES, Field
from addin.verify.compare import RecordedValue, agreement, plain_value, value_in_words
from addin.verify.findings import Agreement, Finding
from addin.verify.structure import plain, present_sheet
from addin.xlsx import DefinedName, Formula, PackageError, Table, Workbook
from addin.xlsx.references import Rect, cell_name, parse_cell, quoted_sheet

#: Where labels are looked for.
_LABELS = Rect(1, 1, 1000, 60)
_QUOTED = re.compile(r'("(?:[^"]|"")*")')


_BANNER, _ANY_CHANGED = "overall verdict", "any input changed"
#: What a formula of the copy of the inputs says.
COMPARISON = "comparison of inputs"
#: The verdict with which a banner begins.
_CAPITALS = re.compile(r"(?:[A-Z]+(?: [A-Z]+)*\b)?")


@dataclass(frozen=True)
class OwnFormula:
    """A live formula of ours where it belongs."""

    sheet: str  #: Its sheet.
    row: int  #: Its cell.
    column: int  #: Likewise.
    formula: str  #: What this version writes there.
    what: str  #: What it says.
    table: str = ""  #: Result table and live column; empty elsewhere.
    header: str = ""  #: Likewise.

    @property
    def cell(self) -> str:
        """Its cell. [A1]"""
        return cell_name(self.row, self.column)

    def stands(self, workbook: Workbook) -> bool:
        """Whether it is there, or shares the formula of another cell."""
        part = workbook.sheet_part(self.sheet)
        value = part.value(self.row, self.column)
        if isinstance(value, Formula):
            return bare(value.text) == bare(self.formula) or self._is_earlier_banner(value.text)
        if not self.table:  # a formula of one cell shares none
            return False
        return (self.row, self.column) in part.formulas

    def _is_earlier_banner(self, text: str) -> bool:
        return self.what == _BANNER and is_earlier_banner(text)


def earlier_banner(workbook: Workbook, expected: str) -> Iterator[Finding]:
    """What the banner formula of an earlier release says, which recalculation leaves in its template.

    Parameters
    ----------
    workbook : Workbook
        The workbook as it was saved.
    expected : str
        The banner of this version. [words]

    Yields
    ------
    Finding
        A note where the verdict is the same; else it fails.
    """
    for own in own_formulas(workbook):
        value = workbook.sheet_part(own.sheet).value(own.row, own.column)
        if own.what != _BANNER or not isinstance(value, Formula):
            continue
        shown = str(plain_value(value.cached) or "")
        if not is_earlier_banner(value.text):
            continue
        sentence = (
            f"the banner is a formula of an earlier release: it shows '{shortened(shown, 60)}', this "
            f"version gives '{shortened(expected, 60)}'. Copy the inputs into a new workbook: torsionbook "
            "new NEW.xlsx --from OLD.xlsx"
        )
        fails = _CAPITALS.match(shown)[0] != _CAPITALS.match(expected)[0]  # type: ignore[index]
        if shown:
            yield Finding(
                "different",
                own.sheet,
                own.cell,
                sentence,
                found=shown,
                expected=expected,
                fails=fails,
            )


def own_formulas(workbook: Workbook) -> list[OwnFormula]:
    """Live formulas of ours in the cells where they belong, whatever stands there."""
    formulas: list[OwnFormula] = []
    for spec in (*RESULT_TABLES, *WORKBOOK_TABLES):
        table = workbook.tables.get(spec.name)
        if table is not None:
            for field in spec.extra_columns:
                formulas += _of_column(workbook, table, spec.columns[0].name, field)
    name = workbook.defined_names.get("OverallVerdict")
    if name is not None and name.sheet is not None and name.rect is not None:
        place = (name.sheet, name.rect.top, name.rect.left)
        banner = OVERALL_WITHOUT_COPY
        if changed := _changed_cell(workbook):
            sheet, row, column = changed
            formulas.append(OwnFormula(*changed, CHANGED_FORMULA, _ANY_CHANGED))
            banner = overall_formula(is_changed(f"{quoted_sheet(sheet)}!{cell_name(row, column)}"))
        formulas.append(OwnFormula(*place, banner, _BANNER))
    for sheet, beside in _labelled(workbook):
        formulas += _beside_labels(workbook, sheet, beside)
    return [*formulas, *_lines(workbook)]


def _changed_cell(workbook: Workbook) -> tuple[str, int, int] | None:
    """The cell that says whether an input has changed, above the copy of the inputs; None without a copy."""
    checks = workbook.tables.get(CHECKS)
    if checks is None:
        return None
    row, column = parse_cell(CHANGED_CELL)
    return checks.sheet, checks.ref.top - COPY_ROW + row, checks.ref.left - 1 + column


def _of_column(workbook: Workbook, table: Table, first: str, column: Field) -> Iterator[OwnFormula]:
    """The live column of a result table: a formula in every row that holds a result."""
    part = workbook.sheet_part(table.sheet)
    at, named = (table.columns_at.get(name.casefold()) for name in (column.name, first))
    for row in range(table.data.top, table.data.bottom + 1) if at else ():
        if named and part.constant(row, named) is None:
            continue
        what = f"live column {column.name}"
        yield OwnFormula(table.sheet, row, at, column.formula, what, table.name, column.name)  # type: ignore[arg-type]


def summary_sheet(workbook: Workbook) -> str | None:
    """The sheet with the key numbers, told by their labels and not by a name that may lead astray."""
    wanted = {plain(number.label) for number in KEY_NUMBERS}
    first = [table.sheet for name, table in workbook.tables.items() if name == "Verdicts"]
    counts: dict[str, int] = {}
    for sheet in (*first, *workbook.sheet_names):
        if sheet not in counts and workbook.sheet_bytes(sheet):
            counts[sheet] = sum(label in wanted for _, _, label in _words_of(workbook, sheet))
            if counts[sheet] * 2 >= len(wanted):
                return sheet
    best = max(counts, key=lambda sheet: counts[sheet], default=None)
    return best if best is not None and counts[best] else next(iter(first), None)


def _words_of(workbook: Workbook, sheet: str) -> Iterator[tuple[int, int, str]]:
    """Cells of a sheet with words that no formula gives, plainly written."""
    part = workbook.sheet_part(sheet)
    for row, column in part.filled_cells(_LABELS):
        if (row, column) not in part.formulas:
            value = part.constant(row, column)
            if isinstance(value, str) and value:
                yield row, column, plain(value)


def _labelled(workbook: Workbook) -> Iterator[tuple[str, dict[str, str]]]:
    """Sheets with formulas beside labels: label → formula."""
    summary, starts = summary_sheet(workbook), workbook.tables.get("StartCycles")
    block = {
        label: BLANK_TEXT.format(name)
        for _, _, _, label, name in TITLE_BLOCK
        if name.startswith("run_")
    }
    if summary is not None:
        yield summary, block | {number.label: number.formula for number in KEY_NUMBERS}
    if starts is not None:
        yield starts.sheet, {fact.label: fact.formula for fact in CYCLE_FACTS}


def _beside_labels(
    workbook: Workbook, sheet: str, formulas: Mapping[str, str]
) -> Iterator[OwnFormula]:
    """Key numbers, facts of the governing shaft and the stamp: the formula right of its label."""
    labels = {plain(label): label for label in formulas}
    where = {number.label: number.where for number in KEY_NUMBERS if number.where}
    part = workbook.sheet_part(sheet)
    headers = [table.ref for table in workbook.tables.values() if table.sheet == sheet]
    for row, column, words in list(_words_of(workbook, sheet)):
        if any(ref.has(row, column) for ref in headers):
            continue
        label = labels.get(words)
        beside = next(part.filled_cells(Rect(row, column + 1, row, column + 4)), None)
        if label is None or beside is None:
            continue
        yield OwnFormula(sheet, *beside, formulas[label], label)
        if label in where:
            after = OwnFormula(sheet, row, column + 3, where[label], f"{label}, where")
            held = part.value(row, column + 3)
            if isinstance(held, Formula) or held not in (None, ""):
                yield after


#: Digests of the lines above the tables of sheets Start-up, Reversals, Starts and Events of earlier templates:
#: those of 0.1.0, then those that were made before the ten sheets.
_EARLIER_LINES = frozenset(
    {"7ee63c59c54e70bf", "6e3f153f4c29777b", "45c318b3f4a1c2f6"}
    | {"80f4c63c4607edce", "ebd1720e90fc230b", "556cf9b8d5aaa0f5", "e7beffd1d1a660c5"}
    | {"249de0bd97110106"}
)


def _is_earlier_line(formula: str) -> bool:
    return hashlib.sha256(formula.encode()).hexdigest()[:16] in _EARLIER_LINES


def _lines(workbook: Workbook) -> Iterator[OwnFormula]:
    """The lines of words above the tables, unless they were moved as they are."""
    lines = [(sheet, first, formula) for sheet, first, _, formula, _, _ in FACT_LINES]
    for shipped, first, formula in (*lines, ("Summary", DOCUMENT_AT.rpartition("!")[2], STRIP)):
        of_this = part_named(shipped)
        sheet = present_sheet(workbook, of_this)
        if sheet is None:
            continue
        first = first.replace("$", "")
        cell = of_this.at(first) if sheet == of_this.worksheet else first
        part = workbook.sheet_part(sheet)
        values = ((at, part.value(*at)) for at in part.formulas)
        held = {at: bare(f.text) for at, f in values if isinstance(f, Formula)}
        if sheet != of_this.worksheet and any(map(_is_earlier_line, held.values())):
            continue
        moved = next((at for at, text in held.items() if text == bare(formula)), None)
        if moved:
            yield OwnFormula(sheet, *moved, formula, "text line")
        elif workbook.value(sheet, cell) not in (None, ""):
            yield OwnFormula(sheet, *parse_cell(cell), formula, "text line")


def typed_over(workbook: Workbook, same_template: bool) -> Iterator[Finding]:
    """Live formulas of ours that were typed over or rewritten, and labels and names led astray.

    Yields
    ------
    Finding
        Constants in place of formulas, and formulas that read nothing, fail; other formulas are
        notes here, their values are judged with those of all formulas.
    """
    for own in own_formulas(workbook):
        if not own.stands(workbook):
            yield replaced(workbook, own, same_version=same_template)
    for sheet, formulas in _labelled(workbook):
        standing = {words for _, _, words in _words_of(workbook, sheet)}
        for label in formulas:
            if plain(label) not in standing:
                sentence = f"the label '{label}' is missing, so the number cannot be identified"
                yield Finding("edited", sheet, "", sentence, expected=label, fails=same_template)
    yield from _verdict_astray(workbook)


#: Formulas of which every word counts: with another one a banner may show the same now, and not after an edit.
_TO_THE_LETTER = (_BANNER, _ANY_CHANGED, COMPARISON)
#: Functions whose value follows from no cell that is compared here: from clock, chance, file or computer.
_OF_THE_MOMENT = re.compile(
    r"(?<![\w.])(NOW|TODAY|RAND|RANDBETWEEN|RANDARRAY|CELL|INFO|INDIRECT|OFFSET)\(", re.IGNORECASE
)
#: What the overall verdict may say.
_VERDICT = re.compile(
    r"(PASS|PASS WITHIN ITS ERROR|FAIL|INCOMPLETE): (all )?\d+ (of \d+ )?checks.*|"
    rf"ACCEPTED \(margin by .*|CHECK THE INPUTS: .*|{CHANGED_WORDS}|NOT CALCULATED"
)
#: What is read as one beside the results, where it is typed.
_VERDICT_WORD = re.compile(r"(pass(ed)?|fail(ed)?|accepted)[.!]*", re.IGNORECASE)


def verdict_cells(workbook: Workbook) -> Iterator[tuple[str, int, int]]:
    """Cells of the other sheets that refer to the overall verdict: sheet, row and column."""
    name = workbook.defined_names.get("OverallVerdict")
    for sheet in workbook.sheet_names:
        if workbook.sheet_bytes(sheet):
            part = workbook.sheet_part(sheet)
            for row, column in part.formulas:
                held = part.value(row, column)
                if isinstance(held, Formula) and _shows_the_verdict(name, sheet, held.text):
                    yield sheet, row, column


def _verdict_astray(workbook: Workbook) -> Iterator[Finding]:
    """The name of the overall verdict on another sheet, and verdicts that no formula gives."""
    name, summary = workbook.defined_names.get("OverallVerdict"), summary_sheet(workbook)
    if name is None or name.sheet is None or name.rect is None:
        yield Finding("edited", summary or "", "", "the name OverallVerdict refers to no cell")
    elif summary is not None:
        at = cell_name(name.rect.top, name.rect.left)
        titles = {plain(label) for _, _, _, label, _ in TITLE_BLOCK}
        columns = {c for _, c, words in _words_of(workbook, summary) if words in titles}
        if name.sheet != summary or (columns and name.rect.left not in columns):
            sentence = (
                "the name OverallVerdict refers to this cell, not to the verdict below the title "
                f"block of sheet {summary}"
            )
            yield Finding("edited", name.sheet, at, sentence)
    specs = {spec.name for spec in (*RESULT_TABLES, *WORKBOOK_TABLES, *INPUT_TABLES)}
    ours = {table.sheet for table in workbook.tables.values() if table.name in specs}
    for sheet in (sheet for sheet in workbook.sheet_names if workbook.sheet_bytes(sheet)):
        part = workbook.sheet_part(sheet)
        areas = [table.ref for table in workbook.tables.values() if table.sheet == sheet]
        for row, column in part.filled_cells(_LABELS):
            shown, held = part.constant(row, column), part.value(row, column)
            if not isinstance(shown, str) or not (
                _VERDICT.fullmatch(shown.strip())
                or (sheet in ours and held == shown and _VERDICT_WORD.fullmatch(shown.strip()))
            ):
                continue
            if sheet not in ours and shown == CHANGED_WORDS:  # as sheet Live may say
                continue
            if any(area.has(row, column) for area in areas):
                continue
            if name and (name.sheet, name.rect) == (sheet, Rect(row, column, row, column)):
                continue  # reported as a formula typed over
            cell = cell_name(row, column)
            if (row, column) not in part.formulas:
                sentence = f"the verdict '{shortened(shown, 60)}' is typed here, not calculated by a formula"
                yield Finding("edited", sheet, cell, sentence, found=shown)
            elif not isinstance(held, Formula) or not _shows_the_verdict(name, sheet, held.text):
                text = f" ={shortened(held.text, 60)}" if isinstance(held, Formula) else ""
                sentence = (
                    f"the verdict '{shortened(shown, 60)}' comes from the formula{text}, not from "
                    "the overall verdict"
                )
                yield Finding("edited", sheet, cell, sentence, found=shown)


def _shows_the_verdict(name: DefinedName | None, sheet: str, text: str) -> bool:
    """Whether a formula of a sheet is nothing but a reference to the overall verdict, by its name or its cell."""
    shown = {"OVERALLVERDICT"}
    if name is not None and name.sheet is not None and name.rect is not None:
        cell = cell_name(name.rect.top, name.rect.left)
        shown |= {f"{name.sheet}!{cell}", f"{quoted_sheet(name.sheet)}!{cell}"}
        shown |= {cell} if sheet == name.sheet else set()
    return bare(text) in {bare(one) for one in shown}


def replaced(workbook: Workbook, own: OwnFormula, *, same_version: bool = True) -> Finding:
    """What is said of a cell that does not hold the formula it should.

    Parameters
    ----------
    workbook : Workbook
        The workbook as it was saved.
    own : OwnFormula
        What should stand there.
    same_version : bool
        Whether this version wrote it; another one may have worded a banner otherwise. [flag]

    Returns
    -------
    Finding
        A formula that shows the same value is a note, unless it reads no cell, reads clock, chance or
        computer, or belongs to a banner.
    """
    value = workbook.sheet_part(own.sheet).value(own.row, own.column)
    if not isinstance(value, Formula):
        shown = plain_value(value)
        words = "nothing" if shown is None else f"'{shortened(str(shown), 60)}'"
        sentence = f"{own.what}: {words} in place of a live formula"
        return Finding("edited", own.sheet, own.cell, sentence, own.table, "", own.header, shown)
    sentence = (
        f"{own.what}: the formula is ={shortened(value.text, 90)}, different from that of "
        "this version"
    )
    of_the_moment = _OF_THE_MOMENT.search("".join(_QUOTED.split(value.text)[::2]))
    fails = True
    if reads_nothing(workbook, value.text):
        sentence = f"{sentence}; it refers to no cell"
    elif of_the_moment:
        sentence = (
            f"{sentence}; {of_the_moment[1].upper()} shows something else at another time or place"
        )
    elif own.what in _TO_THE_LETTER:
        sentence = f"{sentence}; it may show something else after an edit"
        fails = same_version
    else:
        fails = False
    return Finding(
        "edited", own.sheet, own.cell, sentence, own.table, "", own.header, value.text,
        bare(own.formula), fails=fails,
    )  # fmt: skip


_WORD = re.compile(r"[A-Za-z_\\][\w.\\]*")


def reads_nothing(workbook: Workbook, formula: str) -> bool:
    """Whether a formula reads neither a cell nor a table nor a name."""
    unquoted = _QUOTED.sub("", formula)
    names = {name.casefold() for name in workbook.defined_names}
    words = {word.casefold() for word in _WORD.findall(unquoted)}
    cell = re.search(r"(?<![\w.])\$?[A-Za-z]{1,3}\$?\d{1,7}(?![\w(])", unquoted)
    return not (cell or "[" in unquoted or "!" in unquoted or ":" in unquoted or words & names)


def restore(fresh: Workbook) -> dict[tuple[str, int, int], OwnFormula]:
    """Put our formulas back where others stand, so that what they would show is calculated."""
    restored = {}
    for own in own_formulas(fresh):
        if own.table or own.stands(fresh):
            continue
        try:
            fresh.set_cell(own.sheet, own.cell, Formula(own.formula), replace_formula=True)
        except PackageError:
            continue
        restored[own.sheet, own.row, own.column] = own
    return restored


def old_values(
    standing: Workbook,
    fresh: Workbook,
    left_out: dict[str, list[Rect]],
    formats: Sequence[str],
    restored: Mapping[tuple[str, int, int], OwnFormula] = MappingProxyType({}),
    other_release: str = "",
) -> Iterator[Finding]:
    """Formulas of anybody whose value is not the one that follows now.

    A formula of ours that another release wrote otherwise was not edited.
    """
    for sheet in standing.sheet_names:
        if not standing.sheet_bytes(sheet):
            continue
        old, new = standing.sheet_part(sheet), fresh.sheet_part(sheet)
        tables = [table for table in standing.tables.values() if table.sheet == sheet]
        for row, column in old.formulas:
            if any(area.has(row, column) for area in left_out.get(sheet, ())):
                continue
            own = restored.get((sheet, row, column))
            shows, follows = old.constant(row, column), new.constant(row, column)
            if shows is None and own is not None and follows not in (None, ""):
                sentence = f"{own.what}: the changed formula gives no result to check"
                kind = "old value" if other_release else "edited"
                yield Finding(kind, sheet, own.cell, sentence, expected=plain_value(follows))
            if shows is None or follows is None:
                continue
            style = int(old.style(row, column) or 0)
            standing_here = RecordedValue(shows, number_format=formats[style] if formats else "")
            if agreement(standing_here, follows) <= Agreement.DIGITS:
                continue
            kind, what = ("edited", f"{own.what}: changed formula") if own else (
                "old value", "the formula"
            )  # fmt: skip
            if own and other_release:
                kind, what = "old value", f"{own.what}: the formula of {other_release}"
            yield Finding(
                kind, sheet, cell_name(row, column),
                f"{what} shows {value_in_words(shows)}, recalculation gives {value_in_words(follows)}",
                next((t.name for t in tables if t.ref.has(row, column)), ""), found=plain_value(shows),
                expected=plain_value(follows),
            )  # fmt: skip


def unjudged(standing: Workbook, fresh: Workbook | None) -> list[OwnFormula]:
    """Formulas of ours that show a value of which nobody here can say whether it follows.

    Parameters
    ----------
    standing : Workbook
        The workbook as it was saved.
    fresh : Workbook or None
        With the results written anew and the values of its formulas renewed; None where that failed.
    """
    return [
        own
        for own in own_formulas(standing)
        if standing.shown_value(own.sheet, own.cell) not in (None, "")
        and (fresh is None or fresh.shown_value(own.sheet, own.cell) is None)
    ]
