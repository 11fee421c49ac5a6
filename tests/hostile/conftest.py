"""One process that costs are measured in, for all tests of a session."""

import sys
from collections.abc import Iterator

import pytest
from spoiled import Attended


@pytest.fixture(scope="session")
def attended() -> Iterator[Attended]:
    if sys.platform == "win32":
        pytest.skip("the process forks, which Windows does not")
    process = Attended()
    yield process
    process.end()
