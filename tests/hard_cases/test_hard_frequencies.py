"""Natural frequencies of the hard cases, with default settings."""

import numpy as np
import pytest

from tests.hard_cases.answers import frequencies
from tests.hard_cases.corpus import FREQUENCIES, start_two_line
from tests.high_precision import ReferredTree

#: Counting in 120 digits takes a while where there are a thousand of them.
COUNTED = [name for name, c in FREQUENCIES.items() if len(c.inertia) < 100]
CLOSED_FORM = [name for name, c in FREQUENCIES.items() if c.exact is not None]


@pytest.mark.parametrize("name", COUNTED)
def test_every_frequency_is_proven_by_counting(name: str) -> None:
    hard = FREQUENCIES[name]
    omega = frequencies(hard)
    assert len(omega) == len(hard.inertia)
    assert omega[0] == 0.0
    assert np.all(omega[1:] > 0.0)
    assert ReferredTree(hard.case()).wrong(omega, 1e-12) == []


@pytest.mark.parametrize("name", CLOSED_FORM)
def test_every_frequency_has_its_closed_form(name: str) -> None:
    hard = FREQUENCIES[name]
    omega = frequencies(hard)
    assert omega[0] == 0.0
    assert hard.exact is not None
    np.testing.assert_allclose(omega[1:], hard.exact, rtol=1e-12)


def test_modes_1e_9_apart_keep_their_distance() -> None:
    hard = FREQUENCIES["two modes 1e-9 apart"]
    below, above = frequencies(hard)[1:]
    assert above / below - 1.0 == pytest.approx(1e-9, rel=1e-5)


def test_a_thousand_stations_by_counting_at_a_few_of_them() -> None:
    """The closed form is that of the numbers typed: the counts say so too."""
    hard = FREQUENCIES["1,000 stations"]
    assert hard.exact is not None
    tree = ReferredTree(hard.case())
    for mode in (1, 500, 999):
        omega = hard.exact[mode - 1]
        assert (
            tree.count_below(omega * (1.0 - 1e-13))
            <= mode
            < tree.count_below(omega * (1.0 + 1e-13))
        )


def test_modes_exactly_at_twice_the_line_and_at_a_fifth_of_a_hertz() -> None:
    case = start_two_line().case
    from engine.model.modal_analysis import analyse

    found = analyse(case).reported.modes.elastic_frequency
    np.testing.assert_allclose(found, [0.2, 120.0], rtol=1e-12)
