"""What the calculation found: frequencies, margins, steady state, start, reversals, fatigue."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from addin.chart_data import HISTORIES
from addin.report.document import Block, Column, Facts, Listing, Paragraph, Section, Table
from addin.report.equations import by
from addin.report.layout import folded
from addin.report.numbers import clean, fixed, significant, typed
from addin.report.shown import own_speeds
from addin.report.subject import Subject
from addin.report.tables import result_table, turned
from addin.start_cycles import start_cycle_facts, start_cycle_rows
from engine.reversals import PRACTICE_LIMITS

__all__ = ["fatigue", "frequencies", "margins", "reversals", "start", "steady_state"]

#: Most rows of a table of pairs (mode and excitation, element and excitation) shown in full.
_FULL = 40
#: Modes shown: all up to this many, else those below so many line frequencies, within these counts.
_ALL_MODES, _LINE_MULTIPLE, _FEWEST, _MOST = 15, 2.5, 10, 25
#: Columns of mode shapes beside each other.
_SHAPES = 6
#: Most nodes that are named.
_NODES = 8
#: Shares of energy that are named. [1]
_SHARE = 0.05
#: Change of stiffness of which the effect is shown. [1]
_TOLERANCE = 0.1
_ELSEWHERE = "all rows are in the workbook and in the JSON"


def shown_modes(subject: Subject) -> int:
    """How many elastic modes the tables show.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    int
        The lowest so many. [count]
    """
    elastic = [row["frequency"] for row in subject.rows("NaturalFrequencies") if row["frequency"]]
    if len(elastic) <= _ALL_MODES:
        return len(elastic)
    top = _LINE_MULTIPLE * (subject.calculation.case.ratings.line_frequency or 0.0)
    below = sum(1 for f in elastic if f <= top)
    return min(max(below, _FEWEST), _MOST, len(elastic))


def _left_out(shown: int, total: int, what: str, why: str) -> str:
    return "" if shown == total else f"{shown} of {total} {what} are shown, {why}; {_ELSEWHERE}."


# --- frequencies ----------------------------------------------------------------------------------


def frequencies(subject: Subject) -> Section:
    """Natural frequencies, damping, energies and shapes.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    Section
        The section.
    """
    rows, count = subject.rows("NaturalFrequencies"), shown_modes(subject)
    elastic = sum(1 for row in rows if row["frequency"])
    chosen = [row for row in rows if row["mode"] <= count]
    if not elastic:
        return Section(
            "Natural frequencies and mode shapes",
            (Paragraph("The train has no elastic mode: no elastic element joins two inertias."),),
        )
    rigid = len(rows) - elastic
    words = "one rigid-body mode" if rigid == 1 else f"{rigid} rigid-body modes"
    table = result_table(
        "NaturalFrequencies", chosen, subject.shown, "Natural frequencies",
        note=" ".join(filter(None, (
            f"Mode 0: {words}." if rigid else "",
            "Speed: where 2 × slip frequency crosses the mode in the start; blank above 2 × line "
            "frequency. Damping ratio: of critical, in the start.",
            _left_out(count, elastic, "elastic modes", "the lowest"),
            by("Natural frequencies", "Modal damping", "Start-up crossing"),
        ))),
    )  # fmt: skip
    return Section(
        "Natural frequencies and mode shapes",
        (_with_amplification(table, chosen),),
        (
            _damping(subject, chosen),
            _energies(subject, count),
            *_tolerances(subject, count),
            _shapes(subject, count),
        ),
    )


def _with_amplification(table: Table, rows: Sequence[Mapping[str, Any]]) -> Table:
    """The table with a column of 1/2ζ after the damping ratio."""
    headers = [column.header for column in table.columns]
    if "Damping ratio" not in headers:
        return table
    at = headers.index("Damping ratio") + 1
    cells = [
        significant(0.5 / r["damping_ratio"], 3) if r.get("damping_ratio") else "" for r in rows
    ]
    return _with_column(table, at, Column("Amplification", "", "number"), cells)


def _with_column(table: Table, at: int, column: Column, cells: Sequence[str]) -> Table:
    """A table with one column more."""
    return replace(
        table,
        columns=(*table.columns[:at], column, *table.columns[at:]),
        rows=tuple(
            (*row[:at], cell, *row[at:]) for row, cell in zip(table.rows, cells, strict=True)
        ),
    )


def _damping(subject: Subject, rows: Sequence[Mapping[str, Any]]) -> Section:
    """What damping was assumed, and the amplification it means for each mode."""
    case = subject.calculation.case
    stated = case.damping_ratio
    said = [
        "No damping ratio is stated (DampingRatio is blank)."
        if stated is None
        else f"Stated for all elastic modes: {significant(100.0 * stated, 3)} % of critical (DampingRatio)."
    ]
    if case.mode_damping:
        said.append(f"Table ModeDamping states that of {len(case.mode_damping)} modes instead.")
    viscous = sum(1 for e in case.elements if e.damping)
    loss = sum(1 for e in case.elements if e.loss_factor)
    ground = sum(1 for s in case.stations if s.damping)
    for count, what in (
        (viscous, "elements have viscous damping"),
        (loss, "elements have a loss factor"),
        (ground, "stations have damping to ground"),
    ):
        if count:
            said.append(f"{count} {what if count > 1 else _singular(what)}, added by energy.")
    damped = [r for r in rows if r["frequency"] and r.get("damping_ratio")]
    if not damped:
        said.append("No mode is damped: a resonance in continuous operation is unbounded, and the "
                    "start shows the build-up without any decay.")  # fmt: skip
        return Section("Damping", (Paragraph(" ".join(said)),))
    said.append(
        "Damping is an assumption of the inputs: confirm it by experience with like trains. The damping "
        "ratio of each mode and its amplification at resonance, 1/2ζ, stand in the table above."
    )
    blocks: list[Block] = [Paragraph(" ".join(said))]
    item = "Largest neglected damping term"
    if item in subject.audit:
        blocks.append(Paragraph(f"{item}: {clean(subject.audit[item])}.", "note"))
    return Section("Damping", tuple(blocks))


def _singular(words: str) -> str:
    return words.replace("elements have", "element has").replace("stations have", "station has")


def _energies(subject: Subject, count: int) -> Section:
    """Nodes and where the energy of each mode is: what a change of the train would act on."""
    columns = (
        Column("Mode", "", "number"),
        Column("Frequency", subject.shown.unit("NaturalFrequencies", "Frequency"), "number"),
        Column("Strain energy", "", "sentence"),
        Column("Kinetic energy", "", "sentence"),
        Column("Nodes", "", "sentence"),
    )
    factor = subject.shown.units.factor("NaturalFrequencies", "Frequency")
    rows = []
    for mode in subject.calculation.details["modes"][:count]:
        strain = dict(mode["strain_energy"]) | {
            f"bearing of {k}": v for k, v in mode.get("bearing_strain_energy", {}).items()
        }
        kinetic = dict(mode["kinetic_energy"]) | {
            f"{k} sideways": v for k, v in mode.get("sideways_kinetic_energy", {}).items()
        }
        names = [clean(n["element"]) for n in mode["nodes"]]
        nodes = "; ".join(names[:_NODES]) or "none"
        if len(names) > _NODES:
            nodes += f"; and {len(names) - _NODES} more"
        rows.append(
            (
                str(mode["mode"]),
                fixed(mode["frequency"] / factor, 2),
                _shares(strain),
                _shares(kinetic),
                nodes,
            )
        )
    note = (
        f"Shares of at least {100 * _SHARE:.0f} %, the largest first. A node lies inside the element "
        "named. A change of stiffness acts on a mode where it has strain energy, a change of inertia "
        "where it has kinetic energy."
    )
    return Section(
        "Energies and nodes",
        (Table("Energies and nodes of the modes", columns, tuple(rows), note),),
    )


def _shares(energy: Mapping[str, float]) -> str:
    """The largest shares; at least one, at most five."""
    order = sorted(energy.items(), key=lambda pair: -pair[1])
    shown = [pair for k, pair in enumerate(order[:5]) if pair[1] >= _SHARE or k == 0]
    return "; ".join(f"{clean(name)} {100.0 * share:.0f} %" for name, share in shown)


def _tolerances(subject: Subject, count: int) -> Iterator[Section]:
    """What a coupling that is stiffer or softer than its data sheet does to the modes."""
    couplings = [e.element or "" for e in subject.calculation.case.elements if e.kind == "coupling"]
    modes = subject.calculation.details["modes"][: min(count, _SHAPES)]
    if not couplings or not modes:
        return
    columns = (
        Column("Coupling"),
        *(Column(f"Mode {mode['mode']}", "%", "number") for mode in modes),
    )
    rows = tuple(
        (
            clean(name),
            *(
                fixed(50.0 * _TOLERANCE * dict(mode["strain_energy"]).get(name, 0.0), 2)
                for mode in modes
            ),
        )
        for name in couplings[:_FULL]
    )
    left = _left_out(len(rows), len(couplings), "couplings", "the first")
    yield Section(
        "Tolerance of the couplings",
        (
            Table(
                f"Change of a frequency where a coupling is {100.0 * _TOLERANCE:.0f} % stiffer",
                columns,
                rows,
                f"Half the share of strain energy times the change of stiffness: the first-order rule of "
                f"Rayleigh's quotient; of a softer coupling the same downwards. {100.0 * _TOLERANCE:.0f} % "
                "serves to compare: the tolerance itself is the maker's, and not an input. "
                f"{left}".rstrip(),
            ),
        ),
    )


def _shapes(subject: Subject, count: int) -> Section:
    rows = subject.rows("ModeShapes")
    modes = subject.calculation.results.modes
    blocks: list[Block] = []
    picture = subject.pictures.shapes(rows)
    if picture is not None:
        blocks.append(picture)
    drawn = min(count, _SHAPES)
    some = [
        {k: v for k, v in row.items() if k == "station" or int(k.split("_")[1]) <= drawn}
        for row in rows
    ]
    left = _left_out(drawn, len(modes.elastic_frequency), "mode shapes", "the lowest")
    blocks.append(
        result_table(
            "ModeShapes",
            some,
            subject.shown,
            "Mode shapes: twist of each station, largest = 1",
            note=left,
        )  # fmt: skip
    )
    return Section("Mode shapes", tuple(blocks))


# --- continuous operation -------------------------------------------------------------------------


def margins(subject: Subject) -> Section:
    """Interference diagram and separation margins.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    Section
        The section.
    """
    rows = subject.rows("SeparationMargins")
    if not rows:
        why = "no excitation is known, or the train has no elastic mode"
        return Section("Interference and separation margins",
                       (Paragraph(f"No separation margin was calculated: {why}. See the warnings in "
                                  "section 1."),))  # fmt: skip
    blocks: list[Block] = []
    picture = subject.pictures.interference()
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
                        _left_out(
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
    said = (
        "All margins are kept."
        if not failing
        else f"{len(failing)} of {len(rows)} margins are not kept"
        + (", all of them accepted by forced response." if all(
            r["verdict"].startswith("accepted") for r in failing) else ".")
    )  # fmt: skip
    return Section("Interference and separation margins", (Paragraph(said, "lead"), *blocks))


def _with_mode(row: Mapping[str, Any]) -> Mapping[str, Any]:
    """The row of a margin; the name of its excitation as it can be printed."""
    return dict(row) | {"excitation": clean(str(row["excitation"]))}


def _chosen_margins(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """All; of very many every one that does not pass, and the two least of each mode."""
    if len(rows) <= _FULL:
        return list(rows)
    nearest: dict[int, list[Mapping[str, Any]]] = {}
    for row in sorted(rows, key=lambda r: r["margin"]):
        nearest.setdefault(row["mode"], []).append(row)
    keep = {id(row) for near in nearest.values() for row in near[:2]}
    chosen = [row for row in rows if row["verdict"] != "pass" or id(row) in keep]
    if len(chosen) <= _FULL:
        return chosen
    keep = {
        id(row)
        for row in sorted(chosen, key=lambda r: (r["verdict"] == "pass", r["margin"]))[:_FULL]
    }
    return [row for row in chosen if id(row) in keep]


_STEADY = (
    "Element", "Excitation", "Frequency", "Applied at", "Applied torque", "Torque",
    "Zero-to-peak stress", "Peak-to-peak stress", "Allowable", "Verdict",
)  # fmt: skip


def steady_state(subject: Subject) -> Section:
    """Forced response at running speed.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    Section
        The section.
    """
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
            _left_out(len(chosen), len(rows), "rows", "of each element the largest torque and what "
                      "does not pass"),
            by("Forced response", "Shear stress", "Allowable vibratory stress"),
        ))),
    )  # fmt: skip
    judged = {row["element"] for row in rows if row.get("allowable") is not None}
    elements = {row["element"] for row in rows}
    failing = sorted({clean(r["element"]) for r in rows if r["verdict"] in ("fail", "unbounded")})
    said = (
        f"{len(judged)} of {len(elements)} elements have a stress diameter and a material and are judged; "
        f"the {basis} stress is compared with UTS/25. "
        + (f"The limit is exceeded at {', '.join(failing[:8])}{' and others' if len(failing) > 8 else ''}."
           if failing else ("No judged stress exceeds it." if judged else "So nothing was judged."))
    )  # fmt: skip
    return Section(title, (Paragraph(said, "lead"), table))


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
    for row in sorted(failing, key=lambda r: -_size(r))[: max(_FULL - len(keep), 0)]:
        keep[id(row)] = row
    order = {name: k for k, name in enumerate(best)}
    return sorted(keep.values(), key=lambda r: (order[r["element"]], -_size(r)))


def _size(row: Mapping[str, Any]) -> float:
    return math.inf if row.get("torque") is None else float(row["torque"])


# --- the start ------------------------------------------------------------------------------------

_CROSSINGS = (
    ("Mode", "Frequency", "Percent speed", "Time", "Average torque", "Pulsating torque", "Load torque",
     "Acceleration", "Sweep rate"),
    ("Mode", "Frequency", "Governing element", "Peak-to-peak torque", "Peak-to-peak stress",
     "Mesh minimum torque"),
)  # fmt: skip


def start(subject: Subject) -> Section:
    """Outcome, speed, crossings, peaks and histories.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    Section
        The section.
    """
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
            said = "simulated" if effects[name] else f"not simulated: {why[name]}"
            facts.append((words, said))
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
    said = tuple(f"Mode {row['mode']}: {clean(row['note'])}" for row in rows if row.get("note"))
    if said:
        blocks.append(Listing(said))
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
        own_speeds(subject.calculation.case),
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
        _with_column(table, at, Column("Largest over rated", "", "number"), cells),
        note=f"{table.note} Largest over rated: referred to motor speed, as multiples of rated torque.",
    )


def _in_rated(subject: Subject) -> Iterator[Block]:
    from addin.report.opening import largest_peak

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
    picture = subject.pictures.pull_in()
    if picture is not None:
        yield picture


# --- reversals ------------------------------------------------------------------------------------


def reversals(subject: Subject) -> Section:
    """Reversed torque of teeth, clearances and forces.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    Section
        The section.
    """
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
    said = tuple(clean(str(row["note"])) for row in rows)
    blocks: list[Block] = [
        *(Paragraph(words, "lead") for words in said[:3]),
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
    """Damage of one start, allowable starts, S-N line and cycles.

    Parameters
    ----------
    subject : Subject
        What the report is about.

    Returns
    -------
    Section
        The section.
    """
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
    picture = subject.pictures.sn()
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
    from addin.report.numbers import of_dimension

    return of_dimension(math.fsum(row["damage"] for row in cycles), "Damage", "count")
