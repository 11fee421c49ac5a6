"""Viscous damping and state matrix of a train from its incidence: what modal answers are compared with."""

from __future__ import annotations

import numpy as np


def damping_matrix(train):
    """Viscous damping across elements and to ground, shape (n_dof, n_dof). [N m s/rad]"""
    B = train.incidence
    return (B.T * train.viscous) @ B + np.diag(train.ground_damping)


def state_matrix(train):
    """A of ẋ = A x for the state [θ, θ̇], shape (2 n_dof, 2 n_dof). [mixed: 1, 1/s, 1/s²]"""
    B, m, n = train.incidence, train.inertia[:, None], train.n_dof
    K = (B.T * train.stiffness) @ B
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K / m, -damping_matrix(train) / m]])
