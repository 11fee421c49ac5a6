"""From a case to the arrays of its train."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from engine.case.choices import ElementKind, GearType
from engine.case.data import CaseData
from engine.errors import ModelError
from engine.model.assembly import Assembly
from engine.model.gear_bodies import add_bodies, body_data, flanks_of
from engine.model.links import has_clearance, link_of
from engine.model.sections import UNIFORM, sections_of
from engine.model.topology import drive_ends, merge_rigid, rigid_meshes, senses_of_rotation
from engine.model.train import GearBody, Train


def build_train(
    case: CaseData, segments: Mapping[str, int] | None = None, *, lateral: bool = True
) -> Train:
    """Turn a case into arrays.

    Parameters
    ----------
    case : CaseData
        The case; meant to be a checked `Case`. [SI]
    segments : mapping of str to int, optional
        Number of segments of each shaft that has inertia of its own; default 1. An element with
        a clearance stays one piece: it separates in one place. [count]
    lateral : bool, optional
        Whether gears with bearing data move laterally; False: their bearings are rigid. [flag]

    Returns
    -------
    Train
        Masses, stiffnesses, incidence. [SI]

    Raises
    ------
    ModelError
        For an element without stiffness, a node without inertia, or a gear on bearings whose mesh
        lacks stiffness or pitch radius.
    """
    meshes = {m.element: m for m in case.meshes}
    sections = sections_of(case)
    links = [
        link_of(e, meshes.get(e.element), sections.get(str(e.element), ())) for e in case.elements
    ]
    gaps = {e.element for e in case.elements if has_clearance(meshes.get(e.element))}
    a = Assembly(case)
    for i, (e, link) in enumerate(zip(case.elements, links, strict=True)):
        if e.element in gaps:
            a.add(i, e, replace(link, profile=UNIFORM), 1)
        else:
            a.add(i, e, link, (segments or {}).get(str(e.element), 1))
    orientation, sides, reference = drive_ends(case, a)
    internal = {m.element for m in case.meshes if m.gear_type == GearType.INTERNAL}
    flips = {
        i: e.kind == ElementKind.GEAR_MESH and e.element not in internal
        for i, e in enumerate(case.elements)
    }
    sense = senses_of_rotation(a, len(case.stations), reference, flips)
    bodies: tuple[GearBody, ...] = ()
    backs: dict[int, dict[int, float]] = {}
    if lateral and (data := body_data(case, a)):
        bodies, backs = add_bodies(case, a, data, orientation, sense)
        sense = np.concatenate([sense, np.ones(2 * len(bodies))])
    ratio = np.array(a.ratio)
    inertia = np.array(a.inertia)
    dof, scale, n_dof = merge_rigid(a.rigid, a.ratio)
    row = np.array([r for r, (*_, entries) in enumerate(a.rows) for _ in entries], dtype=np.int64)
    node = np.array([n for *_, entries in a.rows for n in entries], dtype=np.int64)
    factor = np.array([f for *_, entries in a.rows for f in entries.values()])
    node_incidence = np.zeros((len(a.rows), len(ratio)))
    node_incidence[row, node] = factor
    incidence = node_incidence  # without rigid meshes
    if n_dof < len(ratio):
        incidence = np.zeros((len(a.rows), n_dof))
        np.add.at(incidence, (row, dof[node]), factor * scale[node])
    dof_inertia = np.asarray(np.bincount(dof, inertia * scale**2, n_dof), dtype=np.float64)
    if np.any(dof_inertia <= 0.0):
        massless = int(np.flatnonzero(dof == int(np.argmin(dof_inertia)))[0])
        raise ModelError(f"Station '{case.stations[massless].station}' has no inertia.")
    return Train(
        stations=tuple(str(st.station) for st in case.stations),
        elements=tuple(str(e.element) for e in case.elements),
        speed_ratio=ratio,
        sense=sense,
        node_inertia=inertia,
        node_damping=np.array(a.damping),
        node_dof=dof,
        node_scale=scale,
        inertia=dof_inertia,
        stiffness=np.array([row[1] for row in a.rows]),
        viscous=np.array([row[2] for row in a.rows]),
        loss_factor=np.array([row[3] for row in a.rows]),
        node_incidence=node_incidence,
        incidence=incidence,
        row_element=np.array([row[0] for row in a.rows], dtype=np.int64),
        rigid_meshes=rigid_meshes(a.rigid, ratio),
        shaft_ends=tuple(end for end in a.ends if case.elements[end.element].element not in gaps),
        orientation=orientation,
        beyond=sides,
        bodies=bodies,
        flanks=flanks_of(case, a, node_incidence, orientation, backs),
    )
