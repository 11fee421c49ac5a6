"""Each number once, as numpy's `unique` has it."""

from __future__ import annotations

import numpy as np
import pytest

from engine.numerics.distinct import distinct


@pytest.mark.parametrize("kind", [float, int, bool])
@pytest.mark.parametrize("sizes", [(0,), (1,), (9,), (0, 5), (4, 7, 1)])
def test_as_numpy(kind, sizes):
    rng = np.random.default_rng(len(sizes))
    parts = [rng.integers(-3, 4, n).astype(kind) for n in sizes]
    expected = np.unique(np.concatenate(parts))
    np.testing.assert_array_equal(distinct(*parts), expected)
    assert distinct(*parts).dtype == expected.dtype
