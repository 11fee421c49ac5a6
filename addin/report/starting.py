"""The start: outcome, peaks and histories; torque reversals; fatigue and allowable starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from addin.charts.start_cycles import start_cycle_facts, start_cycle_rows
from addin.contract.chart_tables import HISTORIES
from addin.report.document import Block, Column, Facts, Listing, Paragraph, Section, Table
from addin.report.equations import by
from addin.report.layout import folded
from addin.report.numbers import clean, fixed, of_dimension, significant, typed
from addin.report.opening import largest_peak
from addin.report.subject import Subject
from addin.report.tables import result_table, turned, with_column
from engine.case.practice_limits import PRACTICE_LIMITS

_CROSSINGS = (
    ("Mode", "Frequency", "Percent speed", "Time", "Average torque", "Pulsating torque", "Load torque",
     "Acceleration", "Sweep rate"),
    ("Mode", "Frequency", "Governing element", "Peak-to-peak torque", "Peak-to-peak stress",
     "Mesh minimum torque"),
)  # fmt: skip


def start(subject: Subject) -> Section:
    """Outcome, speed, crossings, peaks and histories."""
    title, startup = "Start-up", subject.calculation.startup
    if startup is None:
        return Section(title, (Paragraph(
            "No start was calculated: the inputs hold no motor torque and no torque against time. There "
            "are therefore no peaks, no reversals and no number of starts."),))  # fmt: skip
    blocks: list[Block] = [Paragraph(clean(str(startup["sentence"])), "lead")]
    picture = subject.pictures.speed_time()
    if picture is not None:
        blocks.append(picture)
    parts = [_conditions(subject), _crossings(subject), _peaks(subject)]
    field = startup.get("pull_in")
    if field:
        parts.append(Section("Field application and pull-in", tuple(_pull_in(subject, field))))
    histories = subject.pictures.histories()
    if histories:
        note = Paragraph(
            "Each point drawn is calculated; of long histories the least and the largest value of "
            "equal intervals of time are drawn, so that no peak is lost." + _not_drawn(subject), "note",
        )  # fmt: skip
        parts.append(Section("Histories", (*histories, note)))
    return Section(title, tuple(blocks), tuple(parts))


def _not_drawn(subject: Subject) -> str:
    """How many elements have no picture, and how to have one."""
    rows = len(subject.rows("StartupPeaks"))
    if rows <= HISTORIES:
        return ""
    choose = (
        "name others above the charts of sheet Start-up to have them drawn."
        if subject.shown.is_workbook
        else "of a workbook the engineer chooses which."
    )
    return f" {HISTORIES} of {rows} elements are drawn; {choose}"


def _conditions(subject: Subject) -> Section:
    """Under what conditions this start was calculated, and under which it was not."""
    case = subject.calculation.case
    effects = {row["effect"]: bool(row["on"]) for row in subject.rows("Effects")}
    why = {row["effect"]: clean(str(row["why"])) for row in subject.rows("Effects")}
    voltage = 1.0 if case.voltage is None else case.voltage
    facts = [
        (
            "Voltage",
            "that of the torque curves"
            if voltage == 1.0
            else f"{typed(100.0 * voltage, 6)} % of that of the torque curves; motor torques times "
            f"{typed(voltage**2, 4)}",
        )
    ]
    for name, words in (
        ("breaker closing", "Breaker closing"),
        ("pull-in", "Field application, pull-in"),
        ("aborted start", "Aborted start"),
    ):
        if name in effects:
            sentence = "simulated" if effects[name] else f"not simulated: {why[name]}"
            facts.append((words, sentence))
    given = sorted({clean(row.station or "") for row in case.torque_time})
    facts += [
        (
            "Short circuits, reclosing",
            f"torques prescribed against time act at {', '.join(given)} (table TorqueTime)"
            if given
            else "not part of this start; their torque can be prescribed in table TorqueTime",
        ),
        (
            "Starts in succession",
            "each from rest, as cold as the first: residual oscillation, temperature and starts per hour "
            "are not considered",
        ),
    ]
    return Section("Conditions of the start", (Facts(tuple(facts)),))


def _crossings(subject: Subject) -> Section:
    rows = subject.rows("StartupCrossings")
    if not rows:
        return Section("Crossings of 2 × slip frequency",
                       (Paragraph("No mode is crossed by the falling 2 × slip frequency in this start."),))  # fmt: skip
    captions = ("Crossings: speed and torques there", "Crossings: response there")
    notes = (by("Pulsation", "Start-up crossing"),
             "Torque and stress ranges while the mode responds; stress nominal, without SCF.")  # fmt: skip
    blocks: list[Block] = [
        result_table("StartupCrossings", rows, subject.shown, caption, columns, note)
        for caption, columns, note in zip(captions, _CROSSINGS, notes, strict=True)
    ]
    sentences = tuple(
        f"Mode {row['mode']}: {clean(row['note'])}" for row in rows if row.get("note")
    )
    if sentences:
        blocks.append(Listing(sentences))
    return Section("Crossings of 2 × slip frequency", tuple(blocks))


def _peaks(subject: Subject) -> Section:
    rows = subject.rows("StartupPeaks")
    table = result_table(
        "StartupPeaks", rows, subject.shown, "Extreme torques of the start",
        note="From rest to the end of the run, at the element's own speed; stress nominal, without SCF. "
        "Time and speed of the largest torque. Estimated error: change from step h to h/2. "
        + by("Start, exponential", "Shear stress"),
    )  # fmt: skip
    return Section("Extreme torques", (*_in_rated(subject), _over_rated(subject, table, rows)))


def _over_rated(subject: Subject, table: Table, rows: Sequence[Mapping[str, Any]]) -> Table:
    """The table with the largest torque over rated torque, both at motor speed, after the torques."""
    rated, ratio = (
        subject.calculation.case.ratings.rated_torque,
        subject.calculation.case.element_speed_ratios,
    )
    headers = [column.header for column in table.columns]
    if not rated or "Torque, pk‑pk" not in headers:
        return table
    at = headers.index("Torque, pk‑pk")
    cells = [
        fixed(
            max(abs(r["maximum_torque"]), abs(r["minimum_torque"])) * ratio[r["element"]] / rated, 2
        )
        for r in rows
    ]
    return replace(
        with_column(table, at, Column("Largest over rated", "", "number"), cells),
        note=f"{table.note} Largest over rated: referred to motor speed, as multiples of rated torque.",
    )


def _in_rated(subject: Subject) -> Iterator[Block]:
    peak = largest_peak(subject)
    if peak:
        yield Paragraph(f"Largest torque, compared at motor speed: {peak}.")


def _pull_in(subject: Subject, field: Mapping[str, Any]) -> Iterator[Block]:
    facts = [
        (
            "Field applied",
            f"after {fixed(field['field_time'], 3)} s at a slip of {field['field_slip']:.2%}",
        ),
        ("In step at the end", "yes" if field["synchronised"] else "no"),
        ("Pole slips", str(field["pole_slips"])),
    ]
    if field.get("load_angle") is not None:
        facts.append(("Load angle at the end", f"{fixed(math.degrees(field['load_angle']), 1)}°"))
    if field.get("swing_frequency") is not None:
        facts.append(("Swing frequency", f"{fixed(field['swing_frequency'], 2)} Hz"))
    yield Facts(tuple(facts))
    picture = subject.pictures.chart("pull-in")
    if picture is not None:
        yield picture


# --- reversals ------------------------------------------------------------------------------------


def reversals(subject: Subject) -> Section:
    """Reversed torque of teeth, clearances and forces."""
    title, rows = "Torque reversals", subject.rows("TorqueReversals")
    if subject.calculation.startup is None:
        return Section(title, (Paragraph("No start was calculated, hence no reversal."),))
    if not rows:
        return Section(title, (Paragraph("The train has no gear mesh and no geared coupling: no teeth "
                                         "can be unloaded."),))  # fmt: skip
    table = result_table(
        "TorqueReversals", rows, subject.shown, "Torque reversals in the start",
        note="Torques of the From side at its own speed. A reversal is one passage below zero deeper "
        "than 0.1 % of the largest torque. Margin: least over transmitted torque.",
    )  # fmt: skip
    sentences = tuple(clean(str(row["note"])) for row in rows)
    blocks: list[Block] = [
        *(Paragraph(words, "lead") for words in sentences[:3]),
        *turned(table, without=("Note",)),
    ]
    law = subject.calculation.view.contact_law
    if law:
        blocks.append(Paragraph(f"Clearances are modelled; damping law of teeth in contact: {law} "
                                "(docs/method.md, Clearances; [7]).", "note"))  # fmt: skip
    forces = (subject.calculation.startup or {}).get("bearing_forces", ())
    if forces:
        blocks.append(result_table("BearingForces", forces, subject.shown,
                                   "Largest bearing forces, without weight"))  # fmt: skip
    picture = subject.pictures.reversal()
    if picture is not None:
        blocks.append(picture)
    practice = tuple(f"{p.applies_to}, {p.service}: {p.says} ({p.source})" for p in PRACTICE_LIMITS)
    return Section(
        title, tuple(blocks), (Section("What is said in practice", (Listing(practice),)),)
    )


# --- fatigue --------------------------------------------------------------------------------------


def fatigue(subject: Subject) -> Section:
    """Damage of one start, allowable starts, S-N line and cycles."""
    title, rows = "Fatigue and allowable starts", subject.rows("AllowableStarts")
    if subject.calculation.startup is None:
        return Section(
            title, (Paragraph("No start was calculated, hence no damage and no number of starts."),)
        )
    if not rows:
        return Section(title, (Paragraph(
            "No shaft is judged: none has a stress diameter and a material with S-N points."),))  # fmt: skip
    case = subject.calculation.case
    table = result_table(
        "AllowableStarts", rows, subject.shown, "Damage of one start and allowable starts",
        note="Rounded down to whole starts. Paper count: cycle by cycle as in [1], Figure 3. "
        + by("Shear stress", "Damage"),
    )  # fmt: skip
    factor = case.starts_factor or 1.0
    required = "not stated" if case.starts_required is None else f"{case.starts_required:,.0f}"
    verdict = next((v for v in subject.rows("Verdicts") if v["check"] == "Allowable starts"), None)
    facts = [("Starts required", required), ("Factor on starts", fixed(factor, 2))]
    if verdict is not None:
        where = clean(verdict["where"] or "")
        facts.append(("Verdict", verdict["verdict"] + (f" ({where})" if where else "")))
    blocks: list[Block] = [Facts(tuple(facts)), table, *_governing(subject)]
    return Section(title, tuple(blocks))


def _governing(subject: Subject) -> Iterator[Block]:
    """S-N picture and cycles of the shaft that allows the fewest starts."""
    view, shown = subject.calculation.view, subject.shown
    governing = start_cycle_facts(view)
    picture = subject.pictures.chart("sn")
    if picture is not None:
        yield picture
    if governing["shaft"] is None:
        return
    place = ("StartCycles", "Amplitude")
    words = f"Shaft {clean(governing['shaft'])}"
    if governing["endurance"] is not None:
        limit = significant(governing["endurance"] / shown.units.factor(*place), 5)
        words += (
            f": endurance limit in torsion {limit} {shown.unit(*place)}, S-N exponent "
            f"{fixed(governing['exponent'], 2)}"
        )
    yield Paragraph(f"{words}.")
    cycles = start_cycle_rows(view)
    if cycles:
        table = result_table(
            "StartCycles", cycles, shown, f"Cycles of one start: {clean(governing['shaft'])}",
            note="The most damaging first; n cycles, N cycles to failure; a row without amplitude holds "
            f"all other cycles. Sum of the damage: {_sum(cycles)}. " + by("Damage"),
        )  # fmt: skip
        yield from folded(table)
    else:
        yield Paragraph("No cycle of the start is listed: none does damage.")


def _sum(cycles: Sequence[Mapping[str, Any]]) -> str:
    return of_dimension(math.fsum(row["damage"] for row in cycles), "Damage", "count")
