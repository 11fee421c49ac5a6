"""A workbook recalculated without Excel, from a file or as openpyxl has it in memory."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from addin.reading.one_file import WORKBOOK_ENDINGS, file_problem
from addin.reading.workbook import WorkbookInput
from addin.template.filled import MixedUnits
from addin.writing.recalculate import PreparedInput
from addin.writing.recalculate import recalculate as recalculate_file
from addin.xlsx.errors import PackageError
from addin.xlsx.temporary import temporary_folder
from addin.xlsx.whole_files import write_whole
from torsionbook.extras import extra
from torsionbook.inputs import OpenpyxlWorkbook, is_openpyxl, read
from torsionbook.problems import InputError, Problem, records, refuse
from torsionbook.results import Results


@dataclass(frozen=True, repr=False, eq=False)
class Recalculated:
    """A recalculated workbook. Made by `recalculate`."""

    results: Results  #: What was calculated. [SI]
    notes: tuple[str, ...]  #: What the engineer should know of results and file. [sentences]
    path: Path | None  #: The file; None where none was asked for.
    content: bytes = field(repr=False)  #: The file's bytes.

    def __repr__(self) -> str:
        return f"<Recalculated {self.path or 'workbook'}: {self.results.headline}>"

    def workbook(self) -> Any:
        """The workbook with its results as openpyxl reads it: values, no formulas.

        Returns
        -------
        openpyxl.Workbook
            To read from. Saved by openpyxl it would lose charts and styles; the file itself has them.
        """
        openpyxl = extra("openpyxl", "workbooks in memory")
        return openpyxl.load_workbook(io.BytesIO(self.content), data_only=True)

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the file to another place.

        Parameters
        ----------
        path : path
            The file; one that is there is replaced. [path]

        Returns
        -------
        Path
            The file.
        """
        target = Path(path)
        write_whole(target, lambda file: file.write_bytes(self.content))
        return target


def recalculate(
    source: str | PathLike[str] | OpenpyxlWorkbook,
    out: str | PathLike[str] | None = None,
    *,
    template: str | PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Recalculated:
    """Recalculate a workbook: its inputs are read, calculated, and its results written.

    Of a file every part but the result cells stays byte for byte, as with ``torsionbook recalc``. Of an
    openpyxl workbook the inputs go into a shipped template, or into `template`, with all charts and styles; the
    sheets that the script added come along.

    Parameters
    ----------
    source : path or openpyxl Workbook
        A workbook with inputs. [path]
    out : path, optional
        Where the result goes; without it, it is in memory alone. [path]
    template : path, optional
        For an openpyxl workbook: a workbook of this product as somebody styled it, whose own sheets stay. [path]
    progress : callable, optional
        Called with the name of each stage as it begins.

    Returns
    -------
    Recalculated
        Results and file.

    Raises
    ------
    InputError
        With everything that is wrong; then nothing is written.

    Examples
    --------
    >>> import torsionbook as tb
    >>> done = tb.recalculate(tb.template("example_modified"))
    >>> sheet, cell = next(done.workbook().defined_names["OverallVerdict"].destinations)
    >>> str(done.workbook()[sheet][cell.replace("$", "")].value).split(":")[0]
    'INCOMPLETE'
    """
    notes: tuple[str, ...]
    found = read(source)
    refuse(found._read.problems)
    if not isinstance(found._read, WorkbookInput):
        raise ValueError(f"{source} is no workbook. Recalculate a .xlsx or .xlsm file, or use run.")
    if template is not None and not is_openpyxl(source):
        raise ValueError("template is for openpyxl workbooks: a file is its own template.")
    with temporary_folder() as folder:
        path, prepared, notes = found._read.path, found._read, ()
        if is_openpyxl(source):
            prepared, notes = _rebuilt(source, found._read, folder, template)
            path = prepared.path
        target = folder / f"results{path.suffix}" if out is None else Path(out)
        if target.suffix.lower() not in WORKBOOK_ENDINGS:
            raise ValueError(f"{target} must end in .xlsx or .xlsm.")
        outcome = recalculate_file(
            path, destination=target, on_stage=progress, prepared=PreparedInput(read=prepared)
        )
        refuse(outcome.problems)
        assert outcome.calculation is not None
        content = target.read_bytes()
    if out is None and outcome.calculation.case.keep_history not in (None, "no"):
        notes += (
            "The full history was not kept: it is a file beside the workbook. Name one with out.",
        )
    results = Results(found._read, outcome.calculation)
    return Recalculated(
        results, (*notes, *outcome.warnings), None if out is None else target, content
    )


def _rebuilt(
    source: OpenpyxlWorkbook,
    found: WorkbookInput,
    folder: Path,
    template: str | PathLike[str] | None,
) -> tuple[WorkbookInput, tuple[str, ...]]:
    """The inputs of an openpyxl workbook in a template, and what is to be said of it."""
    from addin.template.rebuilt import CannotBeRebuilt, rebuilt_workbook

    own = None if template is None else Path(template)
    was_loaded = getattr(source, "loaded_theme", None) is not None
    try:
        done = rebuilt_workbook(found, folder, own, was_loaded=was_loaded)
    except (PackageError, OSError) as error:
        raise InputError(records((file_problem(own or found.path, error),))) from error
    except (CannotBeRebuilt, MixedUnits) as error:
        allowed = "a template that can hold the inputs"
        raise InputError((Problem("", "", None, "", template, allowed, str(error)),)) from error
    return done.read, done.notes
