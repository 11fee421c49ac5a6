"""Results → the cells the product owns: result tables, facts for live formulas, chart data.

Numbers are written in the unit that stands above each result column, whatever the engineer has
put there. Everything owned is rewritten on each recalculation, so that nothing stale remains;
`addin.xlsx` sees to it that nothing else changes.
"""

from __future__ import annotations

import datetime as dt
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from addin.calculation.calculation import RunView
from addin.calculation.full_speed_words import shaft_speeds
from addin.charts.data import accuracy_block, accuracy_title, chart_blocks
from addin.charts.start_cycles import start_cycle_facts, start_cycle_rows
from addin.contract import tables as fields
from addin.contract.banner import (
    CHANGED_WORDS,
    COPY_SHEET,
    OVERALL_WITHOUT_COPY,
    is_earlier_banner,
)
from addin.contract.chart_tables import CHART_TABLES, HISTORIES, LABELS
from addin.contract.charts import CHARTS, Label, Series
from addin.contract.digests import short_digest
from addin.contract.run_facts import RUN_FACTS
from addin.contract.sheet import column_number, plot_name, text_height
from addin.contract.sheets import (
    FOOT_ROW,
    KEY_ROW,
    NOTES_BEGIN,
    NOTES_END,
    OF_ELEMENTS,
    SHEETS,
    SPARE_ROWS,
    SUMMARY_NOTES,
    VERDICTS_ROW,
)
from addin.contract.shown_cell import shown_cell
from addin.contract.shown_units import ShownUnits, shown_units
from addin.contract.studies.registry import STUDIES, STUDY_SHEETS
from addin.contract.tables import TableSpec
from addin.contract.texts import NO_STUDY
from addin.reading.workbook import WorkbookInput, read_workbook
from addin.recorded.results import recorded_fact
from addin.recorded.study_digests import stated_digests, twelve_digits
from addin.writing.drawn_schematic import draw_schematic
from addin.writing.input_copy import input_copy
from addin.writing.print_areas import hide_empty_charts, renew_print_areas
from addin.writing.printed_rows import printed_rows
from addin.xlsx import (
    Formula,
    SaveReport,
    Table,
    TableData,
    TitleLink,
    Workbook,
    open_workbook,
)
from addin.xlsx.references import MAX_COLUMN, Rect, cell_name
from addin.xlsx.sheet_part import SheetPart

_RPM = math.pi / 30.0
#: How a file says yes and no.
_ON, _OFF = ("1", "true"), ("0", "false")
#: Tables that workbooks made by earlier versions lack; nobody misses them there.
_OPTIONAL = frozenset(
    t.name for t in fields.EVERY_TABLE if t.later or t in fields.WORKBOOK_TABLES
) | {
    "ChartReversal",
    "ChartBlow",
    "ChartForces",
    "ChartPullIn",
    "ChartEvents",
    "ChartAccuracy",
    *(table.name for table in fields.RESULT_TABLES if table.later),
    "ChartMotor",
    "ChartMotorEvent",
    "ChartClearing",
    "ChartProfile",
    "ChartPeaks",
    "ChartGoverning",
    "ChartBulges",
}
#: What the rows of a plain recalculation are, below `NO_STUDY`.
ANALYSES = (
    "Start: linear start with all teeth in contact, on which the plan is based. Start "
    "with events: the same with the effects that sheet Effects and accuracy shows as on. Errors "
    "are the change of the results from step h to h/2."
)


#: What is said of a workbook that has lost the place of the copy.
COPY_LOST = (
    f"Tables of the hidden sheet {COPY_SHEET} are missing, so the banners cannot tell whether inputs were "
    f"changed and say {CHANGED_WORDS}. Make a workbook that has them: torsionbook new NEW.xlsx --from FILE."
)


@dataclass(frozen=True)
class RunStamp:
    """Who calculated, when, from which inputs."""

    software: str  #: Name and version.
    date: dt.datetime  #: When, in UTC. [date]
    sha256: str  #: Digest of the inputs. [hexadecimal]

    @property
    def sentence(self) -> str:
        """What stands on Summary."""
        return f"Results belong to the inputs with SHA-256 {short_digest(self.sha256)}"

    @property
    def day(self) -> str:
        """Date and minute. [text]"""
        return f"{self.date:%Y-%m-%d %H:%M}"


