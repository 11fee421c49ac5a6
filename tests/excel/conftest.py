"""xlwings' machinery as on Windows, for the tests of one module at a time."""

import sys
from pathlib import Path

import pytest
from windows_layer import machinery

# The ranges of the shipped workbooks, as the tests of the registry have them.
sys.path.append(str(Path(__file__).resolve().parents[1] / "worksheet"))


@pytest.fixture(scope="module")
def excel():
    with machinery() as found:
        yield found
