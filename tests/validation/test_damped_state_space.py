"""Damped eigenvalues and state matrices of a geared train.

T02  openTorsion, tests/tests.py test_state_space and test_continuous_2_discrete: four discs, 10:60
     gear, dampers in shafts and to ground; published continuous and discrete (0.1 ms) matrices

Its states are [θ₀, θ₁, θ₃, ω₀, ω₁, ω₃] in physical senses, ours count each station positive in its
own running direction, so the order is the same and the sign is `Train.sense`.
"""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from cases import load_case
from models import case_of
from state_space import state_matrix

from engine.model.build_train import build_train
from engine.model.modes import damped_eigenvalues, modal_damping, modes_of


@pytest.fixture
def t02():
    data = load_case("T02")
    case = case_of(data["model"])
    return data, case, build_train(case)


def physical_signs(train):
    """Diagonal that turns running-direction states into physical ones (d0, d1, d3)."""
    sense = train.sense[[train.stations.index(n) for n in ("d0", "d1", "d3")]]
    assert list(train.node_dof) == [0, 1, 1, 2]
    assert list(sense) == [1.0, 1.0, -1.0]
    return np.concatenate([sense, sense])


def test_continuous_matrix(t02):
    data, _, train = t02
    s = physical_signs(train)
    A = s[:, None] * state_matrix(train) * s
    published = np.array(data["published"]["A"])
    assert A == pytest.approx(published, abs=data["tolerance"]["A_abs"])


def test_discrete_matrices(t02):
    data, _, train = t02
    s = physical_signs(train)
    n, ts = train.n_dof, data["published"]["ts"]
    B = np.vstack([np.zeros((n, n)), np.diag(1.0 / train.inertia)])
    augmented = np.zeros((3 * n, 3 * n))
    augmented[: 2 * n, : 2 * n] = state_matrix(train)
    augmented[: 2 * n, 2 * n :] = B
    discrete = scipy.linalg.expm(augmented * ts)[: 2 * n]
    Ad = s[:, None] * discrete[:, : 2 * n] * s
    Bd = s[:, None] * discrete[:, 2 * n :] * s[:n]
    assert s[:, None] * B * s[:n] == pytest.approx(np.array(data["published"]["B"]), abs=1e-8)
    assert Ad == pytest.approx(np.array(data["published"]["Ad"]), abs=data["tolerance"]["Ad_abs"])
    assert Bd == pytest.approx(np.array(data["published"]["Bd"]), abs=data["tolerance"]["Ad_abs"])


def test_damped_eigenvalues(t02):
    data, _, train = t02
    found = damped_eigenvalues(train, modes_of(train))
    reference = [complex(*v) for v in data["verification"]["recomputed"]["damped_eigenvalues"]]
    assert len(found) == len(reference)
    for value in reference:
        assert np.min(np.abs(found - value)) < 1e-9
    assert np.min(np.abs(found)) < 1e-11  # the rigid angle


def test_damped_eigenvalues_are_those_of_the_state_matrix(t02):
    _, _, train = t02
    modal = damped_eigenvalues(train, modes_of(train))
    direct = np.linalg.eigvals(state_matrix(train))
    for value in direct:
        assert np.min(np.abs(modal - value)) < 1e-8


def test_undamped_frequencies(t02):
    data, _, train = t02
    reference = data["verification"]["recomputed"]["undamped_Hz"]
    assert modes_of(train).frequency == pytest.approx(reference, rel=1e-12, abs=0.0)


def test_modal_form_and_what_it_neglects(t02):
    """Not proportional: the modal ratio is near the exact one, the difference is of the order told."""
    data, case, train = t02
    modes = modes_of(train)
    damping = modal_damping(case, train, modes)
    exact = [complex(*v) for v in data["verification"]["recomputed"]["damped_eigenvalues"]]
    ratio = sorted((-v.real / abs(v), abs(v)) for v in exact if v.imag > 0)
    for zeta, w in ratio:
        mode = int(np.argmin(np.abs(modes.omega - w)))
        assert damping.ratio[mode] == pytest.approx(zeta, rel=2 * damping.coupling + 1e-3)
    assert damping.neglected > 0.0


def test_step_response(t02):
    """10 N m at d0, exact for a constant torque; physical senses as above."""
    data, _, train = t02
    s = physical_signs(train)
    step = data["verification"]["recomputed"]["step_response_10Nm_at_d0"]["rows"]
    n = train.n_dof
    augmented = np.zeros((2 * n + 1, 2 * n + 1))
    augmented[: 2 * n, : 2 * n] = state_matrix(train)
    augmented[n, -1] = 10.0 / train.inertia[0]
    for row in step:
        state = scipy.linalg.expm(augmented * row[0])[: 2 * n, -1]
        assert s * state == pytest.approx(np.array(row[1:]), abs=1e-9)


def test_eigenvalues_have_the_stated_damping_too(t02):
    """With 1.5 % beside the dampers each eigenvalue has the damping ratio of the frequency table."""
    _, case, train = t02
    stated = replace(case, damping_ratio=0.015)
    modes = modes_of(train)
    damping = modal_damping(stated, train, modes)
    values = damped_eigenvalues(train, modes, damping.structural)
    for value in values[values.imag > 1.0]:
        mode = int(np.argmin(np.abs(modes.omega - abs(value))))
        assert damping.ratio[mode] > 0.015
        ratio = -value.real / abs(value)
        assert damping.ratio[mode] == pytest.approx(ratio, rel=2 * damping.coupling + 1e-3)
