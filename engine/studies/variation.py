"""The same train with one quantity changed: what tuning, scatter and calibration have in common.

A change names a quantity and whose it is, and either multiplies what the case says or stands in
its place. Cases are frozen: a changed one is a new one, and everything not named is shared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow, MeshRow
from engine.case.study_inputs import (
    AVERAGE_TORQUE,
    BACKLASH,
    DAMPING,
    DAMPING_RATIO,
    DIAMETER,
    INERTIA,
    LOAD_TORQUE,
    PULSATING_TORQUE,
    SN_LINE,
    STIFFNESS,
    TUNED,
)
from engine.model.links import link_of
from engine.model.sections import sections_of

#: Table and column of the names that a quantity belongs to; the damping ratio is that of all modes.
_OWNERS = {
    **dict.fromkeys((STIFFNESS, DAMPING, DIAMETER, BACKLASH), ("elements", "element")),
    **dict.fromkeys(
        (INERTIA, AVERAGE_TORQUE, PULSATING_TORQUE, LOAD_TORQUE), ("stations", "station")
    ),
    SN_LINE: ("materials", "material"),
}
#: Columns that a change multiplies or replaces in the rows of its name: table, column of the name,
#: column. An S-N line moves up or down as a whole.
_COLUMNS = {
    INERTIA: (("stations", "station", "inertia"),),
    AVERAGE_TORQUE: (("motor_torque", "station", "average"),),
    PULSATING_TORQUE: (
        ("motor_torque", "station", "pulsating"),
        ("motor_torque", "station", "pulsation_1"),
    ),
    LOAD_TORQUE: (("load_torque", "station", "torque"),),
    SN_LINE: (("sn_points", "material", "stress"), ("materials", "material", "endurance")),
}


#: What to say of a name that lacks the quantity.
_MISSING = {
    STIFFNESS: "'{name}' is a rigid mesh, or has no stiffness. Type its stiffness on sheet Train first.",
    DAMPING: "'{name}' has no Damping on sheet Train to scale. Type it first.",
    INERTIA: "station '{name}' has no Inertia on sheet Train. Give it one first.",
    DIAMETER: (
        "the stiffness of '{name}' does not follow from its diameter. Clear its Stiffness on "
        "sheet Train and type OD, ID, Length and Shear modulus."
    ),
    BACKLASH: "'{name}' has no Backlash or Angular backlash in table Meshes. Give it one first.",
    DAMPING_RATIO: "DampingRatio is blank or zero on sheet Case. Give it a value first.",
    **dict.fromkeys(
        (AVERAGE_TORQUE, PULSATING_TORQUE),
        "station '{name}' has no rows in table MotorTorque. Name a motor.",
    ),
    LOAD_TORQUE: "station '{name}' has no rows in table LoadTorque. Name a driven machine.",
    SN_LINE: "material '{name}' has no rows in table SNPoints. Give it an S-N line first.",
}


@dataclass(frozen=True)
class Change:
    """One quantity of a case, changed."""

    quantity: str  #: One of `TUNED` or `SCATTERED`.
    name: str  #: Element, station or material; empty for the damping ratio.
    value: float  #: What it is multiplied by, or becomes. [1 or SI]
    relative: bool = True  #: Whether it is multiplied.

    def of(self, present: float | None) -> float | None:
        """What becomes of a number; a blank stays blank when multiplied. [SI]

        Parameters
        ----------
        present : float or None
            What the case says. [SI]

        Returns
        -------
        float or None
            What the changed case says. [SI]
        """
        if not self.relative:
            return self.value
        return None if present is None else self.value * present


def varied_case(case: CaseData, changes: Iterable[Change]) -> CaseData:
    """A case with quantities changed, one after the other.

    Parameters
    ----------
    case : CaseData
        The case; it stays as it is. [SI]
    changes : iterable of Change
        Of names that have the quantity, see `refusal`. [SI]

    Returns
    -------
    CaseData
        The changed case, not yet checked. [SI]
    """
    draft = _Draft(case)
    for change in changes:
        if change.quantity in _PUT:
            _PUT[change.quantity](draft, change)
        for table, key, column in _COLUMNS.get(change.quantity, ()):
            _column(draft, table, key, change, column)
    return draft.case()


def names_with(case: CaseData, quantity: str) -> tuple[str, ...]:
    """Who has a quantity: what a blank name of `Scatter` stands for.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    quantity : str
        One of `TUNED` or `SCATTERED`. [word]

    Returns
    -------
    tuple of str
        Elements, stations or materials in the order of their tables; one empty name for the
        damping ratio. [names]
    """
    return tuple(name for name in _names(case, quantity) if refusal(case, name, quantity) is None)


def nominal_value(case: CaseData, name: str, quantity: str) -> float | None:
    """What a case says of a quantity; None where it has no single number, such as a curve.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    name : str
        Element, station or material. [name]
    quantity : str
        One of `TUNED` or `SCATTERED`. [word]

    Returns
    -------
    float or None
        Stiffness [N m/rad], damping [N m s/rad], inertia [kg m²], diameter [m], backlash [m or rad],
        damping ratio [1].
    """
    if quantity == DAMPING_RATIO:
        return case.damping_ratio
    if quantity == INERTIA:
        return next((s.inertia for s in case.stations if s.station == name), None)
    element, mesh = _element(case, name), _mesh(case, name)
    if element is None or quantity not in TUNED:
        return None
    if quantity == BACKLASH:
        return None if mesh is None else mesh.backlash or mesh.angular_backlash
    if quantity == DIAMETER:
        return element.od
    link = link_of(element, mesh, sections_of(case).get(name, ()))
    return link.stiffness if quantity == STIFFNESS else link.viscous


def refusal(case: CaseData, name: str, quantity: str, *, relative: bool = True) -> str | None:
    """Why a quantity of a case cannot be changed.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    name : str
        Element, station or material. [name]
    quantity : str
        One of `TUNED` or `SCATTERED`. [word]
    relative : bool, optional
        Whether it is to be multiplied, for which there must be a number. [flag]

    Returns
    -------
    str or None
        What is missing and what to do, as a sentence; None where it can. [sentence]
    """
    if quantity in _OWNERS and name not in _names(case, quantity):
        return f"the case has no {_OWNERS[quantity][1]} '{name}'. Correct the name."
    if quantity in (STIFFNESS, DAMPING) and not relative:
        return None
    if quantity == DIAMETER:
        element = _element(case, name)
        there = element is not None and element.od is not None and element.stiffness is None
    elif quantity == DAMPING_RATIO:
        there = bool(case.damping_ratio or case.mode_damping)
    elif quantity in TUNED:
        there = bool(nominal_value(case, name, quantity))
    else:
        table, key, _ = _COLUMNS[quantity][0]
        there = any(getattr(row, key) == name for row in getattr(case, table))
    return None if there else _MISSING[quantity].format(name=name)


def _names(case: CaseData, quantity: str) -> list[str]:
    if quantity not in _OWNERS:
        return [""]
    table, key = _OWNERS[quantity]
    return [str(getattr(row, key)) for row in getattr(case, table)]


def _element(case: CaseData, name: str) -> ElementRow | None:
    return next((e for e in case.elements if e.element == name), None)


def _mesh(case: CaseData, name: str) -> MeshRow | None:
    return next((m for m in case.meshes if m.element == name), None)


# --- changed rows ----------------------------------------------------------------------


class _Draft:
    """A case while it is changed: its fields, and where the rows of a name stand in its tables."""

    def __init__(self, case: CaseData) -> None:
        self.fields = dict(vars(case))
        self.sections = sections_of(case)
        self._rows: dict[str, list[Any]] = {}
        self._places: dict[tuple[str, str], dict[Any, list[int]]] = {}

    def rows(self, table: str) -> list[Any]:
        """Rows of a table as changed so far."""
        if table not in self._rows:
            self._rows[table] = list(self.fields[table])
        return self._rows[table]

    def places(self, table: str, key: str, name: str) -> Sequence[int]:
        """Where the rows of a name stand; no change alters a name."""
        if (table, key) not in self._places:
            places = self._places[table, key] = {}
            for i, row in enumerate(self.rows(table)):
                places.setdefault(getattr(row, key), []).append(i)
        return self._places[table, key].get(name, ())

    def row(self, table: str, name: str) -> Any:
        """First row of an element in a table; None without any."""
        places = self.places(table, "element", name)
        return self.rows(table)[places[0]] if places else None

    def change(
        self, table: str, key: str, change: Change, new: Callable[[Any], Mapping[str, Any]]
    ) -> None:
        """The rows of a name say something else."""
        rows = self.rows(table)
        for i in self.places(table, key, change.name):
            rows[i] = _with(rows[i], new(rows[i]))

    def case(self) -> CaseData:
        """With all changes in."""
        tables = {table: tuple(rows) for table, rows in self._rows.items()}
        return CaseData(**self.fields | tables)


def _with(row: Any, values: Mapping[str, Any]) -> Any:
    """A row with other values: as `dataclasses.replace`, at a tenth of its cost in studies of thousands."""
    other = object.__new__(type(row))
    fields = vars(other)
    fields.update(vars(row))
    fields.update(values)
    return other


def _column(draft: _Draft, table: str, key: str, change: Change, column: str) -> None:
    draft.change(table, key, change, lambda row: {column: change.of(getattr(row, column))})


def _elastic(draft: _Draft, change: Change, own: str, along: str) -> None:
    """A torsional constant of an element; of teeth it may stand along the line of action instead."""
    element, mesh = draft.row("elements", change.name), draft.row("meshes", change.name)
    typed = None if element is None else getattr(element, own)
    along_the_teeth = (
        element is not None
        and element.kind == ElementKind.GEAR_MESH
        and typed is None
        and mesh is not None
        and getattr(mesh, along) is not None
    )
    if along_the_teeth and change.relative:
        _column(draft, "meshes", "element", change, along)
        return
    if along_the_teeth:
        draft.change("meshes", "element", change, lambda m: {along: None})

    def new(e: ElementRow) -> Mapping[str, Any]:
        link = link_of(e, mesh, draft.sections.get(change.name, ()))
        return {own: change.of(link.stiffness if own == "stiffness" else link.viscous)}

    draft.change("elements", "element", change, new)


def _diameter(draft: _Draft, change: Change) -> None:
    """The outer diameter; the section where stress is judged changes in proportion."""

    def new(e: ElementRow) -> Mapping[str, Any]:
        od = change.of(e.od)
        if od is None or not e.od or e.stress_diameter is None:
            return {"od": od}
        return {"od": od, "stress_diameter": e.stress_diameter * od / e.od}

    draft.change("elements", "element", change, new)


def _backlash(draft: _Draft, change: Change) -> None:
    def new(m: MeshRow) -> Mapping[str, Any]:
        key = "backlash" if m.backlash else "angular_backlash"
        return {key: change.of(getattr(m, key))}

    draft.change("meshes", "element", change, new)


def _damping_ratio(draft: _Draft, change: Change) -> None:
    draft.fields["damping_ratio"] = change.of(draft.fields["damping_ratio"])
    rows = draft.rows("mode_damping")
    rows[:] = [_with(row, {"damping_ratio": change.of(row.damping_ratio)}) for row in rows]


_PUT: Mapping[str, Callable[[_Draft, Change], None]] = {
    STIFFNESS: partial(_elastic, own="stiffness", along="mesh_stiffness"),
    DAMPING: partial(_elastic, own="damping", along="mesh_damping"),
    DIAMETER: _diameter,
    BACKLASH: _backlash,
    DAMPING_RATIO: _damping_ratio,
}
