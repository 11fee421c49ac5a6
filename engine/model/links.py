"""What an element row means mechanically: stiffness, damping and inertia, from numbers or geometry."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from engine.case.choices import ElementKind
from engine.case.data import ElementRow, MeshRow
from engine.errors import ModelError
from engine.model.gears import line_of_action
from engine.model.sections import UNIFORM, Profile, Section, profile_of, series_stiffness
from engine.numerics.same_bits import fourth, square, total


def shaft_stiffness(od: float, bore: float, length: float, shear_modulus: float) -> float:
    """Torsional stiffness of a round shaft, G π (D⁴ − d⁴) / 32 L.

    Parameters
    ----------
    od, bore : float
        Outer and inner diameter. [m]
    length : float
        Length. [m]
    shear_modulus : float
        Shear modulus. [Pa]

    Returns
    -------
    float
        Stiffness. [N m/rad]

    References
    ----------
    Any strength-of-materials text, e.g. Timoshenko, Strength of Materials I, § 56.
    """
    return shear_modulus * math.pi * (fourth(od) - fourth(bore)) / (32.0 * length)


def shaft_inertia(od: float, bore: float, length: float, density: float) -> float:
    """Polar mass inertia of a round shaft, ρ π (D⁴ − d⁴) L / 32.

    Parameters
    ----------
    od, bore : float
        Outer and inner diameter. [m]
    length : float
        Length. [m]
    density : float
        Density. [kg/m³]

    Returns
    -------
    float
        Inertia. [kg m²]
    """
    return density * math.pi * (fourth(od) - fourth(bore)) * length / 32.0


@dataclass(frozen=True)
class Link:
    """Stiffness, damping and inertia of one element, whatever they were given by."""

    #: Torsional stiffness, of a mesh on its From side; None = rigid mesh. [N m/rad]
    stiffness: float | None
    viscous: float  #: Viscous damping, likewise. [N m s/rad]
    loss_factor: float  #: Hysteretic loss factor. [1]
    inertia: float  #: Of the element itself. [kg m²]
    profile: Profile = UNIFORM  #: How stiffness and inertia are spread along it. [1]


def link_of(e: ElementRow, mesh: MeshRow | None, sections: Sequence[Section] = ()) -> Link:
    """What an element row and its mesh row mean mechanically.

    Parameters
    ----------
    e : ElementRow
        The element. [SI]
    mesh : MeshRow or None
        Its row of Meshes. [SI]
    sections : sequence of Section, optional
        Its sections, where it has rows in table `Sections`. [SI]

    Returns
    -------
    Link
        With the stiffness of the geometry where none is typed; a typed one is spread as that of the sections. [SI]

    Raises
    ------
    ModelError
        If neither stiffness nor geometry is given.
    """
    stiffness, viscous = e.stiffness, e.damping
    shaft = e.kind != ElementKind.GEAR_MESH
    if shaft and stiffness is None and e.od and e.length and e.shear_modulus:
        stiffness = shaft_stiffness(e.od, e.id or 0.0, e.length, e.shear_modulus)
    if shaft and stiffness is None and sections:
        stiffness = series_stiffness(sections)
    if not shaft and mesh is not None and mesh.pitch_radius_drive:
        cos_t, share = line_of_action(mesh)
        base = mesh.pitch_radius_drive * cos_t
        if stiffness is None and mesh.mesh_stiffness:
            stiffness = mesh.mesh_stiffness * share * square(base)
        if viscous is None and mesh.mesh_damping:
            viscous = mesh.mesh_damping * share * square(base)
    inertia = 0.0
    if shaft and e.density and e.od and e.length:
        inertia = shaft_inertia(e.od, e.id or 0.0, e.length, e.density)
    if shaft and sections:
        inertia = total(s.inertia for s in sections)
    if shaft and stiffness is None:
        raise ModelError(
            f"Element '{e.element}' has neither a stiffness nor the geometry for one. Type one of "
            "them in table Elements."
        )
    profile = profile_of(sections) if shaft and sections else UNIFORM
    return Link(stiffness, viscous or 0.0, e.loss_factor or 0.0, inertia, profile)


def has_clearance(mesh: MeshRow | None) -> bool:
    """Whether an element can separate and cross a gap; a clearance of zero is none.

    Parameters
    ----------
    mesh : MeshRow or None
        Its row of Meshes. [SI]

    Returns
    -------
    bool
        True with a backlash or angular backlash. [flag]
    """
    return mesh is not None and bool(mesh.backlash or mesh.angular_backlash)