def write_results(
    source: Path | Workbook,
    destination: Path | None,
    run: RunView,
    stamp: RunStamp,
    *,
    in_place: bool = False,
    ignore_lock: bool = False,
    read: WorkbookInput | None = None,
) -> SaveReport:
    """Write the results of a run into a workbook.

    Parameters
    ----------
    source : Path or Workbook
        The workbook the case was read from; if it is open already, as it was then.
    destination : Path or None
        The new workbook; None with `in_place`.
    run : RunView
        Results, see `run_view.view_of`. [SI]
    stamp : RunStamp
        Who, when, from which inputs.
    in_place : bool
        Replace the source; it stays as ``.bak``. [flag]
    ignore_lock : bool
        Open it although a lock file says somebody has it open. [flag]
    read : WorkbookInput, optional
        What was read from the workbook, where it is open; by default it is read here. [SI]

    Returns
    -------
    SaveReport
        What was written, and sentences the user should read.

    Raises
    ------
    PackageError
        When the workbook cannot be opened, has no room for a table, or cannot be saved; nothing
        has been written then.
    """
    if isinstance(source, Workbook):
        workbook = source
        workbook.allow_saving(ignore_lock=ignore_lock)
    else:
        workbook = open_workbook(source, ignore_lock=ignore_lock)
    present = tables_to_write(workbook, run, stamp, chosen_elements(workbook), read)
    workbook.write_tables(present)
    workbook.link_chart_titles(_title_links(workbook))
    _renew_banner(workbook)
    _fit_rows(workbook, present)
    _fit_summary(workbook, present)
    _close_spare_rows(workbook)
    renew_print_areas(workbook, printed_rows(run.tables).counts)
    hide_empty_charts(workbook, CHARTS)
    draw_schematic(workbook, run.case)
    for spec in fields.INPUT_TABLES:  # typed by a program that leaves charts as they were
        table = workbook.tables.get(spec.name)
        if table is not None:
            workbook.renew_charts_of(table.sheet, table.data)
    return workbook.save(destination, in_place=in_place)


def _renew_banner(workbook: Workbook) -> None:
    """The banner of an earlier release knows fewer verdicts: one of this version takes its place."""
    if is_earlier_banner(_banner(workbook)):
        workbook.set_name("OverallVerdict", Formula(OVERALL_WITHOUT_COPY), replace_formula=True)


def calculation_settings(workbook: Workbook) -> Iterator[str]:
    """Sentences on settings of a workbook under which its program shows other values than follow from its cells."""
    settings = workbook.structure.calculation
    if settings.get("calcMode") == "manual":
        yield (
            "This workbook is set to manual calculation: after an edit its banners change only with F9 (Calculate "
            "Now)."
        )
    if settings.get("iterate") in _ON:
        yield (
            "This workbook is set to iterative calculation: formulas that refer to themselves are no error and "
            "may show another value after each calculation."
        )
    if settings.get("fullPrecision") in _OFF:
        yield (
            "This workbook is set to precision as displayed: its program rounds inputs and formulas to the digits "
            "shown."
        )


def formulas_without_tables(workbook: Workbook) -> Iterator[str]:
    """A sentence on formulas of the template that do not follow their tables any more; the banner is the witness of all.

    OpenDocument has no references to tables: a program that saves in it writes the cells of that moment in their place.
    """
    banner = _banner(workbook)
    if "COUNTIFS(" in banner and "[" not in banner:
        yield (
            "The formulas of this workbook refer to single cells instead of tables, as after saving as .ods: the banners, "
            "sheet Summary and the lines above tables may show what is not true; the tables hold the results. Copy the "
            "inputs into a new workbook: torsionbook new NEW.xlsx --from OLD.xlsx"
        )


def _banner(workbook: Workbook) -> str:
    """The formula of the banner; empty where there is none."""
    name = workbook.defined_names.get("OverallVerdict")
    if name is None or name.sheet is None or name.rect is None:
        return ""
    held = workbook.sheet_part(name.sheet).value(name.rect.top, name.rect.left)
    return held.text if isinstance(held, Formula) else ""


