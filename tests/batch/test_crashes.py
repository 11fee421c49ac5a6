"""Four kills over batches of 18 workbooks; benchmarks/batch_crash.py does fifty over 200."""

from pathlib import Path

import pytest
from crash_runs import Crashes


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
def test_killed_at_random_moments_nothing_is_torn_lost_or_done_twice(tmp_path):
    record = Crashes(tmp_path, workbooks=18, seed=20).run(kills=4)
    assert record.kills >= 4
    assert record.batches >= 1
    assert record.checked > 0
    assert len(record.who) > 1
