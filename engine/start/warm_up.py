"""Loads the compiled routines of a start, so that what is timed afterwards is calculation alone.

The first start of a process reads machine code from disk, or compiles it: half a second to half a
minute that has nothing to do with the case, and would be taken for the cost of its effects.
"""

from __future__ import annotations

from functools import cache

from engine.case.data import CaseData, ElementRow, LoadTorqueRow, MotorTorqueRow, StationRow
from engine.model.modal_train import ModalTrain
from engine.model.subdivision import natural_modes
from engine.start.start import run_start

#: Time of the start that is calculated for it. [s]
_SHORT = 0.05


@cache
def load_routines() -> None:
    """Calculate the beginning of a small start once in this process."""
    case = CaseData(
        line_frequency=60.0,
        poles=4,
        rated_torque=1e4,
        damping_ratio=0.01,
        maximum_time=_SHORT,
        stations=(StationRow("Motor", None, 50.0), StationRow("Load", None, 40.0)),
        elements=(ElementRow("Shaft", "shaft", "Motor", "Load", 3.0e6),),
        motor_torque=(
            MotorTorqueRow("Motor", 0.0, 6e3, 2e3),
            MotorTorqueRow("Motor", 1.0, 5e3, 1e3),
        ),
        load_torque=(LoadTorqueRow("Load", 0.0, 1e2), LoadTorqueRow("Load", 1.0, 1e3)),
    )
    subdivided = natural_modes(case)
    run_start(case, ModalTrain.of(case, subdivided.train, subdivided.modes))
