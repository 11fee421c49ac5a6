"""openTorsion's file of components (TORS, JSON) ↔ rows of a case.

A component is a row of elements from one node to the next: disks and gears stand at a node, a shaft leads to the next node, and a
gear with a parent stands at a node of its own. `structure` lists which element of one component another one follows. The format has
no branches other than at gears, no stiffness of teeth, and shafts of 80 GPa and, where it is not given, 8000 kg/m³.

References
----------
openTorsion 0.3, `Assembly.from_tors`; OpenTorsion-Editor, types of a system. Lengths and diameters are in mm, all else is in SI.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from addin.exchange.chains import chain_of, not_written
from addin.exchange.foreign import ForeignError, ForeignTrain, Row, counted, number_of
from engine.case.case import Case
from engine.case.choices import ElementKind
from engine.case.data import ElementRow, MeshRow
from engine.model.links import Link, link_of
from engine.model.sections import sections_of
from engine.numerics.same_bits import fourth

#: What openTorsion takes for shafts from their dimensions. [Pa, kg/m³]
SHEAR_MODULUS, DENSITY = 80e9, 8000.0
#: Diameter of the smaller of two gears of which the file has the ratio alone. [mm]
_ANY_DIAMETER = 100.0
_KNOWN = ("Disk", "ShaftDiscrete", "ShaftContinuous", "GearElement")


def is_opentorsion(content: Mapping[str, Any]) -> bool:
    """Whether a JSON is a system of openTorsion."""
    return isinstance(content.get("components"), list)


# --- reading -------------------------------------------------------------------------------------


def read_opentorsion(content: Mapping[str, Any]) -> ForeignTrain:
    """A train from a system of openTorsion.

    Parameters
    ----------
    content : mapping
        The JSON. [as typed]

    Returns
    -------
    ForeignTrain
        Its rows. [SI]

    Raises
    ------
    ForeignError
        If the components are no chain.
    """
    train = ForeignTrain("a system of openTorsion (TORS)")
    return _Walk(train, list(_elements(content, train))).read()


def _elements(
    content: Mapping[str, Any], train: ForeignTrain
) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    """Component, name and data of every element, in the order of the nodes."""
    components = {str(c.get("name")): c for c in content["components"] if isinstance(c, Mapping)}
    follows: dict[str, str] = {}
    for pair in content.get("structure") or []:
        if not (
            isinstance(pair, Sequence) and len(pair) == 2 and all(isinstance(p, str) for p in pair)
        ):
            raise ForeignError("a row of structure is no pair of elements. Save the system again.")
        if follows.setdefault(pair[0], pair[1].split(".")[0]) != pair[1].split(".")[0]:
            raise ForeignError(
                f"two components follow element '{pair[0]}'. openTorsion reads them as one chain; join them by gears, or "
                "build the branch in the workbook."
            )
    starts = [name for name in components if name not in follows.values()]
    if len(starts) != 1:
        raise ForeignError(
            f"{counted(len(starts), 'component')} of the system follow no other one; a train has one such. Join the "
            "components in structure."
        )
    seen: list[str] = []

    def walk(name: str) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        if name in seen or name not in components:
            raise ForeignError(
                f"component '{name}' is missing or follows itself. Correct structure."
            )
        seen.append(name)
        for element in components[name].get("elements") or []:
            own = str(element.get("name", ""))
            yield name, own, element
            if f"{name}.{own}" in follows:
                yield from walk(follows[f"{name}.{own}"])

    yield from walk(starts[0])
    apart = [name for name in components if name not in seen]
    if apart:
        train.notes.append(f"Not read, because no element leads there: {', '.join(apart)}.")


class _Walk:
    """One pass over the elements, from node to node."""

    def __init__(
        self, train: ForeignTrain, elements: list[tuple[str, str, Mapping[str, Any]]]
    ) -> None:
        self.train, self.elements = train, elements
        names = [name for _, name, _ in elements]
        self.unique = {name for name in names if names.count(name) == 1}
        self.node = 0
        self.inertia: dict[int, float] = {0: 0.0}
        self.damping: dict[int, float] = {}
        self.names: dict[int, str] = {}
        self.gear_names: dict[int, str] = {}
        self.gears: dict[tuple[str, str], tuple[int, Mapping[str, Any]]] = {}
        self.rows: list[tuple[Row, str]] = []
        self.meshes: list[tuple[Row, str]] = []

    def read(self) -> ForeignTrain:
        """Rows of stations, elements and meshes."""
        kinds: dict[str, int] = {}
        ignored = 0
        for component, own, element in self.elements:
            place = f"component '{component}', element '{own}'"
            kind = str(element.get("type"))
            name = own if own in self.unique else f"{component} {own}"
            kinds[kind] = kinds.get(kind, 0) + 1
            ignored += "excitation" in element
            if kind == "Disk":
                self._at_node(element, place)
                self.names.setdefault(self.node, name)
            elif kind in ("ShaftDiscrete", "ShaftContinuous"):
                self._shaft(kind, element, name, place)
            elif kind == "GearElement":
                self._gear(component, own, element, name, place)
            else:
                self.train.refuse(
                    place, kind, f"one of {', '.join(_KNOWN)}", f"type {kind} is not known."
                )
        self._stations()
        for row, place in self.rows:
            self.train.add("Elements", self._named(row), place)
        for row, place in self.meshes:
            self.train.add("Meshes", row, place)
        listed = ", ".join(f"{n} {kind}" for kind, n in kinds.items() if kind in _KNOWN)
        self.train.notes.insert(0, f"Read in SI, lengths and diameters in mm: {listed}.")
        if kinds.get("ShaftContinuous"):
            self.train.notes.append(
                "ShaftContinuous: shear modulus 80 GPa, as openTorsion takes it; density as in the file, else 8000 kg/m³."
            )
        if ignored:
            self.train.notes.append(
                f"Not read: {counted(ignored, 'excitation')}. Type torques in the workbook."
            )
        return self.train

    def _at_node(self, element: Mapping[str, Any], place: str) -> None:
        node = self.node
        self.inertia[node] = self.inertia.get(node, 0.0) + number_of(
            self.train, element, "inertia", place
        )
        self.damping[node] = self.damping.get(node, 0.0) + number_of(
            self.train, element, "damping", place, 0.0
        )

    def _shaft(self, kind: str, element: Mapping[str, Any], name: str, place: str) -> None:
        row: Row = {"element": name, "kind": "shaft", "from": self.node, "to": self.node + 1}
        if kind == "ShaftDiscrete":
            row["stiffness"] = number_of(self.train, element, "stiffness", place)
        else:
            for key, column in (
                ("outerDiameter", "od"),
                ("innerDiameter", "id"),
                ("length", "length"),
            ):
                row[column] = f"{number_of(self.train, element, key, place)!r} mm"
            row |= {
                "shear_modulus": SHEAR_MODULUS,
                "density": number_of(self.train, element, "density", place, DENSITY),
            }
        damping = number_of(self.train, element, "damping", place, 0.0)
        self.rows.append((row | ({"damping": damping} if damping else {}), place))
        self.node += 1
        self.inertia.setdefault(self.node, 0.0)

    def _gear(
        self, component: str, own: str, element: Mapping[str, Any], name: str, place: str
    ) -> None:
        parent = element.get("parent")
        known = self.gears.get((component, str(parent)))
        if parent and known is None:
            self.train.refuse(
                place,
                parent,
                "a gear of this component",
                f"its parent '{parent}' is no gear before it.",
            )
        if known is not None:
            self.node += 1
            parent_node, parent_gear = known
            mesh_name = f"{parent} - {own}"
            ends = {"from": parent_node, "to": self.node}
            row = {"element": mesh_name, "kind": "gear mesh", **ends}
            self.rows.append((row, place))
            self.meshes.append((self._ratio(mesh_name, parent_gear, element, place), place))
        self._at_node(element, place)
        self.gear_names.setdefault(self.node, name)
        self.gears[component, own] = self.node, element

    def _ratio(
        self, mesh: str, parent: Mapping[str, Any], child: Mapping[str, Any], place: str
    ) -> Row:
        """The row of Meshes: teeth where both gears have them, else diameters."""
        pair = (parent, child)
        if all("teeth" in gear for gear in pair):
            teeth = [number_of(self.train, gear, "teeth", place) for gear in pair]
            if all(n.is_integer() for n in teeth):
                return {
                    "element": mesh,
                    "teeth_drive": int(teeth[0]),
                    "teeth_driven": int(teeth[1]),
                }
            return {"element": mesh, "speed_ratio": teeth[0] / teeth[1] if teeth[1] else 0.0}
        if any("teeth" in gear for gear in pair):
            self.train.refuse(
                place,
                "teeth",
                "teeth of both gears",
                "one gear has teeth and the other a diameter.",
            )
        radii = [f"{0.5 * number_of(self.train, g, 'diameter', place)!r} mm" for g in pair]
        return {"element": mesh, "pitch_radius_drive": radii[0], "pitch_radius_driven": radii[1]}

    def _station(self, node: int) -> str:
        return self.names.get(node) or self.gear_names.get(node) or f"Node {node}"

    def _named(self, row: Row) -> Row:
        return row | {end: self._station(row[end]) for end in ("from", "to")}

    def _stations(self) -> None:
        for node, inertia in self.inertia.items():
            damping = self.damping.get(node)
            row = {"station": self._station(node), "inertia": inertia or None}
            self.train.add("Stations", row | {"damping": damping or None}, f"node {node}")


# --- writing -------------------------------------------------------------------------------------


def opentorsion_of(case: Case, name: str) -> tuple[dict[str, Any], list[str]]:
    """A train as a system of openTorsion with one component.

    Parameters
    ----------
    case : Case
        The train. [SI]
    name : str
        Of the system. [name]

    Returns
    -------
    content : dict
        The JSON. [SI, mm]
    notes : list of str
        What the format cannot hold. [sentences]

    Raises
    ------
    ForeignError
        If the train has branches or an end at ground.
    """
    notes: list[str] = []
    stations = {s.station: s for s in case.stations}
    meshes = {m.element: m for m in case.meshes}
    sections = sections_of(case)
    order = chain_of(case, "openTorsion's file")
    elements: list[dict[str, Any]] = [_disk(stations[order[0][0]])]
    for at, e, onward in order[1:]:
        link = link_of(e, meshes.get(e.element), sections.get(str(e.element), ()))
        if e.kind == ElementKind.GEAR_MESH:
            sizes = _sizes(case, e, meshes.get(e.element), onward)
            parent, child = f"{e.element}, drive", f"{e.element}, driven"
            gear = {"type": "GearElement", "inertia": 0.0}
            elements += [
                {"name": parent, **gear, **sizes[0]},
                {"name": child, "parent": parent, **gear, **sizes[1]},
            ]
            if link.stiffness is not None or link.viscous:
                notes.append(f"Mesh '{e.element}' is rigid: the format has no stiffness of teeth.")
        else:
            elements.append(_shaft_of(e, link, sections.get(str(e.element)) is not None, notes))
        elements.append(_disk(stations[at]))
    if any(m.backlash or m.angular_backlash for m in case.meshes):
        notes.append("Clearances are not written.")
    notes += not_written(case)
    component = {"name": "Train", "elements": elements}
    return {"name": name, "structure": [], "components": [component]}, notes


def _disk(station: Any) -> dict[str, Any]:
    return {
        "name": station.station,
        "type": "Disk",
        "inertia": station.inertia or 0.0,
        "damping": station.damping or 0.0,
    }


def _shaft_of(e: ElementRow, link: Link, stepped: bool, notes: list[str]) -> dict[str, Any]:
    """A shaft; one with inertia as openTorsion's cylinder of 80 GPa that twists and turns as much."""
    damping = link.viscous
    if not link.inertia:
        kind = {"type": "ShaftDiscrete", "stiffness": link.stiffness}
        return {"name": e.element, **kind, "damping": damping}
    stiffness, od, bore, length = float(link.stiffness or 0.0), e.od, e.id or 0.0, e.length or 1.0
    own = not stepped and e.stiffness is None and e.shear_modulus == SHEAR_MODULUS
    if not own:
        bore, od = 0.0, (32.0 * stiffness * length / (math.pi * SHEAR_MODULUS)) ** 0.25
        notes.append(
            f"Shaft '{e.element}' is written as a solid cylinder of 80 GPa with the same stiffness and inertia."
        )
    polar = math.pi * (fourth(float(od or 0.0)) - fourth(bore)) / 32.0
    return {
        "name": e.element,
        "type": "ShaftContinuous",
        "damping": damping,
        "length": 1e3 * length,
        "outerDiameter": 1e3 * float(od or 0.0),
        "innerDiameter": 1e3 * bore,
        "density": e.density if own else link.inertia / (polar * length),
    }


def _sizes(
    case: Case, e: ElementRow, mesh: MeshRow | None, onward: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Sizes of the gear that is met first and of the other one."""
    ratio = case.speed_ratios[e.to] / case.speed_ratios[e.from_]
    drive = {"diameter": _ANY_DIAMETER * max(ratio, 1.0)}
    driven = {"diameter": drive["diameter"] / ratio}
    if mesh is not None and mesh.pitch_radius_drive and mesh.pitch_radius_driven:
        drive = {"diameter": 2e3 * mesh.pitch_radius_drive}
        driven = {"diameter": 2e3 * mesh.pitch_radius_driven}
    if mesh is not None and mesh.teeth_drive and mesh.teeth_driven:
        drive |= {"teeth": mesh.teeth_drive}
        driven |= {"teeth": mesh.teeth_driven}
    return (drive, driven) if onward else (driven, drive)
