"""Continuous operation: interference and margins, steady-state response."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from addin.report.document import Block, Column, Paragraph, Section, Table
from addin.report.equations import by
from addin.report.numbers import clean, significant
from addin.report.subject import Subject
from addin.report.tables import FULL, left_out, result_table, with_column


def margins(subject: Subject) -> Section:
    """Interference diagram and separation margins."""
    rows = subject.rows("SeparationMargins")
    if not rows:
        why = "no excitation is known, or the train has no elastic mode"
        return Section("Interference and separation margins",
                       (Paragraph(f"No separation margin was calculated: {why}. See the warnings in "
                                  "section 1."),))  # fmt: skip
    blocks: list[Block] = []
    picture = subject.pictures.chart("interference")
    if picture is not None:
        blocks.append(picture)
    else:
        blocks.append(
            Paragraph(
                "There is no interference diagram: line frequency and speed are not both known."
            )
        )
    chosen = _chosen_margins(rows)
    blocks.append(
        result_table(
            "SeparationMargins",
            [_with_mode(row) for row in chosen],
            subject.shown,
            "Separation margins",
            note=" ".join(
                filter(
                    None,
                    (
                        "Speed: of the motor, where the margin is least within continuous operation.",
                        left_out(
                            len(chosen),
                            len(rows),
                            "pairs of mode and excitation",
                            "every pair that does not pass, and the nearest excitations of each mode",
                        ),
                        by("Separation margin"),
                    ),
                )
            ),
        )  # fmt: skip
    )
    failing = [r for r in rows if r["verdict"] != "pass"]
    sentence = (
        "All margins are kept."
        if not failing
        else f"{len(failing)} of {len(rows)} margins are not kept"
        + (", all of them accepted by forced response." if all(
            r["verdict"].startswith("accepted") for r in failing) else ".")
    )  # fmt: skip
    return Section("Interference and separation margins", (Paragraph(sentence, "lead"), *blocks))


def _with_mode(row: Mapping[str, Any]) -> Mapping[str, Any]:
    """The row of a margin; the name of its excitation as it can be printed."""
    return dict(row) | {"excitation": clean(str(row["excitation"]))}


def _chosen_margins(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """All; of very many every one that does not pass, and the two least of each mode."""
    if len(rows) <= FULL:
        return list(rows)
    nearest: dict[int, list[Mapping[str, Any]]] = {}
    for row in sorted(rows, key=lambda r: r["margin"]):
        nearest.setdefault(row["mode"], []).append(row)
    keep = {id(row) for near in nearest.values() for row in near[:2]}
    chosen = [row for row in rows if row["verdict"] != "pass" or id(row) in keep]
    if len(chosen) <= FULL:
        return chosen
    keep = {
        id(row)
        for row in sorted(chosen, key=lambda r: (r["verdict"] == "pass", r["margin"]))[:FULL]
    }
    return [row for row in chosen if id(row) in keep]


_STEADY = (
    "Element", "Excitation", "Frequency", "Applied at", "Applied torque", "Torque",
    "Zero-to-peak stress", "Peak-to-peak stress", "Allowable", "Verdict",
)  # fmt: skip


def steady_state(subject: Subject) -> Section:
    """Forced response at running speed."""
    rows = subject.rows("SteadyState")
    title = "Steady-state response"
    if not rows:
        return Section(title, (Paragraph("No forced response was calculated: every margin is kept, or "
                                         "no excitation is known."),))  # fmt: skip
    chosen = _chosen_steady(rows)
    basis = subject.calculation.results.steady.stress_basis
    table = result_table(
        "SteadyState", chosen, subject.shown, "Forced response, worst first by element", _STEADY,
        note=" ".join(filter(None, (
            "Torques zero-to-peak at the element's own speed; stresses with SCF. Applied at: the station "
            "of the applied torque.",
            left_out(len(chosen), len(rows), "rows", "of each element the largest torque and what "
                      "does not pass"),
            by("Forced response", "Shear stress", "Allowable vibratory stress"),
        ))),
    )  # fmt: skip
    return Section(
        title, (Paragraph(_judged(rows, basis), "lead"), _with_limits(subject, table, chosen))
    )


def _judged(rows: Sequence[Mapping[str, Any]], basis: str) -> str:
    """By which limits how many elements were judged, and which exceed one."""
    elements = {row["element"] for row in rows}
    stressed = {row["element"] for row in rows if row.get("allowable") is not None}
    limited = {row["element"] for row in rows if row.get("torque_limit") is not None}
    failing = sorted({clean(r["element"]) for r in rows if r["verdict"] in ("fail", "unbounded")})
    sentences = [
        f"{len(stressed)} of {len(elements)} elements have a stress diameter and a material and are "
        f"judged; the {basis} stress is compared with UTS/25."
    ]
    if limited:
        sentences.append(
            f"At {len(limited)} of them the zero-to-peak torque is compared with the maker's vibratory "
            "limit."
        )
    if failing:
        more = " and others" if len(failing) > 8 else ""
        sentences.append(f"The limit is exceeded at {', '.join(failing[:8])}{more}.")
    elif stressed or limited:
        sentences.append("No limit is exceeded.")
    else:
        sentences.append("So nothing was judged.")
    return " ".join(sentences)


def _with_limits(subject: Subject, table: Table, rows: Sequence[Mapping[str, Any]]) -> Table:
    """The table with the makers' vibratory limits beside the torques, where there are any."""
    if all(row.get("torque_limit") is None for row in rows):
        return table
    place = ("SteadyState", "Torque")
    factor = subject.shown.units.factor(*place)
    cells = [
        "" if row.get("torque_limit") is None else significant(row["torque_limit"] / factor, 5)
        for row in rows
    ]
    at = [column.header for column in table.columns].index("Torque") + 1
    column = Column("Vibratory limit", subject.shown.unit(*place), "number")
    return with_column(table, at, column, cells)


def _chosen_steady(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Of each element the largest torque, and what fails, the worst of very many."""
    keep: dict[int, Mapping[str, Any]] = {}
    best: dict[str, Mapping[str, Any]] = {}
    for row in rows:
        seen = best.get(row["element"])
        if seen is None or _size(row) > _size(seen):
            best[row["element"]] = row
    for row in best.values():
        keep[id(row)] = row
    failing = [r for r in rows if r["verdict"] in ("fail", "unbounded")]
    for row in sorted(failing, key=lambda r: -_size(r))[: max(FULL - len(keep), 0)]:
        keep[id(row)] = row
    order = {name: k for k, name in enumerate(best)}
    return sorted(keep.values(), key=lambda r: (order[r["element"]], -_size(r)))


def _size(row: Mapping[str, Any]) -> float:
    return math.inf if row.get("torque") is None else float(row["torque"])
