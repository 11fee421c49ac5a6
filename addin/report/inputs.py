"""The inputs as typed, the train drawn, and the model made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from addin.calculation.audit import library_words
from addin.charts.data import stiffnesses_of
from addin.contract import tables as contract
from addin.report.document import Block, Column, Paragraph, Section, Table, section
from addin.report.equations import by
from addin.report.layout import folded
from addin.report.numbers import clean, fixed, significant
from addin.report.subject import Subject
from addin.report.tables import input_table, turned, without_blanks
from addin.report.units import entry_text

#: Parts of table Elements: title, and the columns beside the name of the element.
_ELEMENT_PARTS = {
    "Elements: connections and elasticity": (
        "Kind", "From", "To", "Stiffness", "Damping", "Loss factor",
    ),
    "Elements: geometry": ("OD", "ID", "Length", "Shear modulus", "Density"),
    "Elements: section where stress is judged": (
        "Stress diameter", "Stress bore", "SCF", "Material",
    ),
    "Elements: limits of the makers": (
        "Service factor", "Rated torque", "Peak torque limit", "Reversal limit", "Vibratory limit",
    ),
}  # fmt: skip
#: The title block, which stands on the cover.
_TITLE_BLOCK = "Document"


def inputs(subject: Subject) -> Section:
    """All inputs, and the mass-elastic model as calculated."""
    how = "Numbers as typed, in the units typed."
    if not subject.shown.is_workbook:
        how = (
            "Numbers with a unit are shown as typed; plain numbers (SI) are converted to usual "
            "units with seven digits."
        )
    sentence = f"{how} Inertias, stiffnesses and torques are at each shaft's own speed."
    parts = (_case, _train, _model, _torques, _fatigue, _choices)
    return section("Inputs", Paragraph(sentence), parts=[part(subject) for part in parts])


def _case(subject: Subject) -> Section:
    """Scalars; a blank one with what a blank means, or not at all."""
    rows = []
    for spec in contract.SCALARS:
        if spec.group == _TITLE_BLOCK:
            continue
        text, unit = entry_text(subject.read.typed.scalars.get(spec.name), spec, subject.shown)
        if text:
            rows.append((spec.name_in_words, f"{text} {unit}".strip(), ""))
        elif spec.default_text:
            rows.append((spec.name_in_words, "", spec.default_text))
    value, blank = Column("Value", "", "number"), Column("Blank means", "", "sentence")
    ratings = subject.calculation.case.ratings
    used = []
    for name, number, place, decimals in (
        ("Line frequency", ratings.line_frequency, ("NaturalFrequencies", "Frequency"), 2),
        ("Synchronous speed", ratings.synchronous_speed, ("SeparationMargins", "Speed"), 1),
        ("Rated torque", ratings.rated_torque, ("StartupPeaks", "Maximum torque"), None),
    ):
        if number is not None:
            number = subject.value(number, *place)
            shown = significant(number, 6) if decimals is None else fixed(number, decimals)
            used.append(f"{name} {shown} {subject.unit(*place)}")
    if ratings.pole_pairs:
        used.append(f"{2 * ratings.pole_pairs} poles")
    sentence = f"Ratings used (blank ones follow from the others): {'; '.join(used)}."
    return section(
        "Case",
        Table("Case", (Column("Input"), value, blank), tuple(rows)),
        Paragraph(sentence, "note") if used else None,
    )


def _table(
    subject: Subject, name: str, caption: str = "", columns: Sequence[str] = ()
) -> Table | None:
    rows = subject.read.typed.tables.get(name, [])
    return input_table(name, rows, subject.shown, caption or contract.caption(name), columns)


def _absent(names: Sequence[str], joint: str) -> Paragraph | None:
    return Paragraph(f"The inputs contain {joint.join(names)}.", "note") if names else None


def _train(subject: Subject) -> Section:
    elements = [_table(subject, "Elements", *part) for part in _ELEMENT_PARTS.items()]
    meshes = _table(subject, "Meshes")
    stepped = [t for name in ("Sections", "SectionMaterials") if (t := _table(subject, name))]
    absent = [] if subject.read.typed.tables.get("Elements") else ["no elements"]
    if meshes is None:
        absent.append("no gear geometry, clearances or bearings (table Meshes)")
    return section(
        "Train",
        *subject.pictures.train(),
        _table(subject, "Stations"),
        *(piece for table in elements if table is not None for piece in folded(table)),
        subject.pictures.chart("profile") if stepped else None,
        *(piece for table in stepped for piece in folded(table)),
        *(turned(meshes) if meshes is not None else ()),
        _absent(absent, " and "),
    )


def _model(subject: Subject) -> Section:
    """Inertias and stiffnesses as calculated, at their own speed and referred to the motor."""
    stiffness = _stiffnesses(subject)
    segments = subject.calculation.results.segments
    text = ", ".join(f"{clean(name)} in {count}" for name, count in segments)
    sentence = (
        f"The inertia of shafts with a density or sections is distributed in segments: {text}."
    )
    return section(
        "Mass-elastic model as calculated",
        _inertias(subject),
        stiffness if stiffness.rows else None,
        subject.table("SectionResults") if subject.calculation.case.sections else None,
        Paragraph(sentence, "note") if segments else None,
    )


def _inertias(subject: Subject) -> Table:
    train = subject.calculation.results.train
    speed = subject.calculation.case.ratings.synchronous_speed
    of_inertia, of_speed = ("Stations", "Inertia"), ("SeparationMargins", "Speed")
    rows = []
    for k, name in enumerate(train.stations):
        ratio = float(train.speed_ratio[k])
        inertia = subject.value(float(train.node_inertia[k]), *of_inertia)
        shown = fixed(subject.value(ratio * speed, *of_speed), 1) if speed else ""
        referred = significant(inertia * ratio**2, 5)
        rows.append((clean(name), fixed(ratio, 4), shown, significant(inertia, 5), referred))
    unit = subject.unit(*of_inertia)
    columns = (
        Column("Station"),
        Column("Speed ratio", "", "number"),
        Column("Synchronous speed of the station", subject.unit(*of_speed), "number"),
        Column("Inertia", unit, "number"),
        Column("Referred to the motor", unit, "number"),
    )
    note = (
        "Station inertia including its part of the distributed shafts; referred = own × "
        "speed ratio²."
    )
    return Table("Inertias", columns, tuple(rows), note)


def _stiffnesses(subject: Subject) -> Table:
    train, case = subject.calculation.results.train, subject.calculation.case
    flanks = {train.elements[f.element]: f.stiffness for f in train.flanks}
    speeds, typed = case.element_speed_ratios, stiffnesses_of(case)
    place = ("Elements", "Stiffness")
    rows = []
    for e in case.elements:
        stiffness = flanks.get(e.element or "") or typed[str(e.element)]
        if e.kind == "gear mesh" and not stiffness:
            own = referred = "rigid"
        else:
            number = subject.value(stiffness, *place)
            own, referred = (significant(n, 5) for n in (number, number * speeds[e.element] ** 2))
        # the diameter that counts for stress; blank where none is stated
        diameter = e.stress_diameter or e.od
        across = significant(subject.value(diameter, "Elements", "OD"), 5) if diameter else ""
        names = (clean(name or "") for name in (e.element, e.from_, e.to))
        rows.append((*names, own, referred, across))
    unit = subject.unit(*place)
    columns = (
        Column("Element"),
        Column("From"),
        Column("To"),
        Column("Stiffness", unit, "number"),
        Column("Referred to the motor", unit, "number"),
        Column("Diameter", subject.unit("Elements", "OD"), "number"),
    )
    note = (
        "Stiffness of a gear mesh: on the From side. Diameter: stress diameter, else outer "
        f"diameter. {by('Shaft stiffness')}"
    )
    return without_blanks(Table("Stiffnesses", columns, tuple(rows), note))


def _torques(subject: Subject) -> Section:
    blocks: list[Block] = []
    absent = []
    for name, without in (
        ("MotorTorque", "no motor torque"),
        ("LoadTorque", "no load torque"),
        ("TorqueTime", "no prescribed torque against time"),
        ("EventTorque", "no torque of an event in operation"),
        ("MotorEvents", "no event of a motor"),
    ):
        table = _table(subject, name)
        if table is None:
            absent.append(without)
        else:
            blocks += folded(_shortened(table))
    for name in ("SupplyVoltage", "Supply"):
        supply = _table(subject, name)
        blocks += [] if supply is None else folded(_shortened(supply))
    motors = [table for name in ("MotorData", "MotorCircuit") if (table := _table(subject, name))]
    if motors:
        absent = [words for words in absent if words != "no motor torque"]
        blocks += [piece for table in motors for piece in turned(table)]
        blocks.append(
            Paragraph("Torque curves that are not typed follow from the motor data.", "note")
        )
    pictures = subject.pictures.chart("torque"), subject.pictures.chart("motor-curves")
    return section("Torques", *pictures, *blocks, _absent(absent, ", "))


#: Rows of a torque curve shown at its beginning and at its end, where it is very long.
_CURVE_ENDS = 120


def _shortened(table: Table) -> Table:
    """A curve of thousands of points by its ends; the digest covers them all."""
    if len(table.rows) <= 3 * _CURVE_ENDS:
        return table
    left_out = len(table.rows) - 2 * _CURVE_ENDS
    note = (
        f"{left_out:,} of {len(table.rows):,} rows are omitted here (the middle of the "
        "table); the input file holds all, and the digest on the cover covers them."
    )
    return replace(table, rows=(*table.rows[:_CURVE_ENDS], *table.rows[-_CURVE_ENDS:]), note=note)


def _fatigue(subject: Subject) -> Section:
    materials, points = _table(subject, "Materials"), _table(subject, "SNPoints")
    sentence = (
        "The inputs contain no material and no S-N data: stresses and allowable starts are "
        "not judged."
    )
    steels = [
        Paragraph(f"Strength of {row.material}: {library_words(row.library_steel)}.")
        for row in subject.calculation.case.materials
        if row.library_steel is not None
    ]
    empty = materials is None and points is None and not steels
    return section(
        "Materials and S-N data",
        materials,
        *steels,
        points,
        *(folded(factors) if (factors := _table(subject, "FatigueFactors")) is not None else ()),
        Paragraph(sentence) if empty else None,
    )


def _choices(subject: Subject) -> Section:
    blanks = {
        "ModeDamping": "No damping of individual modes; DampingRatio applies to all.",
        "Excitations": "Table Excitations is blank; defaults: 1× and 2× of every shaft speed and 1× and 2× "
        "line frequency, 1 % zero-to-peak of the transmitted torque.",
        "EffectChoices": "Effects: none forced on or off; the plan decides.",
    }
    blocks = (_table(subject, name) or Paragraph(blank) for name, blank in blanks.items())
    return section("Damping, excitations and effects", *blocks)
