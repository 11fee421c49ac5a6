"""Reports made once."""

from __future__ import annotations

import pytest
from report_files import ROOT, Made, make


@pytest.fixture(scope="session")
def proposed(examples, tmp_path_factory) -> Made:
    """The report of the example `proposed`, in US units."""
    folder = tmp_path_factory.mktemp("proposed")
    source = ROOT / "templates" / "example_proposed.xlsx"
    return make(folder, source, examples / "proposed.results.json")
