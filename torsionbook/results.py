"""One calculation: tables as frames and records, verdicts, histories, pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

from addin.calculation.calculation import Calculation
from addin.charts.data import chart_blocks, history_limits
from addin.contract.tables import RESULT_TABLES, TableSpec
from addin.contract.version import product_version
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.report.units import document_units
from addin.writing.recalculate import recalculate_case
from addin.writing.results_json import results_to_json, table_rows
from addin.writing.workbook import chosen_elements
from torsionbook.extras import extra
from torsionbook.frames import Tables
from torsionbook.inputs import Input, Source, read
from torsionbook.problems import refuse

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False, eq=False)
class Results(Tables):
    """Everything one run answers. Made by `run` and `recalculate`."""

    _specs = RESULT_TABLES
    _kind = "result table"

    _read: CaseInput = field(repr=False)
    _calculation: Calculation = field(repr=False)

    def __repr__(self) -> str:
        return f"<Results of '{self._read.data.title or ''}': {self.headline or self.outcome}>"

    def _records(self, spec: TableSpec) -> Iterable[Mapping[str, Any]]:
        return table_rows(spec.name, self._calculation.tables.get(spec.name, ()))

    @property
    def input(self) -> Input:
        """What was calculated."""
        return Input(self._read)

    @property
    def outcome(self) -> str:
        """How the start ended, such as ``reached``; ``calculated`` where there is none. [word]"""
        return str(self._calculation.outcome)

    @property
    def overall(self) -> str:
        """The verdict over all checks: ``pass``, ``fail``, ``incomplete``, ... [word]"""
        return str(self.verdicts[0]["verdict"])

    @property
    def headline(self) -> str:
        """The banner of sheet Summary. [sentence]"""
        return str(self.to_json().get("headline", ""))

    @property
    def verdicts(self) -> tuple[Mapping[str, Any], ...]:
        """Every check with its verdict, the overall one first; see table ``Verdicts``. [SI]"""
        return self.rows("Verdicts")

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader must know beside the numbers. [sentences]"""
        return self._calculation.warnings

    @property
    def histories(self) -> tuple[str, ...]:
        """Elements whose torque in the start can be had by `history`. [names]"""
        return tuple(self._calculation.view.histories or ())

    def history(self, element: str) -> pd.DataFrame:
        """Torque of an element in the start, turning points included.

        Parameters
        ----------
        element : str
            One of `histories`. [name]

        Returns
        -------
        pandas.DataFrame
            Columns time and torque, at the element's own speed. [s, N m]
        """
        found = self._calculation.view.histories or {}
        if element not in found:
            there = f"There are {', '.join(found)}." if found else "No start was calculated."
            raise LookupError(f"element '{element}' has no history. {there}")
        time, torque = found[element]
        return _curve({"time": time, "torque": torque}, {"time": "s", "torque": "N*m"})

    def speed(self) -> pd.DataFrame:
        """Mean speed of the reference shaft in the start.

        Returns
        -------
        pandas.DataFrame
            Columns time and speed; empty where no start was calculated. [s, rad/s]
        """
        time, speed = self._calculation.view.speed_time or ((), ())
        return _curve({"time": time, "speed": speed}, {"time": "s", "speed": "rad/s"})

    @property
    def plots(self) -> tuple[str, ...]:
        """Pictures that can be had by `plot`. [names]"""
        return tuple(self._pictures())

    def plot(self, name: str) -> Figure:
        """A picture of the report, in the units of the workbook.

        Parameters
        ----------
        name : str
            One of `plots`, such as ``interference`` or ``speed-time``. [name]

        Returns
        -------
        matplotlib.figure.Figure
            To be shown, changed or saved. [shown units]
        """
        pictures = self._pictures()
        if name not in pictures:
            raise LookupError(f"There is no picture '{name}'. There are {', '.join(pictures)}.")
        picture = pictures[name]()
        assert picture is not None, f"{name} has nothing to show"
        return cast("Figure", picture.drawing)

    def _pictures(self) -> Mapping[str, Callable[[], Any]]:
        """The pictures of the report, to be drawn but not encoded."""
        extra("matplotlib", "pictures")
        from addin.report.figures import Charts, Pictures

        units, run = document_units(self._read).units, self._calculation
        chosen = (
            chosen_elements(self._read.workbook) if isinstance(self._read, WorkbookInput) else ()
        )
        blocks = chart_blocks(run.case, units, run.view, chosen)
        limits = history_limits(run.case, units, run.view, chosen)
        pictures = Pictures(Charts.of(blocks), vectors=False, pixels=False, limits=limits)
        synchronous = run.case.ratings.synchronous_speed
        return pictures.by_name(run.case, run.tables["ModeShapes"], synchronous)

    def to_json(self) -> dict[str, Any]:
        """The object of the results JSON, as ``torsionbook recalc --json`` writes it. [SI]"""
        return results_to_json(self._calculation, product_version())


def run(source: Source, *, progress: Callable[[str], None] | None = None) -> Results:
    """Calculate an input: the numbers of ``torsionbook recalc``, to the last bit.

    Parameters
    ----------
    source : Input, path, mapping or openpyxl Workbook
        What `read` takes.
    progress : callable, optional
        Called with the name of each analysis as it begins.

    Returns
    -------
    Results
        Complete. [SI]

    Raises
    ------
    InputError
        With everything that is wrong.

    Examples
    --------
    >>> import torsionbook as tb
    >>> done = tb.run(tb.template("example_modified"))
    >>> done.outcome, round(done.rows("NaturalFrequencies")[1]["frequency"], 1)
    ('reached', 21.0)
    """
    found = read(source)._read
    refuse(found.problems)
    calculation, problems = recalculate_case(found, {}, progress)
    refuse(problems)
    assert calculation is not None
    return Results(found, calculation)


def _curve(columns: Mapping[str, Any], units: Mapping[str, str]) -> pd.DataFrame:
    frame = extra("pandas", "frames").DataFrame(dict(columns), dtype="float64")
    frame.attrs["units"] = dict(units)
    return frame
