"""A rotor that ROSS saved (TOML, JSON) ↔ rows of a case: what twists of it.

Elements lead from node n to node n + 1; disks, gears and coupling halves add inertia at a node. Bearings, seals, point masses and all
that is lateral have no part in torsion. ROSS saves two geared rotors without their mesh, which is taken as rigid.

References
----------
ROSS 3.1, `Rotor.save` and the elements' own arguments; all in SI. A shaft element has G π (D⁴ − d⁴) / 32 L and its inertia ρ π (D⁴ − d⁴) L / 32.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from addin.exchange.chains import chain_of, not_written
from addin.exchange.foreign import ForeignError, ForeignTrain, Row, counted, number_of
from engine.case.case import Case
from engine.case.choices import ElementKind
from engine.case.data import ElementRow, StationRow
from engine.model.links import Link, link_of, shaft_inertia, shaft_stiffness
from engine.model.sections import STEEL, plain_twist, sections_of

_SHAFT, _COUPLING, _DISK, _GEAR = "ShaftElement", "CouplingElement", "DiskElement", "GearElement"
#: Classes of which something is read.
_READ = (_SHAFT, _COUPLING, _DISK, _GEAR)
#: The version whose format is written.
_VERSION = "3.1.0"


def is_ross(content: Mapping[str, Any]) -> bool:
    """Whether a file holds a rotor of ROSS."""
    return any(key.startswith(("ShaftElement", "CouplingElement")) for key in content)


# --- reading -------------------------------------------------------------------------------------


def read_ross(content: Mapping[str, Any]) -> ForeignTrain:
    """A train from a rotor that ROSS saved.

    Parameters
    ----------
    content : mapping
        The file. [SI]

    Returns
    -------
    ForeignTrain
        Its rows. [SI]
    """
    train = ForeignTrain("a rotor of ROSS")
    elements = [
        (key.split("_")[0], str(e.get("tag") or key), e)
        for key, e in content.items()
        if isinstance(e, Mapping) and "Element" in key.split("_")[0] or key.startswith("PointMass")
    ]
    read = [
        (next((c for c in _READ if kind.startswith(c)), kind), tag, e) for kind, tag, e in elements
    ]
    nodes = _Nodes(train)
    for kind, tag, e in read:
        place = f"element '{tag}'"
        n = int(number_of(train, e, "n", place)) if kind in _READ else 0
        if kind in (_DISK, _GEAR):
            nodes.add(n, number_of(train, e, "Ip", place), tag)
        elif kind == _COUPLING:
            nodes.add(n, number_of(train, e, "Ip_l", place))
            nodes.add(n + 1, number_of(train, e, "Ip_r", place))
        elif kind == _SHAFT:
            nodes.add(n, 0.0)
            nodes.add(n + 1, 0.0)
    nodes.stations()
    layers: dict[int, list[tuple[str, _Cylinder]]] = {}
    for kind, tag, e in read:
        if kind == _COUPLING:
            _coupling(tag, e, nodes, train)
        elif kind == _SHAFT and (cylinder := _cylinder(tag, e, train)) is not None:
            layers.setdefault(cylinder.node, []).append((tag, cylinder))
    for node, own in layers.items():
        _shaft(own, {"from": nodes.name(node), "to": nodes.name(node + 1)}, train)
    _mesh([(tag, e) for kind, tag, e in read if kind == _GEAR], nodes, train)
    _tell(Counter(kind for kind, _, _ in read), content, train)
    together = sum(len(own) for own in layers.values() if len(own) > 1)
    if together:
        train.notes.append(
            f"{together} shaft elements lie in layers between the same nodes; those of a layer are one element here, of their "
            "stiffness and inertia together."
        )
    return train


class _Nodes:
    """Inertia and name of each node."""

    def __init__(self, train: ForeignTrain) -> None:
        self.train = train
        self.inertia: dict[int, float] = {}
        self.tags: dict[int, list[str]] = {}

    def add(self, node: int, inertia: float, tag: str = "") -> None:
        """Inertia of a disk, of a gear or of half a coupling. [kg m²]"""
        self.inertia[node] = self.inertia.get(node, 0.0) + inertia
        if tag:
            self.tags.setdefault(node, []).append(tag)

    def name(self, node: int) -> str:
        """The disk that stands alone at a node, else its number."""
        tags = self.tags.get(node, [])
        return tags[0] if len(tags) == 1 else f"Node {node}"

    def stations(self) -> None:
        """A station for each node; one of a shaft alone has the inertia of that shaft."""
        for node, inertia in sorted(self.inertia.items()):
            self.train.add(
                "Stations", {"station": self.name(node), "inertia": inertia or None}, f"node {node}"
            )


class _Cylinder(NamedTuple):
    """A shaft element."""

    node: int  #: Its first node.
    length: float  #: Length. [m]
    od: float  #: Outer diameter at its first node. [m]
    end_od: float  #: Outer diameter at its second node. [m]
    bore: float  #: Bore. [m]
    modulus: float  #: Shear modulus. [Pa]
    density: float  #: Density. [kg/m³]


def _coupling(tag: str, e: Mapping[str, Any], nodes: _Nodes, train: ForeignTrain) -> None:
    place = f"element '{tag}'"
    n = int(number_of(train, e, "n", place))
    row: Row = {"element": tag, "kind": "coupling", "from": nodes.name(n), "to": nodes.name(n + 1)}
    damping = number_of(train, e, "cr_z", place, 0.0)
    row |= {"stiffness": number_of(train, e, "kr_z", place), "damping": damping or None}
    train.add("Elements", row, place)


def _cylinder(tag: str, e: Mapping[str, Any], train: ForeignTrain) -> _Cylinder | None:
    """Dimensions of a shaft element; None, with the problem noted, for what is none."""
    place, before = f"element '{tag}'", len(train.problems)
    material = e.get("material")
    if not isinstance(material, Mapping):
        train.refuse(place, "no material", "a material", "the element has no material.")
        return None
    n, length, od, bore = (number_of(train, e, key, place) for key in ("n", "L", "odl", "idl"))
    end = number_of(train, e, "odr", place, od)
    end_bore = number_of(train, e, "idr", place, bore)
    if end_bore != bore:
        train.refuse(
            place,
            f"idl {bore:.6g} m, idr {end_bore:.6g} m",
            "one bore in an element",
            "the bore is conical, which a section cannot be. Cut the element into some of constant bore.",
        )
    modulus, density = (number_of(train, material, key, place) for key in ("G_s", "rho"))
    known = len(train.problems) == before
    return _Cylinder(int(n), length, od, end, bore, modulus, density) if known else None


def _shaft(layers: list[tuple[str, _Cylinder]], ends: Row, train: ForeignTrain) -> None:
    """What lies between two nodes: one shaft, tapered or not, or layers that twist as one."""
    tag, first = layers[0]
    place = f"element '{tag}'"
    row: Row = {"element": tag, "kind": "shaft", **ends}
    geometry = {"length": first.length, "od": first.od, "id": first.bore or None}
    if len(layers) > 1:
        train.add("Elements", row | _as_one(layers, train), place)
    elif first.od == first.end_od:
        own = {"shear_modulus": first.modulus, "density": first.density or None}
        train.add("Elements", row | geometry | own, place)
    else:
        name = f"{first.modulus / 1e9:.9g} GPa, {first.density:.9g} kg/m³"
        train.add("Elements", row, place)
        section = {"element": tag, **geometry, "end_od": first.end_od, "material": name}
        train.add("Sections", section, place)
        known = train.tables.get("SectionMaterials", [])
        if all(m["material"] != name for m in known):
            numbers = {"shear_modulus": first.modulus, "density": first.density}
            train.add("SectionMaterials", {"material": name, **numbers, "source": "ROSS"}, place)


def _as_one(layers: list[tuple[str, _Cylinder]], train: ForeignTrain) -> Row:
    """Stiffness and inertia of layers together, as one tube of their outer and inner diameter."""
    cylinders = [c for _, c in layers]
    length, od = cylinders[0].length, max(c.od for c in cylinders)
    bore = min(c.bore for c in cylinders)
    for tag, c in layers:
        if c.od != c.end_od or c.length != length:
            train.refuse(
                f"element '{tag}'",
                f"odl {c.od:.6g} m, odr {c.end_od:.6g} m, L {c.length:.6g} m",
                "cylinders of one length",
                "it lies with another element between the same nodes, and they are no cylinders of one length. Cut them into "
                "such.",
            )
            return {}
    if not all(c.length > 0.0 and c.od > c.bore for c in cylinders):
        train.refuse(
            f"element '{layers[0][0]}'",
            "dimensions",
            "positive length and wall",
            "one of the elements between its nodes has no length or no wall.",
        )
        return {}
    inertia = sum(shaft_inertia(c.od, c.bore, length, c.density) for c in cylinders)
    return {
        "stiffness": sum(shaft_stiffness(c.od, c.bore, length, c.modulus) for c in cylinders),
        "od": od,
        "id": bore or None,
        "length": length,
        "density": inertia / shaft_inertia(od, bore, length, 1.0) or None,
    }


def _mesh(gears: list[tuple[str, Mapping[str, Any]]], nodes: _Nodes, train: ForeignTrain) -> None:
    """The mesh of two gears; of more gears the file does not say which mesh."""
    if not gears:
        return
    if len(gears) != 2:
        train.notes.append(
            f"{counted(len(gears), 'gear')}: the file does not say which of them mesh. Add elements of kind gear mesh in the "
            "workbook."
        )
        return
    (drive, a), (driven, b) = gears
    places = [f"element '{tag}'" for tag, _ in gears]
    row = {"element": f"{drive} - {driven}", "kind": "gear mesh"}
    ends = [
        nodes.name(int(number_of(train, e, "n", place)))
        for (_, e), place in zip(gears, places, strict=True)
    ]
    train.add("Elements", row | {"from": ends[0], "to": ends[1]}, places[0])
    teeth = [
        int(number_of(train, e, "n_teeth", p)) for (_, e), p in zip(gears, places, strict=True)
    ]
    radii = [
        0.5 * number_of(train, e, "pitch_diameter", p)
        for (_, e), p in zip(gears, places, strict=True)
    ]
    train.add(
        "Meshes",
        {
            "element": row["element"],
            "teeth_drive": teeth[0],
            "teeth_driven": teeth[1],
            "pitch_radius_drive": radii[0],
            "pitch_radius_driven": radii[1],
            "pressure_angle": number_of(train, a, "pr_angle", places[0]),
            "helix_angle": number_of(train, a, "helix_angle", places[0], 0.0) or None,
        },
        places[0],
    )
    train.notes.append(
        f"'{drive}' and '{driven}' are taken to mesh, rigidly: ROSS does not save the mesh. Type its stiffness in the workbook; "
        "the speed ratio is that of the teeth."
    )


def _tell(kinds: Counter[str], content: Mapping[str, Any], train: ForeignTrain) -> None:
    """What was read and what not."""
    read = ", ".join(f"{kinds[k]} {k}" for k in _READ if kinds[k])
    train.notes.insert(0, f"Read in SI: {read}.")
    left = ", ".join(f"{n} {kind}" for kind, n in kinds.items() if kind not in _READ)
    if left:
        train.notes.append(f"Not read, having no part in torsion: {left}.")
    if kinds[_DISK] or kinds[_GEAR] or kinds[_COUPLING]:
        train.notes.append("Not read: masses, transverse inertias, lateral and axial data.")
    beta = [
        e for e in content.values() if isinstance(e, Mapping) and (e.get("beta") or e.get("alpha"))
    ]
    if beta:
        train.notes.append(
            "Not read: damping by alpha and beta. Type DampingRatio in the workbook."
        )
    if kinds[_SHAFT]:
        train.notes.append(
            "Inertia of shafts is distributed here; ROSS has it at the nodes, so its higher frequencies differ more, the "
            "coarser its elements."
        )


# --- writing -------------------------------------------------------------------------------------


def ross_of(case: Case) -> tuple[dict[str, Any], list[str]]:
    """A train of one shaft line as a rotor of ROSS.

    Parameters
    ----------
    case : Case
        The train. [SI]

    Returns
    -------
    content : dict
        The JSON that `Rotor.load` reads. [SI]
    notes : list of str
        What the format cannot hold. [sentences]

    Raises
    ------
    ForeignError
        If the train has gears or branches, or no shaft with dimensions.
    """
    gear = next((e for e in case.elements if e.kind == ElementKind.GEAR_MESH), None)
    if gear is not None:
        raise ForeignError(
            f"a rotor of ROSS has one shaft line, but '{gear.element}' is a gear mesh. Export a table of text (.csv), or each "
            "shaft line by itself."
        )
    notes: list[str] = []
    stations = {s.station: s for s in case.stations}
    order = chain_of(case, "a rotor of ROSS")
    sections = sections_of(case)
    content: dict[str, Any] = {"ross_version": _VERSION, "parameters": {}}
    lumped = [stations[order[0][0]].inertia or 0.0]
    named = {0: order[0][0]}
    for at, e, forward in order[1:]:
        own = sections.get(str(e.element), ())
        link = link_of(e, None, own)
        if own and e.stiffness is None:
            written = _cylinders(case, e, link, len(lumped) - 1, forward, notes)
        else:
            written = dict([_element(e, link, len(lumped) - 1, notes, lumped)])
        content |= written
        lumped += [0.0] * (max(x["n"] for x in written.values()) + 2 - len(lumped))
        lumped[-1] += stations[at].inertia or 0.0
        named[len(lumped) - 1] = at
    if not any(key.startswith(_SHAFT) for key in content):
        raise ForeignError(
            "ROSS needs a shaft with dimensions (OD, Length, Shear modulus and Density, or rows in Sections), but every "
            "element has a stiffness alone. Export a table of text (.csv) instead."
        )
    for n, at in named.items():
        if lumped[n]:
            content[f"{_DISK}_{at}"] = {"n": n, "m": 0.0, "Id": 0.0, "Ip": lumped[n], "tag": at}
    notes += _unheld(case, stations)
    return content, notes


def _element(
    e: ElementRow, link: Link, n: int, notes: list[str], lumped: list[float]
) -> tuple[str, dict[str, Any]]:
    """A shaft with dimensions as such, all else as a coupling with half its inertia at each end."""
    if e.od and e.length and e.shear_modulus and e.density and e.stiffness is None:
        size = {"L": e.length, "idl": e.id or 0.0, "odl": e.od, "idr": e.id or 0.0, "odr": e.od}
        if link.viscous:
            notes.append(
                f"Damping of '{e.element}' is not written: a shaft of ROSS has none of its own."
            )
        material = _material(e.shear_modulus, e.density)
        return f"{_SHAFT}_{e.element}", size | {"n": n, "tag": e.element, "material": material}
    if link.inertia:
        notes.append(
            f"'{e.element}' is written as a coupling of its stiffness, with half of its inertia at each end."
        )
        lumped[n] += 0.5 * link.inertia
        lumped.append(0.5 * link.inertia)
    coupling = {"m_l": 0.0, "m_r": 0.0, "Ip_l": 0.0, "Ip_r": 0.0, "kr_z": link.stiffness}
    own = {"cr_z": link.viscous, "n": n, "tag": e.element}
    return f"{_COUPLING}_{e.element}", coupling | own


def _cylinders(
    case: Case, e: ElementRow, link: Link, n: int, forward: bool, notes: list[str]
) -> dict[str, dict[str, Any]]:
    """The sections of an element as shafts, one behind the other."""
    materials = {m.material: m for m in case.section_materials}
    rows = [row for row in case.sections if row.element == e.element]
    written: dict[str, dict[str, Any]] = {}
    twist = 0.0
    for i, row in enumerate(rows if forward else reversed(rows)):
        bore, ends = row.id or 0.0, (row.od or 0.0, row.last_od or 0.0)
        left, right = ends if forward else ends[::-1]
        material = materials.get(row.material, STEEL)
        modulus, density = material.shear_modulus or 0.0, material.density or 0.0
        tag = f"{e.element} {row.section or i + 1}"
        size = {"L": row.length, "idl": bore, "odl": left, "idr": bore, "odr": right}
        written[f"{_SHAFT}_{n + i}_{tag}"] = size | {
            "n": n + i, "tag": tag, "material": _material(modulus, density),
        }  # fmt: skip
        twist += plain_twist(row, modulus)
    stiffer = 1.0 / (twist * (link.stiffness or math.inf)) - 1.0
    if abs(stiffer) > 1e-3:
        notes.append(
            f"The sections of '{e.element}' are written as cylinders. Without what their steps, hubs and keyways do, they are "
            f"{100.0 * abs(stiffer):.2g} % {'stiffer' if stiffer > 0.0 else 'softer'} than here."
        )
    if link.viscous:
        notes.append(
            f"Damping of '{e.element}' is not written: a shaft of ROSS has none of its own."
        )
    return written


def _material(modulus: float, density: float) -> dict[str, Any]:
    """ROSS calculates from G_s alone in torsion; E is that of steel's Poisson's ratio, and names have no blanks."""
    return {"name": f"rho_{density:.6g}", "rho": density, "G_s": modulus, "E": 2.6 * modulus}


def _unheld(case: Case, stations: Mapping[str | None, StationRow]) -> Iterator[str]:
    yield (
        "Masses and transverse inertias are 0 and there are no bearings: enough for torsion. Add them in ROSS for lateral "
        "analyses."
    )
    if any(s.damping for s in stations.values()):
        yield "Damping of stations to ground is not written."
    yield from not_written(case)
