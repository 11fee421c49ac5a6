"""Studies that stand in the workbook: tuning, tolerances, sensitivities, starts and ledger, calibration.

They are printed as they stand, not calculated again, and only where they are studies of the inputs
that the report is of; others are named as out of date.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from addin.recorded.studies import RecordedStudy
from addin.report.document import Block, Figure, Paragraph, Section, Table
from addin.report.numbers import clean
from addin.report.subject import Subject
from addin.report.tables import standing_table
from addin.report.units import DocumentUnits

Row = Mapping[str, Any]

#: Rows shown of long tables. [count]
_BEST, _REASONS, _MOST = 10, 5, 12
_ALL = "all rows are in the workbook"


def studies(subject: Subject, there: Sequence[RecordedStudy]) -> Section:
    """Every study of a workbook, in the order of its sheets.

    Parameters
    ----------
    subject : Subject
        What the report is about.
    there : sequence of RecordedStudy
        Studies that stand in the workbook, at least one. [SI]

    Returns
    -------
    Section
        One part a study.
    """
    sentence = (
        "Studies are calculated by commands of their own and written into the workbook. They are printed from "
        "there where they belong to the inputs of this document; nothing of them was "
        "calculated again."
    )
    return Section("Studies", (Paragraph(sentence),), tuple(_part(subject, one) for one in there))


def _part(subject: Subject, one: RecordedStudy) -> Section:
    title, made = _PARTS.get(one.key) or (one.on_sheet.sheet, _every_table)
    if one.outdated:
        command = one.on_sheet.command
        sentence = (
            f"Out of date, and not shown: sheet {one.on_sheet.sheet} holds a study, but "
            f"{one.outdated}. torsionbook {command} FILE makes it again."
        )
        return Section(title, (Paragraph(clean(sentence), "alert"),))
    blocks = [Paragraph(clean(one.sentence), "lead"), *made(subject, one)]
    return Section(title, (*blocks, Paragraph(clean(one.stamp), "note")))


def _rows(one: RecordedStudy, table: str) -> list[Row]:
    """Rows of a table; none where the workbook has no such table."""
    return list(one.tables.get(table, ()))


def _number(row: Row, column: str) -> float | None:
    value = row.get(column)
    return float(value) if isinstance(value, float | int) and not isinstance(value, bool) else None


def _part_of(shown: int, total: int, which: str) -> str:
    return f"{shown} of {total} are shown, {which}; {_ALL}." if shown < total else ""


def _tables(*made: Table) -> Iterator[Block]:
    return (table for table in made if table.rows)


# --- tuning ---------------------------------------------------------------------------------------


def _tuning(subject: Subject, one: RecordedStudy) -> Iterator[Block]:
    shown, rows = subject.shown, _rows(one, "TuningResults")

    def until(rank: int) -> list[Row]:
        ranks = ((row, _number(row, "Rank")) for row in rows)
        return [r for r, k in ranks if k is not None and (k <= rank or r.get("As is") is True)]

    best = until(_BEST)
    some = _part_of(len(best), len(rows), "the best and the unchanged case")
    yield from _tables(
        standing_table(
            "TuningResults", best, shown, "Combinations by rank",
            ("Rank", "Combination", "Verdict", "Limits broken", "Allowable starts", "Worst margin",
             "Peak-to-peak stress"), some,
        ),
        standing_table(
            "TuningResults", best, shown, "Their modes, and the crossing that stresses the train most",
            ("Rank", "Mode 1", "Mode 2", "Mode 3", "Mode crossed", "Percent speed", "Sweep rate",
             "Pulsating torque"),
        ),
        standing_table(
            "TuningResults", until(_REASONS), shown, "Why they stand there", ("Rank", "Reason"),
            "Numbers in words have the units typed in the workbook.",
        ),
    )  # fmt: skip
    picture = _starts_over_first_variable(subject, one)
    if picture is not None:
        yield picture


def _starts_over_first_variable(subject: Subject, one: RecordedStudy) -> Figure | None:
    axes, lines = _rows(one, "TuningAxes"), _rows(one, "TuningLines")
    if not axes or len(lines) < 2:
        return None
    factor = _factor(subject.shown, "TuningLines", "Of as is")
    series = []
    for name in (f"Line {k}" for k in range(1, 7)):
        points = [(_number(r, "Of as is"), _number(r, name)) for r in lines]
        known = [(x / factor, y) for x, y in points if x is not None and y is not None and y > 0.0]
        if known:
            label = str(axes[0].get(name) or name)
            series.append((label, [x for x, _ in known], [y for _, y in known]))
    across, up = (str(axes[0].get(k) or "") for k in ("First variable", "Second variable"))
    return subject.pictures.curves(
        series,
        across,
        "Allowable starts",
        f"Allowable starts over {across}, a line for {up}",
        log=True,
    )


# --- tolerances, sensitivities --------------------------------------------------------------------


def _tolerances(subject: Subject, one: RecordedStudy) -> Iterator[Block]:
    shown = subject.shown
    yield from _tables(
        standing_table(
            "ToleranceStarts", _rows(one, "ToleranceStarts"), shown,
            "Allowable starts over the sample", ("Element", "Nominal", "P10", "P50", "P90", "Unlimited", "Required",
            "Probability", "Probability low", "Probability high"),
            "P10: a tenth of the sample has fewer. Probability: that the starts required are there, with "
            "its 95 % interval.",
        ),
        standing_table(
            "ToleranceFrequencies", _rows(one, "ToleranceFrequencies")[:_MOST], shown,
            "Natural frequencies over the sample", ("Mode", "Nominal", "P10", "P50", "P90"),
            _part_of(min(_MOST, len(_rows(one, "ToleranceFrequencies"))),
                     len(_rows(one, "ToleranceFrequencies")), "the lowest"),
        ),
        _margins(one, shown),
        standing_table(
            "TolerancePeaks", _rows(one, "TolerancePeaks")[:_MOST], shown,
            "Peaks of the start over the sample", ("Element", "Torque P10", "Torque P50", "Torque P90", "Stress P50",
            "Stress P90"),
        ),
    )  # fmt: skip
    for picture in (_tornado(subject, one), _distribution(subject, one)):
        if picture is not None:
            yield picture


def _margins(one: RecordedStudy, shown: DocumentUnits) -> Table:
    """Margins that are not sure, the least probable first, and all of them together."""
    rows = _rows(one, "ToleranceMargins")
    unsure = [r for r in rows if (_number(r, "Probability") or 0.0) < 1.0]
    unsure.sort(key=lambda r: (r.get("Mode") is not None, _number(r, "Probability") or 0.0))
    told = unsure[:_MOST]
    sure = len(rows) - len(unsure)
    note = f"{sure} margins that every sample keeps are left out. " if sure else ""
    if len(told) < len(unsure):
        note += _part_of(len(told), len(unsure), "the least probable")
    return standing_table(
        "ToleranceMargins", told, shown, "Separation margins over the sample",
        ("Mode", "Excitation", "Nominal", "P10", "P90", "Required", "Probability", "Probability low",
         "Probability high"), note.strip(),
    )  # fmt: skip


def _tornado(subject: Subject, one: RecordedStudy) -> Figure | None:
    bars = [
        (str(r.get("Factor") or ""), 100.0 * low, 100.0 * high)
        for r in _rows(one, "ToleranceTornado")
        if (low := _number(r, "At P10")) is not None and (high := _number(r, "At P90")) is not None
    ]
    return subject.pictures.tornado(
        bars, ("at its P10", "at its P90"), "Change of the answer [%]",
        "What drives the answer named above: each factor alone at its P10 and P90, all others as stated",
    )  # fmt: skip


def _distribution(subject: Subject, one: RecordedStudy) -> Figure | None:
    points = [
        (starts, 100.0 * share)
        for r in _rows(one, "ToleranceDistribution")
        if (starts := _number(r, "Starts")) and (share := _number(r, "Probability")) is not None
    ]
    return subject.pictures.curves(
        [("", [x for x, _ in points], [y for _, y in points])] if len(points) > 1 else [],
        "Allowable starts", "Share of the sample with fewer [%]",
        "Distribution of the allowable starts", log_x=True, markers=False,
    )  # fmt: skip


def _sensitivities(subject: Subject, one: RecordedStudy) -> Iterator[Block]:
    rows = _rows(one, "Sensitivities")

    def size(row: Row) -> float:
        return -max(abs(_number(row, c) or 0.0) for c in ("Starts change", "Peak change"))

    told = sorted(rows, key=size)[:_MOST]
    yield from _tables(
        standing_table(
            "Sensitivities", told, subject.shown, "What + 1 % of each quantity does",
            ("Quantity", "Of", "Peak change", "Peak error", "Starts change", "Starts error", "Note"),
            _part_of(len(told), len(rows), "those with the largest change"),
        )
    )  # fmt: skip


# --- starts, ledger -------------------------------------------------------------------------------


def _starts(subject: Subject, one: RecordedStudy) -> Iterator[Block]:
    shown = subject.shown
    yield from _tables(
        standing_table(
            "StartMatrix", _rows(one, "StartMatrix"), shown, "Starts of each kind",
            ("Condition", "Outcome", "Time", "Peak over rated", "Peak-to-peak stress", "Damage",
             "Allowable starts"),
            "Allowable starts: if all starts were of this kind. Stresses are nominal.",
        )
    )  # fmt: skip
    picture = _over_voltage(subject, one)
    if picture is not None:
        yield picture
    yield from _tables(
        standing_table(
            "DamageLedger", _rows(one, "DamageLedger"), shown, "Damage ledger",
            ("Element", "Allowed", "Used", "Yearly", "Left", "Remaining years", "Years low", "Years high",
             "Verdict"),
        ),
        standing_table(
            "DamageLedger", _rows(one, "DamageLedger"), shown, "Ledger, in words",
            ("Element", "Governing", "Reason"),
        ),
        standing_table(
            "RemainingStarts", _duty(one), shown, "What the duty takes, kind by kind",
            ("Element", "Condition", "So far", "Per year", "Share", "Damage", "Remaining starts"),
        ),
    )  # fmt: skip


def _duty(one: RecordedStudy) -> list[Row]:
    """Kinds of starts that happen."""
    rows = _rows(one, "RemainingStarts")
    return [r for r in rows if _number(r, "So far") or _number(r, "Per year")]


def _over_voltage(subject: Subject, one: RecordedStudy) -> Figure | None:
    rows = _rows(one, "StartsByVoltage")
    factor = _factor(subject.shown, "StartsByVoltage", "Voltage")
    series = []
    for label in ("Loaded", "Unloaded"):
        points = [(_number(r, "Voltage"), _number(r, f"{label} starts")) for r in rows]
        known = sorted((x / factor, y) for x, y in points if x is not None and y)
        if len(known) > 1:
            series.append((label.lower(), [x for x, _ in known], [y for _, y in known]))
    return subject.pictures.curves(
        series, "Voltage [%]", "Allowable starts", "Allowable starts over the voltage at the motor",
        log=True,
    )  # fmt: skip


# --- calibration ----------------------------------------------------------------------------------


def _calibration(subject: Subject, one: RecordedStudy) -> Iterator[Block]:
    shown, changed = subject.shown, _rows(one, "CalibratedParameters")
    changed.sort(key=lambda r: -abs(_number(r, "Pull") or 0.0))
    fit = ("Measured", "Uncertainty", "Before", "After", "Residual", "Used", "Explained", "Note")
    yield from _tables(
        standing_table(
            "FrequencyFit", _rows(one, "FrequencyFit"), shown, "Measured frequencies", ("Mode", *fit),
            "Residual: what is left, in standard deviations of the measurement.",
        ),
        standing_table(
            "PeakFit", _rows(one, "PeakFit"), shown, "Measured peak torques", ("Element", *fit)
        ),
        standing_table(
            "CalibratedFrequencies", _rows(one, "CalibratedFrequencies")[:_MOST], shown,
            "Frequencies before and after",
            ("Mode", "Before", "Prior deviation", "After", "Posterior deviation", "Change", "Known", "Why"),
        ),
        standing_table(
            "CalibratedParameters", changed[:_MOST], shown, "What was changed",
            ("Name", "Quantity", "Change", "Change low", "Change high", "Prior deviation",
             "Posterior deviation", "Determined"),
            _part_of(min(_MOST, len(changed)), len(changed), "those pulled furthest from their prior"),
        ),
    )  # fmt: skip


def _factor(shown: DocumentUnits, table: str, column: str) -> float:
    factor = shown.units.factor(table, column)
    return factor if factor and math.isfinite(factor) else 1.0


def _every_table(subject: Subject, one: RecordedStudy) -> Iterator[Block]:
    """All of a study that has no part of its own here."""
    for spec in one.on_sheet.json_tables:
        columns = [column.name for column in spec.columns]
        table = standing_table(
            spec.name, _rows(one, spec.name), subject.shown, spec.caption, columns
        )
        yield from _tables(table)


_PARTS: Mapping[str, tuple[str, Callable[[Subject, RecordedStudy], Iterator[Block]]]] = {
    "tuning": ("Couplings in every combination", _tuning),
    "tolerances": ("Tolerances", _tolerances),
    "sensitivities": ("Sensitivities", _sensitivities),
    "starts": ("Start matrix and damage ledger", _starts),
    "calibration": ("Calibration against measurements", _calibration),
}
