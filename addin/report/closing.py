"""Effects, accuracy, equations, checks and audit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from addin.charts.start_cycles import start_cycle_facts, start_cycle_rows
from addin.contract.sources import REFERENCES
from addin.report.document import Column, Facts, Listing, Paragraph, Section, Table, section
from addin.report.equations import EQUATIONS, METHODS, by
from addin.report.numbers import clean, scientific
from addin.report.subject import Subject
from addin.report.tables import without_blanks
from engine.case.result_words import NoNumber
from engine.start.start_fatigue import is_counted

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
        sentence = "No start was calculated, so no effects were considered."
        return section(title, Paragraph(sentence))
    simulated = "No effect beyond the linear start was required."
    if subject.calculation.startup is None:
        simulated = "No start was calculated."
    parts = []
    for heading, caption, on, none in (
        ("Simulated", "Effects simulated", True, simulated),
        ("Left out, and why", "Effects left out", False, "Nothing was left out."),
    ):
        some = [row for row in rows if bool(row["on"]) is on]
        table = subject.table("Effects", caption, _EFFECT_COLUMNS, rows=some)
        parts.append(section(heading, table if some else Paragraph(none)))
    sentence = (
        "For each effect, one deciding number is compared with a limit. Bound: largest "
        "change of a result if the effect is left out; 0 = none, blank = effect simulated or "
        "bound unknown."
    )
    plans = tuple(
        f"Plan {plan['number']}: {clean(str(plan['reason']))}"
        for plan in subject.calculation.view.plans
    )
    return section(title, Paragraph(sentence), Listing(plans) if plans else None, parts=parts)


def accuracy(subject: Subject) -> Section:
    """Estimated errors, and what they cost."""
    facts = [
        (item, clean(subject.audit[item])) for item in _ACCURACY_ITEMS if item in subject.audit
    ]
    facts += _starts_errors(subject)
    if "Sensitive" in subject.audit:
        facts.append(("Sensitive", clean(subject.audit["Sensitive"])))
    columns = ["Method", "Setting", "Error peak", "Error starts"]
    times = "Measured times are left out: SOURCE_DATE_EPOCH sets the date of this document, so that the same inputs give the same document."
    if subject.show_times:
        columns.append("Time")
        times = "Times were measured when this document was made; they vary between runs."
    note = f"Errors are estimated by the calculation, as the change from step h to h/2. {times}"
    cost = subject.table("AccuracyCost", "Errors and cost of each analysis", columns, note)
    sentence = (
        "The user states the error wanted, not a time step: peaks and starts are calculated "
        "with a step and half of it, and the step is halved until their change is below that "
        "error."
    )
    # an analysis without an error of its own and without a time has nothing to say here
    rows = tuple(row for row in cost.rows if any(row[1:]))
    return section(
        "Accuracy and what it cost",
        Paragraph(sentence),
        Facts(tuple(facts)),
        without_blanks(replace(cost, rows=rows)) if rows else None,
        parts=[_study(subject)],
    )


def _study(subject: Subject) -> Section:
    """Error against time, where the workbook holds a study of these inputs."""
    title, study = "Error against time", subject.study
    if study is None or not study.belongs_to(subject.calculation.case_sha256):
        stands = "The input file contains no study of error against time."
        if study is not None:
            stands = (
                "The study of error against time in the workbook belongs to other inputs and is "
                f"omitted ({clean(study.inputs) or 'inputs not recorded'})."
            )
        how = (
            "It is made by the command accuracy, and printed here from the workbook that holds it."
        )
        if not subject.shown.is_workbook:
            how = "It is made by the command accuracy, and printed here from a workbook, not from a case JSON."
        return section(title, Paragraph(f"{stands} {how}"))
    caption = "Error against time of this case"
    note = "Recorded in the workbook by torsionbook accuracy, with its date."
    origin = " ".join(filter(None, (clean(study.reference), clean(study.inputs))))
    return section(
        title,
        Paragraph(clean(study.sentence), "lead"),
        subject.pictures.chart("accuracy"),
        subject.table("AccuracyCost", caption, note=note, rows=study.rows) if study.rows else None,
        Paragraph(origin, "note") if origin else None,
    )


def _starts_errors(subject: Subject) -> list[tuple[str, str]]:
    """Of each shaft with a number of starts; the unlimited ones together."""
    head = "Estimated error of starts, "
    errors = {k.removeprefix(head): v for k, v in subject.audit.items() if k.startswith(head)}
    facts = [(f"{head}{clean(k)}", clean(v)) for k, v in errors.items() if v != NoNumber.UNLIMITED]
    unlimited = len(errors) - len(facts)
    if unlimited and is_counted(subject.calculation.results.start):
        shafts = "1 shaft" if unlimited == 1 else f"{unlimited} shafts"
        facts.append(("Unlimited starts", f"{shafts}: no damaging cycle"))
    return facts


def equations(subject: Subject) -> Section:
    """The equations with their sources."""
    sources = tuple((f"[{k}]", source.full) for k, source in enumerate(REFERENCES, start=1))
    return section(
        "Equations and references",
        Paragraph("Symbols as in the nomenclature of the program (docs/nomenclature.md)."),
        *EQUATIONS,
        parts=(
            section("Methods without a separate formula", Facts(METHODS)),
            section("References", Facts(sources, 9.0)),
        ),
    )


def checks(subject: Subject) -> Section:
    """Arithmetic done twice, and what the checker looks at."""
    kinds = {"Check": "sentence", "Values": "number", "Largest difference": "number",
             "Result": "verdict"}  # fmt: skip
    columns = tuple(Column(header, "", kind) for header, kind in kinds.items())
    rows = []
    for name, pairs in _checks(subject):
        if pairs:
            # a margin may be zero but for rounding: differences below 1e-12 are none
            worst = max(abs(a - b) / max(abs(a), abs(b), 1e-3) for a, b in pairs)
            difference = "0" if worst == 0.0 else scientific(worst, 1)
            result = "ok" if worst <= _SAME else "differs"
            rows.append((name, str(len(pairs)), difference, result))
    sentence = (
        "Results that follow by simple arithmetic from other results were recalculated from "
        "the numbers of this document; relative differences are listed. The checker repeats "
        "these calculations by hand."
    )
    by_hand = (
        "Compare the inputs with the drawings and the makers' data sheets, with their revisions.",
        "Check that the units above the columns fit the numbers.",
        "Check that damping, SCF and S-N data are justified.",
        "Check that the effects left out are acceptable for this train.",
        "Check that verdicts marked not judged or incomplete have been resolved.",
        "Check that the digest in the audit equals that of the file: torsionbook verify FILE.",
    )
    return section(
        "Check calculations",
        Paragraph(sentence),
        Table("Check calculations", columns, tuple(rows)) if rows else None,
        parts=(section("To be checked by hand", Listing(by_hand, "☐")),),
    )


def _checks(subject: Subject) -> Iterator[tuple[str, list[tuple[Any, float]]]]:
    """Name of each check, and its values as in the results and calculated again."""
    case, view = subject.calculation.case, subject.calculation.view
    line, frequencies = case.ratings.line_frequency, subject.rows("NaturalFrequencies")
    modes = {row["mode"]: row["frequency"] for row in frequencies if row["mode"]}
    if line:
        yield (
            f"Speed of a crossing. {by('Start-up crossing')}",
            [
                (row["percent_speed"], 1.0 - row["frequency"] / (2.0 * line))
                for row in frequencies
                if row.get("percent_speed") is not None
            ],
        )
    yield (
        f"Margin at the speed shown. {by('Separation margin')}",
        [
            (row["margin"], abs(modes[row["mode"]] - excited) / excited)
            for row in subject.rows("SeparationMargins")
            if (excited := row["excitation_frequency"]) and row["mode"] in modes
        ],
    )
    strength = {m.material: m.uts for m in case.materials}
    material = {e.element: e.material for e in case.elements}
    yield (
        f"Allowable stress. {by('Allowable vibratory stress')}",
        [
            (row["allowable"], (strength.get(material.get(row["element"])) or math.nan) / 25.0)
            for row in subject.rows("SteadyState")
            if row.get("allowable") is not None
        ],
    )
    shafts = subject.rows("AllowableStarts")
    yield (
        f"Allowable starts. {by('Damage')}",
        [
            (row["allowable_starts"], 1.0 / row["damage"])
            for row in shafts
            if row.get("damage") and row.get("allowable_starts")
        ],
    )
    governing = start_cycle_facts(view)["shaft"]
    damage = next((row.get("damage") for row in shafts if row["element"] == governing), None)
    cycles = start_cycle_rows(view)
    yield (
        "Sum of the listed cycles compared with the damage of one start.",
        ([(damage, math.fsum(row["damage"] for row in cycles))] if damage else []),
    )


def audit(subject: Subject) -> Section:
    """Digest, versions, settings."""
    rows = [
        (clean(item), clean(value))
        for item, value in subject.audit.items()
        if not item.startswith(_TOLD_ELSEWHERE) and item not in _ACCURACY_ITEMS
    ]
    sentence = (
        "The digest covers all inputs that can change a result, in SI, rounded to twelve "
        "significant digits, without title block and descriptions. Typing a quantity in "
        "another unit does not change it."
    )
    head = "Time spent: "
    spent = "; ".join(
        f"{item.removeprefix(head)} {value}"
        for item, value in subject.audit.items()
        if item.startswith(head)
    )
    warnings = tuple(clean(warning) for warning in subject.calculation.warnings)
    return section(
        "Audit",
        Paragraph(sentence),
        Facts(tuple(rows)),
        *((Paragraph("Warnings:"), Listing(warnings)) if warnings else ()),
        Paragraph(f"Time spent: {spent}.", "note") if spent and subject.show_times else None,
    )
