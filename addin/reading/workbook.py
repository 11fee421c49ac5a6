"""Workbook → `CaseData`, and every problem with the cell where it is corrected.

Cells are found by defined names and Excel tables, never by address: the unit of a scalar stands in
the cell to its right, the unit of a column right above its header. Nothing stops at the first
problem: cells that cannot be read are noted here, the physics is checked by `engine.case.checks.find_problems`,
and both are reported together.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path

from addin.contract.problems import CellProblem, nearest, placed, shortened
from addin.contract.shipped import template_path
from addin.contract.tables import (
    INPUT_TABLES,
    SCALAR_SHEET,
    SCALAR_TABLE,
    SCALARS,
    STUDY_INPUT_TABLES,
    TEMPLATE_VERSION,
    Field,
    TableSpec,
    input_table,
)
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.cells import (
    Cell,
    CellFault,
    built_in_format,
    is_percent_format,
    read_number,
    read_text,
    read_unit,
)
from addin.reading.study_inputs import studies_read
from addin.reading.typed_case import (
    CaseInput,
    Entry,
    Findings,
    Place,
    StudiesRead,
    Typed,
    TypedCase,
    all_problems,
    in_typed_units,
    to_case_data,
    too_many_rows,
    word_entry,
    word_in_place,
)
from addin.xlsx import DefinedName, Table, Workbook, open_workbook
from addin.xlsx.references import Rect, cell_name, parse_cell, whole_number
from addin.xlsx.xml_part import main
from engine.errors import Problem

#: Names this product has beyond the contract; a workbook without them, and without a value beside their label,
#: reads as blank there.
_OPTIONAL = frozenset(
    {
        "RainflowResidue",
        "MeanStress",
        "Standard",
        "Gear type",
        "ContactLaw",
        "DampingRange",
        "InitialState",
        "TorqueFollows",
        "Elements.Service factor",
        "Teeth drive",
        "Teeth driven",
        "Meshes.Speed ratio",
        "MotorTorque.Phase",
        "MotorTorque.Pulsation1",
        "EventTorque.Base",
        "MotorData.Time constants",
        "Latest clearing",
        "Per life",
        "Event",
        "Clearing",
        "Earliest clearing",
        "Begins",
    }
)


#: What a defined name of cells stands for: a sheet, in quotes where need be, and cells.
_TO_CELLS = re.compile(
    r"(?:'((?:[^'\[\]]|'')+)'|([^'!\[\]#]+))!\$?[A-Z]{1,3}\$?\d+(?::\$?[A-Z]{1,3}\$?\d+)?"
)
#: Rows over and under a scalar in which the words of the next ones are looked for. [count]
_NEAR = 6
#: Names that are listed of a sheet that is not there. [count]
_LISTED = 12


@lru_cache(maxsize=1)
def _own_names() -> frozenset[str]:
    """Names of the product itself, which stand for something else; without capitals."""
    names = set(open_workbook(template_path("blank_us.xlsx"), read_only=True).defined_names)
    return frozenset(name.casefold() for name in names | {spec.name for spec in SCALARS})


@dataclass
class Locations:
    """Where everything stands in the workbook."""

    scalars: dict[str, tuple[str, str]] = field(default_factory=dict)  #: By defined name.
    #: Unit cells; of a scalar under its table ``Case``.
    units: dict[tuple[str, str], tuple[str, str]] = field(default_factory=dict)
    #: Input tables found, by the name of the contract.
    tables: dict[str, Table] = field(default_factory=dict)
    #: Sheet column of each column found.
    columns: dict[tuple[str, str], int] = field(default_factory=dict)
    #: Table row, counted from 1, of each row read.
    rows: dict[str, list[int]] = field(default_factory=dict)

    def table_row(self, table: str, row: int) -> int:
        """The row of a table as the engineer counts it.

        Returns
        -------
        int
            Row of the Excel table counted from 1, blank rows included. [count]
        """
        rows = self.rows.get(table, [])
        return rows[row - 1] if row <= len(rows) else row

    def cell(self, table: str, row: int | None, column: str) -> tuple[str, str]:
        """Sheet and cell of an input.

        Parameters
        ----------
        table : str
            Input table, or ``Case`` for a scalar. [name]
        row : int or None
            Row of `CaseData`, counted from 1; None for a scalar, or for the unit of a column. [count]
        column : str
            Header, name of the scalar, or empty for the whole table. [name]

        Returns
        -------
        tuple of str
            Sheet and cell; the cell is empty when there is none.
        """
        if table == SCALAR_TABLE:
            return self.scalars.get(column, (SCALAR_SHEET, ""))
        excel_table = self.tables.get(table)
        if excel_table is None:
            return input_table(table).sheet, ""
        if row is None:
            return self.units.get((table, column), (excel_table.sheet, ""))
        at = self.columns.get((table, column))
        if at is None:
            return excel_table.sheet, ""
        return excel_table.sheet, cell_name(
            excel_table.data.top + self.table_row(table, row) - 1, at
        )


@dataclass(frozen=True)
class WorkbookInput(CaseInput):
    """A workbook as read; see `CaseInput` for data, problems, warnings and entries."""

    path: Path  #: The file.
    sha256: str  #: Digest of the file. [hexadecimal]
    template_version: str  #: As written in the workbook; empty when missing.
    locations: Locations  #: Where everything stands.
    #: The open workbook; results are written into what the inputs were read from.
    workbook: Workbook = field(repr=False, compare=False)
    #: Where the study tables stand.
    study_locations: Locations = field(default_factory=Locations, repr=False, compare=False)

    def locate(self, problem: Problem) -> CellProblem:
        """A problem of the engine with its sheet and cell."""
        return _located(problem, self.typed, self.locations)

    def otherwise_now(self) -> tuple[list[str], list[str]]:
        """Inputs that are formulas and show something else since results were written."""
        places = dict(self._places())
        if not any(self._is_calculated(*cell) for cell in places):
            return [], []
        after = read_workbook(self.workbook).typed
        without_value, changed = [], []
        for (sheet, cell), (place, entry) in places.items():
            if self.workbook.shown_value(sheet, cell) is None:
                without_value.append(f"{sheet}!{cell}")
            elif after.entry(place) != entry and self._is_calculated(sheet, cell):
                changed.append(f"{sheet}!{cell}")
        return without_value, changed

    def _places(self) -> Iterator[tuple[tuple[str, str], tuple[Place, Entry]]]:
        """Cells of all entries, and of their units."""
        rows: list[tuple[str, int | None, Mapping[str, Entry]]]
        rows = [(SCALAR_TABLE, None, self.typed.scalars)]
        for table, entries in self.typed.tables.items():
            rows += [(table, row, entry) for row, entry in enumerate(entries, start=1)]
        for table, row, line in rows:
            for column, entry in line.items():
                place = (table, row, column)
                yield self.locations.cell(*place), (place, entry)
                if isinstance(entry, Typed) and entry.unit:
                    yield self.locations.units[table, column], (place, entry)

    def _is_calculated(self, sheet: str, cell: str) -> bool:
        part, place = self.workbook.sheet_part(sheet), parse_cell(cell)
        return place in part.formulas or part.array_across(Rect(*place, *place)) is not None


def read_workbook(source: str | Path | Workbook) -> WorkbookInput:
    """Read the inputs of a workbook, all problems collected.

    Parameters
    ----------
    source : str, Path or Workbook
        File, opened for reading only, or a workbook that is open already. [path]

    Returns
    -------
    WorkbookInput
        Data, problems, warnings and where everything stands. [SI]

    Raises
    ------
    addin.xlsx.PackageError
        When the file is not a workbook that can be opened.
    """
    if isinstance(source, Workbook):
        return _Reading(source).result()
    return _Reading(open_workbook(source, read_only=True)).result()


class _Reading:
    """One reading of one workbook: what has been found so far."""

    def __init__(self, workbook: Workbook) -> None:
        self.workbook = workbook
        self.typed = TypedCase()
        self.findings = Findings()
        self.locations = Locations()
        self.warnings: list[str] = []
        self.lost: dict[str, list[str]] = {}  # sheet that is not there → names that lead to it
        self.names = {name.casefold(): defined for name, defined in workbook.defined_names.items()}
        self.tables = {name.casefold(): defined for name, defined in workbook.tables.items()}

    def result(self) -> WorkbookInput:
        """Everything read and checked."""
        version = self._version()
        for spec in SCALARS:
            self._read_scalar(spec)
        self._note_lost_sheets()
        for table in INPUT_TABLES:
            self._read_table(table)
        self._note_earlier_default()
        of_reader = self.findings.without()
        data = to_case_data(self.typed, self.findings)
        problems = all_problems(data, self.findings)
        studies, study_locations = self._studies()
        return WorkbookInput(
            path=self.workbook.path,
            sha256=self.workbook.container.sha256,
            data=data,
            problems=tuple(_located(p, self.typed, self.locations) for p in problems),
            warnings=tuple(self.warnings),
            template_version=version,
            typed=self.typed,
            studies=studies,
            findings=of_reader,
            locations=self.locations,
            workbook=self.workbook,
            study_locations=study_locations,
        )

    def _studies(self) -> tuple[StudiesRead | None, Locations]:
        """The study sheets, where the workbook has any, and where they are: read apart, so that they spoil no case."""
        present = [spec for spec in STUDY_INPUT_TABLES if spec.name.casefold() in self.tables]
        if not present:
            return None, Locations()
        apart = _Reading(self.workbook)
        for table in present:
            apart._read_table(table)
        read = studies_read(
            {table.name for table in present},
            apart.typed,
            self.typed,
            apart.findings,
            lambda problem: _located(problem, apart.typed, apart.locations),
            tuple(apart.warnings),
        )
        return read, apart.locations

    # ---- scalars -------------------------------------------------------------------------------

    def _version(self) -> str:
        """Version of the template, with a warning when it is not this one's."""
        name = self.names.get("templateversion")
        if name is None or name.sheet is None or name.rect is None:
            return ""
        value = self._cell(name.sheet, name.rect.top, name.rect.left).value
        version = f"{value:.15g}" if isinstance(value, float) else str(value or "").strip()
        if version != TEMPLATE_VERSION:
            self.warnings.append(
                f"The workbook has template version '{shortened(version)}', this program ships version '{TEMPLATE_VERSION}'. "
                "If results look wrong, make a workbook of this version: torsionbook new NEW.xlsx --from "
                "FILE."
            )
        return version

    def _note_earlier_default(self) -> None:
        """A workbook without the scalar was calculated otherwise by the version that made it."""
        if "torquefollows" in self.names or not self.typed.tables.get("MotorTorque"):
            return
        self.warnings.append(
            "The workbook has no scalar TorqueFollows, so motor curves are read at the mean speed. Version 0.1.0 read "
            "them at the rotor's own speed: for its numbers make a workbook of this version (torsionbook new NEW.xlsx "
            "--from FILE) and set TorqueFollows to own speed."
        )

    def _read_scalar(self, spec: Field) -> None:
        """One scalar, by its defined name."""
        place = (SCALAR_TABLE, None, spec.name)
        name = self.names.get(spec.name.casefold())
        if name is None or name.sheet is None or name.rect is None:
            lost = "" if name is None else self._lost_sheet(name)
            if lost:
                self.lost.setdefault(lost, []).append(spec.name)
            elif spec.name not in _OPTIONAL or self._value_beside_label(spec):
                self._note_missing_name(spec, broken=name is not None)
            return
        sheet, top, left = name.sheet, name.rect.top, name.rect.left
        self.locations.scalars[spec.name] = (sheet, cell_name(top, left))
        unit_at = (top, name.rect.right + 1)
        self.locations.units[SCALAR_TABLE, spec.name] = (sheet, cell_name(*unit_at))
        cell = self._cell(sheet, top, left)
        entry: Entry | None = None
        if not spec.is_number:
            entry = self._words(cell, spec, place)
        elif word := word_in_place(cell.value, spec):
            entry = word
        else:
            number = self._number(cell, spec, place, "in the cell to the right of it")
            if number is not None:
                scaled = self._scale(self._cell(sheet, *unit_at), spec, place)
                entry = scaled and self._typed(number, *scaled, cell, place)
        if entry is not None:
            self.typed.scalars[spec.name] = entry

    def _value_beside_label(self, spec: Field) -> bool:
        """Whether a value stands beside a scalar's words, under or over those of the scalars read before it."""
        for sheet, cell in set(self.locations.scalars.values()):
            part, (row, column) = self.workbook.sheet_part(sheet), parse_cell(cell)
            for near in range(max(row - _NEAR, 1), row + _NEAR + 1):
                if column > 1 and part.constant(near, column - 1) == spec.name_in_words:
                    return part.constant(near, column) is not None
        return False

    def _lost_sheet(self, name: DefinedName) -> str:
        """The sheet that a name leads to, where the workbook has none of it; else empty."""
        match = _TO_CELLS.fullmatch(name.text.strip())
        if match is None:
            return ""
        sheet = (match.group(1) or match.group(2)).replace("''", "'")
        there = {sheet_name.casefold() for sheet_name in self.workbook.sheet_names}
        return "" if sheet.casefold() in there else sheet

    def _note_lost_sheets(self) -> None:
        """One problem for all names that lead to a sheet that is not there."""
        for sheet, names in self.lost.items():
            rest = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
            listed = ", ".join(names[:_LISTED]) + rest
            what = (
                f"the defined name refers to sheet {sheet}, which"
                if len(names) == 1
                else f"{len(names)} defined names refer to sheet {sheet} ({listed}), which"
            )
            self.findings.add(
                (SCALAR_TABLE, None, names[0]),
                sheet,
                "a sheet of the workbook",
                f"{what} is missing in the workbook. If another program renamed the sheet, rename it "
                f"to {sheet}; if it was deleted, start from a new template.",
            )
            self.findings.silence(*((SCALAR_TABLE, None, name) for name in names[1:]))

    def _note_missing_name(self, spec: Field, broken: bool) -> None:
        own = _own_names()
        others = [
            n
            for n in self.workbook.defined_names
            if n.casefold() not in own and not n.casefold().startswith("run_")
        ]
        meant = nearest(spec.name, others, 0.75)
        if broken:
            what = "the defined name refers to no cell, because its row or sheet was deleted"
        else:
            what = "the workbook has no such defined name"
        hint = f" The name '{meant}' is similar; rename it." if meant else ""
        self.findings.add(
            (SCALAR_TABLE, None, spec.name),
            meant,
            "a defined name",
            f"{what}.{hint} Define it again (Formulas > Name Manager), or start from a new "
            "template.",
        )

    # ---- tables --------------------------------------------------------------------------------

    def _read_table(self, spec: TableSpec) -> None:
        """One input table, by its name."""
        table = self.tables.get(spec.name.casefold())
        if table is None or not table.has_header:
            self._note_missing_table(spec, table)
            return
        self.locations.tables[spec.name] = table
        headers = {folded_header(name): i for i, name in enumerate(table.columns)}
        for column in spec.columns:
            index = headers.get(folded_header(column.name))
            if index is None:
                self._note_missing_column(spec, column, table)
                continue
            at = table.ref.left + index
            self.locations.columns[spec.name, column.name] = at
            if table.ref.top > 1:
                unit_cell = cell_name(table.ref.top - 1, at)
                self.locations.units[spec.name, column.name] = (table.sheet, unit_cell)
        self._read_rows(spec, table)
        self._note_merges(spec, table)
        self._warn_of_rows(spec, table)
        self._silence_missing_columns(spec)

    def _note_missing_table(self, spec: TableSpec, table: Table | None) -> None:
        if table is None and spec.later:
            return
        if table is not None:
            message = "the table has no header row. Switch it on (Table Design > Header Row)."
        else:
            known = {other.name.casefold() for other in INPUT_TABLES}
            others = [name for name in self.workbook.tables if name.casefold() not in known]
            meant = nearest(spec.name, others, 0.75)
            if spec.later and not meant:
                return
            hint = f" Table '{meant}' is similar; rename it." if meant else ""
            message = (
                f"the workbook has no table of this name.{hint} Restore the table name (Table Design "
                "> Table Name), or start from a new template."
            )
        self.findings.add((spec.name, None, ""), None, "an Excel table of this name", message)

    def _note_missing_column(self, spec: TableSpec, column: Field, table: Table) -> None:
        if not _OPTIONAL.isdisjoint((column.name, f"{spec.name}.{column.name}")):
            return
        known = {folded_header(other.name) for other in (*spec.columns, *spec.extra_columns)}
        others = [name for name in table.columns if folded_header(name) not in known]
        meant = nearest(column.name, others, 0.5)
        hint = f" Column '{meant}' is similar; rename it." if meant else ""
        self.findings.add(
            (spec.name, None, column.name),
            meant,
            f"a column with the header {column.name}",
            f"the table has no such column.{hint} Restore its header, or add the column (it may "
            "stay blank).",
        )

    def _silence_missing_columns(self, spec: TableSpec) -> None:
        rows = range(1, len(self.locations.rows[spec.name]) + 1)
        for column in spec.columns:
            if (spec.name, None, column.name) in self.findings.bad:
                self.findings.silence(*((spec.name, row, column.name) for row in rows))

    def _read_rows(self, spec: TableSpec, table: Table) -> None:
        """All rows that hold something; the others are passed over."""
        columns = {
            self.locations.columns[spec.name, column.name]: column
            for column in spec.columns
            if (spec.name, column.name) in self.locations.columns
        }
        lines: dict[int, dict[str, Cell]] = {}
        for row, at in self.workbook.sheet_part(table.sheet).filled_cells(table.data):
            if at in columns:
                cell = self._cell(table.sheet, row, at)
                if not cell.is_blank:
                    lines.setdefault(row, {})[columns[at].name] = cell
        if spec.states:
            lines = {row: line for row, line in lines.items() if spec.states in line}
        if too_many_rows(spec.name, len(lines), self.findings):
            lines = {}
        self.locations.rows[spec.name] = [row - table.data.top + 1 for row in lines]
        entries: list[dict[str, Entry]] = [{} for _ in lines]
        self.typed.tables[spec.name] = entries
        for column in columns.values():
            cells = {
                i: line[column.name] for i, line in enumerate(lines.values()) if column.name in line
            }
            for i, entry in self._column_entries(spec, column, cells):
                entries[i][column.name] = entry

    def _column_entries(
        self, spec: TableSpec, column: Field, cells: Mapping[int, Cell]
    ) -> Iterator[tuple[int, Entry]]:
        """Index and entry of the cells of one column that can be read."""
        if not cells:
            return
        if not column.is_number:
            for i, cell in cells.items():
                words = self._words(cell, column, (spec.name, i + 1, column.name))
                if words is not None:
                    yield i, words
            return
        place: Place = (spec.name, None, column.name)
        sheet, at = self.locations.units.get((spec.name, column.name), ("", ""))
        unit = self._cell(sheet, *parse_cell(at)) if at else Cell(None)
        scaled = self._scale(unit, column, place)
        for i, cell in cells.items():
            place = (spec.name, i + 1, column.name)
            if word := word_in_place(cell.value, column):
                yield i, word
                continue
            number = self._number(cell, column, place, "in the cell above the header")
            if scaled is None:
                self.findings.silence(place)
            elif number is not None:
                entry = self._typed(number, *scaled, cell, place)
                if entry is not None:
                    yield i, entry

    def _note_merges(self, spec: TableSpec, table: Table) -> None:
        """Merged cells inside a table: Excel keeps one value and shows it for all."""
        for merge in self.workbook.sheet_part(table.sheet).merges:
            if not merge.meets(table.data):
                continue
            across = range(merge.left, merge.right + 1)
            columns = [
                column.name
                for column in spec.columns
                if self.locations.columns.get((spec.name, column.name)) in across
            ]
            inside = range(merge.top - table.data.top + 1, merge.bottom - table.data.top + 2)
            rows = enumerate(self.locations.rows[spec.name], start=1)
            indices = [index for index, row in rows if row in inside]
            if not indices:
                continue  # nothing is typed there
            self.findings.add(
                (spec.name, indices[0], columns[0] if columns else ""),
                f"merged cells {merge}",
                "one cell a value",
                f"the cells {merge} are merged and share one value. Unmerge them and fill each.",
            )
            self.findings.silence(*((spec.name, i, name) for i in indices for name in columns))

    # ---- cells ---------------------------------------------------------------------------------

    def _cell(self, sheet: str, row: int, column: int) -> Cell:
        part = self.workbook.sheet_part(sheet)
        value = part.constant(row, column)
        style = part.style(row, column) if isinstance(value, float) else None
        index = whole_number(style or "0", len(self._formats) - 1)
        number_format = "General" if index is None else self._formats[index]
        return Cell(value, (row, column) in part.formulas, number_format)

    @cached_property
    def _formats(self) -> list[str]:
        return _number_formats(self.workbook)

    def _number(self, cell: Cell, spec: Field, place: Place, unit_place: str) -> float | None:
        with self._noting(place):
            return read_number(cell, spec, unit_place)
        return None

    def _words(self, cell: Cell, spec: Field, place: Place) -> str | None:
        with self._noting(place):
            words = read_text(cell, spec)
            return None if words is None else word_entry(words, spec, place, self.findings)
        return None

    @contextmanager
    def _noting(self, place: Place) -> Iterator[None]:
        """Note why a cell cannot be read, in place of raising it."""
        try:
            yield
        except CellFault as fault:
            self.findings.add(place, fault.found, fault.allowed, fault.message)

    def _scale(self, cell: Cell, spec: Field, place: Place) -> tuple[UnitScale, str] | None:
        """The scale of a unit cell and the unit; one that cannot be read is noted."""
        if not spec.has_unit:
            return UnitScale(1.0), ""
        unit = None
        try:
            unit = read_unit(cell)
            return parse_unit(unit, spec.dimension), unit
        except (CellFault, UnitError) as error:
            found, message = error.found if unit is None else unit or None, error.message
            if place[0] == SCALAR_TABLE:
                message = f"unit cell {self.locations.units[place[0], place[2]][1]}: {message}"
            self.findings.add(place, found, error.allowed, message)
            return None

    def _typed(
        self, number: float, scale: UnitScale, unit: str, cell: Cell, place: Place
    ) -> Typed | None:
        """A number with its unit, unless percent is stated twice."""
        if scale.factor == 0.01 and is_percent_format(cell.number_format):
            self.findings.add(
                place,
                f"{100 * number:.10g}%",
                "a plain number of percent",
                f"the cell shows {100 * number:.10g}% but contains {number:.10g}, and its unit is "
                f"already %. Format the cell as Number and type {100 * number:.10g}.",
            )
            return None
        return Typed(number, scale, unit)

    # ---- warnings ------------------------------------------------------------------------------

    def _warn_of_rows(self, spec: TableSpec, table: Table) -> None:
        """Hidden rows are read; rows right below the table are not."""
        sheet = self.workbook.sheet_part(table.sheet)
        hidden = set(sheet.hidden_rows(table.data.top, table.data.bottom))
        rows = [r for r in self.locations.rows[spec.name] if table.data.top + r - 1 in hidden]
        if rows:
            self.warnings.append(
                f"Sheet {table.sheet}, table {spec.name}: {_rows_in_words(rows)} hidden or filtered, "
                "but included in the calculation."
            )
        if table.has_totals:
            return
        below = Rect(table.ref.bottom + 1, table.ref.left, table.ref.bottom + 1, table.ref.right)
        if any(True for _ in sheet.filled_cells(below)):
            self.warnings.append(
                f"Sheet {table.sheet}, table {spec.name}: the row below the table (row {below.top} of "
                "the sheet) is outside it and is not read. Extend the table if the row belongs to it."
            )