def tables_to_write(
    workbook: Workbook,
    run: RunView,
    stamp: RunStamp,
    chosen: Sequence[str | None],
    read: WorkbookInput | None = None,
) -> list[TableData]:
    """What recalculation writes into the tables of a workbook, in the units it shows.

    Parameters
    ----------
    workbook : Workbook
        The open workbook; sentences on what it lacks are added to its notes.
    run : RunView
        Results. [SI]
    stamp : RunStamp
        Who, when, from which inputs.
    chosen : sequence of (str or None)
        Elements whose histories are drawn, see `chosen_elements`. [names]
    read : WorkbookInput, optional
        What was read from the workbook; by default it is read here. [SI]

    Returns
    -------
    list of TableData
        Results, facts and chart data of the tables that the workbook has.
    """
    units, problems = read_shown_units(workbook, run.case.ratings.rated_torque)
    blocks = chart_blocks(run.case, units, run, chosen)
    # a workbook of an earlier version has no place for what is said of the order
    sorts = "run_PrintedResponse" in workbook.defined_names
    wanted = [*_result_blocks(run, units, sorts), _run_facts(run, stamp, units)]
    wanted += [TableData(table.name, blocks[table.name], table.columns) for table in CHART_TABLES]
    copied = input_copy(read or read_workbook(workbook), stamp.sha256)
    if not copied and CHANGED_WORDS in _banner(workbook):
        problems = [*problems, COPY_LOST]
    problems = [*problems, *calculation_settings(workbook), *formulas_without_tables(workbook)]
    wanted += copied
    workbook.notes += problems
    return _present(workbook, wanted)


def write_study(
    workbook: Workbook,
    destination: Path | None,
    rows: Sequence[Mapping[str, Any]],
    words: Mapping[str, str],
    stamp: RunStamp,
    rated_torque: float | None,
    *,
    ignore_lock: bool = False,
) -> SaveReport:
    """Write what an accuracy study showed into sheet `Accuracy`, and nothing else.

    Parameters
    ----------
    workbook : Workbook
        The workbook the case was read from.
    destination : Path or None
        The new workbook; None replaces the source, which stays as ``.bak``.
    rows : sequence of mapping
        Rows of `AccuracyCost`. [SI]
    words : mapping
        ``sentence`` and ``reference`` of the study. [sentences]
    stamp : RunStamp
        Who, when, from which inputs.
    rated_torque : float or None
        Base of pu. [N m]
    ignore_lock : bool
        Write although a lock file says somebody has the workbook open. [flag]

    Returns
    -------
    SaveReport
        What was written, and sentences the user should read.

    Raises
    ------
    PackageError
        When the workbook cannot be saved; nothing has been written then.
    """
    units = _units_to_write(workbook, rated_torque, ignore_lock)
    spec = fields.result_table("AccuracyCost")
    chart = next(table for table in CHART_TABLES if table.name == "ChartAccuracy")
    wanted = [
        _result_block(spec, rows, units),
        TableData(chart.name, accuracy_block(rows), chart.columns),
    ]
    workbook.write_tables(_present(workbook, wanted))
    renew_print_areas(workbook, {}, only=spec.sheet)
    hide_empty_charts(workbook, {"accuracy": CHARTS["accuracy"]})
    facts = {
        "run_AccuracySentence": words["sentence"],
        "run_AccuracyReference": words["reference"],
        "run_AccuracyInputs": f"Study of the inputs with SHA-256 {short_digest(stamp.sha256)}, "
        f"{stamp.day} UTC, {stamp.software}",
    }
    _set_facts(workbook, facts)
    labels = workbook.tables.get("ChartLabels")
    if labels is not None and _has_label(labels, _ACCURACY_TITLE):
        cell = _label_cell(labels, _ACCURACY_TITLE)
        workbook.set_cell(labels.sheet, cell, accuracy_title(bool(rows), studied=True))
        workbook.link_chart_titles(_title_links(workbook, _ACCURACY_TITLE))
    return workbook.save(destination, in_place=destination is None)


