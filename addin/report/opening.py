"""Cover, summary and scope."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from addin.contract.digests import short_digest
from addin.contract.problems import shortened
from addin.contract.texts import NOTES
from addin.diff.changes import Differences
from addin.report.actions import actions, has_other_designs
from addin.report.cases import governing
from addin.report.document import (
    Column,
    Cover,
    Facts,
    Listing,
    Paragraph,
    Section,
    SignatureBox,
    Table,
    section,
)
from addin.report.numbers import clean, fixed, significant
from addin.report.subject import Subject
from engine.case.result_words import Judgement
from engine.start.start_fatigue import is_counted

#: Longest tag below the title; the title block has all of it. [characters]
_SUBTITLE = 120
#: Rows of the revision table that stay blank for later revisions.
_BLANK_REVISIONS = 3
#: Modes without their margin that the conclusions speak of. [count]
_NEAREST = 5
#: Warnings on the summary; where there are more, section Audit lists all.
_WARNINGS = 15
#: Columns of the verdicts on the summary, and of what they cover below it.
_VERDICT = ("Check", "Result", "Limit", "Safety factor", "Verdict", "Where")
_COVERAGE = ("Check", "Coverage", "Not judged")
#: What no calculation of this program covers, whatever the inputs.
_NOT_COVERED = (
    "Short circuits at the motor and fast reclosing of the line that are not among the inputs.",
    "Lateral and axial vibration, except lateral motion of gears with bearing data.",
    "Keys, keyways, interference fits and hub stresses beyond the SCF stated for an element.",
    "Measured behaviour: frequencies and damping are calculated or assumed; where a "
    "margin is small, confirm them by a field test with strain gauges or a torsiograph.",
)


_SIGNS = (
    "0‑pk, pk‑pk",
    "Zero-to-peak, the amplitude about the mean; and peak-to-peak, the whole range.",
)


def cover_of(subject: Subject) -> Cover:
    """The first page."""
    calculation = subject.calculation
    overall = next(
        iter(subject.rows("Verdicts")),
        {"verdict": Judgement.INCOMPLETE, "where": "no check was made"},
    )
    date = calculation.stamp.date
    digest = calculation.case_sha256
    facts = (
        ("Document", subject.words("document") or "not given"),
        ("Revision", subject.words("revision") or "not given"),
        ("Client", subject.words("client") or "not given"),
        ("Equipment tag", subject.words("tag") or "not given"),
        ("Calculated", f"{date:%Y-%m-%d %H:%M} UTC"),
        ("Software", calculation.stamp.software),
        ("Inputs", f"{short_digest(digest)} (SHA-256; the whole of it in the audit)"),
    )
    prepared, checked = subject.words("prepared_by"), subject.words("checked_by")
    description = f"Inputs {short_digest(digest)}"
    first = (subject.words("revision"), f"{date:%Y-%m-%d}", description, prepared, checked, "")
    earlier = [] if subject.against is None else _earlier(subject.against)
    blank = [("",) * len(first)] * _BLANK_REVISIONS
    heads = ("Rev.", "Date", "Description", "Prepared", "Checked", "Approved")
    columns = tuple(Column(h, "", "sentence" if h == "Description" else "text") for h in heads)
    return Cover(
        kind="Torsional vibration analysis",
        title=subject.words("title") or "Torsional vibration analysis",
        subtitle=shortened(subject.words("tag"), _SUBTITLE),
        verdict=str(overall["verdict"]),
        sentence=_verdict_sentence(overall),
        facts=facts,
        alerts=subject.alerts,
        revisions=Table("Revisions", columns, (*earlier, first, *blank)),
        signatures=signatures(subject),
    )


def signatures(subject: Subject) -> SignatureBox:
    """Who prepared and checked, and room for who approves."""
    roles = {"Prepared by": "prepared_by", "Checked by": "checked_by"}
    names = ((role, subject.words(scalar)) for role, scalar in roles.items())
    return SignatureBox((*names, ("Approved by", "")))


def _earlier(differences: Differences) -> list[tuple[str, ...]]:
    """The line of the revision compared with; its date is not known here."""
    first = differences.first
    before = first.data
    if before is None:
        return []
    sentence = f"{clean(first.source.name)}, inputs {short_digest(first.digest)}"
    words = (before.revision, "", sentence, before.prepared_by, before.checked_by, "")
    return [tuple(shortened(clean(str(one or "")), 100) for one in words)]


def _verdict_sentence(overall: Mapping[str, Any]) -> str:
    where = clean(str(overall.get("where") or ""))
    if where:
        return where[:1].upper() + where[1:] + "."
    if overall["verdict"] == Judgement.ACCEPTED:
        return (
            "A separation margin is not kept; at that resonance the elements that carry the mode are "
            "within their limits."
        )
    return "All checks pass."


def summary(subject: Subject) -> Section:
    """Verdicts, key figures and warnings."""
    note = "A check needs a limit in the inputs; results without a limit are shown but not judged."
    warnings = [clean(warning) for warning in subject.calculation.warnings]
    if len(warnings) > _WARNINGS:
        rest = f"And {len(warnings) - _WARNINGS} more; the audit has them all."
        warnings = [*warnings[:_WARNINGS], rest]
    listed = Listing(tuple(warnings)) if warnings else Paragraph("There are no warnings.")
    remaining = Listing(tuple(conclusions(subject)))
    return section(
        "Summary",
        subject.pictures.schematic(subject.calculation.case),
        subject.table("Verdicts", columns=_VERDICT, note=note),
        parts=(
            section("Coverage of the verdicts", _coverage(subject)),
            *_standard(subject),
            section("Key figures", Facts(tuple(_key_figures(subject)))),
            section("Warnings of the calculation", listed),
            section("Conclusions and what remains to be done", remaining),
        ),
    )


def _coverage(subject: Subject) -> Table:
    """What each check was made for, and what it leaves out."""
    rows = [r for r in subject.rows("Verdicts") if r.get("coverage") or r.get("not_judged")]
    return subject.table("Verdicts", "Coverage of the verdicts", _COVERAGE, rows=rows)


def _standard(subject: Subject) -> Iterator[Section]:
    """What the standard asks for, where one is named."""
    if subject.rows("StandardRequirements"):
        yield section("Standard and requirements", subject.table("StandardRequirements"))


def conclusions(subject: Subject) -> Iterator[str]:
    """What follows from the verdicts: where the train could be changed, what to enter, what to measure."""
    verdicts = {
        str(row["check"]): row["verdict"]
        for row in subject.rows("Verdicts")
        if row["check"] != "Overall"
    }
    bad = (Judgement.FAIL, Judgement.UNBOUNDED)
    failing = [check for check, verdict in verdicts.items() if verdict in bad]
    open_checks = [
        check
        for check, verdict in verdicts.items()
        if verdict in (Judgement.NOT_JUDGED, Judgement.INCOMPLETE)
    ]
    if failing:
        yield f"Not accepted as designed: {', '.join(failing)}."
    elif len(open_checks) < len(verdicts):
        yield "No judged check fails."
    if open_checks:
        start = subject.calculation.results.start
        ended = (
            "" if start is None or is_counted(start) else f" The start is {start.outcome.outcome}."
        )
        yield (
            f"Not judged, or only in part: {', '.join(open_checks)}. The table of verdicts names the "
            f"elements; this report makes no statement on them.{ended}"
        )
    governs = governing(subject)
    if governs:
        yield governs
    near = _nearest_modes(subject)
    for mode in near:
        yield _where_to_act(subject, mode)
    yield from actions(subject)
    if near:
        energies = (_mode(subject, mode)["largest_strain_energy"] for mode in near)
        shafts = dict.fromkeys(clean(str(energy)) for energy in energies)
        modes = ", ".join(str(mode) for mode in near)
        yield (
            f"Field test: confirm the frequency of mode{'s' if len(near) > 1 else ''} {modes} and "
            f"the damping by torque telemetry at {', '.join(shafts)}, during a start and in "
            "operation; the required margin is then 10 % (MarginBasis measured)."
        )
    else:
        yield (
            "Field test: not required by these margins; if made, measure torque during the start "
            "to confirm damping and peaks."
        )
    if subject.against is None and not has_other_designs(subject):
        yield "No other design is compared here."


def _nearest_modes(subject: Subject) -> list[int]:
    """The lowest modes that do not keep a margin, whether or not the response is accepted."""
    modes = {
        row["mode"] for row in subject.rows("SeparationMargins") if row["verdict"] != Judgement.PASS
    }
    return sorted(modes)[:_NEAREST]


def _mode(subject: Subject, mode: int) -> Mapping[str, Any]:
    return next(row for row in subject.rows("NaturalFrequencies") if row["mode"] == mode)


def _where_to_act(subject: Subject, mode: int) -> str:
    """A mode without its margin, and the element that moves it most."""
    rows = [row for row in subject.rows("SeparationMargins") if row["mode"] == mode]
    worst = min(rows, key=lambda row: row["margin"])
    row = _mode(subject, mode)
    place = ("NaturalFrequencies", "Frequency")
    frequency = fixed(subject.value(row["frequency"], *place), 2)
    return (
        f"Mode {mode} ({frequency} {subject.unit(*place)}) has "
        f"{fixed(100.0 * worst['margin'], 1)} % margin from {clean(str(worst['excitation']))}; "
        f"{fixed(100.0 * worst['required'], 0)} % required. "
        f"{fixed(100.0 * row['share'], 0)} % of its strain energy is in "
        f"{clean(str(row['largest_strain_energy']))}, whose stiffness shifts it most."
    )


def _key_figures(subject: Subject) -> Iterator[tuple[str, str]]:
    results, place = subject.calculation.results, ("NaturalFrequencies", "Frequency")
    elastic = [row for row in subject.rows("NaturalFrequencies") if row["frequency"]]
    if elastic:
        first = ", ".join(fixed(subject.value(r["frequency"], *place), 2) for r in elastic[:5])
        yield "Lowest natural frequencies", f"{first} {subject.unit(*place)}"
    worst = results.margins.worst
    if worst is not None:
        margin, required = fixed(100.0 * worst.margin, 2), fixed(100.0 * worst.required, 0)
        against = f"mode {worst.mode} against {clean(worst.excitation)}"
        yield "Least separation margin", f"{margin} % ({against}; {required} % required)"
    if subject.calculation.startup is None:
        yield "Start", "not calculated: the inputs hold no motor torque and no torque against time"
        return
    yield "Start", clean(str(subject.calculation.startup["sentence"]))
    peak = largest_peak(subject)
    if peak:
        yield "Largest torque in the start", peak
    starts = results.starts
    if starts is None or not starts.shafts:
        yield "Allowable starts", "no shaft was judged"
    elif not is_counted(results.start):
        yield "Allowable starts", "not judged: the start was not completed"
    elif starts.judged_starts is None:
        yield "Allowable starts", "unlimited: no damaging cycle in a start"
    else:
        rounded = int(starts.judged_starts * (1.0 + 1e-9))
        yield "Allowable starts", f"{rounded:,} ({clean(starts.governing or '')})"


def largest_torque(peak: Mapping[str, Any]) -> float:
    """The larger of the extreme torques of an element, without sign. [N m]"""
    return max(abs(peak["maximum_torque"]), abs(peak["minimum_torque"]))


def largest_peak(subject: Subject) -> str:
    """The largest torque of the start, compared at motor speed.

    Returns
    -------
    str
        Element, torque at its own speed and pu of rated torque; empty without a start. [text]
    """
    case = subject.calculation.case
    own = case.element_speed_ratios
    rows = [(largest_torque(row), row["element"]) for row in subject.rows("StartupPeaks")]
    if not rows:
        return ""
    size, element = max(rows, key=lambda r: r[0] * own[r[1]])
    place = ("StartupPeaks", "Maximum torque")
    shown_size = significant(subject.value(size, *place), 5)
    words = f"{clean(element)}: {shown_size} {subject.unit(*place)}"
    rated = case.ratings.rated_torque
    if not rated:
        return words
    return f"{words}; referred to the motor {fixed(size * own[element] / rated, 2)} × rated torque"


def _of_model(text: str) -> str:
    """A limit without the scalar that a user of the program could type."""
    return text.partition("; KeepHistory")[0].rstrip(".") + "."


def scope(subject: Subject) -> Section:
    """What was calculated, from what, by which conventions, and what was not."""
    stamp = subject.calculation.stamp
    basis = (
        "This document reports the torsional vibration analysis of the train on the cover. All "
        f"results were calculated by {stamp.software} from the inputs printed here when the document "
        "was made; none were copied from stored results. The digest at the foot of each page "
        "identifies these inputs."
    )
    covered = (
        "Natural frequencies, mode shapes and energies; separation margins against each continuous "
        "excitation; forced response.",
        "The start from rest, with the pulsation of the motor at twice slip frequency sweeping down "
        "through the modes; torque reversals; fatigue damage of one start and allowable starts.",
        "Effects simulated, effects left out and why, with a bound where known (appendix A).",
    )
    limits = (term for term in NOTES["Limits of this version"] if term[0] != "Reference")
    return section(
        "Scope and basis",
        Paragraph(basis),
        Paragraph("Covered:"),
        Listing(covered),
        parts=(
            section("Conventions", Facts((*NOTES["Conventions"], _SIGNS))),
            section("Not covered", Listing(_NOT_COVERED)),
            # what concerns workbooks alone is no limit of the model
            section(
                "Limits of the model", Facts(tuple((t, _of_model(text)) for t, text in limits))
            ),
        ),
    )
