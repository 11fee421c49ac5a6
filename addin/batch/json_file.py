"""Whether a file is a result JSON that torsionbook wrote: none other is ever replaced by one."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

__all__ = ["holds_results", "is_result_json"]

#: How results begin, and the errors of an input that has none, as this program writes them.
_BEGINS = re.compile(
    rb'\s*\{\s*"format"\s*:\s*\d+\s*,\s*(?P<digest>"case_sha256"\s*:\s*"[0-9a-f]{64}"\s*,\s*)?'
    rb'"version"\s*:\s*"[^"]{0,99}"\s*,\s*"(?:outcome|warnings)"\s*:'
)
#: More than that ever takes. [bytes]
_LOOKED_AT = 1000
#: What both hold, in whatever order another program saved them.
_KEYS = frozenset({"format", "version", "warnings", "errors"})


def is_result_json(path: Path) -> bool:
    """Look at what a file holds.

    Returns
    -------
    bool
        True for results and for the errors of an input; False also where it cannot be read. [flag]
    """
    return _kind(path) != ""


def holds_results(path: Path) -> bool:
    """Whether it holds results, not the errors of an input that has none."""
    return _kind(path) == "results"


def _kind(path: Path) -> str:
    """``results``, ``errors``, or nothing where it is neither."""
    if not path.is_file():  # such as a device, which has no end
        return ""
    try:
        with open(path, "rb") as file:
            begins = _BEGINS.match(file.read(_LOOKED_AT))
        if begins is not None:
            return "results" if begins["digest"] else "errors"
        content: Any = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return ""
    if not isinstance(content, dict) or not content.keys() >= _KEYS:
        return ""
    return "results" if "case_sha256" in content else "errors"
