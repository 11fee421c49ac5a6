"""Ranges of a sheet → a case: a row of units, a row of headers, rows of values.

The same names, units and sentences as in a workbook that is read as a whole; a range only lacks
the sheet and the address it came from, so a place is table, row and column.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from addin.contract.problems import CellProblem, first_of, nearest
from addin.contract.tables import (
    EVERY_INPUT,
    INPUT_TABLES,
    SCALAR_TABLE,
    SCALARS,
    Field,
    TableSpec,
    input_table,
)
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.cells import Cell as SheetCell
from addin.reading.cells import CellFault, read_number, read_text
from addin.reading.study_inputs import study_rows, units_for_words
from addin.reading.typed_case import (
    CaseInput,
    Entry,
    Findings,
    PerUnitBases,
    Place,
    Typed,
    TypedCase,
    all_problems,
    in_typed_units,
    to_case_data,
    word_entry,
    word_in_place,
)
from addin.worksheet.registry import Block, Cell, FunctionError
from engine.case.case import Case
from engine.case.checks.motors import check_motors
from engine.case.checks.problem import first_of_each_cell
from engine.case.checks.sections import check_sections
from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow, StationRow
from engine.case.study_inputs import StudyInputs
from engine.errors import Problem

#: A header is looked for in so many rows from the top: title, units, headers.
HEADER_ROWS = 3
#: Likeness from which a text beside a value is taken for a misspelt name, not for a note. [1]
_NEARLY = 0.85
#: Problems listed in one cell.
MOST_TOLD = 5


def case_of(blocks: Mapping[str, Block]) -> CaseInput:
    """Read a case from ranges.

    Parameters
    ----------
    blocks : mapping of str to rows of cells
        ``Case`` for scalars, else the name of an input table → its range. [as typed]

    Returns
    -------
    CaseInput
        Data, problems and entries as typed. [SI]

    Raises
    ------
    FunctionError
        If a range is no such table at all.
    """
    reading = _Reading()
    for name, block in blocks.items():
        if name == SCALAR_TABLE:
            reading.scalars(block)
        else:
            reading.table(input_table(name), block)
    return reading.result()


def study_inputs_of(
    case: Case, blocks: Mapping[str, Block]
) -> tuple[StudyInputs, tuple[Problem, ...]]:
    """Read study tables from ranges.

    Parameters
    ----------
    case : Case
        The case that they belong to. [SI]
    blocks : mapping of str to rows of cells
        Name of a study table → its range. [as typed]

    Returns
    -------
    inputs : StudyInputs
        Their rows. [SI]
    problems : tuple of Problem
        Cells that cannot be read; rows are counted below the headers. [as typed]

    Raises
    ------
    FunctionError
        If a range is no such table at all.
    """
    reading = _Reading()
    for name, block in blocks.items():
        reading.table(input_table(name), block)
    ratings = case.ratings
    bases = PerUnitBases(ratings.rated_torque, ratings.synchronous_speed, case.speed_ratios)
    inputs = study_rows(reading.typed, bases, reading.findings)
    units = units_for_words(reading.typed, TypedCase())
    return replace(inputs, units=units), tuple(reading.findings.problems)


def case_of_motors(
    data: Block, circuit: Block | None, line_frequency: float | None
) -> tuple[CaseData, list[CellProblem]]:
    """Read data sheets of motors from ranges, without a train; per unit needs no apparent power then.

    Parameters
    ----------
    data, circuit : rows of cells
        Tables MotorData and MotorCircuit. [as typed]
    line_frequency : float or None
        Line frequency. [Hz]

    Returns
    -------
    case : CaseData
        With nothing but the motors; a motor without a station is called by its row. [SI]
    problems : list of CellProblem
        Everything wrong with them; rows are counted below the headers.

    Raises
    ------
    FunctionError
        If a range is no such table at all.
    """
    reading = _Reading()
    reading.table(input_table("MotorData"), data)
    if circuit is not None:
        reading.table(input_table("MotorCircuit"), circuit)
    read = to_case_data(reading.typed, reading.findings)
    motors = tuple(
        replace(row, station=row.station or f"Row {k}") for k, row in enumerate(read.motor_data, 1)
    )
    stations = tuple(StationRow(row.station) for row in motors)
    case = replace(read, motor_data=motors, stations=stations, line_frequency=line_frequency)
    reading.findings.silence(
        *(
            ("MotorData", k, "Apparent power")
            for k, row in enumerate(motors, 1)
            if row.apparent_power is None
        )
    )
    found = first_of_each_cell(check_motors(case), reading.findings.bad)
    return case, [reading.placed(problem) for problem in (*reading.findings.problems, *found)]


def case_of_sections(
    sections: Block, materials: Block | None
) -> tuple[CaseData, list[CellProblem]]:
    """Read sections of shafts from ranges, without a train.

    Parameters
    ----------
    sections, materials : rows of cells
        Tables Sections and SectionMaterials. [as typed]

    Returns
    -------
    case : CaseData
        With nothing but the sections and a shaft for each element they name. [SI]
    problems : list of CellProblem
        Everything wrong with them; rows are counted below the headers.

    Raises
    ------
    FunctionError
        If a range is no such table at all.
    """
    reading = _Reading()
    reading.table(input_table("Sections"), sections)
    if materials is not None:
        reading.table(input_table("SectionMaterials"), materials)
    read = to_case_data(reading.typed, reading.findings)
    names = dict.fromkeys(row.element for row in read.sections if row.element)
    case = replace(read, elements=tuple(ElementRow(name, ElementKind.SHAFT) for name in names))
    found = first_of_each_cell(check_sections(case), reading.findings.bad)
    return case, [reading.placed(problem) for problem in (*reading.findings.problems, *found)]


def problems_in_words(problems: Sequence[CellProblem]) -> str:
    """Everything wrong, for one cell.

    Parameters
    ----------
    problems : sequence of CellProblem
        What is wrong. [sentences]

    Returns
    -------
    str
        Sentences, the first `MOST_TOLD` of them; empty if nothing is wrong.
    """
    return " ".join(first_of([problem.message for problem in problems], MOST_TOLD))


class _Reading:
    """What has been found so far."""

    def __init__(self) -> None:
        self.typed = TypedCase()
        self.findings = Findings()
        self.rows: dict[str, list[int]] = {}

    # ---- scalars -------------------------------------------------------------------------------

    def scalars(self, block: Block) -> None:
        """Name, value and unit side by side, anywhere in the range."""
        names = {_folded(spec.name): spec for spec in SCALARS}
        if not any(isinstance(c, str) and _folded(c) in names for row in block for c in row):
            raise FunctionError(
                "Case: the range "
                f"{_other(SCALAR_TABLE, block) or 'contains no input name of sheet Case.'} "
                "Select the names, values and units of sheet Case, side by side."
            )
        if any(isinstance(row[0], float) for row in block):
            raise FunctionError(
                "Case: the first column of the range contains numbers. Start the range with the "
                "column of names."
            )
        there: set[str] = set()
        seen: set[str] = set()
        columns: set[int] = set()
        for row in block:
            for i, cell in enumerate(row):
                spec = names.get(_folded(cell)) if isinstance(cell, str) else None
                before = row[i - 1] if i else None
                if spec is None or (isinstance(before, str) and _folded(before) in names):
                    continue  # no name, or the value of the name before it
                columns.add(i)
                place = (SCALAR_TABLE, None, spec.name)
                if i + 1 >= len(row):
                    raise FunctionError(
                        f"Case: the range ends with the column of '{cell}'. Select its value and "
                        "unit too."
                    )
                there.add(spec.name)
                if row[i + 1] is None:
                    continue  # blank, or a heading of the same name
                if spec.name in seen:
                    self.findings.add(
                        place, cell, "unique names", f"the name '{cell}' occurs twice. Delete one."
                    )
                    continue
                seen.add(spec.name)
                unit = row[i + 2] if i + 2 < len(row) else None
                entry = self._entry(spec, row[i + 1], unit, place, "right of it")
                if entry is not None:
                    self.typed.scalars[spec.name] = entry
        self._misspelt_names(block, columns, [s.name for s in SCALARS if s.name not in there])

    def _misspelt_names(self, block: Block, columns: set[int], missing: list[str]) -> None:
        """Texts that stand where names do, have a value, and are nearly a name that is missing."""
        folded = {_folded(name): name for name in missing}
        for row in block:
            for i in columns:
                cell, value = row[i], row[i + 1] if i + 1 < len(row) else None
                if not isinstance(cell, str) or value is None:
                    continue
                meant = nearest(_folded(cell), list(folded), cutoff=_NEARLY)
                if meant is not None:
                    self.findings.add(
                        (SCALAR_TABLE, None, cell),
                        cell,
                        "a name of sheet Case",
                        f"the name '{cell}' is unknown. Did you mean '{folded[meant]}'?",
                    )

    # ---- tables --------------------------------------------------------------------------------

    def table(self, spec: TableSpec, block: Block) -> None:
        """A range with its headers."""
        at = self._header_row(spec, block)
        columns = self._columns(spec, block, at)
        scales = {
            j: self._scale(column, block[at - 1][j] if at else None, (spec.name, None, column.name))
            for j, column in columns.items()
            if column.is_number
        }
        units = {j: _text(block[at - 1][j]) if at else "" for j in columns}
        misspelt = self._misspelt(spec, block[at], columns)
        self._nameless(spec, block, at)
        entries: list[dict[str, Entry]] = []
        self.typed.tables[spec.name] = entries
        self.rows[spec.name] = []
        for number, row in enumerate(block[at + 1 :], start=1):
            filled = {j for j in columns if row[j] is not None}
            stated = {columns[j].name for j in filled}
            states = spec.states and spec.states not in misspelt
            if not filled or (states and spec.states not in stated):
                continue
            self.rows[spec.name].append(number)
            line: dict[str, Entry] = {}
            entries.append(line)
            self.findings.silence(*((spec.name, len(entries), name) for name in misspelt))
            for j in sorted(filled):
                column = columns[j]
                place = (spec.name, len(entries), column.name)
                entry = self._cell(column, row[j], scales.get(j), units[j], place)
                if entry is not None:
                    line[column.name] = entry

    def _header_row(self, spec: TableSpec, block: Block) -> int:
        known = {_folded(column.name) for column in spec.columns}
        other = _other(spec.name, block)
        for i, row in enumerate(block[:HEADER_ROWS]):
            hits = _hits(row, known)
            if not other and (hits >= 2 or hits == len(spec.columns)):
                return i
        names = ", ".join(column.name for column in spec.columns[:4])
        raise FunctionError(
            f"{spec.name}: the range {other or 'has no headers.'} Select the table with its "
            f"headers ({names}, ...) and the row of units above them."
        )

    def _nameless(self, spec: TableSpec, block: Block, at: int) -> None:
        """Columns with values whose header is blank or no text."""
        for j, header in enumerate(block[at]):
            filled = [row[j] for row in block[at + 1 :] if row[j] is not None]
            if isinstance(header, str) or (header is None and not filled):
                continue
            shown = "no header" if header is None else f"the header {_text(header) or 'an error'}"
            self.findings.add(
                (spec.name, None, f"column {j + 1}"),
                _text(header) or None,
                "a header of the table",
                f"the column has {shown}. Select only the table, or give the column a header.",
            )

    def _misspelt(self, spec: TableSpec, header: list[Cell], columns: dict[int, Field]) -> set[str]:
        """Columns that an unknown header may stand for: that they are blank is not reported as well."""
        missing = [c.name for c in spec.columns if c not in columns.values()]
        known = {_folded(c.name) for c in (*spec.columns, *spec.extra_columns)}
        unknown = [c for c in header if isinstance(c, str) and _folded(c) not in known]
        meant = {nearest(cell, missing) for cell in unknown}
        return set(missing) if None in meant else {name for name in meant if name}

    def _columns(self, spec: TableSpec, block: Block, at: int) -> dict[int, Field]:
        known = {_folded(column.name): column for column in spec.columns}
        extra = {_folded(column.name) for column in spec.extra_columns}
        columns: dict[int, Field] = {}
        for j, cell in enumerate(block[at]):
            if not isinstance(cell, str) or _folded(cell) in extra:
                continue
            column = known.get(_folded(cell))
            if column is None:
                meant = nearest(cell, [c.name for c in spec.columns])
                hint = f" Did you mean '{meant}'?" if meant else ""
                self.findings.add(
                    (spec.name, None, cell),
                    cell,
                    "a header of the table",
                    f"the header '{cell}' is unknown.{hint}",
                )
            elif column in columns.values():
                self.findings.add(
                    (spec.name, None, column.name),
                    cell,
                    "unique headers",
                    f"the header '{column.name}' occurs twice. Select only one table.",
                )
            else:
                columns[j] = column
        return columns

    # ---- cells ---------------------------------------------------------------------------------

    def _entry(
        self, spec: Field, value: Cell, unit: Cell, place: Place, unit_place: str
    ) -> Entry | None:
        if value is None:
            return None
        scale = self._scale(spec, unit, place, unit_place) if spec.is_number else None
        return self._cell(spec, value, scale, _text(unit), place)

    def _scale(
        self, spec: Field, unit: Cell, place: Place, unit_place: str = "above the header"
    ) -> UnitScale | None:
        """What one unit is worth; a unit that cannot be read is noted."""
        if not spec.has_unit:
            return UnitScale(1.0)
        try:
            return parse_unit(_text(unit), spec.dimension)
        except UnitError as error:
            message = error.message
            if unit is None:
                units = ", ".join(spec.units)
                message = (
                    f"the unit {unit_place} is missing. Include the units in the range; usual "
                    f"units are {units}."
                )
            self.findings.add(place, _text(unit) or None, error.allowed, message)
            return None

    def _cell(
        self, spec: Field, value: Cell, scale: UnitScale | None, unit: str, place: Place
    ) -> Entry | None:
        cell = SheetCell(value)
        try:
            if not spec.is_number:
                words = read_text(cell, spec)
                return None if words is None else word_entry(words, spec, place, self.findings)
            if word := word_in_place(value, spec):
                return word
            number = read_number(cell, spec, "in the cell above the header")
        except CellFault as fault:
            self.findings.add(place, fault.found, fault.allowed, fault.message)
            return None
        if scale is None:
            self.findings.silence(place)
            return None
        return None if number is None else Typed(number, scale, unit)

    # ---- all -----------------------------------------------------------------------------------

    def result(self) -> CaseInput:
        """Everything read and checked."""
        for table in INPUT_TABLES:
            self.typed.tables.setdefault(table.name, [])
        data = to_case_data(self.typed, self.findings)
        problems = tuple(map(self.placed, all_problems(data, self.findings)))
        return CaseInput(data=data, problems=problems, warnings=(), typed=self.typed)

    def placed(self, problem: Problem) -> CellProblem:
        """A problem with its row as it is counted in the range."""
        typed = in_typed_units(problem, self.typed)
        rows = self.rows.get(problem.table, [])
        row = problem.row
        if row is not None and row <= len(rows):
            row = rows[row - 1]
        where = [problem.table if problem.table != SCALAR_TABLE else "Case"]
        where += [f"row {row}"] if row is not None else []
        where += [problem.column] if problem.column else []
        return CellProblem(
            "",
            typed.table,
            row,
            typed.column,
            typed.found,
            typed.allowed,
            f"{', '.join(where)}: {typed.message}",
        )


def _text(cell: Cell) -> str:
    if isinstance(cell, str):
        return cell
    return f"{cell:.15g}" if isinstance(cell, float) else ""


def _hits(row: list[Cell], known: set[str]) -> int:
    """Cells of a row that are such headers."""
    return sum(1 for cell in row if isinstance(cell, str) and _folded(cell) in known)


def _other(name: str, block: Block) -> str:
    """That a range holds another table, if it fits that one better."""
    likeness = {SCALAR_TABLE: _hits([row[0] for row in block], {_folded(s.name) for s in SCALARS})}
    for spec in EVERY_INPUT:
        known = {_folded(column.name) for column in spec.columns}
        likeness[spec.name] = max((_hits(row, known) for row in block[:HEADER_ROWS]), default=0)
    best = max(likeness, key=lambda one: likeness[one])
    if likeness[best] < 2 or likeness[best] <= likeness[name]:
        return ""
    what = "names of sheet Case" if best == SCALAR_TABLE else f"table {best}"
    return f"contains {what}: check the order of the arguments."


def _folded(text: str) -> str:
    """A name without blanks and capitals: ``End speed`` is ``EndSpeed``."""
    return "".join(text.split()).casefold()
