"""Studies of an input: many runs, by the same records as the commands and the server."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from addin.contract.tables import RESULT_TABLES, STUDY_RESULT_TABLES, TableSpec, table
from addin.contract.version import product_version
from addin.reading.typed_case import CaseInput
from addin.recorded.studies import RecordedStudy
from addin.report.units import document_units
from addin.studies.registry import found_studies
from addin.studies.run_study import calculate_study, to_json
from addin.studies.study import Study, StudyResult, wrong_setting
from addin.workers.opened_map import open_parallel_map
from torsionbook.extras import extra
from torsionbook.frames import Tables
from torsionbook.inputs import Source, read
from torsionbook.problems import refuse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TABLES = (*STUDY_RESULT_TABLES, *RESULT_TABLES)


@dataclass(frozen=True, repr=False, eq=False)
class StudyResults(Tables):
    """What a study showed. Made by `study`."""

    _specs = _TABLES
    _kind = "result table"

    _study: Study = field(repr=False)
    _read: CaseInput = field(repr=False)
    _result: StudyResult = field(repr=False)
    _warnings: tuple[str, ...] = field(repr=False)

    def __repr__(self) -> str:
        return f"<Results of study {self._study.command}: {self.sentence}>"

    def _records(self, spec: TableSpec) -> Sequence[Mapping[str, Any]]:
        return self.to_json().get(spec.key, ())  # type: ignore[no-any-return]

    @property
    def sentence(self) -> str:
        """What was found, in words. [sentence]"""
        return self._result.sentence

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the engineer should know. [sentences]"""
        return self._warnings

    @property
    def plots(self) -> tuple[str, ...]:
        """Pictures that can be had by `plot`, by their captions. [names]"""
        return tuple(self._figures())

    def plot(self, name: str) -> Figure:
        """A picture of the report.

        Parameters
        ----------
        name : str
            One of `plots`. [name]

        Returns
        -------
        matplotlib.figure.Figure
            To be shown, changed or saved. [shown units]
        """
        figures = self._figures()
        if name not in figures:
            there = f"There are {'; '.join(figures)}." if figures else "This study has none."
            raise LookupError(f"There is no picture '{name}'. {there}")
        return figures[name]

    def _figures(self) -> dict[str, Figure]:
        """The pictures of the report by caption, drawn but not encoded."""
        extra("matplotlib", "pictures")
        from addin.report.figures import Charts, Pictures
        from addin.report.studies import study_pictures

        rows = {**self._result.tables, **self._result.charts}
        recorded = RecordedStudy(
            on_sheet=self._study.spec,
            sentence=self.sentence,
            stamp="",
            tables={name: _by_header(name, rows[name]) for name in rows},
            outdated="",
            edited=(),
            is_recorded=True,
        )
        pictures = Pictures(Charts({}, {}), vectors=False, pixels=False)
        found = study_pictures(recorded, document_units(self._read), pictures)
        return {picture.caption: picture.drawing for picture in found}

    def save(self, name: str = "case", **options: Any) -> tuple[Path, ...]:
        """Write the further files that the command of the study writes, such as the best cases of ``tune``.

        Parameters
        ----------
        name : str, optional
            Their names begin with it. [name]
        **options
            Options of the command that name files, such as ``cases="best", top=3`` of ``tune``.

        Returns
        -------
        tuple of Path
            The files written; cases among them can be read by `read`.
        """
        known = {option.name: option for option in self._study.options}
        for option in options:
            if option not in known:
                raise LookupError(
                    f"{self._study.command} has no option '{option}'. Available: {', '.join(known) or 'none'}."
                )
        given = {
            name: Path(options[name])
            if option.kind is Path and name in options
            else options.get(name, option.default)
            for name, option in known.items()
        }
        if sentence := self._study.refusal(given):
            raise ValueError(sentence)
        return tuple(self._study.save(self._result, given, Path(f"{name}.json")))

    def to_json(self) -> dict[str, Any]:
        """The object that the command of the study writes with ``--json``. [SI]"""
        as_json = self._study.as_json or partial(to_json, self._study)
        return as_json(self._result, self._read, self._warnings)


def study(
    source: Source,
    name: str,
    *,
    jobs: int = 1,
    progress: Callable[[str], None] | None = None,
    **settings: Any,
) -> StudyResults:
    """Make a study of an input, which holds the tables of the study.

    Parameters
    ----------
    source : Input, path, mapping or openpyxl Workbook
        What `read` takes.
    name : str
        ``tune``, ``tolerances``, ``sensitivities``, ``starts``, ``calibrate`` or ``accuracy``: the commands. [word]
    jobs : int, optional
        Processes; 1 = this one. [count]
    progress : callable, optional
        Called with a word on what is being done.
    **settings
        Those of the command, such as ``samples=1000``.

    Returns
    -------
    StudyResults
        Complete. [SI]

    Raises
    ------
    InputError
        With everything that is wrong with the case or the tables of the study.

    Examples
    --------
    >>> import torsionbook as tb
    >>> train = tb.read(tb.template("example_modified")).change({"Tuning": [
    ...     {"Element": "LS coupling", "Quantity": "stiffness", "Values": "0.8; 1.2", "Unit": "1"}]})
    >>> len(tb.study(train, "tune").rows("TuningResults"))  # the two, and the train as it is
    3
    """
    studies = {one.command: one for one in found_studies()}
    if name not in studies:
        raise LookupError(f"There is no study '{name}'. There are {', '.join(studies)}.")
    asked = studies[name]
    if wrong := wrong_setting(name, asked.options, settings):
        raise ValueError(wrong)
    found = read(source)._read
    every = {option.name: option.default for option in asked.options if option.is_setting}
    with open_parallel_map(
        1 if asked.measures_time else jobs, None, product_version, lambda: False
    ) as parallel_map:
        result, problems, warnings = calculate_study(
            asked, found, parallel_map, every | settings, progress or (lambda stage: None)
        )
    refuse(problems)
    assert result is not None
    return StudyResults(asked, found, result, warnings)


def _by_header(name: str, rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of a table by the headers of its sheet."""
    headers = {column.key: column.name for column in table(name).columns}
    return [{headers.get(key, key): value for key, value in row.items()} for row in rows]