def _number_formats(workbook: Workbook) -> list[str]:
    """Number format code of each style index."""
    part = workbook.structure.related("styles")
    if part is None:
        return []
    root = workbook.container.tree(part)
    custom = {
        whole_number(entry.get("numFmtId")): entry.get("formatCode", "")
        for entry in root.iterfind(f"{main('numFmts')}/{main('numFmt')}")
    }
    identifiers = (
        whole_number(entry.get("numFmtId", "0")) or 0
        for entry in root.iterfind(f"{main('cellXfs')}/{main('xf')}")
    )
    return [custom.get(number) or built_in_format(number) for number in identifiers]


# --- places ---------------------------------------------------------------------------------------


def _located(problem: Problem, typed: TypedCase, locations: Locations) -> CellProblem:
    """A problem with rows as the engineer counts them, its cell, and the number as typed."""
    sheet, cell = locations.cell(problem.table, problem.row, problem.column)
    problem = in_typed_units(problem, typed)
    row = None if problem.row is None else locations.table_row(problem.table, problem.row)
    kind = "unit cell" if row is None and problem.table != SCALAR_TABLE else "cell"
    message = _renumbered(problem, locations)
    return placed(replace(problem, row=row, message=message), sheet, cell, kind)


_ROW_IN_WORDS = re.compile(r"(?:table (\w+), )?\brow (\d+)\b")


def _renumbered(problem: Problem, locations: Locations) -> str:
    """The sentence with every row it names counted as in the Excel table."""

    def counted(match: re.Match[str]) -> str:
        row = locations.table_row(match.group(1) or problem.table, int(match.group(2)))
        return match.group()[: -len(match.group(2))] + str(row)

    return _ROW_IN_WORDS.sub(counted, problem.message)


def _rows_in_words(rows: list[int]) -> str:
    if len(rows) == 1:
        return f"row {rows[0]} is"
    return "rows " + ", ".join(map(str, rows)) + " are"


def folded_header(text: str) -> str:
    """A header without line breaks, double blanks and capitals."""
    return " ".join(text.replace("\u00a0", " ").split()).casefold()
