"""`torsionbook` whose starts give up a hundred times later: long enough to be watched on any machine.

The processes for starts import this file again, so the limit is theirs too.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addin.cli.app import main  # noqa: E402
from engine.backlash import event_start  # noqa: E402

event_start.MOST_WORK *= 100
event_start.MAX_VALUES *= 100

if __name__ == "__main__":
    main()
