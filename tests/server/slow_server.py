"""`torsionbook` that calculates each run of a start to the finest tolerance a hundred times.

Such a start lasts minutes on any machine: long enough to be watched and cancelled.
"""

import sys
from multiprocessing.connection import Connection
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addin.cli.app import main  # noqa: E402
from addin.workers import processes  # noqa: E402
from engine.backlash import event_start  # noqa: E402

#: The finest tolerance of peaks that may be typed.
FINEST = 2e-7
once = event_start._simulated
begin = processes._begin


def again_and_again(setup, step, tolerance, most):
    finest = tolerance <= FINEST * (1.0 + 1e-9)  # a workbook has it in %
    for _ in range(99 if finest else 0):
        once(setup, step, tolerance, most)
    return once(setup, step, tolerance, most)


def begin_slow(serve, line: Connection) -> None:
    """What a process for starts begins with: by its name in this module, as none knows the script."""
    event_start._simulated = again_and_again
    begin(serve, line)


if __name__ == "__main__":
    from tests.server import slow_server

    processes._begin = slow_server.begin_slow
    main()
