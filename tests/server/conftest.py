"""One server for all tests of this folder, inside the test process and outside."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from servers import inside, outside
from starlette.testclient import TestClient

from addin.server.settings import Settings

# ranges of the shipped workbooks
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "worksheet"))


@pytest.fixture(scope="session")
def client() -> Iterator[TestClient]:
    """A client of a server with the usual settings."""
    with inside(Settings(workers=1)) as client:
        yield client


@pytest.fixture(scope="session")
def served() -> Iterator[str]:
    """The address of a server in a process of its own."""
    with outside() as address:
        yield address