def write_study_results(
    workbook: Workbook,
    destination: Path | None,
    tables: Mapping[str, Sequence[Mapping[str, Any]]],
    facts: Mapping[str, str],
    rated_torque: float | None,
    *,
    recorded: str = "",
    ignore_lock: bool = False,
) -> SaveReport:
    """Write the results of a study into its sheets, and nothing else.

    Parameters
    ----------
    workbook : Workbook
        The workbook the inputs were read from.
    destination : Path or None
        The new workbook; None replaces the source, which stays as ``.bak``.
    tables : mapping of str to sequence of mapping
        Rows of its result tables, by name. [SI]
    facts : mapping of str to str
        Defined names and their words, see `study_sheets.STUDY_FACTS`. [text]
    rated_torque : float or None
        Base of pu. [N m]
    recorded : str
        Defined name that takes digests of what is written, so that edits are seen. [name]
    ignore_lock : bool
        Write although a lock file says somebody has the workbook open. [flag]

    Returns
    -------
    SaveReport
        What was written, and sentences the user should read.

    Raises
    ------
    PackageError
        When the workbook cannot be saved; nothing has been written then.
    """
    units = _units_to_write(workbook, rated_torque, ignore_lock)
    wanted = [
        _result_block(fields.result_table(name), rows, units) for name, rows in tables.items()
    ]
    present = [
        replace(one, rows=[tuple(map(twelve_digits, row)) for row in one.rows])
        for one in _present(workbook, wanted)
    ]
    workbook.write_tables(present)
    _fit_rows(workbook, present)
    drawn = {spec.name: spec for study in STUDIES for spec in study.charts}
    hide_empty_charts(
        workbook,
        {
            name: spec
            for name, spec in drawn.items()
            if tables.keys() & {series.table for series in spec.series}
        },
    )
    for sheet in dict.fromkeys(fields.result_table(name).sheet for name in tables):
        renew_print_areas(workbook, {}, only=sheet)
    if recorded:
        specs = [fields.result_table(one.name) for one in present]
        facts = {**facts, recorded: "; ".join(stated_digests(workbook, specs, units))}
    _set_facts(workbook, facts)
    return workbook.save(destination, in_place=destination is None)


def _units_to_write(
    workbook: Workbook, rated_torque: float | None, ignore_lock: bool
) -> ShownUnits:
    """The units a study is written in; the workbook may be saved from now on."""
    workbook.allow_saving(ignore_lock=ignore_lock)
    units, problems = read_shown_units(workbook, rated_torque)
    workbook.notes += problems
    return units


def _set_facts(workbook: Workbook, facts: Mapping[str, str]) -> None:
    """Words behind defined names, where the workbook has them."""
    for name, text in facts.items():
        if name in workbook.defined_names:
            workbook.set_name(name, text)


def read_shown_units(
    workbook: Workbook, rated_torque: float | None
) -> tuple[ShownUnits, list[str]]:
    """The units above the columns of a workbook.

    Parameters
    ----------
    workbook : Workbook
        The open workbook.
    rated_torque : float or None
        Base of pu. [N m]

    Returns
    -------
    units : ShownUnits
        Names and factors; a table that is not in the workbook has none.
    problems : list of str
        A sentence for each unit that cannot be used.
    """
    names: dict[tuple[str, str], str] = {}
    for spec in fields.EVERY_TABLE:
        table = workbook.tables.get(spec.name)
        if table is None or not table.header_row or table.header_row < 2:
            continue
        above = table.ref._replace(top=table.header_row - 1, bottom=table.header_row - 1)
        shown = workbook.sheet_part(table.sheet).constants(above)
        for header, text in zip(table.columns, shown, strict=True):
            if isinstance(text, str):
                names[spec.name, header] = text.strip()
    return shown_units(names, rated_torque)


def _result_blocks(run: RunView, units: ShownUnits, sorts: bool) -> list[TableData]:
    """Rows of every result table; live checks are formulas whose value is calculated when saving."""
    specs = (*fields.RESULT_TABLES, *fields.WORKBOOK_TABLES)
    tables = dict(run.tables) | {
        "StartCycles": start_cycle_rows(run),
        "Plans": [{"plan": plan["number"], "reason": plan["reason"]} for plan in run.plans],
        "BearingForces": (run.startup or {}).get("bearing_forces", ()),
        "EnergyShares": run.energies,
    }
    if sorts:
        tables["SteadyState"] = printed_rows(run.tables).response
    return [_result_block(spec, tables.get(spec.name, ()), units) for spec in specs]


def _result_block(
    spec: TableSpec, results: Sequence[Mapping[str, Any]], units: ShownUnits
) -> TableData:
    columns = spec.written_columns
    rows = [[shown_cell(spec, f, row, units) for f in columns] for row in results]
    formulas = {f.name: f.formula for f in spec.extra_columns if rows}
    return TableData(spec.name, rows, [f.name for f in columns], formulas)


