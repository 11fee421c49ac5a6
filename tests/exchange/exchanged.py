"""Trains that are written for other programs, and how a file of theirs becomes a case."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from addin.exchange.read_train import checked_train, read_train
from engine.case.case import Case
from engine.case.data import ElementRow, MeshRow, SectionRow, StationRow

FILES = Path(__file__).parent / "files"


def stored(name: str) -> Any:
    return json.loads((FILES / name).read_text(encoding="utf-8"))


def imported(text: str) -> Case:
    """The case of a file without mistakes."""
    read = checked_train(read_train(text))
    assert read.problems == ()
    return read.case()


def row_of_stations() -> Case:
    """One shaft line: a shaft from its dimensions between two couplings."""
    return Case(
        stations=(
            StationRow("Motor", None, 35.0),
            StationRow("Hub", None, 0.8, damping=3.0),
            StationRow("Hub F", None, 0.7),
            StationRow("Fan", None, 55.0),
        ),
        elements=(
            ElementRow("Coupling M", "coupling", "Motor", "Hub", 2.5e6, damping=40.0),
            ElementRow(
                "Shaft", "shaft", "Hub", "Hub F", None, 0.09, 0.02, 0.02, 79.3e9, 7850.0
            ),
            ElementRow("Coupling F", "coupling", "Hub F", "Fan", 1.8e6),
        ),
    )  # fmt: skip


def shaft_of_sections() -> Case:
    """A motor and a fan on a shaft of two cylinders of different bores, without a step outside."""
    line = row_of_stations()
    return Case(
        stations=(line.stations[0], line.stations[-1]),
        elements=(ElementRow("Rotor", "shaft", "Motor", "Fan"),),
        sections=(
            SectionRow("Rotor", "left", 0.3, 0.12, id=0.02),
            SectionRow("Rotor", "right", 0.5, 0.12, id=0.06),
        ),
    )


def geared_train() -> Case:
    """A gear between couplings, and a shaft whose material is not that of openTorsion."""
    line = row_of_stations()
    return Case(
        stations=(
            *line.stations,
            StationRow("Pinion", None, 0.4),
            StationRow("Compressor", None, 2.2),
        ),
        elements=(
            *line.elements,
            ElementRow("Gear", "gear mesh", "Fan", "Pinion"),
            ElementRow("Quill", "shaft", "Pinion", "Compressor", 3.1e5),
        ),
        meshes=(MeshRow("Gear", teeth_drive=143, teeth_driven=29),),
    )
