"""The worksheet functions: short, each a question to the engine and a table of the contract.

A table comes with its headers in one row, the unit of a column in brackets, in the units of the
template that the model's tables are typed in (SI or US customary) unless `Units` says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from typing import Any

from addin.contract import tables as fields
from addin.contract.problems import nearest, shortened
from addin.contract.shown_units import ShownUnits
from addin.contract.tables import Field, TableSpec, result_table
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.worksheet.blocks import case_of, problems_in_words
from addin.worksheet.models import AT_SPEED, MODELS, RUN, Model
from addin.worksheet.registry import Argument, Block, FunctionError, registered
from engine.case.case import Case

__all__: list[str] = []

Rows = list[list[Any]]

MODEL = Argument("Model", "model", "The cell with =TV_MODEL(...).")
UNITS = Argument("Units", "text", "SI or US; blank = as the model's tables are typed.", True)
HEADERS = Argument("Headers", "flag", "FALSE leaves the row of headers out.", True)
#: Argument of TV_MODEL → input table.
TABLES = (
    "Stations", "Elements", "Meshes", "ModeDamping", "MotorTorque", "LoadTorque", "TorqueTime",
    "Materials", "SNPoints", "Excitations", "EffectChoices",
)  # fmt: skip
#: Points of a decimated curve, unless asked otherwise; and the most. [count]
USUAL_POINTS, MOST_POINTS = 501, 20_001
#: A stress this little above another is that stress, typed in another unit.
_SAME_STRESS = 1.0 + 1e-9
#: Names of a case that one sentence lists. [count]
MOST_NAMED = 20


def _width(name: str) -> int:
    """Columns of a table of results."""
    return len(_result_spec(name).columns)


def _result_spec(name: str) -> TableSpec:
    return next(t for t in (*fields.RESULT_TABLES, *fields.WORKBOOK_TABLES) if t.name == name)


# --- shown units ----------------------------------------------------------------------------------


def _system(units: str | None, model: Model | None) -> str:
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
    from addin.contract.shown_units import shown_units, template_units

    tables = (*fields.RESULT_TABLES, *fields.WORKBOOK_TABLES, *fields.STUDY_RESULT_TABLES)
    found, problems = shown_units(template_units(system, tables), None)
    assert not problems, problems
    return found


def table_cells(
    spec: TableSpec,
    rows: Iterable[Mapping[str, Any]],
    system: str,
    headers: bool | None,
    columns: Sequence[Field] | None = None,
) -> Rows:
    """Rows of a result table, cell for cell as a workbook shows them.

    Parameters
    ----------
    spec : TableSpec
        The table. [table]
    rows : iterable of mapping
        Its rows by JSON key. [SI]
    system : str
        Units shown, SI or US. [word]
    headers : bool or None
        False leaves the row of headers out. [flag]
    columns : sequence of Field, optional
        The columns shown; default all. [columns]

    Returns
    -------
    list of list
        Cells. [shown units]
    """
    from addin.writing.workbook import shown_cell

    units = units_of(system)
    columns = spec.columns if columns is None else columns
    found: Rows = [[shown_cell(spec, c, row, units) for c in columns] for row in rows]
    if headers is False:
        return found
    return [[_header(c, units.name(spec.name, c.name)) for c in columns], *found]


def _header(field: Field, unit: str) -> str:
    return f"{field.name} [{unit}]" if unit else field.name


def _si(dimension: str, system: str) -> tuple[str, float]:
    """Unit of a dimension in a system of units, and its size in SI."""
    known = fields.DIMENSIONS[dimension]
    unit = known.unit_us if system == "US" else known.unit_si
    return unit, parse_unit(unit, dimension).factor


# --- what is calculated, once a model -------------------------------------------------------------


def _at_speed(handle: str) -> tuple[Model, Mapping[str, Any]]:
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
    from engine.operation.margins import forbidden_bands, rows_of_bands
    from engine.results.details import modal_details
    from engine.results.tables import speed_tables
    from engine.run import at_speed

    found = at_speed(case)
    near = [(row.mode, row.excitation) for row in found.margins.not_kept]
    bands = rows_of_bands(forbidden_bands(case, found.excitations), near)
    return speed_tables(found) | {"ForbiddenBands": bands} | modal_details(found)


def _run(handle: str) -> tuple[Model, Any]:
    """The whole calculation of a model."""
    model = MODELS.of(handle)

    def calculate(case: Any) -> Any:
        from addin.calculation.calculation import calculate as whole

        return whole(case)

    return model, MODELS.result(model, RUN, calculate)


def _run_table(
    name: str, handle: str, units: str | None, headers: bool | None, missing: str = ""
) -> Rows:
    model, run = _run(handle)
    rows = run.tables.get(name) or ()
    if not rows:
        raise _none(run, missing)
    return table_cells(result_table(name), rows, _system(units, model), headers)


NO_START = "The case has no start: fill MotorTorque (and LoadTorque) or TorqueTime."
NO_SHAFT = "No shaft is judged for fatigue: give Material, Stress diameter and S-N points."


def _none(run: Any, missing: str) -> FunctionError:
    """Why a table of the start is empty: there is no start, or what else it needs is missing."""
    return FunctionError(NO_START if run.startup is None else missing, "#N/A")


def _one_of(argument: str, found: str, known: Sequence[str]) -> str:
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


# --- the model ------------------------------------------------------------------------------------


@registered(
    "TV_MODEL",
    Argument("Stations", "block", "Table Stations with headers and the row of units above."),
    Argument("Elements", "block", "Table Elements with headers and units."),
    Argument("Case", "block", "Names, values and units of sheet Case, side by side.", True),
    *(
        Argument(name, "block", f"Table {name} with headers and units.", True)
        for name in TABLES[2:]
    ),
    scalar=True,
    example="=TV_MODEL(Train!B6:G22, Train!B26:U42, Case!B5:J43, Train!B46:R51, Train!I6:J17, "
    "Torque!B6:E37, Torque!G6:I47, Torque!K6:M27, Fatigue!B6:G12, Fatigue!I6:K19, "
    "Excitation!B6:G21, Case!B33:C43)",
)
def tv_model(stations: Block, elements: Block, case: Block | None, *others: Block | None) -> str:
    """Check a case and give its handle, which the other functions take.

    Equal cases have equal handles. What is wrong with the tables is said in its place.
    """
    blocks = {"Stations": stations, "Elements": elements}
    if case is not None:
        blocks[fields.SCALAR_TABLE] = case
    for name, block in zip(TABLES[2:], others, strict=True):
        if block is not None:
            blocks[name] = block
    found = case_of(blocks)
    if found.problems:
        raise FunctionError(problems_in_words(found))
    return MODELS.add(found).handle


# --- modes ----------------------------------------------------------------------------------------


@registered(
    "TV_FREQUENCIES",
    MODEL,
    UNITS,
    HEADERS,
    columns=_width("NaturalFrequencies"),
    example='=TV_FREQUENCIES(A1, "SI")',
)
def tv_frequencies(model: str, units: str | None, headers: bool | None) -> Rows:
    """Natural frequencies with damping, start-up crossing and the element that strains most.

    Rigid-body modes come first with frequency 0.
    """
    found, tables = _at_speed(model)
    rows = tables["NaturalFrequencies"]
    return table_cells(result_table("NaturalFrequencies"), rows, _system(units, found), headers)


@registered(
    "TV_MODE",
    MODEL,
    Argument("Mode", "count", "The number of the elastic mode, counted from 1."),
    HEADERS,
    columns=2,
    example="=TV_MODE(A1, 2)",
)
def tv_mode(model: str, mode: int, headers: bool | None) -> Rows:
    """Shape of one mode: relative twist of each station, the largest = 1."""
    _, tables = _at_speed(model)
    key = f"mode_{mode}"
    rows = tables["ModeShapes"]
    _existing(mode, len(tables["modes"]))
    found: Rows = [[row["station"], row[key]] for row in rows]
    return found if headers is False else [["Station", f"Mode {mode}"], *found]


@registered(
    "TV_ENERGY",
    MODEL,
    Argument("Mode", "count", "The number of the elastic mode; blank = all.", True),
    HEADERS,
    columns=0,
    example="=TV_ENERGY(A1)",
)
def tv_energy(model: str, mode: int | None, headers: bool | None) -> Rows:
    """Energy shares: of each element in the strain and of each station in the kinetic energy."""
    _, tables = _at_speed(model)
    modes = tables["modes"]
    if mode is not None:
        _existing(mode, len(modes))
        modes = [modes[mode - 1]]
    if not modes:
        raise FunctionError("The train has no elastic mode: it has one station only.", "#N/A")
    found: Rows = []
    for kind, words in (("strain_energy", "strain"), ("kinetic_energy", "kinetic")):
        for name in modes[0][kind]:
            found.append([name, words, *(m[kind][name] for m in modes)])
    head = ["Name", "Energy", *(f"Mode {m['mode']} [1]" for m in modes)]
    return found if headers is False else [head, *found]


def _existing(mode: int, count: int) -> None:
    if mode > count:
        raise FunctionError(f"Mode: found {mode}; the train has {count} elastic modes.", "#N/A")


@registered(
    "TV_STIFFNESS",
    Argument("OD", "number", "The outer diameter [mm or in]."),
    Argument("ID", "number", "The bore [mm or in]; blank = solid.", blank=True),
    Argument("Length", "number", "The length [mm or in]."),
    Argument("Shear modulus", "number", "The shear modulus [MPa or psi]."),
    Argument("Units", "text", "SI (mm, MPa, N*m/rad; default) or US (in, psi, lbf*in/rad).", True),
    scalar=True,
    example="=TV_STIFFNESS(200, 0, 500, 79300)",
)
def tv_stiffness(
    outer: float, bore: float | None, length: float, modulus: float, units: str | None
) -> float:
    """Torsional stiffness of a round shaft, k = G π (D⁴ − d⁴) / 32 L."""
    from engine.model.links import shaft_stiffness

    system = _system(units, None)
    _, metre = _si("length", system)
    _, pascal = _si("pressure", system)
    _, newton_metre = _si("torsional stiffness", system)
    for name, value in (("OD", outer), ("Length", length), ("Shear modulus", modulus)):
        if value <= 0.0:
            raise FunctionError(f"{name}: found {value:.10g}; it must be above 0.", "#NUM!")
    inner = 0.0 if bore is None else bore
    if not 0.0 <= inner < outer:
        raise FunctionError(
            f"ID: found {inner:.10g}; it must be at least 0 and below OD {outer:.10g}.", "#NUM!"
        )
    sizes = outer * metre, inner * metre, length * metre, modulus * pascal
    try:
        stiffness = float(shaft_stiffness(*sizes) / newton_metre)
    except (OverflowError, ZeroDivisionError):
        stiffness = math.inf
    if not 0.0 < stiffness < math.inf:
        raise FunctionError("These sizes give a stiffness that no number can hold.", "#NUM!")
    return stiffness


# --- running --------------------------------------------------------------------------------------


@registered(
    "TV_MARGINS",
    MODEL,
    UNITS,
    HEADERS,
    columns=_width("SeparationMargins"),
    example="=TV_MARGINS(A1)",
)
def tv_margins(model: str, units: str | None, headers: bool | None) -> Rows:
    """Separation margin of every mode from every excitation, with its verdict."""
    found, tables = _at_speed(model)
    rows = tables["SeparationMargins"]
    if not rows:
        raise FunctionError("Nothing is judged: the case states no speed and no line.", "#N/A")
    return table_cells(result_table("SeparationMargins"), rows, _system(units, found), headers)


#: Columns of `ForbiddenBands` that one case has.
BAND_COLUMNS = ("Excitation", "From", "To", "Lowest", "Highest", "Modes inside")


@registered(
    "TV_BANDS",
    MODEL,
    UNITS,
    HEADERS,
    columns=len(BAND_COLUMNS),
    example="=TV_BANDS(A1)",
)
def tv_bands(model: str, units: str | None, headers: bool | None) -> Rows:
    """Where no mode may lie: the band of frequencies round every excitation, and the modes inside.

    From and To are the required margin solved for the frequency: f_min (1 - m) and f_max (1 + m).
    """
    found, tables = _at_speed(model)
    rows, spec = tables["ForbiddenBands"], result_table("ForbiddenBands")
    if not rows:
        raise FunctionError("No bands: the case states no speed and no line.", "#N/A")
    columns = [spec.column(name) for name in BAND_COLUMNS]
    return table_cells(spec, rows, _system(units, found), headers, columns)


@registered(
    "TV_STEADY", MODEL, UNITS, HEADERS, columns=_width("SteadyState"), example="=TV_STEADY(A1)"
)
def tv_steady(model: str, units: str | None, headers: bool | None) -> Rows:
    """Forced response where a margin is not kept: torque, stress and UTS/25."""
    found, tables = _at_speed(model)
    rows = tables["SteadyState"]
    if not rows:
        raise FunctionError("Every margin is kept, so no forced response is needed.", "#N/A")
    return table_cells(result_table("SteadyState"), rows, _system(units, found), headers)


# --- the start ------------------------------------------------------------------------------------


def _points(points: int | None) -> int:
    if points is not None and not 3 <= points <= MOST_POINTS:
        raise FunctionError(f"Points: found {points}; give 3 to {MOST_POINTS}.", "#NUM!")
    return USUAL_POINTS if points is None else points


@registered(
    "TV_SPEED_TIME",
    MODEL,
    Argument(
        "Points", "count", f"Rows at the most without the header, {USUAL_POINTS} unless said.", True
    ),
    HEADERS,
    long=True,
    columns=3,
    example="=TV_SPEED_TIME(A1, 200)",
)
def tv_speed_time(model: str, points: int | None, headers: bool | None) -> Rows:
    """Mean speed of the motor against time during the start."""
    from addin.charts.rows import thinned

    limit = _points(points)
    _, run = _run(model)
    if run.view.speed_time is None or not run.case.ratings.synchronous_speed:
        raise FunctionError(NO_START, "#N/A")
    time, speed = run.view.speed_time
    kept = thinned(time, speed, limit)
    share = speed / run.case.ratings.synchronous_speed
    found: Rows = [
        [float(time[i]), float(speed[i]) * 30.0 / math.pi, 100.0 * float(share[i])] for i in kept
    ]
    return found if headers is False else [["Time [s]", "Speed [rpm]", "Speed [%]"], *found]


@registered(
    "TV_PEAKS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=_width("StartupPeaks"),
    example="=TV_PEAKS(A1)",
)
def tv_peaks(model: str, units: str | None, headers: bool | None) -> Rows:
    """Largest and least torque of every element in the start, with the estimated error."""
    return _run_table("StartupPeaks", model, units, headers)


@registered(
    "TV_HISTORY",
    MODEL,
    Argument("Element", "text", "The name of the element."),
    Argument(
        "Points", "count", f"Rows at the most without the header, {USUAL_POINTS} unless said.", True
    ),
    UNITS,
    HEADERS,
    long=True,
    columns=2,
    example='=TV_HISTORY(A1, "LS coupling", 1000)',
)
def tv_history(
    model: str, element: str, points: int | None, units: str | None, headers: bool | None
) -> Rows:
    """Torque of an element against time; thinned so that every interval keeps its extremes."""
    from addin.charts.rows import decimate

    limit = _points(points)
    found, run = _run(model)
    histories = run.view.histories or {}
    if not histories:
        raise FunctionError(NO_START, "#N/A")
    name = _one_of("Element", element, list(histories))
    shown, place = units_of(_system(units, found)), ("StartupPeaks", "Maximum torque")
    unit, factor = shown.name(*place), shown.factor(*place)
    time, torque = histories[name]
    kept = decimate(time, torque, limit)
    rows: Rows = [[float(time[i]), float(torque[i]) / factor] for i in kept]
    return rows if headers is False else [["Time [s]", f"Torque [{unit}]"], *rows]


@registered(
    "TV_REVERSALS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=_width("TorqueReversals"),
    example="=TV_REVERSALS(A1)",
)
def tv_reversals(model: str, units: str | None, headers: bool | None) -> Rows:
    """Torque reversals, impacts and tooth force of meshes and geared couplings."""
    missing = "The train has no gear mesh and no geared coupling."
    return _run_table("TorqueReversals", model, units, headers, missing)


@registered(
    "TV_CYCLES",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=_width("StartCycles"),
    example="=TV_CYCLES(A1)",
)
def tv_cycles(model: str, units: str | None, headers: bool | None) -> Rows:
    """The most damaging cycles of one start of the governing shaft: n, N and n/N."""
    from addin.charts.start_cycles import start_cycle_rows

    found, run = _run(model)
    rows = start_cycle_rows(run.view)
    if not rows:
        judged = run.tables.get("AllowableStarts")
        raise _none(run, "The start makes no stress cycle." if judged else NO_SHAFT)
    return table_cells(_result_spec("StartCycles"), rows, _system(units, found), headers)


@registered(
    "TV_STARTS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=_width("AllowableStarts"),
    example="=TV_STARTS(A1)",
)
def tv_starts(model: str, units: str | None, headers: bool | None) -> Rows:
    """Damage of one start and allowable starts of every judged shaft."""
    return _run_table("AllowableStarts", model, units, headers, NO_SHAFT)


@registered(
    "TV_SN_LIFE",
    MODEL,
    Argument("Material", "text", "The name in table Materials."),
    Argument("Stress", "numbers", "The zero-to-peak stress, nominal times SCF [MPa or psi]."),
    UNITS,
    Argument(
        "Remarks",
        "flag",
        "TRUE adds beside each life where the S-N line is extended beyond its points.",
        True,
    ),
    example='=TV_SN_LIFE(A1, "Alloy steel", 200, "SI")',
)
def tv_sn_life(
    model: str, material: str, stress: Rows, units: str | None, remarks: bool | None
) -> Rows:
    """Cycles to failure at a stress, on the S-N line in torsion; below endurance 'unlimited'.

    Above the first S-N point the first slope is extended, as in the count of allowable starts: the
    life is a number, but no tested one, and such starts are not judged. Remarks `TRUE` says so
    beside each life. Above UTS there is no life: the stress is refused.
    """
    from engine.errors import ModelError
    from engine.fatigue.sn_curve import sn_curve_for

    found = MODELS.of(model)
    case = found.case
    name = _one_of("Material", material, [str(m.material) for m in case.materials])
    row = next(m for m in case.materials if str(m.material) == name)
    try:
        curve = sn_curve_for(row, case.sn_points)
    except ModelError as wrong:
        raise FunctionError(str(wrong), "#NUM!") from None
    unit, pascal = _si("pressure", _system(units, found))
    answer: Rows = []
    for i, line in enumerate(stress):
        lives: list[Any] = []
        for j, value in enumerate(line):
            if value is not None:
                _check_stress(value * pascal, value, unit, pascal, row, (i, j))
            life = None if value is None else float(curve.cycles_to_failure(value * pascal))
            lives.append(life if life is None or math.isfinite(life) else "unlimited")
        said = [None if v is None else _extended(curve, v * pascal) for v in line]
        answer.append([*lives, *said] if remarks else lives)
    return answer


def _check_stress(
    stress: float, value: float, unit: str, pascal: float, material: Any, at: tuple[int, int]
) -> None:
    """Refuse a stress that no S-N line answers for."""
    place = "Stress" if at == (0, 0) else f"Stress, row {at[0] + 1}, column {at[1] + 1}"
    if value < 0.0:
        raise FunctionError(f"{place}: found {value:.10g}; give 0 or more.", "#NUM!")
    strength = material.uts
    if strength is not None and stress > strength * _SAME_STRESS:
        raise FunctionError(
            f"{place}: found {value:.10g} {unit}; it lies above UTS of '{material.material}', "
            f"{strength / pascal:.6g} {unit}, where no S-N line holds.",
            "#NUM!",
        )


def _extended(curve: Any, stress: float) -> str | None:
    """Where the S-N line is not between its points; nothing is said where it is."""
    if curve.above_first_point(stress / _SAME_STRESS):
        return "above the first S-N point: its slope extended"
    if stress <= curve.endurance:
        rule = curve.below_endurance
        return None if rule == "none" else f"below endurance: {rule}"
    if stress * _SAME_STRESS < curve.stress[-1]:
        return "below the last S-N point: its slope extended to endurance"
    return None


@registered(
    "TV_LIFE",
    Argument("Damage", "numbers", "The damage of one start of each kind, as TV_STARTS gives it."),
    Argument("Per year", "numbers", "How many of each kind a year; 0 = none."),
    Argument("So far", "numbers", "How many of each kind so far.", True),
    Argument("Starts factor", "number", "StartsFactor; blank = 1.", True),
    example="=TV_LIFE(0.002, 24, 60, 2)",
)
def tv_life(damage: Rows, per_year: Rows, so_far: Rows | None, factor: float | None) -> Rows:
    """Damage ledger of a duty: used, damage a year, what is left, and years that it lasts.

    Palmgren-Miner: damage of all starts is added up, their order is ignored; a shaft is used up at
    1 / Starts factor. One shaft a call; years are `unlimited` where nothing is taken.
    """
    from engine.studies.starts.damage_ledger import remaining_life

    one, yearly = _column("Damage", damage), _column("Per year", per_year)
    blank = so_far is None or all(value is None for line in so_far for value in line)
    seen = [0.0] * len(one) if blank else _column("So far", so_far or [])
    for name, column in (("Per year", yearly), ("So far", seen)):
        if len(column) != len(one):
            raise FunctionError(
                f"{name}: found {len(column)} cells beside {len(one)} of Damage; give as many."
            )
    if factor is not None and not factor > 0.0:
        raise FunctionError(f"Starts factor: found {factor:.10g}; give more than 0.", "#NUM!")
    used = math.fsum(q * n for q, n in zip(one, seen, strict=True))
    a_year = math.fsum(q * n for q, n in zip(one, yearly, strict=True))
    left = 1.0 / (factor or 1.0) - used
    years = remaining_life(left, a_year)
    return [[used, a_year, left, "unlimited" if years is None else years]]


def _column(name: str, cells: Rows) -> list[float]:
    """Numbers of a range, none of them negative; blank = 0."""
    found = [0.0 if value is None else float(value) for line in cells for value in line]
    wrong = next((value for value in found if value < 0.0), None)
    if wrong is not None:
        raise FunctionError(f"{name}: found {wrong:.10g}; give 0 or more.", "#NUM!")
    return found


#: Columns of `CalibratedParameters` that a formula shows.
CALIBRATED = (
    "Name", "Stiffness", "Calibrated stiffness", "Change", "Change low", "Change high", "Determined",
)  # fmt: skip


@registered(
    "TV_CALIBRATE",
    MODEL,
    Argument("Frequencies", "numbers", "The measured natural frequencies [Hz], in any order."),
    Argument("Uncertainty", "number", "Their standard deviation, 0.01 or 1 %; blank = 1 %.", True),
    Argument("Spread", "number", "How sure every stiffness is; blank = 10 %.", True),
    UNITS,
    HEADERS,
    columns=len(CALIBRATED),
    example="=TV_CALIBRATE(A1, 30.1, 0.01, 0.1)",
)
def tv_calibrate(
    model: str,
    frequencies: Rows,
    uncertainty: float | None,
    spread: float | None,
    units: str | None,
    headers: bool | None,
) -> Rows:
    """The least change of all stiffnesses that explains measured natural frequencies.

    Each frequency is taken for the mode that it fits best, one to one. A frequency that no mode can
    have is refused. Sheet Calibration (`torsionbook calibrate`) tells more, and knows inertias,
    modes that are named and peak torques.
    """
    from engine.case.study_inputs import STIFFNESS, MeasuredFrequencyRow, ScatterRow, StudyInputs
    from engine.studies.calibration.calibration import calibrate
    from engine.studies.calibration.inputs import calibration_problems
    from engine.studies.calibration.tables import parameter_rows

    found = MODELS.of(model)
    typed = [float(v) for line in frequencies for v in line if v is not None]
    if not typed:
        raise FunctionError("Frequencies is blank. Give measured natural frequencies [Hz].")
    asked = StudyInputs(
        scatter=() if spread is None else (ScatterRow(None, STIFFNESS, None, spread),),
        measured_frequencies=tuple(MeasuredFrequencyRow(None, f, uncertainty) for f in typed),
    )
    wrong = calibration_problems(found.case, asked)
    if wrong:
        said = wrong[0]
        raise FunctionError(f"{said.column or said.table}: {said.message}", "#NUM!")
    result = calibrate(found.case, asked)
    unused = next((m for m in result.measurements if not m.used), None)
    if unused is not None:
        raise FunctionError(f"Frequencies: {unused.measured:.10g} Hz. {unused.note}", "#N/A")
    spec = result_table("CalibratedParameters")
    columns = [spec.column(name) for name in CALIBRATED]
    rows = parameter_rows(result)
    return table_cells(spec, rows, _system(units, found), headers, columns)


@registered(
    "TV_EFFECTS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=_width("Effects"),
    example="=TV_EFFECTS(A1)",
)
def tv_effects(model: str, units: str | None, headers: bool | None) -> Rows:
    """Which effects the calculation simulates, with the number that decided each."""
    return _run_table("Effects", model, units, headers)


@registered(
    "TV_VERDICTS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=_width("Verdicts"),
    example="=TV_VERDICTS(A1)",
)
def tv_verdicts(model: str, units: str | None, headers: bool | None) -> Rows:
    """The checks of sheet Summary: how the start ended, margins, peaks, starts against required."""
    return _run_table("Verdicts", model, units, headers, "Nothing is judged.")


# --- units ----------------------------------------------------------------------------------------


@registered(
    "TV_CONVERT",
    Argument("Value", "numbers", "A number, or a range of them."),
    Argument("From", "text", "The unit of the value, such as lb*ft^2."),
    Argument("To", "text", "The unit wanted, such as kg*m^2."),
    example='=TV_CONVERT(10900, "lb*ft^2", "kg*m^2")',
)
def tv_convert(value: Rows, given: str, wanted: str) -> Rows:
    """Convert numbers from one unit to another of the same dimension."""
    factor = _factor(given, wanted)
    return [[None if v is None else v * factor for v in row] for row in value]


@cache
def _factor(given: str, wanted: str) -> float:
    sizes, others = _sizes(given), _sizes(wanted)
    if not sizes or not others:
        unknown, known = (given, others) if not sizes else (wanted, sizes)
        raise FunctionError(f"'{unknown[:40]}' is not a known unit{_meant(unknown, known)}.")
    common = [name for name in sizes if name in others]
    for name in common:
        if sizes[name].base == others[name].base:
            return sizes[name].factor / others[name].factor
    if common:
        raise FunctionError(f"'{given[:40]}' and '{wanted[:40]}' are shares of different things.")
    raise FunctionError(f"'{given[:40]}' is {_named(next(iter(sizes)))}, '{wanted[:40]}' is not.")


def _sizes(unit: str) -> dict[str, UnitScale]:
    """What a unit is worth, by every dimension it is a unit of."""
    found = {}
    for name, dimension in fields.DIMENSIONS.items():
        if dimension.units and name != "cycles per minute":  # frequency holds its unit
            with suppress(UnitError):
                found[name] = parse_unit(unit, name)
    return found


def _meant(unit: str, others: Iterable[str]) -> str:
    """What may have been meant by a unit that is none, first among those of the other's kind."""
    for name in [*others, *(n for n, d in fields.DIMENSIONS.items() if d.units)]:
        try:
            parse_unit(unit, name)
        except UnitError as wrong:
            if wrong.hint:
                return f"; {wrong.hint}"
    usual = dict.fromkeys(u for d in fields.DIMENSIONS.values() for u in d.units)
    meant = nearest(unit, usual)
    return f"; did you mean {meant}?" if meant else ""


def _named(dimension: str) -> str:
    return f"{'an' if dimension[0] in 'aeiou' else 'a'} {dimension}"


# The functions of the studies take their tables from here, so they are entered last.
from addin.worksheet import studies  # noqa: E402, F401
