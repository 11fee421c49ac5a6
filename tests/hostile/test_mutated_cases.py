"""Cases spoiled as hands spoil them end in named problems or finite results: a sample of benchmarks/mutated_cases.py."""

from __future__ import annotations

import pytest

from benchmarks.mutated_cases import QUICK, ended, mutated


def test_a_case_is_the_same_from_its_number_alone() -> None:
    assert mutated(5) == mutated(5)
    assert mutated(5)[1] != mutated(6)[1]


@pytest.mark.parametrize("number", [0, 1, 4, 5])
def test_a_mutated_case_is_calculated_or_refused(number: int) -> None:
    one = ended(number)
    assert one.sound, one


@pytest.mark.slow
@pytest.mark.parametrize(
    "first", [1_000, *(pytest.param(n, marks=pytest.mark.long) for n in range(1_020, 1_000 + QUICK, 20))]
)  # fmt: skip
def test_some_more(first: int) -> None:
    assert [one for n in range(first, first + 20) if not (one := ended(n)).sound] == []
