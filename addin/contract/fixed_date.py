"""The date that takes the place of the present, for files that are made twice and must be equal."""

from __future__ import annotations

import datetime as dt
import os

VARIABLE = "SOURCE_DATE_EPOCH"
_LAST_SECOND = 253_402_300_799  # of the year 9999


class WrongDate(ValueError):
    """The variable is set to what is no date; the message says what to do."""


def fixed_date() -> dt.datetime | None:
    """The date that SOURCE_DATE_EPOCH sets, in UTC; None where it sets none. [date]

    Raises
    ------
    WrongDate
        If it is no number of seconds since 1970, up to the year 9999.
    """
    seconds = os.environ.get(VARIABLE, "").strip()
    if not seconds:
        return None
    if not (seconds.isascii() and seconds.isdigit() and float(seconds) <= _LAST_SECOND):
        shown = repr(seconds if len(seconds) <= 40 else seconds[:37] + "...")
        raise WrongDate(
            f"The environment variable {VARIABLE} is {shown}; it must be a whole number of seconds since 1970 "
            "(up to the year 9999). Correct it, or remove it to use the present date."
        )
    return dt.datetime.fromtimestamp(int(seconds), dt.UTC)