def _run_facts(run: RunView, stamp: RunStamp, units: ShownUnits) -> TableData:
    ratings = run.case.ratings
    start = run.startup or {}
    speed = ratings.synchronous_speed
    governing, printed = start_cycle_facts(run), printed_rows(run.tables)
    endurance = governing["endurance"]
    facts: dict[str, Any] = {
        "run_Stamp": stamp.sentence,
        "run_Software": stamp.software,
        "run_Date": stamp.day,
        "run_SHA256": stamp.sha256,
        "run_Outcome": start.get("sentence") or start.get("outcome"),
        "run_OutcomeWord": start.get("outcome"),
        "run_StartTime": start.get("time"),
        "run_SynchronousSpeed": speed / _RPM if speed else None,
        "run_LineFrequency": ratings.line_frequency,
        **_at_full_speed(run),
        "run_StartsFactor": run.case.starts_factor or 1.0,
        "run_HzPerFrequency": units.factor("NaturalFrequencies", "Frequency"),
        "run_HzPerExcitation": units.factor("SeparationMargins", "Excitation frequency"),
        "run_PaPerUTS": units.factor("Materials", "UTS"),
        "run_PaPerAllowable": units.factor("SteadyState", "Allowable"),
        "run_GoverningShaft": governing["shaft"],
        "run_SNExponent": governing["exponent"],
        "run_Endurance": endurance and endurance / units.factor("StartCycles", "Amplitude"),
        "run_NmPerMinimum": units.factor("TorqueReversals", "Minimum torque"),
        "run_NmPerTransmitted": units.factor("TorqueReversals", "Transmitted torque"),
        "run_ContactLaw": run.contact_law,
        "run_AccuracySentence": NO_STUDY,
        "run_AccuracyReference": ANALYSES,
        "run_AccuracyInputs": stamp.sentence,
        "run_PrintedModes": printed.on_modes,
        "run_PrintedResponse": printed.on_response,
    }
    rows = [[name, meaning, facts[name]] for name, meaning in RUN_FACTS]
    return TableData("RunFacts", rows, ["Name", "Meaning", "Value"])


def _at_full_speed(run: RunView) -> dict[str, Any]:
    """What tells a wrong unit before anything is believed."""
    facts = run.full_speed
    if facts is None:
        names = (
            "Poles",
            "ShaftSpeeds",
            "TotalRatio",
            "InertiaConstant",
            "MotorInertiaConstant",
            "LoadShare",
            "RatedPower",
            "RatedTorque",
            "RunningLoadShare",
        )
        return dict.fromkeys(f"run_{name}" for name in names)
    return {
        "run_Poles": facts.poles,
        "run_ShaftSpeeds": shaft_speeds(facts) or None,
        "run_TotalRatio": facts.total_ratio,
        "run_InertiaConstant": facts.inertia_constant,
        "run_MotorInertiaConstant": facts.motor_inertia_constant,
        "run_LoadShare": _percent(facts.load),
        "run_RatedPower": None if facts.rated_power is None else 1e-3 * facts.rated_power,
        "run_RatedTorque": facts.rated_torque,
        "run_RunningLoadShare": _percent(facts.running_load),
    }


def _percent(share: float | None) -> float | None:
    return None if share is None else 100.0 * share


def chosen_elements(workbook: Workbook) -> list[str | None]:
    """What the engineer wrote into the cells above the history charts.

    Returns
    -------
    list of (str or None)
        One a chart; None leaves the choice to the program. [names]
    """
    names = map(plot_name, range(1, HISTORIES + 1))
    return [recorded_fact(workbook, name) or None for name in names]


_ACCURACY_TITLE = "Accuracy title"


def _title_links(workbook: Workbook, only: str = "") -> list[TitleLink]:
    """Cells of the titles of our charts: a spreadsheet program may have made fixed words of them."""
    labels = workbook.tables.get("ChartLabels")
    if labels is None:
        return []
    links = []
    for chart in CHARTS.values():
        title, axis = chart.title, chart.y.title
        if not isinstance(title, Label) or only not in ("", title.key):
            continue
        values = [_drawn_values(workbook, series) for series in chart.series]
        drawn = tuple(rect for sheet, rect in filter(None, values) if sheet == labels.sheet)
        if len(drawn) < len(values):
            continue
        shown = [label for label in (title, axis) if isinstance(label, Label)]
        if not all(_has_label(labels, label.key) for label in shown):
            continue  # a workbook of an earlier version
        links.append(
            TitleLink(
                labels.sheet,
                drawn,
                _label_cell(labels, title.key),
                _label_cell(labels, axis.key) if isinstance(axis, Label) else "",
                title.words,
                axis.words if isinstance(axis, Label) else "",
            )
        )
    return links


