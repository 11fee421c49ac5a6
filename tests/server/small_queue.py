"""`torsionbook` whose server lets one calculation of a client wait, and refuses the others."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addin.cli.app import main  # noqa: E402
from addin.server.processes import Work  # noqa: E402

begin = Work.__init__


def begin_small(self: Work, processes: int, waiting: int, *others: object) -> None:
    begin(self, processes, 1, *others)


if __name__ == "__main__":
    Work.__init__ = begin_small
    main()
