"""The inputs as typed, the train drawn, and the model made of them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from addin.charts.data import stiffness_of
from addin.contract import tables as contract
from addin.report.document import Block, Column, Paragraph, Section, Table
from addin.report.equations import by
from addin.report.layout import folded
from addin.report.numbers import clean, fixed, significant
from addin.report.subject import Subject
from addin.report.tables import input_tables, turned, without_blanks
from addin.report.units import entry_text
from engine.case.data import ElementRow

#: Columns of Elements that belong together, the name of the element in each part.
_ELEMENT_PARTS = (
    ("Kind", "From", "To", "Stiffness", "Damping", "Loss factor"),
    ("OD", "ID", "Length", "Shear modulus", "Density"),
    ("Stress diameter", "Stress bore", "SCF", "Material"),
    ("Rated torque", "Peak torque limit", "Reversal limit", "Vibratory limit"),
)
#: Title of each part.
_ELEMENT_TITLES = (
    "Elements: connections and elasticity",
    "Elements: geometry",
    "Elements: section where stress is judged",
    "Elements: limits of the makers",
)
#: The title block, which stands on the cover.
_TITLE_BLOCK = "Document"


def inputs(subject: Subject) -> Section:
    """All inputs, and the mass-elastic model as calculated."""
    how = (
        "Numbers stand as typed, in the units typed."
        if subject.shown.is_workbook
        else "Numbers with a unit stand as typed; plain numbers, which are in SI, in usual units to "
        "seven digits."
    )
    return Section(
        "Inputs",
        (
            Paragraph(
                f"{how} Inertias, stiffnesses and torques are at the own speed of each shaft."
            ),
        ),
        (
            _case(subject),
            _train(subject),
            _model(subject),
            _torques(subject),
            _fatigue(subject),
            _choices(subject),
        ),
    )


def _case(subject: Subject) -> Section:
    """Scalars; a blank one with what a blank means, or not at all."""
    rows = []
    for spec in contract.SCALARS:
        if spec.group == _TITLE_BLOCK:
            continue
        text, unit = entry_text(subject.read.typed.scalars.get(spec.name), spec, subject.shown)
        if text:
            rows.append((_spaced(spec.name), f"{text} {unit}".strip(), ""))
        elif spec.default_text:
            rows.append((_spaced(spec.name), "", spec.default_text))
    columns = (
        Column("Input"),
        Column("Value", "", "number"),
        Column("Blank means", "", "sentence"),
    )
    ratings = subject.calculation.case.ratings
    used = [
        ("Line frequency", ratings.line_frequency, "NaturalFrequencies", "Frequency", 2),
        ("Synchronous speed", ratings.synchronous_speed, "SeparationMargins", "Speed", 1),
        ("Rated torque", ratings.rated_torque, "StartupPeaks", "Maximum torque", None),
    ]
    found = []
    for name, value, table, column, decimals in used:
        if value is not None:
            number = value / subject.shown.units.factor(table, column)
            shown = significant(number, 6) if decimals is None else fixed(number, decimals)
            found.append(f"{name} {shown} {subject.shown.unit(table, column)}")
    if ratings.pole_pairs:
        found.append(f"{2 * ratings.pole_pairs} poles")
    blocks: list[Block] = [Table("Case", columns, tuple(rows))]
    if found:
        blocks.append(
            Paragraph(
                f"Ratings used, each from the others where blank: {'; '.join(found)}.", "note"
            )
        )
    return Section("Case", tuple(blocks))


def _spaced(name: str) -> str:
    """``LineFrequency`` → ``Line frequency``."""
    words = re.findall(r"[A-Z][a-z]+|[A-Z]+(?![a-z])", name)
    return " ".join([words[0], *(w if w.isupper() else w.lower() for w in words[1:])])


def _tables(
    subject: Subject, name: str, groups: Sequence[Sequence[str]] = (), caption: str = ""
) -> list[Table]:
    rows = subject.read.typed.tables.get(name, [])
    return (
        input_tables(name, rows, subject.shown, caption or contract.caption(name), groups)
        if rows
        else []
    )


def _train(subject: Subject) -> Section:
    blocks: list[Block] = [*subject.pictures.train()]
    blocks += _tables(subject, "Stations")
    for title, group in zip(_ELEMENT_TITLES, _ELEMENT_PARTS, strict=True):
        for table in _tables(subject, "Elements", (group,), title):
            blocks += folded(table)
    meshes = _tables(subject, "Meshes")
    for table in meshes:
        blocks += turned(table)
    absent = [] if subject.read.typed.tables.get("Elements") else ["no elements"]
    if not meshes:
        absent.append("no gear geometry, clearances or bearings (table Meshes)")
    if absent:
        blocks.append(Paragraph(f"The inputs hold {' and '.join(absent)}.", "note"))
    return Section("Train", tuple(blocks))


def _model(subject: Subject) -> Section:
    """Inertias and stiffnesses as calculated, at their own speed and referred to the motor."""
    blocks: list[Block] = [*_inertias(subject)]
    stiffness = _stiffnesses(subject)
    if stiffness.rows:
        blocks.append(stiffness)
    segments = subject.calculation.results.segments
    if segments:
        text = ", ".join(f"{clean(name)} in {count}" for name, count in segments)
        blocks.append(
            Paragraph(
                f"Shafts with a density carry their own inertia in equal segments: {text}.", "note"
            )
        )
    return Section("Mass-elastic model as calculated", tuple(blocks))


def _inertias(subject: Subject) -> Iterator[Table]:
    train = subject.calculation.results.train
    place = ("Stations", "Inertia")
    unit, factor = subject.shown.unit(*place), subject.shown.units.factor(*place)
    speed = subject.calculation.case.ratings.synchronous_speed
    speed_place = ("SeparationMargins", "Speed")
    rows = []
    for k, name in enumerate(train.stations):
        ratio, inertia = float(train.speed_ratio[k]), float(train.node_inertia[k]) / factor
        shown = fixed(ratio * speed / subject.shown.units.factor(*speed_place), 1) if speed else ""
        rows.append(
            (
                clean(name),
                fixed(ratio, 4),
                shown,
                significant(inertia, 5),
                significant(inertia * ratio**2, 5),
            )
        )
    columns = (
        Column("Station"),
        Column("Speed ratio", "", "number"),
        Column("Speed at synchronism", subject.shown.unit(*speed_place), "number"),
        Column("Inertia", unit, "number"),
        Column("Referred to the motor", unit, "number"),
    )
    yield Table(
        "Inertias", columns, tuple(rows),
        "Inertia of a station with its share of distributed shafts; referred = own × speed ratio².",
    )  # fmt: skip


def _stiffnesses(subject: Subject) -> Table:
    train, case = subject.calculation.results.train, subject.calculation.case
    flanks = {train.elements[f.element]: f.stiffness for f in train.flanks}
    speeds = case.element_speed_ratios
    place = ("Elements", "Stiffness")
    unit, factor = subject.shown.unit(*place), subject.shown.units.factor(*place)
    rows = []
    for e in case.elements:
        stiffness = flanks.get(e.element or "") or stiffness_of(e)
        own = speeds[e.element]
        rigid = e.kind == "gear mesh" and not stiffness
        shown = "rigid" if rigid else significant(stiffness / factor, 5)
        referred = "rigid" if rigid else significant(stiffness / factor * own**2, 5)
        rows.append(
            (
                clean(e.element or ""),
                clean(e.from_ or ""),
                clean(e.to or ""),
                shown,
                referred,
                _least_diameter(subject, e),
            )
        )
    columns = (
        Column("Element"),
        Column("From"),
        Column("To"),
        Column("Stiffness", unit, "number"),
        Column("Referred to the motor", unit, "number"),
        Column("Diameter", subject.shown.unit("Elements", "OD"), "number"),
    )
    note = (
        "Of a gear mesh on the From side. Diameter: where stress is judged, else the outer one. "
        f"{by('Shaft stiffness')}"
    )
    return without_blanks(Table("Stiffnesses", columns, tuple(rows), note))


def _least_diameter(subject: Subject, element: ElementRow) -> str:
    """The diameter that counts for stress; blank where none is stated."""
    diameter = element.stress_diameter or element.od
    if not diameter:
        return ""
    return significant(diameter / subject.shown.units.factor("Elements", "OD"), 5)


def _torques(subject: Subject) -> Section:
    blocks: list[Block] = []
    picture = subject.pictures.chart("torque")
    if picture is not None:
        blocks.append(picture)
    absent = []
    for name in ("MotorTorque", "LoadTorque", "TorqueTime"):
        found = _tables(subject, name)
        for table in found:
            blocks += folded(_shortened(table))
        if not found:
            absent.append({"MotorTorque": "no motor torque", "LoadTorque": "no load torque"}.get(
                name, "no prescribed torque against time"))  # fmt: skip
    if absent:
        blocks.append(Paragraph(f"The inputs hold {', '.join(absent)}.", "note"))
    return Section("Torques", tuple(blocks))


#: Rows of a torque curve shown at its beginning and at its end, where it is very long.
_CURVE_ENDS = 120


def _shortened(table: Table) -> Table:
    """A curve of thousands of points by its ends; the digest covers them all."""
    if len(table.rows) <= 3 * _CURVE_ENDS:
        return table
    left_out = len(table.rows) - 2 * _CURVE_ENDS
    note = (
        f"{left_out:,} of {len(table.rows):,} rows in the middle are left out here; they are in the "
        "input file, and the digest on the cover covers them."
    )
    return replace(table, rows=(*table.rows[:_CURVE_ENDS], *table.rows[-_CURVE_ENDS:]), note=note)


def _fatigue(subject: Subject) -> Section:
    found: list[Block] = [*_tables(subject, "Materials"), *_tables(subject, "SNPoints")]
    if not found:
        found.append(Paragraph("The inputs hold no material and no S-N data: no stress limit and no "
                               "number of starts can be judged."))  # fmt: skip
    return Section("Materials and S-N data", tuple(found))


def _choices(subject: Subject) -> Section:
    blocks: list[Block] = []
    for name, blank in (
        ("ModeDamping", "Damping of single modes: none stated; DampingRatio holds for all."),
        (
            "Excitations",
            "Excitations: blank, hence 1× and 2× of every shaft speed and 1× and 2× line frequency, "
            "1 % zero-to-peak of the transmitted torque.",
        ),
        ("EffectChoices", "Effects: none forced on or off; the plan decides."),
    ):
        found = _tables(subject, name)
        blocks += found or [Paragraph(blank)]
    return Section("Damping, excitations and effects", tuple(blocks))
