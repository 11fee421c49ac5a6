"""Any input file, a workbook or a case JSON → `CaseInput`, or why it cannot be opened."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from addin.contract.problems import CellProblem, printable
from addin.reading.case_json import read_case_json
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import read_workbook
from addin.xlsx import open_workbook
from addin.xlsx.container import DEFAULT_LIMITS, Limits
from addin.xlsx.errors import PackageError

#: Endings of workbooks; every other file is taken for JSON where it is to be written.
WORKBOOK_ENDINGS = (".xlsx", ".xlsm")


@dataclass(frozen=True)
class Unreadable:
    """An input that could not be opened at all, in the form of one that was read."""

    problems: tuple[CellProblem, ...]  #: Why.
    warnings: tuple[str, ...] = ()  #: Nothing.
    cause: Exception | None = None  #: What was raised.


def read_checked(source: Path, limits: Limits = DEFAULT_LIMITS) -> CaseInput | Unreadable:
    """Read and check a workbook or a case JSON; what is wrong is inside, not raised.

    Parameters
    ----------
    source : Path
        A .xlsx, .xlsm or .json file. [path]
    limits : Limits, optional
        How large a workbook may be.

    Returns
    -------
    CaseInput or Unreadable
        Data, problems and warnings. [SI]
    """
    try:
        if source.suffix.lower() == ".json":
            return read_case_json(source)
        return read_workbook(open_workbook(source, read_only=True, limits=limits))
    except (PackageError, OSError) as error:
        return Unreadable((file_problem(source, error),), cause=error)


def file_problem(source: Path, error: Exception) -> CellProblem:
    """A file that cannot be opened or written, as a problem."""
    sentence = str(error)
    if isinstance(error, FileNotFoundError) and _is_elsewhere(error, source):
        sentence = f"{error.filename} cannot be created. Name another folder for the results."
    elif isinstance(error, FileNotFoundError):
        sentence = f"file {error.filename or source} not found. Check the path."
    elif isinstance(error, IsADirectoryError) and _is_elsewhere(error, source):
        sentence = f"{error.filename} is a folder. Name a result file in it."
    elif isinstance(error, IsADirectoryError) or (
        isinstance(error, PermissionError)
        and os.path.isdir(source)
        and not _is_elsewhere(error, source)
    ):  # the second on Windows
        sentence = f"{source} is a folder; name the workbooks in it."
    elif isinstance(error, PermissionError) and os.path.isdir(error.filename or source):
        sentence = f"Nothing can be read or written in the folder {error.filename or source}. Name another folder."
    elif isinstance(error, PermissionError):
        sentence = (
            f"{error.filename or source} cannot be read or written. Close it if it is open "
            "elsewhere."
        )
    elif isinstance(error, (NotADirectoryError, FileExistsError)):
        sentence = f"{error.filename or source} is a file, but a folder is needed. Name a folder."
    elif isinstance(error, OSError) and error.strerror:
        sentence = f"{error.filename or source} cannot be used: {error.strerror}. Remove the cause, or name another file."
    sentence = "\n".join(map(printable, sentence.split("\n")))
    return CellProblem(
        "", "", None, "", printable(str(source)), "a file that can be used", sentence
    )


def _is_elsewhere(error: OSError, source: Path) -> bool:
    """Whether it is not the file itself that is missing or a folder, but a place to write to."""
    return isinstance(error.filename, str) and Path(error.filename).absolute() != source.absolute()
