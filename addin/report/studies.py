"""Studies that stand in the workbook: tuning, tolerances, sensitivities, starts and ledger, calibration.

They are printed as recorded, not calculated again, and only where they are studies of the inputs
that the report is of; others are named as out of date.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.contract.studies.tuning import NO_VARIABLE
from addin.recorded.studies import RecordedStudy
from addin.report.document import Block, Figure, Paragraph, Section, Table, section
from addin.report.figures import Pictures
from addin.report.numbers import clean, number_in
from addin.report.subject import Subject
from addin.report.tables import standing_table
from addin.report.units import DocumentUnits

Row = Mapping[str, Any]

#: Rows shown of long tables. [count]
_BEST, _REASONS, _MOST = 10, 5, 12
_ALL = "the complete list is kept with the calculation"


def studies(subject: Subject, recorded: Sequence[RecordedStudy]) -> Section:
    """Every study of a workbook, in the order of its sheets.

    Parameters
    ----------
    subject : Subject
        What the report is about.
    recorded : sequence of RecordedStudy
        Studies that stand in the workbook, at least one. [SI]

    Returns
    -------
    Section
        One part a study.
    """
    sentence = (
        "Studies are many calculations, made before this document. Those of its inputs are "
        "printed as recorded."
    )
    parts = [_part(_Study(subject.shown, subject.pictures, study)) for study in recorded]
    return section("Studies", Paragraph(sentence), parts=parts)


def study_pictures(
    recorded: RecordedStudy, shown: DocumentUnits, pictures: Pictures
) -> list[Figure]:
    """The pictures that a report has of a study, in their order."""
    _, blocks = _PARTS.get(recorded.key) or ("", _every_table)
    study = _Study(shown, pictures, recorded)
    return [block for block in blocks(study) if isinstance(block, Figure)]


@dataclass(frozen=True)
class _Study:
    """A study and what it is printed with."""

    shown: DocumentUnits  #: Units of the document.
    pictures: Pictures  #: What draws.
    recorded: RecordedStudy  #: The study. [SI]

    def rows(self, table: str) -> list[Row]:
        """Rows of a table; none where the workbook has no such table."""
        return list(self.recorded.tables.get(table, ()))

    def table(
        self,
        name: str,
        caption: str,
        columns: Sequence[str],
        note: str = "",
        rows: Sequence[Row] | None = None,
    ) -> Table | None:
        """A table of all its rows or of some; None where there are none."""
        rows = self.rows(name) if rows is None else rows
        return standing_table(name, rows, self.shown, caption, columns, note) if rows else None

    def value(self, number: float, table: str, column: str) -> float:
        """An SI number in the unit of a column, where that is a unit. [shown unit]"""
        factor = self.shown.units.factor(table, column)
        return number / (factor if factor and math.isfinite(factor) else 1.0)


def _part(study: _Study) -> Section:
    recorded = study.recorded
    title, blocks = _PARTS.get(recorded.key) or (recorded.on_sheet.sheet, _every_table)
    if recorded.outdated:
        sentence = f"Out of date and omitted: {recorded.outdated}."
        return section(title, Paragraph(clean(sentence), "alert"))
    return section(
        title,
        Paragraph(clean(recorded.sentence), "lead"),
        *blocks(study),
        Paragraph(clean(recorded.stamp), "note"),
    )


def _part_of(shown: int, total: int, which: str) -> str:
    return f"{shown} of {total} are shown, {which}; {_ALL}." if shown < total else ""


def _points(
    study: _Study, table: str, across: str, up: str, rows: Sequence[Row]
) -> list[tuple[float, float]]:
    """Points of a curve: across in its unit, and the numbers above zero that stand for it."""
    numbers = ((number_in(row, across), number_in(row, up)) for row in rows)
    return [
        (study.value(x, table, across), y)
        for x, y in numbers
        if x is not None and y is not None and y > 0.0
    ]


# --- tuning ---------------------------------------------------------------------------------------


def _tuning(study: _Study) -> Iterator[Block | None]:
    rows = study.rows("TuningResults")

    def until(rank: int) -> list[Row]:
        ranks = ((row, number_in(row, "Rank")) for row in rows)
        return [r for r, k in ranks if k is not None and (k <= rank or r.get("As is") is True)]

    best = until(_BEST)
    yield study.table(
        "TuningResults", "Combinations by rank",
        ("Rank", "Combination", "Verdict", "Limits broken", "Allowable starts", "Worst margin",
         "Peak-to-peak stress"),
        _part_of(len(best), len(rows), "the best and the unchanged case"), best,
    )  # fmt: skip
    yield study.table(
        "TuningResults", "Modes, and the crossing with the largest stress",
        ("Rank", "Mode 1", "Mode 2", "Mode 3", "Mode crossed", "Percent speed", "Sweep rate",
         "Pulsating torque"), rows=best,
    )  # fmt: skip
    yield study.table(
        "TuningResults", "Reasons for the ranking", ("Rank", "Reason"),
        "Numbers in the text are in the units typed.", until(_REASONS),
    )  # fmt: skip
    axes, lines = study.rows("TuningAxes"), study.rows("TuningLines")
    if not axes or len(lines) < 2:
        return
    names = [f"Line {k}" for k in range(1, 7)]
    curves = [(name, _points(study, "TuningLines", "Of as is", name, lines)) for name in names]
    across, up = (str(axes[0].get(k) or "") for k in ("First variable", "Second variable"))
    yield study.pictures.curves(
        [(str(axes[0].get(name) or name), points) for name, points in curves if points],
        across,
        "Allowable starts",
        f"Allowable starts against {across}"
        + ("" if up == NO_VARIABLE else f", one line per {up}"),
        log=True,
    )


# --- tolerances, sensitivities --------------------------------------------------------------------


def _tolerances(study: _Study) -> Iterator[Block | None]:
    yield study.table(
        "StartsOfSample", "Allowable starts of the sample",
        ("Element", "Nominal", "P10", "P50", "P90", "Unlimited", "Required", "Probability",
         "Probability low", "Probability high"),
        "P10: 10 % of the samples have fewer. Probability: of reaching the required starts, "
        "with its 95 % interval.",
    )  # fmt: skip
    modes = study.rows("ToleranceFrequencies")
    yield study.table(
        "ToleranceFrequencies", "Natural frequencies of the sample",
        ("Mode", "Nominal", "P10", "P50", "P90"),
        _part_of(min(_MOST, len(modes)), len(modes), "the lowest"), modes[:_MOST],
    )  # fmt: skip
    yield _margins(study)
    yield study.table(
        "TolerancePeaks", "Peaks of the start in the sample",
        ("Element", "Torque P10", "Torque P50", "Torque P90", "Stress P50", "Stress P90"),
        rows=study.rows("TolerancePeaks")[:_MOST],
    )  # fmt: skip
    bars = [
        (str(r.get("Factor") or ""), 100.0 * low, 100.0 * high)
        for r in study.rows("ToleranceTornado")
        if (low := number_in(r, "At P10")) is not None
        and (high := number_in(r, "At P90")) is not None
    ]
    yield study.pictures.tornado(
        bars, ("at its P10", "at its P90"), "Change of the result [%]",
        "Main drivers of the result above: each factor alone at its P10 and P90, all others "
        "nominal",
    )  # fmt: skip
    points = [
        (starts, 100.0 * share)
        for r in study.rows("ToleranceDistribution")
        if (starts := number_in(r, "Starts")) and (share := number_in(r, "Probability")) is not None
    ]
    yield study.pictures.curves(
        [("", points)] if len(points) > 1 else [],
        "Allowable starts", "Share of samples with fewer starts [%]",
        "Distribution of the allowable starts", log_x=True, markers=False,
    )  # fmt: skip


def _margins(study: _Study) -> Table | None:
    """Margins that are not sure, the least probable first, and all of them together."""
    rows = study.rows("ToleranceMargins")
    unsure = [r for r in rows if (number_in(r, "Probability") or 0.0) < 1.0]
    unsure.sort(key=lambda r: (r.get("Mode") is not None, number_in(r, "Probability") or 0.0))
    least = unsure[:_MOST]
    sure = len(rows) - len(unsure)
    note = f"{sure} margins kept by every sample are omitted. " if sure else ""
    note += _part_of(len(least), len(unsure), "those least likely to be kept")
    return study.table(
        "ToleranceMargins", "Separation margins of the sample",
        ("Mode", "Excitation", "Nominal", "P10", "P90", "Required", "Probability", "Probability low",
         "Probability high"), note.strip(), least,
    )  # fmt: skip


def _sensitivities(study: _Study) -> Iterator[Block | None]:
    rows = study.rows("Sensitivities")

    def size(row: Row) -> float:
        return -max(abs(number_in(row, c) or 0.0) for c in ("Starts change", "Peak change"))

    largest = sorted(rows, key=size)[:_MOST]
    yield study.table(
        "Sensitivities", "Effect of + 1 % of each quantity",
        ("Quantity", "Of", "Peak change", "Peak error", "Starts change", "Starts error", "Note"),
        _part_of(len(largest), len(rows), "those with the largest change"), largest,
    )  # fmt: skip


# --- starts, ledger -------------------------------------------------------------------------------


def _starts(study: _Study) -> Iterator[Block | None]:
    yield study.table(
        "StartMatrix", "Allowable starts by start condition",
        ("Condition", "Outcome", "Time", "Peak over rated", "Peak-to-peak stress", "Damage",
         "Allowable starts"),
        "Allowable starts: if only this condition occurred. Stresses are nominal.",
    )  # fmt: skip
    rows = study.rows("StartsByVoltage")
    curves = [
        (name.lower(), sorted(_points(study, "StartsByVoltage", "Voltage", f"{name} starts", rows)))
        for name in ("Loaded", "Unloaded")
    ]
    yield study.pictures.curves(
        [(name, points) for name, points in curves if len(points) > 1],
        "Voltage [%]", "Allowable starts", "Allowable starts against the voltage at the motor", log=True,
    )  # fmt: skip
    yield study.table(
        "DamageLedger", "Damage ledger",
        ("Element", "Allowed", "Used", "Yearly", "Left", "Remaining years", "Years low", "Years high",
         "Verdict"),
    )  # fmt: skip
    yield study.table(
        "DamageLedger", "Summary of the damage ledger", ("Element", "Governing", "Reason")
    )
    duty = [
        row
        for row in study.rows("RemainingStarts")
        if number_in(row, "So far") or number_in(row, "Per year")
    ]
    damaged = [row for row in duty if number_in(row, "Damage")] or duty
    left_out = len(duty) - len(damaged)
    yield study.table(
        "RemainingStarts", "Damage of the duty by start condition",
        ("Element", "Condition", "So far", "Per year", "Share", "Damage", "Remaining starts"),
        f"{left_out} pairs of element and condition without damage are omitted." if left_out else "",
        damaged,
    )  # fmt: skip


# --- calibration, others --------------------------------------------------------------------------


def _calibration(study: _Study) -> Iterator[Block | None]:
    fit = ("Measured", "Uncertainty", "Before", "After", "Residual", "Used", "Explained", "Note")
    yield study.table(
        "FrequencyFit", "Measured frequencies", ("Mode", *fit),
        "Residual: calculated minus measured, in standard deviations of the measurement.",
    )  # fmt: skip
    yield study.table("PeakFit", "Measured peak torques", ("Element", *fit))
    yield study.table(
        "CalibratedFrequencies", "Frequencies before and after",
        ("Mode", "Before", "Prior deviation", "After", "Posterior deviation", "Change", "Known", "Why"),
        rows=study.rows("CalibratedFrequencies")[:_MOST],
    )  # fmt: skip
    changed = study.rows("CalibratedParameters")
    changed.sort(key=lambda r: -abs(number_in(r, "Pull") or 0.0))
    most = changed[:_MOST]
    yield study.table(
        "CalibratedParameters", "Changed quantities",
        ("Name", "Quantity", "Change", "Change low", "Change high", "Prior deviation",
         "Posterior deviation", "Determined"),
        _part_of(len(most), len(changed), "those with the largest change, as a multiple of the prior standard deviation"),
        most,
    )  # fmt: skip


def _every_table(study: _Study) -> Iterator[Block | None]:
    """All of a study that has no part of its own here."""
    for spec in study.recorded.on_sheet.json_tables:
        yield study.table(spec.name, spec.caption, [column.name for column in spec.columns])


_PARTS: Mapping[str, tuple[str, Callable[[_Study], Iterator[Block | None]]]] = {
    "tuning": ("Tuning: all combinations", _tuning),
    "tolerances": ("Tolerances", _tolerances),
    "sensitivities": ("Sensitivities", _sensitivities),
    "starts": ("Start matrix and damage ledger", _starts),
    "calibration": ("Calibration against measurements", _calibration),
}
