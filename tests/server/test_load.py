"""Many calls while a long start runs: nothing is lost, and one request for many cells is cheap."""

import pytest
from sheet_ranges import model_arguments

from addin.server.client import Client
from benchmarks.server_load import CALLS, beside_a_start, together


@pytest.mark.slow
def test_a_thousand_calls_beside_a_long_start_are_all_answered(served):
    found = beside_a_start(served)
    # It was cancelled after the last answer, so no short call has waited for it.
    assert found["start was running throughout"]
    for when in ("alone", "beside", "paced"):
        assert found[when]["right"] == CALLS


@pytest.mark.slow
def test_a_thousand_cells_cost_less_than_a_tenth_of_a_request_each(served):
    client = Client(served)  # a process that another test has cancelled is replaced before this
    ((handle,),) = client.call("TV_MODEL", *model_arguments("example_modified"))
    client.call("TV_PEAKS", handle)
    found = together(served, rounds=3)
    assert found["together"] < 0.1 * min(found["each"], found["browser"])
