"""Whether a file is a summary that a batch wrote: none other is ever replaced by one."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

__all__ = ["SHEETS", "is_summary", "is_summary_csv"]

#: Sheets of a summary, and it has no others.
SHEETS = ("Files", "Errors")
#: More than the list of sheets of a summary ever takes. [bytes]
_MOST = 100_000
#: How the CSV of a summary begins, also where a spreadsheet program saved it with other separators.
_CSV_BEGINS = re.compile(rb'(?:\xef\xbb\xbf)?"?File"?[,;\t]"?Outcome"?[,;\t]"?Verdict"?[,;\t]')


def is_summary(path: Path) -> bool:
    """Look at the sheets of a workbook."""
    try:
        with zipfile.ZipFile(path) as package, package.open("xl/workbook.xml") as part:
            text = part.read(_MOST).decode("utf-8", "replace")
    except (OSError, KeyError, zipfile.BadZipFile, NotImplementedError, RuntimeError):
        return False
    return tuple(re.findall(r'<sheet name="([^"]*)"', text)) == SHEETS


def is_summary_csv(path: Path) -> bool:
    """Look at the headers of a CSV."""
    try:
        with open(path, "rb") as file:
            return _CSV_BEGINS.match(file.read(100)) is not None
    except OSError:
        return False
