"""What a sweep over the operating range may have missed between its frequencies: within the error it states."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from engine.case.case import Case
from engine.case.data import ElementRow, ExcitationRow, StationRow
from engine.model.build_train import build_train
from engine.model.excitation import excitations_of
from engine.model.modal_train import ModalTrain
from engine.model.modes import modal_damping, modes_of, stated_damping
from engine.operation.margins import separation_margins
from engine.operation.steady_state import harmonic_response, steady_state

#: Frequencies of the truth before it is refined, and what rounding leaves of a torque. [count, 1]
FINE, ROUNDING = 20_001, 1e-11


def train_of(seed: int) -> Case:
    """Three to eight stations, some dampers; a range of speed that holds modes."""
    rng = np.random.default_rng((seed, 7))
    n = int(rng.integers(3, 9))
    stiffness = 10.0 ** rng.uniform(5.0, 7.0, n - 1)
    damping = np.where(
        rng.random(n - 1) < 0.3, stiffness * 10.0 ** rng.uniform(-5.0, -2.5, n - 1), 0.0
    )
    stations = tuple(
        StationRow(f"S{i}", None, float(10.0 ** rng.uniform(0.0, 2.5))) for i in range(n)
    )
    elements = tuple(
        ElementRow(f"E{i}", "coupling", f"S{i}", f"S{i + 1}", float(k), damping=float(c) or None)
        for i, (k, c) in enumerate(zip(stiffness, damping, strict=True))
    )
    low = float(rng.uniform(20.0, 100.0))
    return Case(
        stations=stations,
        elements=elements,
        damping_ratio=float(10.0 ** rng.uniform(-3.0, -1.0)),
        minimum_speed=low,
        maximum_speed=low * float(rng.uniform(1.5, 8.0)),
        excitations=(ExcitationRow("1x", order=1.0, station="S0", torque=1.0),),
    )


def largest(case: Case, torque) -> np.ndarray:
    """Largest torque of each element over the range, refined about the largest of many frequencies."""
    omega = np.linspace(case.minimum_speed, case.maximum_speed, FINE)
    at = torque(omega)
    found = []
    for element, best in enumerate(np.argmax(at, axis=1)):
        ends = omega[max(best - 1, 0)], omega[min(best + 1, FINE - 1)]
        peak = minimize_scalar(
            lambda w, e=element: -torque(np.array([w]))[e, 0], bounds=ends, method="bounded",
            options={"xatol": 1e-9 * ends[0]},
        )  # fmt: skip
        found.append(max(at[element, best], -peak.fun))
    return np.array(found)


@pytest.mark.first_ones(6)
@pytest.mark.parametrize("seed", range(60))
def test_the_largest_torque_is_within_the_stated_error(seed):
    case = train_of(seed)
    train = build_train(case)
    modes = modes_of(train)
    excitations = excitations_of(case, train)
    margins = separation_margins(case, train, modes, excitations)
    modal = ModalTrain(train, modes, modal_damping(case, train, modes))
    rows = [r for r in steady_state(case, modal, excitations, margins).rows if r.mode is None]
    assert len(rows) == len(case.elements)
    ratio, at_first = stated_damping(case, modes), np.eye(train.n_stations)[0].astype(complex)

    def torque(omega):
        found = harmonic_response(train, modes, omega, at_first, damping_ratio=ratio)
        return np.abs(found.element_torque)

    for row, true in zip(rows, largest(case, torque), strict=True):
        assert math.isfinite(row.error)
        assert row.torque <= true * (1.0 + ROUNDING)
        assert true <= row.torque * (1.0 + row.error + ROUNDING), (row, true / row.torque - 1.0)
