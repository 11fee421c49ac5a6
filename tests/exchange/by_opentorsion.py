"""Calculated by openTorsion 0.3 itself: frequencies of systems in its own format (TORS).

Run with a Python that has opentorsion, in this folder: `python by_opentorsion.py`. It loads files/tors_system.json, typed after the
format of the OpenTorsion-Editor, and what torsionbook exported (files/exported_to_opentorsion.json), and records the frequencies in
files/opentorsion_frequencies.json. [Hz]
"""

import json
import math
from importlib.metadata import version
from pathlib import Path

import numpy as np
from opentorsion.assembly import Assembly
from scipy.linalg import eigh

FILES = Path(__file__).parent / "files"


def frequencies(name):
    """Of the matrices that openTorsion assembles."""
    system = json.loads((FILES / f"{name}.json").read_text(encoding="utf-8"))
    assembly = Assembly.from_tors(system)
    squares = eigh(assembly.K, assembly.M, eigvals_only=True)
    return (np.sqrt(np.abs(squares)) / (2.0 * math.pi)).tolist()


def main():
    """Write the frequencies."""
    names = ("tors_system", "exported_to_opentorsion")
    found = {name: frequencies(name) for name in names if (FILES / f"{name}.json").exists()}
    text = json.dumps({"opentorsion": version("opentorsion"), **found}, indent=1)
    (FILES / "opentorsion_frequencies.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
