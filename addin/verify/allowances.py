"""The error that this version reports for a result, in the unit in which it is shown.

Only results of the start carry an estimated error, and frequencies where shafts were cut into
segments. All others are exact to rounding, and nothing is allowed for them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from engine.results.results import Results

__all__ = ["Allowances"]

#: Result columns with the error of the peak torques, and the column whose size it is a share of.
_OF_PEAKS: Mapping[tuple[str, str], str] = {
    ("StartupPeaks", "Maximum torque"): "Peak-to-peak torque",
    ("StartupPeaks", "Minimum torque"): "Peak-to-peak torque",
    ("StartupPeaks", "Peak-to-peak torque"): "Peak-to-peak torque",
    ("StartupPeaks", "Peak-to-peak stress"): "Peak-to-peak stress",
    ("StartupCrossings", "Peak-to-peak torque"): "Peak-to-peak torque",
    ("StartupCrossings", "Peak-to-peak stress"): "Peak-to-peak stress",
    ("StartupCrossings", "Mesh minimum torque"): "Mesh minimum torque",
    ("TorqueReversals", "Minimum torque"): "Minimum torque",
    ("TorqueReversals", "Margin"): "Margin",
    ("TorqueReversals", "Tooth force"): "Tooth force",
    ("TorqueReversals", "Recontact speed"): "Recontact speed",
    ("TorqueReversals", "Recontact speed angular"): "Recontact speed angular",
    ("BearingForces", "Force"): "Force",
    ("StartCycles", "Amplitude"): "Amplitude",
}
_OF_STARTS = frozenset({"Damage", "Allowable starts", "Paper count"})
_OF_FREQUENCIES = frozenset({"Frequency", "CPM"})
#: Estimates of errors themselves: another version may estimate them otherwise, up to their size.
_ESTIMATES = frozenset({"Error", "Error peak", "Error starts", "Bound"})


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
        self._peaks: float | None = None
        if results.start is not None:
            spread = results.sensitivity.spread if results.sensitivity is not None else 0.0
            self._peaks = max(results.start.estimated_error, spread)

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
        if column in _ESTIMATES:
            return _share(1.0, own)
        if (table, column) in _OF_PEAKS:
            return _share(self._peaks, row.get(_OF_PEAKS[table, column]))
        if table == "AllowableStarts" and column in _OF_STARTS:
            return _share(self._starts.get(str(row.get("Element"))), own)
        if table == "StartCycles" and column in ("Damage", "Cycles to failure"):
            return _share(max(self._starts.values(), default=None), own)
        if table == "Verdicts" and column == "Result":
            return self.of_words() and _share(self.of_words(), own)
        if column in _OF_FREQUENCIES:
            return _share(self._frequency, own)
        return None


def _share(error: float | None, size: Any) -> float | None:
    if error is None or not isinstance(size, int | float):
        return None
    return error * abs(size)
