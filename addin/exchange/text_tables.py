"""Tables of stations and elements as text (CSV, tabs from a clipboard) ↔ rows of a case.

Read are the tables that `table_text` writes, and those of makers: one table with a row a mass and the stiffness of the shaft to
the next row, or one of masses and one of shafts. Units stand in brackets behind the names of the columns, or below them.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from addin.contract.problems import shortened
from addin.contract.tables import INPUT_TABLES, Field, TableSpec, input_table
from addin.contract.units import UnitError
from addin.exchange.foreign import ForeignError, ForeignTrain, Row, counted
from addin.exchange.table_headers import (
    NUMBER,
    SPEED,
    Header,
    folded,
    header_of,
    known_names,
    unit_of,
)

#: What a train is made of and stressed by; the order is that of the text.
TRAIN_TABLES = (
    "Stations", "Elements", "Sections", "SectionMaterials", "Meshes", "ModeDamping", "Materials", "SNPoints", "FatigueFactors",
)  # fmt: skip
#: A row a mass with the shaft to the next mass, as makers list a train.
CHAIN = "masses and shafts"
#: Columns by which a table without title is known, the most telling first.
_KNOWN_BY = (
    ("Sections", ("Element", "Section")),
    ("Elements", ("From", "To")),
    ("Meshes", ("Element", "Pitch radius drive")),
    ("Meshes", ("Element", "Teeth drive")),
    ("ModeDamping", ("Mode", "Damping ratio")),
    (CHAIN, ("Inertia", "Stiffness")),
    (CHAIN, ("Inertia", "Length")),
    ("Stations", ("Inertia",)),
    ("Elements", ("Stiffness",)),
    ("SectionMaterials", ("Material", "Shear modulus")),
    ("Materials", ("Material", "UTS")),
    ("SNPoints", ("Cycles", "Stress")),
)
#: Columns of a shaft in such a table.
_OF_SHAFT = ("Element", "Kind", "Stiffness", "OD", "ID", "Length", "Shear modulus", "Density")
_NO_VALUE = frozenset({"", "-", "–", "—", "n/a"})
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_GROUPED = {
    ",": re.compile(r"[+-]?\d{1,3}(?:,\d{3})+\.\d*|[+-]?\d{1,3}(?:,\d{3}){2,}"),
    ".": re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*|[+-]?\d{1,3}(?:\.\d{3}){2,}"),
}
#: Speeds of neighbours that differ by more are joined by a gear. [1]
_SAME_SPEED = 1e-6


@dataclass
class _Table:
    """One table of the text."""

    name: str  #: Input table, or `CHAIN`.
    headers: dict[str, Header]  #: By column.
    titled: bool = False  #: Named by a title: every line is a row, also one with a name alone.
    rows: list[tuple[int, dict[str, str]]] = field(
        default_factory=list
    )  #: Line, and cells by column.


# --- reading -------------------------------------------------------------------------------------


def read_tables(text: str) -> ForeignTrain:
    """A train from tables of text.

    Parameters
    ----------
    text : str
        Separated by tabs, semicolons or commas. [text]

    Returns
    -------
    ForeignTrain
        Numbers with the unit of their column. [as typed]

    Raises
    ------
    ForeignError
        If no column is known.
    """
    lines, words = _cells(text)
    train = ForeignTrain("a table of text")
    train.notes += words
    tables = _tables(lines, train)
    if not tables:
        raise ForeignError(
            "no table of a train was found: no line has the headers of one. Write names and units above the columns, such "
            "as Station, Inertia [kg*m^2], Stiffness [N*m/rad], Speed [rpm]."
        )
    for table in tables:
        _fill(table, train)
    _name_ends(tables, train)
    return train


def _name_ends(tables: Sequence[_Table], train: ForeignTrain) -> None:
    """Ends that are numbers of stations, by the names of these."""
    stations = [t for t in tables if t.name == "Stations"]
    names = {cells.get(NUMBER, ""): _station_name(cells) for t in stations for _, cells in t.rows}
    known = set(names.values())
    for row in train.tables.get("Elements", []):
        for end in ("from", "to"):
            if row.get(end) not in known:
                row[end] = names.get(str(row.get(end)), row.get(end))
    if all(t.titled for t in tables if t.name == "Elements"):
        return
    ratios = {row.get("station"): _ratio(row) for row in train.tables.get("Stations", [])}
    for row in train.tables.get("Elements", []):
        row.setdefault("element", f"{row.get('from')} - {row.get('to')}")
        row.setdefault(
            "kind", _kind(ratios.get(row.get("from"), 1.0), ratios.get(row.get("to"), 1.0))
        )


def _filled(row: Row) -> Row:
    return {key: value for key, value in row.items() if value is not None}


def _ratio(station: Row) -> float:
    """Speed ratio of a station by its speed; 1 where none stands."""
    ratio = station.get("speed_ratio")
    return ratio if isinstance(ratio, float) and ratio > 0.0 else 1.0


def _kind(a: float, b: float) -> str:
    """What joins two stations of these speed ratios."""
    return "gear mesh" if abs(b / a - 1.0) > _SAME_SPEED else "shaft"


def _cells(text: str) -> tuple[list[tuple[int, list[str]]], list[str]]:
    """Lines of cells with their numbers, decimal commas as points, and what is said of it."""
    text = text.removeprefix("\ufeff")
    first = next((line for line in text.splitlines() if re.search("[\t;,]", line)), ",")
    delimiter = next(mark for mark in "\t;," if mark in first)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    lines = []
    try:
        for row in reader:
            lines.append((reader.line_num, [cell.strip() for cell in row]))
    except csv.Error as error:
        raise ForeignError(f"line {reader.line_num}: {error}. Correct the line.") from None
    cells = [cell for _, row in lines for cell in row]
    comma = False
    if not any(re.fullmatch(r"[+-]?\d+\.\d+", cell) for cell in cells):
        # three digits behind a comma may be thousands, unless semicolons show where the file is from
        digits = r"\d+" if delimiter == ";" else r"(?:\d{1,2}|\d{4,})"
        decimal = re.compile(rf"[+-]?\d+,{digits}")
        comma = any(decimal.fullmatch(c) or _GROUPED["."].fullmatch(c) for c in cells)
    numbers = [(line, [_with_point(cell, comma) for cell in row]) for line, row in lines]
    return numbers, ["Commas in numbers are read as decimal commas."] if comma else []


def _with_point(cell: str, comma: bool) -> str:
    """A number with a decimal point and without marks between thousands; other text as it is."""
    number = cell.replace("\u00a0", "").replace("−", "-")
    group, point = (".", ",") if comma else (",", ".")
    if _GROUPED[group].fullmatch(number):
        number = number.replace(group, "")
    number = number.replace(point, ".")
    return number if _NUMBER.fullmatch(number) else cell


def _tables(lines: Sequence[tuple[int, list[str]]], train: ForeignTrain) -> list[_Table]:
    """The tables of the text; a title of its own may name one."""
    every = known_names([input_table(name) for name in TRAIN_TABLES])
    titles = {folded(name): name for name in TRAIN_TABLES}
    tables: list[_Table] = []
    title = ""
    awaits_units = ended = False
    for line, cells in lines:
        filled = [cell for cell in cells if cell]
        if not filled:
            title, ended = "", True
            continue
        known = [h for i, cell in enumerate(cells) if (h := header_of(i, cell, every)) is not None]
        if len(filled) == 1 and folded(filled[0]) in titles:
            title = titles[folded(filled[0])]
        elif len({h.name for h in known}) > 1 and not any(map(_NUMBER.fullmatch, filled)):
            tables.append(_headed(line, cells, title, {h.name for h in known}, train))
            title, awaits_units, ended = "", True, False
        elif tables and awaits_units and _is_units(cells, tables[-1]):
            _give_units(cells, tables[-1])
            awaits_units = False
        elif tables and (
            len(filled) > 1
            or _NUMBER.fullmatch(filled[0])
            or (tables[-1].titled and not ended)  # a name alone
        ):
            row = {n: cells[h.index] for n, h in tables[-1].headers.items() if h.index < len(cells)}
            tables[-1].rows.append((line, row))
            awaits_units = False
        else:
            train.notes.append(f"Line {line} is not read: '{shortened(filled[0])}'.")
    return tables


def _headed(
    line: int, cells: list[str], title: str, known: set[str], train: ForeignTrain
) -> _Table:
    """A table by the line of its headers."""
    name = title or next((n for n, told in _KNOWN_BY if known.issuperset(told)), "Stations")
    specs = [input_table(n) for n in (("Stations", "Elements") if name == CHAIN else (name,))]
    names = known_names(specs)
    table = _Table(name, {}, titled=bool(title))
    ignored = []
    for index, cell in enumerate(cells):
        header = header_of(index, cell, names)
        if header is None or header.name in table.headers or _is_other(header, specs):
            ignored += [f"'{shortened(cell)}'"] if cell else []
        elif name == CHAIN and header.name in ("Damping", "Loss factor", "Running load"):
            ignored.append(f"'{shortened(cell)}' (of a station or of a shaft?)")
        else:
            table.headers[header.name] = header
    if ignored:
        train.notes.append(f"Line {line}: not read: {_listed('column', ignored)}.")
    return table


def _listed(noun: str, words: Sequence[str]) -> str:
    return f"{noun}{'s' if len(words) > 1 else ''} {', '.join(words)}"


def _is_other(header: Header, specs: Sequence[TableSpec]) -> bool:
    """A unit above words: the weight of a mass, not its name."""
    column = _field(header.name, specs)
    return bool(header.unit) and column is not None and not column.is_number


def _field(name: str, specs: Sequence[TableSpec]) -> Field | None:
    return next((c for spec in specs for c in spec.columns if c.name == name), None)


def _specs(table: _Table) -> list[TableSpec]:
    names = ("Stations", "Elements") if table.name == CHAIN else (table.name,)
    return [input_table(name) for name in names]


def _is_units(cells: list[str], table: _Table) -> bool:
    """Whether a line below the headers has units: no number, and a unit of a column that has none."""
    if any(map(_NUMBER.fullmatch, cells)):
        return False
    for name, header in table.headers.items():
        column = _field(name, _specs(table))
        cell = cells[header.index] if header.index < len(cells) else ""
        if column is None or not column.has_unit or header.unit or not cell:
            continue
        try:
            unit_of(Header(header.index, header.text, name, cell.strip("[]()")), column)
        except UnitError:
            continue
        return True
    return False


def _give_units(cells: list[str], table: _Table) -> None:
    for name, header in table.headers.items():
        cell = cells[header.index].strip("[]()") if header.index < len(cells) else ""
        if cell and not header.unit:
            named = header_of(header.index, f"{header.text} [{cell}]", {folded(header.text): name})
            table.headers[name] = named or header


def _fill(table: _Table, train: ForeignTrain) -> None:
    """Rows of the case from a table."""
    units = _units(table, train)
    lines = [line for line, _ in table.rows]
    where = (
        f"lines {lines[0]} to {lines[-1]}"
        if len(lines) > 1
        else f"line {lines[0] if lines else '?'}"
    )
    shown = [f"{name} in {unit}" for name, unit in units.items() if unit not in ("", "1")]
    train.notes.append(
        f"Table of {'stations and shafts' if table.name == CHAIN else table.name}, {where}: "
        f"{counted(len(lines), 'row')}{'; ' + ', '.join(shown) if shown else ''}."
    )
    if table.name == CHAIN:
        _fill_chain(table, units, train)
        return
    spec = input_table(table.name)
    rows = [(line, _row(spec.columns, cells, units)) for line, cells in table.rows]
    if table.name == "Elements" and not {"From", "To"} <= table.headers.keys():
        _join(rows, train)
        return
    for (line, row), (_, cells) in zip(rows, table.rows, strict=True):
        name = {"station": _station_name(cells)} if table.name == "Stations" else {}
        train.add(table.name, row | name, f"line {line}")
    if table.name == "Stations":
        _give_ratios(table, train)


def _units(table: _Table, train: ForeignTrain) -> dict[str, str]:
    """The unit of each column with numbers; one that is missing or wrong is noted once."""
    units = {}
    for name, header in table.headers.items():
        column = _field(name, _specs(table))
        if column is None or not column.is_number or not column.has_unit:
            continue
        place = f"column '{header.text}'"
        allowed = f"a unit such as {', '.join(column.units)}"
        if header.unit in ("", "1") and column.dimension == "ratio":
            continue
        if not header.unit:
            train.refuse(
                place,
                None,
                allowed,
                f"it has no unit. Write it behind the name, such as {name} [{column.units[0]}].",
            )
            continue
        try:
            units[name] = unit_of(header, column)
        except UnitError as error:
            train.refuse(place, header.unit, allowed, error.message)
            continue
        if units[name] != header.unit:
            train.notes.append(f"Unit '{header.unit}' of {name} is read as {units[name]}.")
    return units


def _value(cell: str, column: Field, units: Mapping[str, str]) -> str | float | int | None:
    """A cell as the case JSON has it."""
    if column.is_number and cell.casefold() in _NO_VALUE:
        return None
    if not column.is_number or not _NUMBER.fullmatch(cell):
        return cell or None
    unit = units.get(column.name, "")
    if unit:
        return f"{cell} {unit}"
    return int(cell) if column.kind == "integer" and cell.isdigit() else float(cell)


def _row(columns: Sequence[Field], cells: Mapping[str, str], units: Mapping[str, str]) -> Row:
    return {c.key: _value(cells[c.name], c, units) for c in columns if c.name in cells}


def _station_name(cells: Mapping[str, str]) -> str:
    return cells.get("Station") or cells.get("Description") or cells.get(NUMBER, "")


def _give_ratios(table: _Table, train: ForeignTrain) -> None:
    """Speed ratios of the stations from their speeds, the first of which is the reference."""
    speeds = [_speed(cells) for _, cells in table.rows if _is_station(table, cells)]
    if SPEED not in table.headers or not speeds or not speeds[0]:
        if SPEED not in table.headers and "Speed ratio" not in table.headers:
            train.notes.append(
                "No column Speed or Speed ratio: all numbers are taken at the speed of their own shaft, and gears have the "
                "ratio that table Meshes gives them."
            )
        return
    rows = train.tables["Stations"][-len(speeds) :]
    for row, speed in zip(rows, speeds, strict=True):
        if speed:
            row["speed_ratio"] = speed / speeds[0]
    train.notes.append(
        f"Speed ratios refer to the first row, '{rows[0].get('station', '')}'; it should be the motor."
    )


def _speed(cells: Mapping[str, str]) -> float:
    cell = cells.get(SPEED, "")
    return float(cell) if _NUMBER.fullmatch(cell) else 0.0


def _is_station(table: _Table, cells: Mapping[str, str]) -> bool:
    """In a list of masses and shafts a row with an inertia is a mass."""
    return table.name != CHAIN or cells.get("Inertia", "").casefold() not in _NO_VALUE


def _is_total(cells: Mapping[str, str]) -> bool:
    return any(folded(cell).startswith(("total", "sum")) for cell in cells.values())


def _fill_chain(table: _Table, units: dict[str, str], train: ForeignTrain) -> None:
    """Masses with the shafts between them."""
    stations, elements = map(input_table, ("Stations", "Elements"))
    totals = [line for line, cells in table.rows if _is_total(cells)]
    if totals:
        train.notes.append(f"Not read, being sums: {_listed('line', [str(n) for n in totals])}.")
    table.rows = [row for row in table.rows if not _is_total(row[1])]
    masses = [(line, cells) for line, cells in table.rows if _is_station(table, cells)]
    for line, cells in masses:
        columns = [
            c for c in stations.columns if c.name in ("Description", "Inertia", "Speed ratio")
        ]
        row = _row(columns, cells, units) | {"station": _station_name(cells) or f"Line {line}"}
        train.add("Stations", row, f"line {line}")
    _give_ratios(table, train)
    columns = [c for c in elements.columns if c.name in _OF_SHAFT]
    shafts = [
        (line, {name: cell for name, cell in cells.items() if name in _OF_SHAFT})
        for line, cells in _shafts_in_order(table, masses, train)
    ]
    _join([(line, _row(columns, cells, units)) for line, cells in shafts], train)


def _shafts_in_order(
    table: _Table, masses: list[tuple[int, dict[str, str]]], train: ForeignTrain
) -> list[tuple[int, dict[str, str]]]:
    """The line and the cells of the shaft behind each mass but the last."""
    between = [row for row in table.rows if row not in masses]
    if between:
        if len(between) != len(masses) - 1 or any(_has_shaft(cells) for _, cells in masses):
            train.refuse(
                f"line {between[0][0]}",
                counted(len(between), "line"),
                "one line for each shaft between two masses",
                f"{counted(len(masses), 'mass', 'masses')} and {counted(len(between), 'line')} with a shaft alone; a train of "
                "masses in a row has one shaft less than masses. Write the stiffness in the row of the mass before the shaft, "
                "or each shaft in a row of its own.",
            )
        return between
    filled = [_has_shaft(cells) for _, cells in masses]
    if all(filled) and len(filled) > 1:
        train.refuse(
            f"line {masses[-1][0]}",
            counted(len(filled), "shaft"),
            f"{len(filled) - 1} shafts for {len(filled)} masses",
            "every mass has a stiffness beside it, but the last (or the first) has no shaft. Clear the one that joins nothing.",
        )
        return []
    if filled and filled[-1]:
        train.notes.append("The stiffness in a row is that of the shaft from the row above.")
        return masses[1:]
    train.notes.append("The stiffness in a row is that of the shaft to the next row.")
    return masses[:-1]


def _has_shaft(cells: Mapping[str, str]) -> bool:
    return any(
        cells.get(name, "").casefold() not in _NO_VALUE for name in ("Stiffness", "OD", "Length")
    )


def _join(shafts: Sequence[tuple[int, Row]], train: ForeignTrain) -> None:
    """One shaft from each station to the next; where the speed changes it is a gear."""
    stations = train.tables.get("Stations", [])
    if len(shafts) != max(len(stations) - 1, 0):
        if not train.problems:
            train.refuse(
                f"line {shafts[0][0] if shafts else 1}",
                counted(len(shafts), "shaft"),
                f"{len(stations) - 1} shafts for {len(stations)} stations in a row",
                f"{counted(len(shafts), 'shaft')} for {counted(len(stations), 'station')}. Write From and To beside each shaft.",
            )
        return
    geared = []
    for (line, shaft), a, b in zip(shafts, stations, stations[1:], strict=False):
        names = {"from": a.get("station"), "to": b.get("station")}
        name = shaft.get("element") or f"{names['from']} - {names['to']}"
        kind = _kind(_ratio(a), _ratio(b))
        if kind == "gear mesh":
            shaft = {k: v for k, v in shaft.items() if k == "stiffness"}
            geared.append(f"'{name}'")
        train.add(
            "Elements", {"element": name, "kind": kind, **names} | _filled(shaft), f"line {line}"
        )
    if geared:
        train.notes.append(
            f"{_listed('Gear mesh', geared).replace('meshs', 'meshes')}, where the speed changes: rigid where no stiffness stands, else "
            "referred to the From side."
        )


# --- writing -------------------------------------------------------------------------------------


def table_text(
    tables: Mapping[str, Sequence[Mapping[str, object]]],
    units: Mapping[tuple[str, str], str],
    delimiter: str,
) -> str:
    """Tables of a train as text, a title above each and units behind the names of columns.

    Parameters
    ----------
    tables : mapping of str to rows
        Rows by header. [units]
    units : mapping of (str, str) to str
        Unit of a column of a table. [units]
    delimiter : str
        Comma, semicolon or tab. [character]

    Returns
    -------
    str
        Numbers with a decimal point and all their digits.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=delimiter, lineterminator="\n")
    for spec in _train_specs():
        rows = tables.get(spec.name, ())
        columns = [c for c in spec.columns if any(c.name in row for row in rows)]
        if not columns:
            continue
        if text.tell():
            writer.writerow([])
        writer.writerow([spec.name])
        writer.writerow([_header_text(c, units.get((spec.name, c.name), "")) for c in columns])
        writer.writerows([[row.get(c.name, "") for c in columns] for row in rows])
    return text.getvalue()


def _header_text(column: Field, unit: str) -> str:
    return (
        f"{column.name} [{unit}]"
        if unit and (unit, column.dimension) != ("1", "ratio")
        else column.name
    )


def _train_specs() -> Iterator[TableSpec]:
    order = {name: i for i, name in enumerate(TRAIN_TABLES)}
    yield from sorted((s for s in INPUT_TABLES if s.name in order), key=lambda s: order[s.name])
