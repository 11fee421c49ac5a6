"""Effects, accuracy, equations, checks and audit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from addin.charts.start_cycles import start_cycle_facts, start_cycle_rows
from addin.contract.sources import REFERENCES
from addin.report.document import (
    Block,
    Column,
    Facts,
    Listing,
    Paragraph,
    Section,
    SignatureBox,
    Table,
)
from addin.report.equations import EQUATIONS, METHODS, by
from addin.report.numbers import clean, scientific
from addin.report.subject import Subject
from addin.report.tables import result_table, without_blanks
from engine.case.result_words import NoNumber

_EFFECT_COLUMNS = ("Effect", "Choice", "Deciding number", "Limit", "Bound", "Why")
#: Items of table Audit that tell how accurate the answers are.
_ACCURACY_ITEMS = (
    "Modes by",
    "Shaft segments",
    "Largest neglected damping term",
    "Method of the start",
    "Wanted error of peak torques",
    "Estimated error of peak torques",
    "of which modes left out",
    "Largest step",
)
#: Items that stand in other sections, or below.
_TOLD_ELSEWHERE = (
    "Equation: ",
    "Time spent: ",
    "Warning ",
    "Estimated error of starts",
    "Sensitive",
)
#: Agreement asked of a formula evaluated twice. [1]
_SAME = 1e-9


def effects(subject: Subject) -> Section:
    """What was simulated, and what was left out and why."""
    rows = subject.rows("Effects")
    title = "Effects simulated and left out"
    if not rows:
        return Section(
            title, (Paragraph("No start was calculated, so there was no effect to decide on."),)
        )
    parts = []
    simulated = (
        "No start was calculated."
        if subject.calculation.startup is None
        else "Nothing beyond the linear start was called for."
    )
    for heading, on, none in (
        ("Simulated", True, simulated),
        ("Left out, and why", False, "Nothing was left out."),
    ):
        some = [row for row in rows if bool(row["on"]) is on]
        caption = "Effects simulated" if on else "Effects left out"
        table = result_table("Effects", some, subject.shown, caption, _EFFECT_COLUMNS)
        parts.append(Section(heading, (table,) if some else (Paragraph(none),)))
    sentence = (
        "Each effect is decided by a number, compared with a limit. Bound: the most that leaving it out "
        "changes an answer; 0 means exactly nothing, blank that it is on or that nothing is known of it."
    )
    plans = tuple(
        f"Plan {plan['number']}: {clean(str(plan['reason']))}"
        for plan in subject.calculation.view.plans
    )
    told: tuple[Block, ...] = (Listing(plans),) if plans else ()
    return Section(title, (Paragraph(sentence), *told), tuple(parts))


def accuracy(subject: Subject) -> Section:
    """Estimated errors, and what they cost."""
    found = [
        (item, clean(subject.audit[item])) for item in _ACCURACY_ITEMS if item in subject.audit
    ]
    found += _starts_errors(subject)
    if "Sensitive" in subject.audit:
        found.append(("Sensitive", clean(subject.audit["Sensitive"])))
    columns = (
        "Method",
        "Setting",
        "Error peak",
        "Error starts",
        *(("Time",) if subject.show_times else ()),
    )
    cost = result_table(
        "AccuracyCost", subject.rows("AccuracyCost"), subject.shown, "Errors and cost of each analysis",
        columns,
        "Errors are estimated by the calculation, from a step h to h/2. "
        + ("Times are those measured when this document was made; they differ from run to run."
           if subject.show_times else "Measured times are left out of a document with a fixed date."),
    )  # fmt: skip
    sentence = (
        "The error of an answer is asked for, not a time step: peaks and starts are calculated at a step "
        "and at half of it, and the step is halved until their change is below the wanted error."
    )
    # an analysis without an error of its own and without a time has nothing to say here
    rows = tuple(row for row in cost.rows if any(row[1:]))
    shown = without_blanks(Table(cost.caption, cost.columns, rows, cost.note))
    table: tuple[Block, ...] = (shown,) if rows else ()
    return Section(
        "Accuracy and what it cost",
        (Paragraph(sentence), Facts(tuple(found)), *table),
        (_study(subject),),
    )


def _study(subject: Subject) -> Section:
    """Error against time, where the workbook holds a study of these inputs."""
    title, study = "Error against time", subject.study
    if study is None or not study.belongs_to(subject.calculation.case_sha256):
        stands = "No study of error against time stands in the input file."
        if study is not None:
            stands = (
                "The study of error against time in the workbook belongs to other inputs, and is not "
                f"shown ({clean(study.inputs) or 'it does not say to which'})."
            )
        how = "torsionbook accuracy FILE makes one and writes it into a copy of the workbook; a report of that copy shows it here."  # fmt: skip
        if not subject.shown.is_workbook:
            how = "torsionbook accuracy makes one of a case file too; a report shows it where the input is a workbook."  # fmt: skip
        return Section(title, (Paragraph(f"{stands} {how}"),))
    picture = subject.pictures.chart("accuracy")
    blocks: list[Block] = [Paragraph(clean(study.sentence), "lead")]
    if picture is not None:
        blocks.append(picture)
    if study.rows:
        blocks.append(
            result_table(
                "AccuracyCost",
                study.rows,
                subject.shown,
                "Error against time of this case",
                note="As recorded in the workbook: what torsionbook accuracy measured, and when.",
            )
        )
    told = " ".join(filter(None, (clean(study.reference), clean(study.inputs))))
    return Section(title, (*blocks, *((Paragraph(told, "note"),) if told else ())))


def _starts_errors(subject: Subject) -> list[tuple[str, str]]:
    """Of each shaft with a number of starts; the unlimited ones together."""
    head = "Estimated error of starts, "
    errors = {
        item.removeprefix(head): value
        for item, value in subject.audit.items()
        if item.startswith(head)
    }
    found = [(f"{head}{clean(k)}", clean(v)) for k, v in errors.items() if v != NoNumber.UNLIMITED]
    unlimited = sum(1 for value in errors.values() if value == NoNumber.UNLIMITED)
    if unlimited:
        shafts = "1 shaft" if unlimited == 1 else f"{unlimited} shafts"
        found.append(("Unlimited starts", f"{shafts}: no cycle does damage"))
    return found


def equations(subject: Subject) -> Section:
    """The equations with their sources."""
    sources = tuple((f"[{k}]", source.full) for k, source in enumerate(REFERENCES, start=1))
    return Section(
        "Equations and references",
        (
            Paragraph("Symbols as in the nomenclature of the program (docs/nomenclature.md)."),
            *EQUATIONS,
        ),
        (
            Section("Methods without a formula of their own", (Facts(METHODS),)),
            Section("References", (Facts(sources, 9.0),)),
        ),
    )


def checks(subject: Subject) -> Section:
    """Arithmetic done twice, and room for the checker."""
    columns = (
        Column("Check", "", "sentence"),
        Column("Values", "", "number"),
        Column("Largest difference", "", "number"),
        Column("Result", "", "verdict"),
    )
    rows = tuple(
        (
            name,
            str(count),
            "0" if worst == 0.0 else scientific(worst, 1),
            "ok" if worst <= _SAME else "differs",
        )
        for name, count, worst in _checks(subject)
    )
    sentence = (
        "Results that are simple arithmetic on other results were calculated a second time from the "
        "numbers of this document; relative differences. A checker repeats them by hand."
    )
    by_hand = (
        "Inputs compared with the drawings and the makers' data sheets, with their revisions.",
        "Units above the columns are those of the numbers.",
        "Damping, SCF and S-N data are justified.",
        "Effects left out are acceptable for this train.",
        "Verdicts marked not judged have been dealt with.",
        "Digest on the cover equals that of the file: torsionbook verify FILE.",
    )
    names = (("Prepared by", subject.words("prepared_by")), ("Checked by", subject.words("checked_by")),
             ("Approved by", ""))  # fmt: skip
    table = Table("Arithmetic done twice", columns, rows)
    return Section(
        "Checks and signatures",
        (Paragraph(sentence), *((table,) if rows else ())),
        (
            Section("To be checked by hand", (Listing(by_hand, "☐"),)),
            Section("Signatures", (SignatureBox(names),)),
        ),
    )


def _checks(subject: Subject) -> Iterator[tuple[str, int, float]]:
    """Name, number of values and largest relative difference of each check."""
    case = subject.calculation.case
    line = case.ratings.line_frequency
    modes = {
        row["mode"]: row["frequency"] for row in subject.rows("NaturalFrequencies") if row["mode"]
    }
    if line:
        pairs = [
            (row["percent_speed"], 1.0 - row["frequency"] / (2.0 * line))
            for row in subject.rows("NaturalFrequencies")
            if row.get("percent_speed") is not None
        ]
        yield from _compared(f"Speed of a crossing. {by('Start-up crossing')}", pairs)
    pairs = [
        (
            row["margin"],
            abs(modes[row["mode"]] - row["excitation_frequency"]) / row["excitation_frequency"],
        )
        for row in subject.rows("SeparationMargins")
        if row["excitation_frequency"] and row["mode"] in modes
    ]
    yield from _compared(f"Margin at the speed shown. {by('Separation margin')}", pairs)
    strength = {m.material: m.uts for m in case.materials}
    material = {e.element: e.material for e in case.elements}
    pairs = [
        (row["allowable"], (strength.get(material.get(row["element"])) or math.nan) / 25.0)
        for row in subject.rows("SteadyState")
        if row.get("allowable") is not None
    ]
    yield from _compared(f"Allowable stress. {by('Allowable vibratory stress')}", pairs)
    pairs = [
        (row["allowable_starts"], 1.0 / row["damage"])
        for row in subject.rows("AllowableStarts")
        if row.get("damage") and row.get("allowable_starts")
    ]
    yield from _compared(f"Allowable starts. {by('Damage')}", pairs)
    yield from _compared(
        "Sum of the cycles listed against the damage of one start.", _sums(subject)
    )


def _sums(subject: Subject) -> list[tuple[float, float]]:
    view = subject.calculation.view
    shaft = start_cycle_facts(view)["shaft"]
    damage = next(
        (r.get("damage") for r in subject.rows("AllowableStarts") if r["element"] == shaft), None
    )
    if not damage:
        return []
    return [(damage, math.fsum(row["damage"] for row in start_cycle_rows(view)))]


def _compared(name: str, pairs: list[tuple[Any, float]]) -> Iterator[tuple[str, int, float]]:
    if pairs:
        # a margin may be zero but for rounding: differences below 1e-12 are none
        worst = max(abs(a - b) / max(abs(a), abs(b), 1e-3) for a, b in pairs)
        yield name, len(pairs), worst


def audit(subject: Subject) -> Section:
    """Digest, versions, settings."""
    rows = [
        (clean(item), clean(value))
        for item, value in subject.audit.items()
        if not item.startswith(_TOLD_ELSEWHERE) and item not in _ACCURACY_ITEMS
    ]
    sentence = (
        "The digest is taken of all inputs that can change a result, in SI, rounded to twelve significant "
        "digits; title block and descriptions are left out. Retyping a quantity in another unit does not "
        "change it."
    )
    spent = [
        (item.removeprefix("Time spent: "), value)
        for item, value in subject.audit.items()
        if item.startswith("Time spent: ")
    ]
    blocks: list[Block] = [Paragraph(sentence), Facts(tuple(rows))]
    warnings = subject.calculation.warnings
    if warnings:
        blocks += [Paragraph("Warnings:"), Listing(tuple(clean(one) for one in warnings))]
    if spent and subject.show_times:
        text = "; ".join(f"{name} {value}" for name, value in spent)
        blocks.append(Paragraph(f"Time spent: {text}.", "note"))
    return Section("Audit", tuple(blocks))
