"""What the functions share: their common arguments, results of a model, and tables as cells in shown units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from typing import Any

from addin.calculation.calculation import calculate
from addin.contract import tables as fields
from addin.contract.problems import nearest, shortened
from addin.contract.shown_cell import shown_cell
from addin.contract.shown_units import ShownUnits, shown_units, template_units
from addin.contract.tables import Field
from addin.contract.units import parse_unit
from addin.worksheet.models import AT_SPEED, MODELS, RUN, Model
from addin.worksheet.registry import Argument, FunctionError, registered
from engine.case.case import Case
from engine.operation.margins import forbidden_bands, rows_of_bands
from engine.results.details import modal_details
from engine.results.tables import speed_tables
from engine.run import at_speed

Rows = list[list[Any]]


MODEL = Argument("Model", "model", "The cell with =TV_MODEL(...).")
UNITS = Argument("Units", "text", "SI or US; blank = as the model's tables are typed.", True)
HEADERS = Argument("Headers", "flag", "FALSE omits the header row.", True)


#: Names of a case that one sentence lists. [count]
MOST_NAMED = 20


def system_for(units: str | None, model: Model | None) -> str:
    if units is None:
        return model.system if model is not None else "SI"
    word = units.casefold()
    if word in ("si", "us"):
        return word.upper()
    raise FunctionError(f"Units: found '{units[:40]}'; give SI or US, or leave it out.")


@cache
def units_of(system: str) -> ShownUnits:
    """The units of the shipped templates.

    Parameters
    ----------
    system : str
        SI or US. [word]

    Returns
    -------
    ShownUnits
        The unit of every column and its size. [SI]
    """
    tables = (*fields.RESULT_TABLES, *fields.WORKBOOK_TABLES, *fields.STUDY_RESULT_TABLES)
    found, problems = shown_units(template_units(system, tables), None)
    assert not problems, problems
    return found


def table_cells(
    table: str,
    rows: Iterable[Mapping[str, Any]],
    system: str,
    headers: bool | None,
    columns: Sequence[str] = (),
) -> Rows:
    """Rows of a result table, cell for cell as a workbook shows them.

    Parameters
    ----------
    table : str
        The table. [name]
    rows : iterable of mapping
        Its rows by JSON key. [SI]
    system : str
        Units shown, SI or US. [word]
    headers : bool or None
        False leaves the row of headers out. [flag]
    columns : sequence of str, optional
        The columns shown; default all but repeated ones. [headers]

    Returns
    -------
    list of list
        Cells. [shown units]
    """
    units, spec = units_of(system), fields.table(table)
    by_name = {field.name: field for field in spec.written_columns}
    shown = [by_name[name] for name in columns] or spec.columns
    cells: Rows = [[shown_cell(spec, c, row, units) for c in shown] for row in rows]
    if headers is False:
        return cells
    return [[header_of(c, units.name(table, c.name)) for c in shown], *cells]


def header_of(field: Field, unit: str) -> str:
    return f"{field.name} [{unit}]" if unit else field.name


def si_unit(dimension: str, system: str) -> tuple[str, float]:
    """Unit of a dimension in a system of units, and its size in SI."""
    known = fields.DIMENSIONS[dimension]
    unit = known.unit_us if system == "US" else known.unit_si
    return unit, parse_unit(unit, dimension).factor


def at_speed_tables(handle: str) -> tuple[Model, Mapping[str, Any]]:
    """Tables that need no start."""
    model = MODELS.of(handle)
    return model, MODELS.result(model, AT_SPEED, speed_results)


def speed_results(case: Case) -> Mapping[str, Any]:
    """Tables that need no start.

    Parameters
    ----------
    case : Case
        The case. [SI]

    Returns
    -------
    mapping
        Tables by name, and modes. [SI]
    """
    found = at_speed(case)
    near = [(row.mode, row.excitation) for row in found.margins.not_kept]
    bands = rows_of_bands(forbidden_bands(case, found.excitations), near)
    return speed_tables(found) | {"ForbiddenBands": bands} | modal_details(found)


def run_of(handle: str) -> tuple[Model, Any]:
    """The whole calculation of a model."""
    model = MODELS.of(handle)
    return model, MODELS.result(model, RUN, calculate)


def shows_table(
    function: str,
    table: str,
    results: Callable[[str], tuple[Model, Any]],
    missing: str = "",
    columns: Sequence[str] = (),
    example: str = "=%s(A1)",
) -> Callable[[Callable[[Any], Any]], Callable[..., Rows]]:
    """Enter a function of the worksheet that shows a table of a model.

    Parameters
    ----------
    function : str
        Its name in the worksheet. [name]
    table : str
        The table. [name]
    results : callable
        Takes a handle and gives the model and its results: `at_speed_tables` or `run_of`.
    missing : str, optional
        Why a table without rows has none. [sentence]
    columns : sequence of str, optional
        Names of the columns shown; default all. [names]
    example : str, optional
        A formula; ``%s`` stands for the name.

    Returns
    -------
    callable
        Decorates what takes the results and gives the rows of the table.
    """
    count = len(columns or fields.table(table).columns)
    long = results is run_of

    def enter(rows_of: Callable[[Any], Any]) -> Callable[..., Rows]:
        @registered(
            function,
            MODEL,
            UNITS,
            HEADERS,
            long=long,
            columns=count,
            example=example.replace("%s", function),
        )
        @wraps(rows_of)
        def answer(handle: str, units: str | None, headers: bool | None) -> Rows:
            model, found = results(handle)
            rows = rows_of(found)
            if not rows and long:
                raise no_rows(found, missing)
            if not rows and missing:
                raise FunctionError(missing, "#N/A")
            return table_cells(table, rows, system_for(units, model), headers, columns)

        return answer

    return enter


NO_START = "The case has no start: fill MotorTorque (and LoadTorque) or TorqueTime."
NO_SHAFT = "No shaft is judged for fatigue: type Material, Stress diameter and S-N points."


def no_rows(run: Any, missing: str) -> FunctionError:
    """Why a table of the start is empty: there is no start, or what else it needs is missing."""
    return FunctionError(NO_START if run.startup is None else missing, "#N/A")


def name_in_case(argument: str, found: str, known: Sequence[str]) -> str:
    """A name of the case, as the case spells it."""
    for name in known:
        if name.casefold() == found.casefold():
            return name
    listed = ", ".join(f"'{name}'" for name in known[:MOST_NAMED]) or "none"
    more = f" and {len(known) - MOST_NAMED} more" if len(known) > MOST_NAMED else ""
    meant = nearest(found, known)
    hint = f" Did you mean '{meant}'?" if meant else ""
    raise FunctionError(
        f"{argument}: found '{shortened(found)}'; there are: {listed}{more}.{hint}", "#N/A"
    )
