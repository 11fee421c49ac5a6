"""Where a path leads, links followed."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["real_path"]


def real_path(path: Path) -> Path:
    """The place behind a path; of links in a circle, where the circle begins.

    `Path.resolve` raises on a circle before Python 3.13, so that one such link would stop a whole folder.
    """
    return Path(os.path.realpath(path))
