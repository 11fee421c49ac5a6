"""One process that costs are measured in, for all tests of a session."""

from collections.abc import Iterator

import pytest
from spoiled import Attended


@pytest.fixture(scope="session")
def attended() -> Iterator[Attended]:
    process = Attended()
    yield process
    process.end()
