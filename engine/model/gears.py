"""Gear teeth as lines: where a flank's force acts, and along which direction.

Everything is in the transverse plane, x and y as the angle of the line of centres is measured. The
axial force of a helical mesh, and the tilting it causes, are left out. A gear's sense of rotation
is +1 counter-clockwise. α_t is the transverse pressure angle, β_b the base helix angle.

References
----------
ISO 21771: transverse pressure angle, base circles, normal and transverse backlash.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.choices import GearType
from engine.case.data import MeshRow
from engine.numerics.same_bits import atan2, cos, sin

#: Pressure angle where the Meshes table leaves it blank: the usual 20 degrees. [rad]
USUAL_PRESSURE_ANGLE = math.radians(20.0)


def transverse_pressure_angle(mesh: MeshRow) -> float:
    """Pressure angle in the transverse plane, tan α_t = tan α_n / cos β.

    Parameters
    ----------
    mesh : MeshRow
        The mesh; blank pressure angle = 20°, blank helix angle = 0. [rad]

    Returns
    -------
    float
        α_t. [rad]
    """
    normal = USUAL_PRESSURE_ANGLE if mesh.pressure_angle is None else mesh.pressure_angle
    return float(atan2(sin(normal), cos(normal) * cos(mesh.helix_angle or 0.0)))


def line_of_action(mesh: MeshRow) -> tuple[float, float]:
    """Base radius factor cos α_t and stiffness factor cos² β_b of a helical mesh.

    tan α_t = tan α_n / cos β and sin β_b = sin β cos α_n (contract, "Gears"; ISO 21771).

    Parameters
    ----------
    mesh : MeshRow
        The mesh; blank pressure angle = 20°, blank helix angle = 0. [rad]

    Returns
    -------
    cos_transverse : float
        Base radius over pitch radius. [1]
    stiffness_factor : float
        Transverse over normal stiffness. [1]
    """
    normal = USUAL_PRESSURE_ANGLE if mesh.pressure_angle is None else mesh.pressure_angle
    sin_base_helix = sin(mesh.helix_angle or 0.0) * cos(normal)
    return cos(transverse_pressure_angle(mesh)), 1.0 - sin_base_helix * sin_base_helix


@dataclass(frozen=True, eq=False)
class FlankNormals:
    """Unit vectors along which each flank pushes the driven gear; the driver gets the opposite."""

    drive: Floats  #: Of the flank that transmits the driving torque. [1] Shape (2,).
    #: Of the other one: its mirror image about the common centre line. [1] Shape (2,).
    back: Floats


def flank_normals(
    mesh: MeshRow, *, from_drives: bool, sense: float, driver_larger: bool
) -> FlankNormals:
    """Directions of both flanks' forces, from the geometry at the pitch point.

    With e_c from the driver's centre to the driven one's, p from the driver's centre to the pitch
    point and e_t = sense · (p turned by +90°), along which the pitch point moves: the drive flank
    pushes the driven gear along cos α_t e_t + sin α_t q, the back flank along
    −cos α_t e_t + sin α_t q. In an external mesh the pitch point lies between the centres, p = e_c,
    and the flanks part the gears: q = e_c. In an internal mesh it lies beyond the pinion's centre
    as seen from the ring's, so p = e_c if the ring drives, −e_c if the pinion does. The pinion is
    pushed from the pitch point towards its own centre, which is towards the ring's centre, and the
    ring away from its own: the flanks pull the centres together, q = −e_c, whichever drives.

    Parameters
    ----------
    mesh : MeshRow
        Orientation (the line of centres From → To), angles, gear type. [SI]
    from_drives : bool
        Whether From is the driver. [flag]
    sense : float
        Sense of rotation of the driver, +1 or −1. [1]
    driver_larger : bool
        Whether the driver has the larger pitch radius: the ring of an internal mesh. [flag]

    Returns
    -------
    FlankNormals
        Unit vectors. [1]
    """
    alpha, angle = transverse_pressure_angle(mesh), mesh.orientation or 0.0
    centres = np.array([cos(angle), sin(angle)]) * (1.0 if from_drives else -1.0)
    internal = mesh.gear_type == GearType.INTERNAL
    pitch_point = -centres if internal and not driver_larger else centres
    along = sense * np.array([-pitch_point[1], pitch_point[0]])
    radial = -centres if internal else centres
    tangential, apart = cos(alpha) * along, sin(alpha) * radial
    return FlankNormals(tangential + apart, apart - tangential)
