"""One server for all tests of this folder, inside the test process and outside."""

from collections.abc import Iterator

import pytest
from servers import SLOW_PROGRAM, inside, outside
from starlette.testclient import TestClient

from addin.server.settings import Settings


@pytest.fixture(scope="session")
def client() -> Iterator[TestClient]:
    """A client of a server with the usual settings."""
    with inside(Settings(workers=1)) as client:
        yield client


@pytest.fixture(scope="session")
def served() -> Iterator[str]:
    """The address of a server in a process of its own, in which some starts last minutes."""
    with outside(program=SLOW_PROGRAM) as address:
        yield address
