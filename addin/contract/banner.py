"""The banner: the overall verdict in words, with its counts, as a formula and as a function."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from engine.case.result_words import Judgement

#: Verdicts of checks that were not made, or on a part of what they are for.
OPEN = (Judgement.NOT_JUDGED, Judgement.INCOMPLETE)


def _count(words: str) -> str:
    """How many checks have a verdict; the row of the overall verdict is not a check."""
    return f'COUNTIFS(Verdicts[Verdict],"{words}",Verdicts[Check],"<>Overall")'


_ALL = _count("?*")
_FAILED = f"{_count('fail*')}+{_count('unbounded*')}"
_OPEN = f"{_count('not judged*')}+{_count('incomplete*')}"
_WITHIN_ERROR = _count("pass within*")
#: How many notes there are.
NOTES = 'COUNTIF(Audit[Item],"Warning *")'
#: Hidden sheet with the copy of the inputs, and its cell that says whether one has changed since.
COPY_SHEET = "Inputs calculated"
CHANGED_CELL = "C2"
#: The overall verdict and the strip with the document's number, for the other sheets. They and the cell above
#: are referred to by their cells, which programs follow when they are moved: a name can be led elsewhere.
OVERALL_AT = "Summary!$B$9"
DOCUMENT_AT = "Summary!$B$2"


def is_changed(cell: str) -> str:
    """Whether an input has changed, as a condition; where the cell that says it is gone, nothing is claimed."""
    return f"IFERROR({cell},1)"


#: The same in a workbook as it is shipped.
IS_CHANGED = is_changed(f"'{COPY_SHEET}'!${CHANGED_CELL[0]}${CHANGED_CELL[1:]}")
#: The banner then.
CHANGED_WORDS = "INPUTS CHANGED SINCE CALCULATION"
#: What follows where nothing has changed.
_JUDGED = (
    'IF(COUNTIFS(Verdicts[Verdict],"check*",Verdicts[Check],"Overall")>0,'
    '"CHECK THE INPUTS: "&INDEX(Verdicts[Where],MATCH("Overall",Verdicts[Check],0)),'
    f'IF({_FAILED}>0,"FAIL: "&({_FAILED})&" of "&{_ALL}&" checks",'
    f'IF({_OPEN}>0,"INCOMPLETE: "&({_OPEN})&" of "&{_ALL}&" checks not judged, or only in part",'
    f'IF({_WITHIN_ERROR}>0,"PASS WITHIN ITS ERROR: "&{_WITHIN_ERROR}&" of "&{_ALL}&" checks",'
    f"IF({_count('accepted*')}>0,"
    f'"ACCEPTED (margin by forced response): all "&{_ALL}&" checks",'
    f'"PASS: all "&{_ALL}&" checks")))))'
    f'&IF({NOTES}=0,"",", "&{NOTES}&IF({NOTES}=1," note"," notes"))'
)


def overall_formula(changed: str = IS_CHANGED) -> str:
    """The banner as a formula of the spreadsheet; `headline` gives the same words, of inputs as calculated."""
    return f'=IF({_ALL}=0,"NOT CALCULATED",IF({changed},"{CHANGED_WORDS}",{_JUDGED}))'


#: The same for a workbook of 0.1.0, which has no copy of its inputs.
OVERALL_WITHOUT_COPY = f'=IF({_ALL}=0,"NOT CALCULATED",{_JUDGED})'
#: Digests of the banner formulas of earlier releases (0.1.0): they call a check that is incomplete a pass.
_EARLIER = frozenset({"964ad841f577f7bb"})
_QUOTED = re.compile(r'("(?:[^"]|"")*")')


def bare(formula: str) -> str:
    """A formula without what programs write otherwise: blanks, anchors and capitals."""
    parts = _QUOTED.split(formula.strip().removeprefix("="))
    return "".join(
        part if part.startswith('"') else re.sub(r"[\s$]", "", part).upper() for part in parts
    )


def is_earlier_banner(formula: str) -> bool:
    """Whether it is the banner of an earlier release, which recalculation replaces."""
    return hashlib.sha256(bare(formula).encode()).hexdigest()[:16] in _EARLIER


def headline(overall: Mapping[str, Any], verdicts: Sequence[str], notes: int) -> str:
    """The banner, as `overall_formula` calculates it.

    Parameters
    ----------
    overall : mapping
        The overall row: keys ``verdict`` and ``where``.
    verdicts : sequence of str
        Of the checks, without the overall one.
    notes : int
        How many notes there are. [count]

    Returns
    -------
    str
        Such as ``PASS: all 7 checks, 2 notes``. [words]
    """
    count, total = Counter(verdicts), len(verdicts)
    failed = count[Judgement.FAIL] + count[Judgement.UNBOUNDED]
    open_ = sum(count[word] for word in OPEN)
    if not total:
        return "NOT CALCULATED"
    if overall["verdict"] == Judgement.CHECK_INPUTS:
        words = f"CHECK THE INPUTS: {overall['where']}"
    elif failed:
        words = f"FAIL: {failed} of {total} checks"
    elif open_:
        words = f"INCOMPLETE: {open_} of {total} checks not judged, or only in part"
    elif within := count[Judgement.WITHIN_ERROR]:
        words = f"PASS WITHIN ITS ERROR: {within} of {total} checks"
    elif count[Judgement.ACCEPTED]:
        words = f"ACCEPTED (margin by forced response): all {total} checks"
    else:
        words = f"PASS: all {total} checks"
    return words + (f", {notes} note{'s' if notes > 1 else ''}" if notes else "")