def _drawn_values(workbook: Workbook, series: Series) -> tuple[str, Rect] | None:
    """Sheet and cells that a series draws upwards; None where the workbook has no such column or row."""
    table = workbook.tables.get(series.table)
    if table is None or series.y not in table.columns:
        return None
    at = table.ref.left + table.column_index(series.y)
    top, bottom = table.data.top, table.data.bottom
    if series.row is not None:
        top = bottom = top + series.row
    return table.sheet, Rect(top, at, bottom, at)


def _has_label(labels: Table, key: str) -> bool:
    return bool(labels.data.bottom >= labels.data.top + LABELS.index(key))


def _label_cell(labels: Table, key: str) -> str:
    return cell_name(labels.data.top + LABELS.index(key), labels.ref.left + 1)


def _present(workbook: Workbook, wanted: Sequence[TableData]) -> list[TableData]:
    """The tables and columns that the workbook still has; the others are named in its notes."""
    kept = []
    for data in wanted:
        table = workbook.tables.get(data.name)
        if table is None:
            if data.name in _OPTIONAL:
                continue
            workbook.notes.append(
                f"The workbook has no table {data.name}; its results are only in the JSON. A new "
                "template has the table."
            )
            continue
        kept.append(_cut_to_room(workbook, _with_columns(workbook, data, table.columns)))
    return kept


def _cut_to_room(workbook: Workbook, data: TableData) -> TableData:
    """Some tables have a fixed room; what does not fit is in the JSON only."""
    spec = fields.find_table(data.name)
    if spec is None or not spec.room:
        return data
    count = len(data.rows)
    while count > 1 and workbook.obstacles({data.name: count}):
        count -= 1
    if count < len(data.rows):
        workbook.notes.append(
            f"Table {data.name} has room for {count} of {len(data.rows)} rows; the others are in "
            "the JSON. Move the cells below the table to see all rows."
        )
    return replace(data, rows=data.rows[:count])


def _fit_rows(workbook: Workbook, written: Sequence[TableData]) -> None:
    """Row heights of tables with sentences that wrap; rows no longer used get the usual one."""
    needed: dict[tuple[str, int], float] = {}  # tables side by side share their rows
    for data in written:
        spec, columns = fields.find_table(data.name), list(data.columns or ())
        room, letters, narrow = _room_of(workbook, data.name)
        wrapped = [
            (columns.index(field.name), room.get(field.name, field.width))
            for field in (spec.columns if spec else ())
            if (field.width or (room and not field.is_number)) and field.name in columns
        ]
        if spec is None or not wrapped:
            continue
        table = workbook.table(data.name)
        heights = [
            max(text_height(str(row[at] or ""), width, letters, narrow) for at, width in wrapped)
            for row in data.rows
        ]
        heights += [text_height("", 1.0, letters, narrow)] * (spec.room - len(heights))
        for row_number, height in enumerate(heights, table.data.top):
            at = table.sheet, row_number
            needed[at] = max(height, needed.get(at, 0.0))
    headers = {(table.sheet, table.header_row) for table in workbook.tables.values()}
    for (sheet, row_number), height in needed.items():
        if (sheet, row_number) in headers:  # of a table beside it, whose words are longer
            continue
        workbook.set_row_height(sheet, row_number, height)


