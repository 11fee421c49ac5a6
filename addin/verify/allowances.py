"""The error that this version reports for a result, in the unit in which it is shown.

Only results of the start and of events carry an estimated error, and frequencies where shafts were cut into
segments. All others are exact to rounding, and nothing is allowed for them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from addin.contract.field import ReportedError
from addin.contract.tables import find_column
from engine.results.results import Results


class Allowances:
    """The reported errors of one calculation.

    Parameters
    ----------
    results : Results
        It. [SI]
    """

    def __init__(self, results: Results) -> None:
        self._frequency = results.frequency_error if results.segments else None
        self._starts = {name: error for name, error in results.starts_error if error is not None}
        self._events = {e.name: e.response.estimated_error for e in results.events if e.response}
        self._damage = {
            (e.name, shaft): error for e in results.events for shaft, error in e.damage_errors
        }
        self._peaks: float | None = None
        start = results.start
        if start is not None:
            spread = start.repeatability.spread if start.repeatability is not None else 0.0
            self._peaks = max(start.estimated_error, spread)
        self._of_rows = dict(_errors_of_rows(results))

    def of_words(self) -> float | None:
        """Relative error of a number inside a sentence.

        Returns
        -------
        float or None
            That of the peak torques, or of frequencies where there is no start. [1]
        """
        return self._peaks if self._peaks is not None else self._frequency

    def of_value(self, table: str, column: str, row: Mapping[str, Any]) -> float | None:
        """The reported error of one number.

        Parameters
        ----------
        table, column : str
            Result table and header. [names]
        row : mapping
            The row as it would be written, by header. [shown units]

        Returns
        -------
        float or None
            None where the result has no error but rounding. [shown unit]
        """
        own = row.get(column)
        if isinstance(own, str):
            return self.of_words()
        field = find_column(table, column)
        if field is None or field.error is None:
            return None
        error, size = self._error(table, field.error, row), row.get(field.share_of or column)
        if error is None or not isinstance(size, int | float):
            return None
        return error * abs(size)

    def _error(self, table: str, error: ReportedError, row: Mapping[str, Any]) -> float | None:
        """A reported error, relative: that of the row where its table reports one for each. [1]"""
        if error in (ReportedError.PEAKS, ReportedError.EVENTS):
            own = self._of_rows.get((table, str(row.get("Event") or ""), str(row.get("Element"))))
            if own is not None:
                return own
        if error is ReportedError.PEAKS:
            return self._peaks
        if error is ReportedError.STARTS:
            return self._starts.get(str(row.get("Element")))
        if error is ReportedError.ALL_STARTS:
            return max(self._starts.values(), default=None)
        if error is ReportedError.FREQUENCIES:
            return self._frequency
        if error is ReportedError.EVENTS:
            return self._events.get(str(row.get("Event")))
        if error is ReportedError.EVENT_DAMAGE:
            return self._damage.get((str(row.get("Event")), str(row.get("Element"))))
        if error is ReportedError.WORDS:
            return self.of_words()
        return 1.0  # another version may estimate an error otherwise, up to its size


def _errors_of_rows(results: Results) -> Iterator[tuple[tuple[str, str, str], float]]:
    """Table, event and element of each row with an error of its own, and that error. [1]

    None is larger than that of all peaks, which disregards elements whose torque is negligible.
    """
    start = results.start
    if start is not None:
        spread = start.repeatability.spread if start.repeatability is not None else 0.0
        for peak in start.peaks:
            own = min(peak.relative_error, start.estimated_error)
            yield ("StartupPeaks", "", peak.element), max(own, spread)
    for event in results.events:
        response = event.response
        if response is not None:
            for peak in response.peaks:
                own = min(peak.relative_error, response.estimated_error)
                yield ("EventPeaks", event.name, peak.element), own
