"""The start: outcome, peaks and histories; torque reversals; fatigue and allowable starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from addin.charts.start_cycles import start_cycle_facts, start_cycle_rows
from addin.contract.chart_tables import HISTORIES
from addin.report.document import Block, Column, Facts, Listing, Paragraph, Section, section
from addin.report.equations import by
from addin.report.layout import folded
from addin.report.numbers import clean, fixed, of_dimension, significant, typed
from addin.report.opening import largest_peak, largest_torque
from addin.report.subject import Subject
from addin.report.tables import turned, with_column
from engine.case.choices import MeanStress
from engine.case.coverage import links
from engine.case.practice_limits import PRACTICE_LIMITS

_CROSSINGS = (
    ("Mode", "Frequency", "Percent speed", "Time", "Average torque", "Pulsating torque", "Load torque",
     "Acceleration", "Sweep rate", "Multiple of slip"),
    ("Mode", "Frequency", "Governing element", "Peak-to-peak torque", "Peak-to-peak stress",
     "Mesh minimum torque"),
)  # fmt: skip


def start(subject: Subject) -> Section:
    """Outcome, speed, crossings, peaks and histories."""
    title, startup = "Start-up", subject.calculation.startup
    if startup is None:
        sentence = (
            "No start was calculated: the inputs contain no motor torque and no torque against "
            "time. Start-up peaks, reversals and allowable starts are therefore missing."
        )
        return section(title, Paragraph(sentence))
    parts = [_conditions(subject), _crossings(subject), _peaks(subject)]
    field = startup.get("pull_in")
    if field:
        parts.append(_pull_in(subject, field))
    histories = subject.pictures.histories(subject.calculation.case.ratings.synchronous_speed)
    if histories:
        note = (
            "Each point drawn is calculated; long histories are drawn as minimum and maximum of "
            "equal time intervals, so that no peak is lost." + _not_drawn(subject)
        )
        parts.append(section("Histories", *histories, Paragraph(note, "note")))
    outcome = Paragraph(clean(str(startup["sentence"])), "lead")
    return section(title, outcome, subject.pictures.speed_time(), parts=parts)


def _not_drawn(subject: Subject) -> str:
    """How many elements have no picture."""
    rows = len(subject.rows("StartupPeaks"))
    if rows <= HISTORIES:
        return ""
    return f" {HISTORIES} of {rows} elements are drawn."


def _conditions(subject: Subject) -> Section:
    """Under what conditions this start was calculated, and under which it was not."""
    case = subject.calculation.case
    effects = {row["effect"]: bool(row["on"]) for row in subject.rows("Effects")}
    why = {row["effect"]: clean(str(row["why"])) for row in subject.rows("Effects")}
    voltage = 1.0 if case.voltage is None else case.voltage
    effect_on_torque = "the voltage of the torque curves"
    if voltage != 1.0:
        effect_on_torque = (
            f"{typed(100.0 * voltage, 6)} % of {effect_on_torque}; motor torques times "
            f"{typed(voltage**2, 4)}"
        )
    facts = [("Voltage", effect_on_torque)]
    for name, words in (
        ("breaker closing", "Breaker closing"),
        ("pull-in", "Field application, pull-in"),
        ("aborted start", "Aborted start"),
    ):
        if name in effects:
            sentence = "simulated" if effects[name] else f"not simulated: {why[name]}"
            facts.append((words, sentence))
    tabled = case.torque_time_from_rest
    stations = ", ".join(sorted({clean(row.station or "") for row in tabled}))
    prescribed = "not part of this start; in operation they are events (table EventTorque)"
    if tabled:
        prescribed = f"torques prescribed against time act at {stations} (table TorqueTime)"
    succession = (
        "each start from rest; residual vibration, temperature and starts per hour are not "
        "considered"
    )
    facts += [("Short circuits, reclosing", prescribed), ("Starts in succession", succession)]
    return section("Conditions of the start", Facts(tuple(facts)))


def _crossings(subject: Subject) -> Section:
    title, rows = "Crossings of 2 × slip frequency", subject.rows("StartupCrossings")
    if not rows:
        sentence = "No mode is crossed by the falling 2 × slip frequency in this start."
        return section(title, Paragraph(sentence))
    captions = ("Crossings: speed and torques there", "Crossings: response there")
    notes = (by("Pulsation", "Start-up crossing"),
             "Torque and stress ranges in the crossing window of the mode; stress nominal, without SCF.")  # fmt: skip
    tables = [
        subject.table("StartupCrossings", caption, columns, note)
        for caption, columns, note in zip(captions, _CROSSINGS, notes, strict=True)
    ]
    sentences = tuple(
        f"Mode {row['mode']}: {clean(row['note'])}" for row in rows if row.get("note")
    )
    return section(title, *tables, Listing(sentences) if sentences else None)


def _peaks(subject: Subject) -> Section:
    """Extreme torques of each element, beside the torques the largest over rated torque."""
    table = subject.table(
        "StartupPeaks", "Extreme torques of the start",
        note="From rest to the end of the run, at the element's own speed; stress nominal, without SCF. "
        "Time and speed of the largest torque. Estimated error: change from step h to h/2. "
        + by("Start, exponential", "Shear stress"),
    )  # fmt: skip
    case, rows = subject.calculation.case, subject.rows("StartupPeaks")
    rated, ratio = case.ratings.rated_torque, case.element_speed_ratios
    if rated:
        cells = [fixed(largest_torque(r) * ratio[r["element"]] / rated, 2) for r in rows]
        column = Column("Peak torque / rated torque", "", "number")
        wider = with_column(table, "Torque, pk‑pk", column, cells, before=True)
        if wider is not table:
            note = " Peak torque / rated torque: referred to motor speed."
            table = replace(wider, note=table.note + note)
    peak = largest_peak(subject)
    sentence = Paragraph(f"Largest torque, referred to motor speed: {peak}.") if peak else None
    return section("Extreme torques", sentence, table)


def _pull_in(subject: Subject, field: Mapping[str, Any]) -> Section:
    applied = f"after {fixed(field['field_time'], 3)} s at a slip of {field['field_slip']:.2%}"
    facts = [
        ("Field applied", applied),
        ("Synchronised at the end", "yes" if field["synchronised"] else "no"),
        ("Pole slips", str(field["pole_slips"])),
    ]
    startup = subject.calculation.startup or {}
    if startup.get("in_step_time") is not None:
        since = f"from {fixed(startup['in_step_time'], 3)} s on (slip below {startup['in_step_slip']:.1%})"
        facts.append(("In step", since))
    if field.get("load_angle") is not None:
        facts.append(("Load angle at the end", f"{fixed(math.degrees(field['load_angle']), 1)}°"))
    if field.get("swing_frequency") is not None:
        facts.append(("Swing frequency", f"{fixed(field['swing_frequency'], 2)} Hz"))
    picture = subject.pictures.chart("pull-in")
    return section("Field application and pull-in", Facts(tuple(facts)), picture)


# --- reversals ------------------------------------------------------------------------------------


def reversals(subject: Subject) -> Section:
    """Reversed torque of teeth, clearances and forces."""
    title, rows = "Torque reversals", subject.rows("TorqueReversals")
    startup = subject.calculation.startup
    if startup is None:
        words = Paragraph("No start was calculated, hence no reversal.")
        return section(title, words)
    if not rows:
        sentence = "The train has no gear mesh and no geared coupling, so no teeth can unload."
        return section(title, Paragraph(sentence))
    table = subject.table(
        "TorqueReversals", "Torque reversals in the start",
        note="Torques of the From side at its own speed. A reversal is one passage below zero "
             "deeper than 0.1 % of the largest torque. Margin: least torque / transmitted torque.",
    )  # fmt: skip
    law, forces = subject.calculation.view.contact_law, startup.get("bearing_forces", ())
    sentence = (
        f"Clearances are modelled; damping law of teeth in contact: {law} (docs/method.md, Clearances; "
        "[7])."
    )
    practice = tuple(f"{p.applies_to}, {p.service}: {p.says} ({p.source})" for p in PRACTICE_LIMITS)
    return section(
        title,
        *(Paragraph(clean(str(row["note"])), "lead") for row in rows[:3]),
        *turned(table, without=("Note",)),
        Paragraph(sentence, "note") if law else None,
        subject.table("BearingForces", "Largest bearing forces, excluding weight", rows=forces)
        if forces
        else None,
        subject.pictures.reversal(),
        parts=[section("Limits used in practice", Listing(practice))],
    )


def makers(subject: Subject) -> Section:
    """What the makers of couplings and gears must know, a column each; shafts have the rows of the peaks."""
    title, rows = "Sheet to the makers", subject.rows("MakerSheet")
    makers_of = {str(e.element) for e in links(subject.calculation.case)}
    asked = [row for row in rows if row["element"] in makers_of]
    note = (
        "At the element's own speed, of a mesh at its From side. Vibratory torque zero-to-peak; peak and reversing torque of start "
        "and events. Required rating: continuous torque × service factor. Cycles: passages of the start beyond the offered rating."
    )
    others = ("Element", "Continuous torque", "Vibratory torque", "Peak torque", "Reversing torque", "Reversals", "Longest reversal")  # fmt: skip
    rest = [row for row in rows if row["element"] not in makers_of]
    return section(
        title,
        *(
            turned(subject.table("MakerSheet", "Couplings and gears", note=note, rows=asked))
            if asked
            else ()
        ),
        subject.table("MakerSheet", "Other elements", others, rows=rest) if rest else None,
    )


# --- fatigue --------------------------------------------------------------------------------------


def fatigue(subject: Subject) -> Section:
    """Damage of one start, allowable starts, S-N line and cycles."""
    title, rows = "Fatigue and allowable starts", subject.rows("AllowableStarts")
    if subject.calculation.startup is None:
        sentence = "No start was calculated, hence no damage and no number of starts."
        return section(title, Paragraph(sentence))
    if not rows:
        sentence = (
            "No shaft is judged: no element has a stress diameter and a material with S-N points."
        )
        return section(title, Paragraph(sentence))
    case = subject.calculation.case
    table = subject.table(
        "AllowableStarts", "Damage of one start and allowable starts",
        note="Rounded down to whole starts. Paper count: cycle by cycle as in [1], Figure 3. "
        + by("Shear stress", "Damage"),
    )  # fmt: skip
    required = "not stated" if case.starts_required is None else f"{case.starts_required:,.0f}"
    facts = [
        ("Starts required", required),
        ("Factor on starts", fixed(case.starts_factor or 1.0, 2)),
    ]
    for row in subject.rows("Verdicts"):
        if row["check"] == "Allowable starts":
            where = clean(row["where"] or "")
            facts.append(("Verdict", row["verdict"] + (f" ({where})" if where else "")))
    return section(
        title,
        Facts(tuple(facts)),
        table,
        *_limits(subject),
        subject.pictures.chart("sn"),
        *_governing(subject),
    )


def _limits(subject: Subject) -> Iterator[Block]:
    """Endurance limits with their safety; factors and their sources where any is typed."""
    case, rows = subject.calculation.case, subject.rows("FatigueLimits")
    is_factored = bool(case.fatigue_factors) or case.mean_stress == MeanStress.GOODMAN
    columns = ("Element", "Stress amplitude", "Endurance limit", "Safety factor", "Kf")
    caption, note = "Endurance limits and safety", by("Shear stress")
    if not is_factored:
        yield subject.table("FatigueLimits", caption, columns, note=note)
        return
    yield from turned(subject.table("FatigueLimits", caption, note=note), without=("Sources",))
    named = [f"{clean(r['element'])}: {clean(r['sources'])}" for r in rows if r["sources"]]
    published = (
        "Surface, size and reliability factors, notch sensitivity by Neuber and Goodman's line: Budynas and Nisbett, "
        "Shigley's Mechanical Engineering Design, 9th ed.; fillets and keyways: Pilkey, Formulas for Stress, Strain, "
        "and Structural Matrices, Table 6-1; notch sensitivity by Peterson: Dowling, Mechanical Behavior of Materials."
    )
    yield Paragraph(f"{'. '.join(named)}. {published}" if named else published, "note")


def _governing(subject: Subject) -> Iterator[Block]:
    """S-N line and cycles of the shaft that allows the fewest starts."""
    view = subject.calculation.view
    governing = start_cycle_facts(view)
    if governing["shaft"] is None:
        return
    place, shaft = ("StartCycles", "Amplitude"), clean(governing["shaft"])
    words = f"Shaft {shaft}"
    if governing["endurance"] is not None:
        limit = significant(subject.value(governing["endurance"], *place), 5)
        words += (
            f": endurance limit in torsion {limit} {subject.unit(*place)}, S-N exponent "
            f"{fixed(governing['exponent'], 2)}"
        )
    yield Paragraph(f"{words}.")
    cycles = start_cycle_rows(view)
    if not cycles:
        yield Paragraph("No damaging cycle in the start.")
        return
    damage = of_dimension(math.fsum(row["damage"] for row in cycles), "Damage", "count")
    note = (
        "The most damaging first; n cycles, N cycles to failure; a row without amplitude holds all "
        f"other cycles. Sum of the damage: {damage}. {by('Damage')}"
    )
    yield from folded(
        subject.table("StartCycles", f"Cycles of one start: {shaft}", note=note, rows=cycles)
    )
