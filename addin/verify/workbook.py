"""A workbook: its results against those that follow from its inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from addin.calculation.calculation import Calculation
from addin.contract.digests import DIGITS, short_digest
from addin.contract.tables import RESULT_TABLES, WORKBOOK_TABLES, find_table
from addin.contract.texts import NO_STUDY
from addin.contract.version import RELEASED, product_version
from addin.reading.workbook import WorkbookInput, read_workbook
from addin.recorded.provenance import Provenance, workbook_provenance
from addin.recorded.studies import recorded_studies
from addin.verify.allowances import Allowances
from addin.verify.appearance import LOOKED_AT, NOT_JUDGED, compare_appearance
from addin.verify.chart_sources import compare_copies, compare_drawings
from addin.verify.charts import compare_charts, drawn_elements
from addin.verify.compare import RecordedValue, agreement, shown_step
from addin.verify.findings import (
    Agreement,
    Counts,
    Finding,
    Verification,
    concluded,
    not_calculated,
)
from addin.verify.fixed_texts import compare_texts
from addin.verify.formulas import (
    earlier_banner,
    old_values,
    restore,
    typed_over,
    unjudged,
    verdict_cells,
)
from addin.verify.input_copy import compare_input_copy, without_copy
from addin.verify.key_units import compare_units
from addin.verify.schematic import compare_schematic
from addin.verify.structure import (
    PlainTexts,
    has_every_column,
    led_astray,
    missing_tables,
    odd_columns,
    other_sheets,
    without_banner,
)
from addin.verify.tables import TablePair, compare_tables
from addin.writing.recalculate import recalculate_case
from addin.writing.results_json import overall_words
from addin.writing.workbook import RunStamp, chosen_elements, read_shown_units, tables_to_write
from addin.xlsx import (
    Formula,
    ObstaclesFound,
    PackageError,
    Table,
    TableData,
    Workbook,
    drawn_charts,
)
from addin.xlsx.references import Rect, cell_name
from engine.case.data import CaseData, case_digest

_RESULTS = (*RESULT_TABLES, *WORKBOOK_TABLES)
_NO_FACT = ("", "", None)
#: Facts about the run and not the inputs, or reported by a finding of their own.
_OWN_FACTS = frozenset({"run_Software", "run_Date", "run_SHA256", "run_Stamp"})
_STUDY_FACTS = frozenset({"run_AccuracySentence", "run_AccuracyReference", "run_AccuracyInputs"})


def verify_workbook(
    read: WorkbookInput,
    *,
    within: Agreement = Agreement.ERROR,
    on_stage: Callable[[str], None] | None = None,
) -> Verification:
    """Calculate a workbook again and compare every result that stands in it.

    Parameters
    ----------
    read : WorkbookInput
        Its inputs, without problems. [SI]
    within : Agreement
        What is accepted.
    on_stage : callable, optional
        Called with the name of each analysis as it begins.

    Returns
    -------
    Verification
        Result by result.
    """
    workbook = read.workbook
    recorded = _recorded(workbook)
    findings = [*_on_record(workbook)]
    inputs = case_digest(read.data)
    about = Verification(
        workbook.path, "", "", recorded.software, f"torsionbook {product_version()}",
        recorded.digest, inputs, recorded.settings, within, looked_at=LOOKED_AT, not_judged=NOT_JUDGED,
    )  # fmt: skip
    if not recorded.digest and not _holds_results(workbook):
        return replace(
            about,
            outcome="never calculated",
            sentence=_on_what_stands(workbook),
            findings=(*_on_accuracy(workbook, inputs), *_on_studies(read)),
        )
    findings += _on_digest(workbook, recorded, inputs)
    run, problems = recalculate_case(read, recorded.settings, on_stage)
    if run is None:
        return not_calculated(about, problems, findings)
    counts, more = _compared(workbook, run, about)
    findings += more
    same_words = about.same_version or not _is_known(about)
    if recorded.digest == inputs:
        findings += compare_input_copy(read, inputs, same_version=same_words)
    findings += _on_studies(read)
    texts = PlainTexts(workbook)
    findings += missing_tables(texts)
    findings += odd_columns(workbook)
    findings += led_astray(texts)
    findings += other_sheets(workbook)
    findings += without_banner(workbook, {sheet for sheet, _, _ in verdict_cells(workbook)})
    findings += without_copy(workbook)
    try:
        findings += compare_appearance(workbook)
        findings += compare_texts(texts, same_words and has_every_column(workbook))
    except PackageError as error:  # a part that nobody needs for the numbers cannot be read
        sentence = f"formats, hidden cells and texts were not checked: {error}"
        findings.append(Finding("not judged", "", "", sentence))
        about = replace(about, looked_at=())
    findings += typed_over(workbook, same_words and has_every_column(workbook))
    return concluded(about, counts, findings)


# --- what the workbook records --------------------------------------------------------------------


def _recorded(workbook: Workbook) -> Provenance:
    """Digest, software and settings."""
    audit, facts = workbook_provenance(workbook), _facts(workbook)
    digest, software = (
        str(facts.get(f"run_{name}", _NO_FACT)[2] or "") for name in ("SHA256", "Software")
    )
    return replace(
        audit, digest=audit.digest or digest.strip(), software=audit.software or software
    )


def _on_record(workbook: Workbook) -> Iterator[Finding]:
    """Settings that are lost, two places that disagree, names that were led astray."""
    table, audit, facts = (
        workbook.tables.get("Audit"),
        workbook_provenance(workbook),
        _facts(workbook),
    )
    for setting in audit.unreadable:
        sentence = f"the setting {setting} is not usable in this version"
        yield Finding("settings", table.sheet if table else "", "", sentence, "Audit")
    sheet, cell, value = facts.get("run_SHA256", _NO_FACT)
    digest = str(value or "").strip()
    if digest and audit.digest and digest != audit.digest:
        yield Finding(
            "digest", sheet, cell,
            f"the digest {short_digest(digest)} differs from {short_digest(audit.digest)} in "
            "table Audit: one of them was edited", "RunFacts", "run_SHA256", "Value", digest, audit.digest,
        )  # fmt: skip
    elif not digest and audit.digest:
        yield Finding("digest", "", "", "run_SHA256 is blank, but table Audit has a digest")
    for name, (sheet, cell, _) in facts.items():
        named = workbook.defined_names.get(name)
        at = named and named.rect and (named.sheet, cell_name(named.rect.top, named.rect.left))
        if at and at != (sheet, cell):
            sentence = f"the name {name} refers to this cell instead of {sheet}!{cell}"
            yield Finding("edited", at[0] or "", at[1], sentence, "RunFacts", name)


def _facts(workbook: Workbook, name: str = "RunFacts") -> dict[str, tuple[str, str, Any]]:
    """Sheet, cell and value of each row of `RunFacts`, or of the facts of the studies."""
    table = workbook.tables.get(name)
    if table is None:
        return {}
    rows = _rows(workbook, table, ("Name", "Value"))
    return {
        str(row["Name"].value): (table.sheet, row["Value"].place, row["Value"].value)
        for row in rows
        if row["Name"].value
    }


def _on_digest(workbook: Workbook, recorded: Provenance, inputs: str) -> Iterator[Finding]:
    if recorded.digest == inputs:
        return
    sheet, cell, _ = _facts(workbook).get("run_SHA256", _NO_FACT)
    sentence = "the file has results but no digest of their inputs"
    if recorded.digest:
        sentence = (
            f"the results were calculated from inputs with SHA-256 {short_digest(recorded.digest)}, "
            f"but the file has {short_digest(inputs)}: inputs were changed since. Recalculate"
        )
    yield Finding(
        "digest", sheet, cell, sentence, "RunFacts", "run_SHA256", "Value", recorded.digest, inputs
    )


def _on_studies(read: WorkbookInput) -> Iterator[Finding]:
    """Studies are not made again; whether each is one of the inputs and rows in the file is reported."""
    units, _ = read_shown_units(read.workbook, read.data.ratings.rated_torque)
    facts = _facts(read.workbook, "StudyFacts")
    for study in recorded_studies(read, units):
        name, command = f"{study.key}_SHA256", study.on_sheet.command
        sheet, cell, digest = facts.get(name, (study.on_sheet.sheet, "", None))
        if study.outdated:
            sentence = (
                f"the study on sheet {study.on_sheet.sheet} is out of date: {study.outdated}. Run "
                f"torsionbook {command} again"
            )
            yield Finding("digest", sheet, cell, sentence, "StudyFacts", name, "Value", digest)
        else:
            sentence = (
                f"the study on sheet {study.on_sheet.sheet} belongs to the inputs and rows in the "
                f"file; its numbers are not verified here, but recalculated by torsionbook {command}"
            )
            if not study.is_recorded:
                sentence += "; the file has no record of what the study wrote, so manual edits are not detected"
            yield Finding("not compared", sheet, cell, sentence, "StudyFacts", name, fails=False)
        for table in study.edited:
            there = read.workbook.tables.get(table)
            sentence = (
                f"table {table} differs from what torsionbook {command} wrote: a cell, row, column or "
                "unit was edited"
            )
            where = study.on_sheet.sheet if there is None else there.sheet
            yield Finding("edited", where, "", sentence, table)


def _on_what_stands(workbook: Workbook) -> str:
    """What there is in a workbook that was never calculated."""
    if _has_study(workbook):
        return (
            "Only sheet Effects and accuracy is filled, by torsionbook accuracy, whose study is not recalculated here. All "
            "other result tables are empty. Run torsionbook recalc."
        )
    return "All result tables are empty. Run torsionbook recalc."


def _on_accuracy(workbook: Workbook, inputs: str) -> Iterator[Finding]:
    """Whether the accuracy study, where there is one, is that of the inputs in the file."""
    at = _facts(workbook).get("run_AccuracyInputs")
    if at is not None and _has_study(workbook) and inputs[:DIGITS] not in str(at[2]):
        yield Finding(
            "digest", *at[:2], "the accuracy study belongs to other inputs", "RunFacts",
            "run_AccuracyInputs", "Value", at[2], inputs,
        )  # fmt: skip


def _holds_results(workbook: Workbook) -> bool:
    """Whether any result table holds a value; an accuracy study is no result of the nominal run."""
    studied = {"AccuracyCost"} if _has_study(workbook) else set()
    tables = (
        (spec, workbook.tables.get(spec.name)) for spec in _RESULTS if spec.name not in studied
    )
    return any(
        any(_rows(workbook, table, tuple(field.name for field in spec.columns)))
        for spec, table in tables
        if table is not None
    )


def _is_known(about: Verification) -> bool:
    """Whether the version that the file names is one that there ever was."""
    return about.made_by in {about.this, *(f"torsionbook {version}" for version in RELEASED)}


# --- comparing ------------------------------------------------------------------------------------


def _compared(
    workbook: Workbook, run: Calculation, about: Verification
) -> tuple[list[Counts], list[Finding]]:
    fresh = read_workbook(workbook.path).workbook
    stamp = RunStamp(run.stamp.software, run.stamp.date, run.case_sha256)
    drawn = drawn_elements(workbook, list(run.view.histories or ()))
    written = tables_to_write(fresh, run.view, stamp, drawn)
    findings = [Finding("not shown", "", "", note, fails=False) for note in fresh.notes]
    for k, (wanted, shown) in enumerate(zip(chosen_elements(workbook), drawn, strict=False), 1):
        if wanted and wanted != shown:
            sentence = f"history {k} draws {shown}, but {wanted} was selected afterwards"
            findings.append(Finding("chart", "", "", sentence, fails=False))
    study = _has_study(workbook)
    by_name = {data.name: data for data in written}
    pairs = []
    for spec in _RESULTS:
        table, data = workbook.tables.get(spec.name), by_name.get(spec.name)
        if table is None or data is None or (study and spec.name == "AccuracyCost"):
            continue
        columns = tuple(data.columns or table.columns)
        rows = [dict(zip(columns, row, strict=True)) for row in data.rows]
        recorded = list(_rows(workbook, table, columns))
        pairs.append(TablePair(spec.name, table.sheet, columns, rows, recorded))
    units, _ = read_shown_units(workbook, run.case.ratings.rated_torque)
    known = _is_known(about)
    same_words = about.same_version or not known
    if not known:
        sentence = (
            f"the file was made by '{about.made_by}', an unknown version; its texts are compared "
            "with those of this version"
        )
        findings.append(Finding("different", "", "", sentence, "Audit", "Software", fails=False))
    allowances = Allowances(run.results)
    counts, more = compare_tables(pairs, allowances, about, known_version=known, unit_of=units.name)
    findings += more
    findings += _facts_compared(workbook, by_name.get("RunFacts"), study, counts, about)
    for one, finding in compare_charts(workbook, written, same_words):
        counts.append(one)
        findings += [finding] if finding else []
    findings += _drawings(workbook, run.case, same_words)
    findings += compare_units(workbook, same_words)
    findings += earlier_banner(workbook, overall_words(run).get("headline", ""))
    findings += _formulas_compared(workbook, fresh, written, pairs, about.other_release)
    return counts, findings


def _drawings(workbook: Workbook, case: CaseData, same_version: bool) -> list[Finding]:
    """Charts that draw other cells, or carry other values than their cells have; the schematic."""
    try:
        charts = drawn_charts(workbook)
        drawings = compare_drawings(workbook, charts, same_version)
        schematics = compare_schematic(workbook, case, same_version)
        return [*drawings, *compare_copies(workbook, charts), *schematics]
    except PackageError as error:  # a chart that nobody can read is no result either
        return [Finding("not shown", "", "", f"charts were not checked: {error}", fails=False)]


def _rows(
    workbook: Workbook, table: Table, columns: tuple[str, ...]
) -> Iterator[dict[str, RecordedValue]]:
    """Rows of a table in which something stands in one of the columns."""
    part = workbook.sheet_part(table.sheet)
    formats, spec = workbook.looks.number_formats, find_table(table.name)
    # a coarser number format in the file than the shipped one allows nothing more
    ours = {f.name: f.format for f in spec.workbook_columns if f.is_number} if spec else {}
    for row in range(table.data.top, table.data.bottom + 1):
        held = {}
        for column in columns:
            at = table.columns_at.get(column.casefold())
            if at is None:
                continue
            value = part.value(row, at)
            formula = value.text if isinstance(value, Formula) else ""
            shows = value.cached if isinstance(value, Formula) else value
            style = int(part.style(row, at) or 0) if isinstance(shows, float) else 0
            code = formats[style] if style < len(formats) else ""
            shipped = ours.get(column, "")
            if code and shipped and isinstance(shows, float):
                code = min(code, shipped, key=lambda one: shown_step(shows, one))
            held[column] = RecordedValue(shows, cell_name(row, at), formula, code)
        if any(cell.value not in (None, "") or cell.formula for cell in held.values()):
            yield held


def _facts_compared(
    workbook: Workbook,
    data: TableData | None,
    study: bool,
    counts: list[Counts],
    about: Verification,
) -> Iterator[Finding]:
    """Facts that live formulas read."""
    if data is None:
        return
    facts = _facts(workbook)
    of_facts = Counts("RunFacts", next((sheet for sheet, _, _ in facts.values()), ""))
    counts.append(of_facts)
    for name, _, follows in data.rows:
        if name not in facts:
            continue
        if name in _OWN_FACTS or (name in _STUDY_FACTS and study) or name == "run_AccuracyInputs":
            of_facts.not_compared += 1
            continue
        sheet, cell, stands = facts[name]
        how = agreement(RecordedValue(stands, cell), follows)
        if follows is not None or how is not Agreement.BITS:
            of_facts.of[how] += 1
        if how > Agreement.DIGITS:
            yield Finding(
                "different", sheet, cell, f"{name}: '{stands}' is recorded, recalculation gives '{follows}'",
                "RunFacts", str(name), "Value", stands, follows,
                not isinstance(follows, str) or about.same_version or not _is_known(about),
            )  # fmt: skip
    yield from _on_accuracy(workbook, about.inputs)


def _has_study(workbook: Workbook) -> bool:
    """Whether sheet Effects and accuracy holds a study, which is a calculation of its own."""
    _, _, words = _facts(workbook).get("run_AccuracySentence", ("", "", None))
    return bool(words) and words != NO_STUDY


def _formulas_compared(
    workbook: Workbook,
    fresh: Workbook,
    written: list[TableData],
    pairs: list[TablePair],
    other_release: str,
) -> Iterator[Finding]:
    """Formulas whose value is old, once the results are written anew."""
    left_out: dict[str, list[Rect]] = {}
    for pair in pairs:
        table = workbook.tables[pair.name]
        if len(pair.expected) != len(pair.recorded):
            left_out.setdefault(table.sheet, []).append(table.data)
    try:
        fresh.write_tables(list(_with_own_values(workbook, written)))
        restored = restore(fresh)
        report = fresh.refresh_formula_caches()
    except PackageError as error:
        obstacles = error.obstacles[:3] if isinstance(error, ObstaclesFound) else (error,)
        reason = " ".join(map(str, obstacles))
        yield Finding("not shown", "", "", f"formulas were not checked: {reason}", fails=False)
        yield from _of_unjudged(workbook, None, reason)
        return
    yield from old_values(
        workbook, fresh, left_out, workbook.looks.number_formats, restored, other_release
    )
    if report.removed:
        sentence = f"{report.removed} formulas were not checked. {report.reason}"
        yield Finding("not shown", "", "", sentence, fails=False)
        yield from _of_unjudged(workbook, fresh, report.reason)


def _of_unjudged(workbook: Workbook, fresh: Workbook | None, reason: str) -> Iterator[Finding]:
    """Live formulas of ours that cannot be judged: the workbook is not verified by its tables alone."""
    formulas = unjudged(workbook, fresh)
    if formulas:
        first, many = formulas[0], len(formulas)
        count = "1 live formula" if many == 1 else f"{many:,} live formulas"
        sentence = f"{count} of torsionbook could not be checked, the first in this cell. {reason}"
        yield Finding("not judged", first.sheet, first.cell, sentence)


def _with_own_values(workbook: Workbook, written: list[TableData]) -> Iterator[TableData]:
    """What is written, with dates, versions and wall times as recorded: no formula counts as old because of them."""
    study, facts = _has_study(workbook), _facts(workbook)
    for data in written:
        if data.name == "RunFacts":
            own = _OWN_FACTS | (_STUDY_FACTS if study else {"run_AccuracyInputs"})
            rows = [
                [name, meaning, facts[name][2] if name in own and name in facts else value]
                for name, meaning, value in data.rows
            ]
            yield replace(data, rows=rows)
        elif study and data.name in ("AccuracyCost", "ChartAccuracy"):
            continue
        elif data.name in ("Effects", "AccuracyCost"):
            yield _with_standing(workbook, data, "Time")
        else:
            yield data


def _with_standing(workbook: Workbook, data: TableData, column: str) -> TableData:
    """Rows with the values of one column as recorded."""
    columns = list(data.columns or ())
    if column not in columns:
        return data
    table = workbook.tables[data.name]
    at, place = columns.index(column), table.ref.left + table.column_index(column)
    part = workbook.sheet_part(table.sheet)
    values = (part.constant(table.data.top + k, place) for k in range(len(data.rows)))
    rows = [
        [*row[:at], value, *row[at + 1 :]] for row, value in zip(data.rows, values, strict=True)
    ]
    return replace(data, rows=rows)