def _room_of(workbook: Workbook, name: str) -> tuple[Mapping[str, float], float, bool]:
    """Widths of columns that are wider than their texts need at the least, height of the letters, whether they are narrow.

    Of a table whose letters are large, where it is shipped today; elsewhere nothing is known of the columns.
    """
    table, part = workbook.tables.get(name), _READABLE_PARTS.get(name)
    if table is None or part is None:
        return {}, _USUAL, False
    place, units = part.tables[name], any(c.has_unit for c in fields.table(name).workbook_columns)
    column, row = place.rstrip("0123456789"), int(place.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ"))
    left = column_number(column)
    if (table.ref.top, table.ref.left) != (row + 1 + units, part.shift + left):
        return {}, _USUAL, False
    widths = part.column_widths
    return (
        {
            header: widths[left + k] - _INDENT
            for k, header in enumerate(table.columns)
            if left + k in widths
        },
        part.letters,
        part.narrow,
    )


#: Usual height of letters. [pt]
_USUAL = 9.0
#: The parts with larger ones, by their tables.
_READABLE_PARTS = {
    name: part for part in (*SHEETS, *STUDY_SHEETS) if part.letters > _USUAL for name in part.tables
}
#: What the frame and the indent of a cell take of its width. [characters]
_INDENT = 2.0


def _fit_summary(workbook: Workbook, written: Sequence[TableData]) -> None:
    """Rows without a verdict take no room on the page; notes have the lines that they need."""
    verdicts = workbook.tables.get("Verdicts")
    if verdicts is None or (verdicts.ref.top, verdicts.ref.left) != (VERDICTS_ROW + 1, 2):
        return  # a workbook of an earlier version, or one whose sheet was rearranged
    part = workbook.sheet_part(verdicts.sheet)
    _close(part, range(verdicts.data.bottom + 1, FOOT_ROW), _BESIDE_SUMMARY)
    facts = [
        dict(zip(map(str.casefold, data.columns or ()), row, strict=False))
        for data in written
        if data.name == "Audit"
        for row in data.rows
    ]
    told = [fact for fact in facts if str(fact.get("item")).startswith("Warning ")]
    notes = [str(fact.get("value", "")) for fact in told]  # a column may have been removed
    if len(notes) > SUMMARY_NOTES:
        notes[SUMMARY_NOTES - 1 :] = [""]  # how many more there are
    notes += [""] * (SUMMARY_NOTES - len(notes))
    for row, note in zip(range(NOTES_BEGIN, NOTES_END, 2), notes, strict=True):
        height = max(KEY_ROW, 0.5 * text_height(note, _NOTES_WIDTH, _SUMMARY.letters) - 1.0)
        for each in (row, row + 1):
            part.set_row_height(each, height)


def _close_spare_rows(workbook: Workbook) -> None:
    """Rows of sheet Start between two tables take no room on the page where nothing stands there."""
    above = [workbook.tables.get(name) for name in ("StartupCrossings", "TorqueReversals")]
    below = [workbook.tables.get(name) for name in ("StartupPeaks", "MakerSheet")]
    tables = [table for table in (*above, *below) if table is not None]
    if len({table.sheet for table in tables}) != 1 or len(tables) < len(above) + len(below):
        return  # a workbook of an earlier version, or one whose sheet was rearranged
    if any(table is not None and table.ref.top != OF_ELEMENTS + 2 for table in below):
        return
    sheet = tables[0].sheet
    part = workbook.sheet_part(sheet)
    used = max(table.data.bottom for table in tables[: len(above)])
    _close(part, range(max(used + 1, SPARE_ROWS.start), SPARE_ROWS.stop), 1)


def _close(part: SheetPart, rows: range, first_column: int) -> None:
    """Rows that take no room on the page, but for those with something in this column or right of it."""
    if not rows:
        return
    within = Rect(rows.start, first_column, rows.stop - 1, MAX_COLUMN)
    taken = {row for row, _ in part.filled_cells(within)}
    for row in rows:
        if row not in taken:
            part.set_row_height(row, _CLOSED, create=True)


#: Height of a row that shows nothing; a row of height 0 is hidden. [pt]
_CLOSED = 1.5
#: First column right of sheet Summary, where the engineer may have written something.
_BESIDE_SUMMARY = 9
_SUMMARY = next(sheet for sheet in SHEETS if sheet.name == "Summary")
#: Columns F to I of sheet Summary, where the notes stand. [characters]
_NOTES_WIDTH = sum(_SUMMARY.column_widths[column] for column in range(6, 10)) - _INDENT


def _with_columns(workbook: Workbook, data: TableData, there: Sequence[str]) -> TableData:
    known = {name.casefold() for name in there}
    names = list(data.columns or there)
    keep = [k for k, name in enumerate(names) if name.casefold() in known]
    missing = [name for name in names if name.casefold() not in known]
    if missing:
        workbook.notes.append(
            f"Table {data.name} has no column {', '.join(missing)}; its values are only in the "
            "JSON."
        )
    formulas = {name: text for name, text in data.formulas.items() if name.casefold() in known}
    rows = [[row[k] for k in keep] for row in data.rows] if missing else data.rows
    return TableData(data.name, rows, [names[k] for k in keep], formulas)
