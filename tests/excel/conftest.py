"""xlwings' machinery as on Windows, for the tests of one module at a time."""

import pytest
from windows_layer import machinery


@pytest.fixture(scope="module")
def excel():
    with machinery() as found:
        yield found
