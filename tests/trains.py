"""Small trains with a motor, for tests of the start."""

from __future__ import annotations

from typing import Any

import numpy as np

from engine.case.case import Case
from engine.case.data import ElementRow, LoadTorqueRow, MotorTorqueRow, StationRow
from engine.model.modal_train import ModalTrain
from engine.model.subdivision import natural_modes
from engine.start.start import Start, run_start

#: Speed, average, pulsating (zero-to-peak) over rated torque: a salient-pole motor. [1]
MOTOR = (
    (0.0, 0.6, 0.25),
    (0.3, 0.65, 0.25),
    (0.6, 0.8, 0.22),
    (0.9, 0.95, 0.2),
    (0.95, 0.8, 0.2),
    (1.0, 0.0, 0.2),
)
#: Speed and torque over rated torque: a compressor unloaded. [1]
LOAD = ((0.0, 0.06), (0.1, 0.02), (0.5, 0.07), (1.0, 0.25))

#: Rated torque of the small trains. [N m]
RATED = 10_000.0


def motor(station: str = "Motor", rated: float = RATED, curve: Any = MOTOR) -> tuple[Any, ...]:
    """Rows of table MotorTorque."""
    return tuple(MotorTorqueRow(station, x, rated * a, rated * b) for x, a, b in curve)


def load(station: str = "Load", rated: float = RATED, curve: Any = LOAD) -> tuple[Any, ...]:
    """Rows of table LoadTorque; `rated` at the station's own speed."""
    return tuple(LoadTorqueRow(station, x, rated * y) for x, y in curve)


def geared(**fields: Any) -> Case:
    """Motor, bull gear, pinion and load: modes near 24 and 90 Hz, ratio 3, start of about 2 s."""
    ratio = 3.0
    given: dict[str, Any] = {
        "line_frequency": 60.0,
        "poles": 4,
        "rated_torque": RATED,
        "damping_ratio": 0.01,
        "stations": (
            StationRow("Motor", None, 50.0),
            StationRow("Bull gear", None, 20.0),
            StationRow("Pinion", None, 1.0, ratio),
            StationRow("Load", None, 4.0, ratio),
        ),
        "elements": (
            ElementRow("Low-speed shaft", "shaft", "Motor", "Bull gear", 3.0e6),
            ElementRow("Mesh", "gear mesh", "Bull gear", "Pinion"),
            ElementRow("High-speed shaft", "shaft", "Pinion", "Load", 1.0e5),
        ),
        "motor_torque": motor(),
        "load_torque": load(rated=RATED / ratio),
    }
    return Case(**(given | fields))


def prepared(case: Case) -> ModalTrain:
    """Train, modes and damping of a case."""
    found = natural_modes(case)
    return ModalTrain.of(case, found.train, found.modes)


def started(case: Case) -> Start:
    """The start of a case."""
    return run_start(case, prepared(case))


def peaks(start: Start) -> dict[str, np.ndarray]:
    """Maximum and minimum torque of every element."""
    return {p.element: np.array([p.maximum, p.minimum]) for p in start.peaks}
