"""The mean speed of a motor from its definition: momentum of its shaft line over inertia, at the motor's station."""

from __future__ import annotations

from typing import Any

import numpy as np

from engine.case.choices import TorqueFollows
from engine.case.data import CaseData


def read_weights(
    case: CaseData,
    rows: np.ndarray,
    stiffness: np.ndarray,
    inertia: np.ndarray,
    ratio: Any,
    at: int,
) -> np.ndarray:
    """The speed at which the curves of the motor at one freedom are read, from the speeds of all freedoms.

    `rows` are the deflections of springs and flanks, `ratio` the speeds of a rigid train, 0 of lateral motion.
    """
    weights = np.zeros(len(inertia))
    if case.torque_follows == TorqueFollows.OWN_SPEED:
        weights[at] = 1.0
        return weights
    rigid = np.asarray(ratio, dtype=float)
    joined = (rows[stiffness > 0.0] != 0.0) & (rigid != 0.0)
    line = np.arange(len(inertia)) == at
    for _ in range(len(joined) + 1):  # what springs hold together with it
        line = line | np.any(joined[np.any(joined & line, axis=1)], axis=0)
    rigid = np.where(line, rigid, 0.0)
    assert np.max(np.abs(rows[stiffness > 0.0] @ rigid), initial=0.0) < 1e-9
    return rigid[at] * inertia * rigid / (inertia @ rigid**2)
