"""Natural frequencies, damping, energies and nodes, tolerances, mode shapes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from addin.report.document import Column, Paragraph, Section, Table, section
from addin.report.equations import by
from addin.report.numbers import clean, fixed, significant
from addin.report.subject import Subject
from addin.report.tables import FULL, left_out, with_column

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
    title, rows = "Natural frequencies and mode shapes", subject.rows("NaturalFrequencies")
    count = shown_modes(subject)
    elastic = sum(1 for row in rows if row["frequency"])
    chosen = [row for row in rows if row["mode"] <= count]
    if not elastic:
        sentence = "The train has no elastic mode: no elastic element joins two inertias."
        return section(title, Paragraph(sentence))
    rigid = len(rows) - elastic
    words = "one rigid-body mode" if rigid == 1 else f"{rigid} rigid-body modes"
    notes = (
        f"Mode 0: {words}." if rigid else "",
        "Speed: crossing of 2 × slip frequency in the start; blank above 2 × line frequency. "
        "Damping ratio: fraction of critical in the start.",
        left_out(count, elastic, "elastic modes", "the lowest"),
        by("Natural frequencies", "Modal damping", "Start-up crossing"),
    )
    table = subject.table("NaturalFrequencies", note=" ".join(filter(None, notes)), rows=chosen)
    amplifications = [
        significant(0.5 / r["damping_ratio"], 3) if r.get("damping_ratio") else "" for r in chosen
    ]
    column = Column("Amplification", "", "number")
    return section(
        title,
        with_column(table, "Damping ratio", column, amplifications),
        parts=(
            _damping(subject, chosen),
            _energies(subject, count),
            *_tolerances(subject, count),
            _shapes(subject, count),
        ),
    )


def _damping(subject: Subject, rows: Sequence[Mapping[str, Any]]) -> Section:
    """What damping was assumed, and the amplification it means for each mode."""
    case = subject.calculation.case
    stated = case.damping_ratio
    sentences = [
        "No damping ratio is stated (DampingRatio is blank)."
        if stated is None
        else (
            "Damping ratio stated for all elastic modes: "
            f"{significant(100.0 * stated, 3)} % of critical (DampingRatio)."
        )
    ]
    if case.mode_damping:
        sentences.append(
            "Modes with a damping ratio of their own in table ModeDamping: "
            f"{len(case.mode_damping)}."
        )
    for kind, rows_of_kind, column, what in (
        ("element", case.elements, "damping", "viscous damping"),
        ("element", case.elements, "loss_factor", "a loss factor"),
        ("station", case.stations, "damping", "damping to ground"),
    ):
        count = sum(bool(getattr(row, column)) for row in rows_of_kind)
        if count:
            which = f"{kind}s have" if count > 1 else f"{kind} has"
            sentences.append(
                f"{count} {which} {what}, which is included in the damping ratio of each mode."
            )
    item, neglected = "Largest neglected damping term", None
    if any(r["frequency"] and r.get("damping_ratio") for r in rows):
        sentences.append(
            "Damping is an assumed input: confirm it by experience with similar trains. The "
            "table above gives the damping ratio of each mode and its amplification at "
            "resonance, 1/2ζ."
        )
        if item in subject.audit:
            neglected = Paragraph(f"{item}: {clean(subject.audit[item])}.", "note")
    else:
        sentences.append(
            "All modes are undamped: resonance in continuous operation is unbounded, and "
            "vibration in the start does not decay."
        )
    return section("Damping", Paragraph(" ".join(sentences)), neglected)


def _energies(subject: Subject, count: int) -> Section:
    """Nodes and where the energy of each mode is: what a change of the train would act on."""
    place = ("NaturalFrequencies", "Frequency")
    columns = (
        Column("Mode", "", "number"),
        Column("Frequency", subject.unit(*place), "number"),
        Column("Strain energy", "", "sentence"),
        Column("Kinetic energy", "", "sentence"),
        Column("Nodes", "", "sentence"),
    )
    rows = []
    for mode in subject.calculation.details["modes"][:count]:
        strain = dict(mode["strain_energy"]) | {
            f"bearing of {k}": v for k, v in mode.get("bearing_strain_energy", {}).items()
        }
        kinetic = dict(mode["kinetic_energy"]) | {
            f"{k} lateral": v for k, v in mode.get("sideways_kinetic_energy", {}).items()
        }
        names = [clean(n["element"]) for n in mode["nodes"]]
        nodes = "; ".join(names[:_NODES]) or "none"
        if len(names) > _NODES:
            nodes += f"; and {len(names) - _NODES} more"
        frequency = fixed(subject.value(mode["frequency"], *place), 2)
        rows.append((str(mode["mode"]), frequency, _shares(strain), _shares(kinetic), nodes))
    note = (
        f"Shares of at least {100 * _SHARE:.0f} %, largest first. A node lies inside the "
        "element named. To shift a mode, change stiffness where it has strain energy or "
        "inertia where it has kinetic energy."
    )
    table = Table("Energies and nodes of the modes", columns, tuple(rows), note)
    return section("Energies and nodes", table)


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
    columns = [Column("Coupling")]
    columns += [Column(f"Mode {mode['mode']}", "%", "number") for mode in modes]
    shares = [dict(mode["strain_energy"]) for mode in modes]
    rows = tuple(
        (clean(name), *(fixed(50.0 * _TOLERANCE * share.get(name, 0.0), 2) for share in shares))
        for name in couplings[:FULL]
    )
    stiffer = f"{100.0 * _TOLERANCE:.0f} %"
    left = left_out(len(rows), len(couplings), "couplings", "the first")
    note = (
        "Half the strain-energy share times the stiffness change (first order, Rayleigh's quotient); "
        f"a softer coupling lowers the frequency by the same amount. {stiffer} is for comparison only: "
        f"the actual tolerance is the maker's and is not an input. {left}".rstrip()
    )
    caption = f"Frequency change if a coupling is {stiffer} stiffer"
    yield section(
        "Stiffness tolerance of the couplings", Table(caption, tuple(columns), rows, note)
    )


def _shapes(subject: Subject, count: int) -> Section:
    rows = subject.rows("ModeShapes")
    drawn = min(count, _SHAPES)
    some = [
        {k: v for k, v in row.items() if k == "station" or int(k.split("_")[1]) <= drawn}
        for row in rows
    ]
    elastic = len(subject.calculation.results.modes.elastic_frequency)
    note = left_out(drawn, elastic, "mode shapes", "the lowest")
    caption = "Mode shapes: twist of each station, largest = 1"
    return section(
        "Mode shapes",
        subject.pictures.shapes(rows),
        subject.table("ModeShapes", caption, note=note, rows=some),
    )
