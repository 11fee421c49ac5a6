"""Natural frequencies, damping, energies and nodes, tolerances, mode shapes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from addin.report.document import Block, Column, Paragraph, Section, Table
from addin.report.equations import by
from addin.report.numbers import clean, fixed, significant
from addin.report.subject import Subject
from addin.report.tables import FULL, left_out, result_table, with_column

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


def shown_modes(subject: Subject) -> int:
    """How many elastic modes the tables show."""
    elastic = [row["frequency"] for row in subject.rows("NaturalFrequencies") if row["frequency"]]
    if len(elastic) <= _ALL_MODES:
        return len(elastic)
    top = _LINE_MULTIPLE * (subject.calculation.case.ratings.line_frequency or 0.0)
    below = sum(1 for f in elastic if f <= top)
    return min(max(below, _FEWEST), _MOST, len(elastic))


def frequencies(subject: Subject) -> Section:
    """Natural frequencies, damping, energies and shapes."""
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
            left_out(count, elastic, "elastic modes", "the lowest"),
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
    return with_column(table, at, Column("Amplification", "", "number"), cells)


def _damping(subject: Subject, rows: Sequence[Mapping[str, Any]]) -> Section:
    """What damping was assumed, and the amplification it means for each mode."""
    case = subject.calculation.case
    stated = case.damping_ratio
    sentences = [
        "No damping ratio is stated (DampingRatio is blank)."
        if stated is None
        else f"Stated for all elastic modes: {significant(100.0 * stated, 3)} % of critical (DampingRatio)."
    ]
    if case.mode_damping:
        sentences.append(
            f"Table ModeDamping states that of {len(case.mode_damping)} modes instead."
        )
    viscous = sum(1 for e in case.elements if e.damping)
    loss = sum(1 for e in case.elements if e.loss_factor)
    ground = sum(1 for s in case.stations if s.damping)
    for count, what in (
        (viscous, "elements have viscous damping"),
        (loss, "elements have a loss factor"),
        (ground, "stations have damping to ground"),
    ):
        if count:
            sentences.append(f"{count} {what if count > 1 else _singular(what)}, added by energy.")
    damped = [r for r in rows if r["frequency"] and r.get("damping_ratio")]
    if not damped:
        sentences.append("No mode is damped: a resonance in continuous operation is unbounded, and the "
                    "start shows the build-up without any decay.")  # fmt: skip
        return Section("Damping", (Paragraph(" ".join(sentences)),))
    sentences.append(
        "Damping is an assumption of the inputs: confirm it by experience with like trains. The damping "
        "ratio of each mode and its amplification at resonance, 1/2ζ, stand in the table above."
    )
    blocks: list[Block] = [Paragraph(" ".join(sentences))]
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
        for name in couplings[:FULL]
    )
    left = left_out(len(rows), len(couplings), "couplings", "the first")
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
    left = left_out(drawn, len(modes.elastic_frequency), "mode shapes", "the lowest")
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
