"""Words that stand in results, beside numbers or in their place.

Each is a `StrEnum`: a member is written, compared, sorted and pickled as the word itself.
"""

from __future__ import annotations

from enum import StrEnum


class Judgement(StrEnum):
    """The verdict of a check."""

    PASS = "pass"
    ACCEPTED = "accepted by forced response"
    FAIL = "fail"
    UNBOUNDED = "unbounded"
    NOT_JUDGED = "not judged"


class NoNumber(StrEnum):
    """What stands where a number would."""

    UNLIMITED = "unlimited"
    UNBOUNDED = "unbounded"
    NOT_JUDGED = "not judged"
