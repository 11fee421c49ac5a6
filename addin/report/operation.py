"""Continuous operation: interference and margins, steady-state response."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from addin.report.document import Column, Paragraph, Section, Table, section
from addin.report.equations import by
from addin.report.layout import folded
from addin.report.numbers import clean, significant
from addin.report.subject import Subject
from addin.report.tables import FULL, left_out, with_column
from engine.case.result_words import Judgement

Row = Mapping[str, Any]

#: Verdicts of margins that are kept.
_KEPT = (Judgement.PASS, Judgement.WITHIN_ERROR)


def margins(subject: Subject) -> Section:
    """Interference diagram and separation margins."""
    title, rows = "Interference and separation margins", subject.rows("SeparationMargins")
    if not rows:
        why = "no excitation is known, or the train has no elastic mode"
        sentence = f"No separation margins: {why}. See the warnings in section 1."
        return section(title, Paragraph(sentence))
    failing = [row for row in rows if row["verdict"] not in _KEPT]
    sentence = "All margins are kept."
    if failing:
        accepted = all(row["verdict"].startswith("accepted") for row in failing)
        rest = ", all of them accepted by forced response." if accepted else "."
        sentence = f"{len(failing)} of {len(rows)} margins are not kept{rest}"
    chosen = _chosen_margins(rows)
    notes = (
        "Speed: motor speed with the least margin in continuous operation.",
        left_out(
            len(chosen), len(rows), "pairs of mode and excitation",
            "all pairs that fail, and the nearest excitations of each mode",
        ),
        by("Separation margin"),
    )  # fmt: skip
    return section(
        title,
        Paragraph(sentence, "lead"),
        subject.pictures.chart("interference")
        or Paragraph(
            "No interference diagram: line frequency or speed is missing. Type LineFrequency and "
            "SynchronousSpeed."
        ),
        subject.table("SeparationMargins", note=" ".join(filter(None, notes)), rows=chosen),
    )


def _chosen_margins(rows: Sequence[Row]) -> list[Row]:
    """All; of very many every one that does not pass, and the two least of each mode."""
    if len(rows) <= FULL:
        return list(rows)
    nearest: dict[int, list[Row]] = {}
    for row in sorted(rows, key=lambda r: r["margin"]):
        nearest.setdefault(row["mode"], []).append(row)
    keep = {id(row) for near in nearest.values() for row in near[:2]}
    chosen = [row for row in rows if row["verdict"] != Judgement.PASS or id(row) in keep]
    if len(chosen) <= FULL:
        return chosen
    worst = sorted(chosen, key=lambda r: (r["verdict"] == Judgement.PASS, r["margin"]))[:FULL]
    keep = {id(row) for row in worst}
    return [row for row in chosen if id(row) in keep]


_STEADY = (
    "Element", "Excitation", "Frequency", "Torque", "Zero-to-peak stress", "Peak-to-peak stress",
    "Allowable", "Verdict", "Applied at", "Applied torque",
)  # fmt: skip


def steady_state(subject: Subject) -> Section:
    """Forced response at running speed."""
    rows = subject.rows("SteadyState")
    title = "Steady-state response"
    if not rows:
        sentence = "No forced response: no excitation has a known torque and frequency."
        return section(title, Paragraph(sentence))
    chosen = _chosen_steady(rows)
    basis = subject.calculation.results.steady.stress_basis
    which = "for each element the largest torque, and all that fail"
    notes = (
        "Torques zero-to-peak at the element's own speed; stresses with SCF. Applied at: "
        "station where the torque acts.",
        left_out(len(chosen), len(rows), "rows", which),
        by("Forced response", "Shear stress", "Allowable vibratory stress"),
    )
    table = subject.table(
        "SteadyState", "Forced response, worst first by element", _STEADY,
        " ".join(filter(None, notes)), rows=chosen,
    )  # fmt: skip
    return section(
        title, Paragraph(_judged(rows, basis), "lead"), _with_limits(subject, table, chosen)
    )


def _judged(rows: Sequence[Row], basis: str) -> str:
    """By which limits how many elements were judged, and which exceed one."""
    elements = {row["element"] for row in rows}
    stressed = {row["element"] for row in rows if row.get("allowable") is not None}
    limited = {row["element"] for row in rows if row.get("torque_limit") is not None}
    failing = sorted(
        {clean(r["element"]) for r in rows if r["verdict"] in (Judgement.FAIL, Judgement.UNBOUNDED)}
    )
    sentences = [
        f"{len(stressed)} of {len(elements)} elements have a stress diameter and a material and are "
        f"judged; the {basis} stress is compared with UTS/25."
    ]
    if limited:
        sentences.append(
            "Elements whose zero-to-peak torque is compared with the maker's vibratory limit: "
            f"{len(limited)}."
        )
    if failing:
        more = " and others" if len(failing) > 8 else ""
        sentences.append(f"A limit is exceeded at {', '.join(failing[:8])}{more}.")
    elif stressed or limited:
        sentences.append("No limit is exceeded.")
    else:
        sentences.append("Nothing was judged.")
    return " ".join(sentences)


def _with_limits(subject: Subject, table: Table, rows: Sequence[Row]) -> Table:
    """The table with the makers' vibratory limits beside the torques, where there are any."""
    if all(row.get("torque_limit") is None for row in rows):
        return table
    place = ("SteadyState", "Torque")
    limits = (row.get("torque_limit") for row in rows)
    cells = [
        "" if limit is None else significant(subject.value(limit, *place), 5) for limit in limits
    ]
    column = Column("Vibratory limit", subject.unit(*place), "number")
    return with_column(table, "Torque", column, cells)


def _chosen_steady(rows: Sequence[Row]) -> list[Row]:
    """Of each element the largest torque, and what fails, the worst of very many."""
    best: dict[str, Row] = {}
    for row in rows:
        largest = best.get(row["element"])
        if largest is None or _size(row) > _size(largest):
            best[row["element"]] = row
    keep = {id(row): row for row in best.values()}
    failing = [r for r in rows if r["verdict"] in (Judgement.FAIL, Judgement.UNBOUNDED)]
    worst = sorted(failing, key=lambda r: -_size(r))[: max(FULL - len(keep), 0)]
    keep |= {id(row): row for row in worst}
    order = {name: k for k, name in enumerate(best)}
    return sorted(keep.values(), key=lambda r: (order[r["element"]], -_size(r)))


def _size(row: Row) -> float:
    return math.inf if row.get("torque") is None else float(row["torque"])


def events(subject: Subject) -> Section:
    """Faults in operation: peaks of every element, and what was not calculated."""
    notes = [
        Paragraph(clean(event.note)) for event in subject.calculation.results.events if event.note
    ]
    rows = [row for row in subject.rows("EventPeaks") if "maximum" in row]
    note = (
        "Torques from the event on, those of operation or start included, at the element's own speed; stress nominal. Events "
        "are not counted as starts."
    )
    peaks = folded(subject.table("EventPeaks", note=note, rows=rows)) if rows else ()
    air_gap = folded(subject.table("AirGapTorque")) if subject.rows("AirGapTorque") else ()
    pictures = [subject.pictures.chart(name) for name in ("air-gap", "clearing")]
    return section("Motor and electrical events", *notes, *peaks, *air_gap, *pictures)
