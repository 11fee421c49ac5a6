"""Written and calculated by ROSS 3.1 itself: the files beside this one and their frequencies.

Run with a Python that has ross-rotordynamics, in this folder: `python by_ross.py`. It writes files/ross_rotor.toml and
files/ross_geared.toml, loads what torsionbook exported (files/exported_…to_ross.json), and records torsional frequencies in
files/ross_frequencies.json. [Hz]
"""

import json
import math
from pathlib import Path

import numpy as np
import ross
from ross.utils import convert_6dof_to_torsional
from scipy.linalg import eigh

FILES = Path(__file__).parent / "files"
STEEL = ross.Material("steel", rho=7810, E=211e9, G_s=81.2e9)
SLEEVE = ross.Material("sleeve", rho=8000, E=1e9, G_s=4e8)


def frequencies(rotor):
    """Of the torsional part of ROSS's matrices."""
    torsional = convert_6dof_to_torsional(rotor)
    squares = eigh(torsional.K(0.0), torsional.M(), eigvals_only=True)
    return (np.sqrt(np.abs(squares)) / (2.0 * math.pi)).tolist()


def shaft(n, length, od, bore=0.0, material=STEEL):
    return ross.ShaftElement(L=length, idl=bore, odl=od, material=material, n=n)


def rotor():
    """A motor, a coupling and a fan on shafts of short elements, one of them with a sleeve."""
    shafts = [shaft(i, 0.05, 0.1) for i in range(8)]
    shafts.append(shaft(3, 0.05, 0.14, 0.1, SLEEVE))
    shafts.append(
        ross.CouplingElement(m_l=20, m_r=15, Ip_l=0.3, Ip_r=0.2, kr_z=4e5, cr_z=12.0, n=8)
    )
    shafts += [shaft(i, 0.05, 0.08, 0.02) for i in range(9, 15)]
    disks = [
        ross.DiskElement(n=2, m=900, Id=20, Ip=35, tag="Motor"),
        ross.DiskElement(n=13, m=600, Id=30, Ip=55, tag="Fan"),
    ]
    bearings = [ross.BearingElement(n=n, kxx=1e8, cxx=0) for n in (0, 7, 10, 14)]
    return ross.Rotor(shafts, disks, bearings, point_mass_elements=[ross.PointMass(n=14, m=3)])


def geared():
    """Two rotors and their gears."""

    def line(teeth, diameter, node):
        gear = ross.GearElement(
            n=node, m=5, Id=0.01, Ip=0.02 * diameter / 0.1, n_teeth=teeth, pitch_diameter=diameter,
            pr_angle=math.radians(20),
        )  # fmt: skip
        disk = ross.DiskElement(n=0 if node else 3, m=32, Id=0.17, Ip=0.33)
        bearings = [ross.BearingElement(n=n, kxx=1e6, cxx=0) for n in (1, 2)]
        return ross.Rotor([shaft(i, 0.25, 0.05) for i in range(3)], [disk, gear], bearings)

    return ross.MultiRotor(
        line(40, 0.2, 3), line(20, 0.1, 0), coupled_nodes=(3, 0), gear_mesh_stiffness=1e8
    )


def main():
    """Write the files and the frequencies."""
    found = {}
    for name, made in (("ross_rotor", rotor()), ("ross_geared", geared())):
        (FILES / f"{name}.toml").unlink(missing_ok=True)
        made.save(FILES / f"{name}.toml")
    found["ross_rotor"] = frequencies(rotor())
    for name in ("exported_to_ross", "exported_sections_to_ross"):
        found[name] = frequencies(ross.Rotor.load(FILES / f"{name}.json"))
    text = json.dumps({"ross": ross.__version__, **found}, indent=1)
    (FILES / "ross_frequencies.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
