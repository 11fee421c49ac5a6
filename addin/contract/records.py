"""Records found in their folder: a new file is a new record, and no list is edited."""

from __future__ import annotations

import importlib
import pkgutil
from types import ModuleType
from typing import TypeVar

from addin.contract.field import IncompleteRecord

Record = TypeVar("Record")


def path_of(module: ModuleType) -> str:
    """The file of a module as it is in the source tree."""
    return module.__name__.replace(".", "/") + ".py"


def find_records(package: str, kind: type[Record]) -> dict[str, Record]:
    """The records of a folder by the files in which they stand.

    Parameters
    ----------
    package : str
        Dotted name of the folder. Every module in it holds one record, but `registry`.
    kind : type
        Class of the records.

    Returns
    -------
    dict of str to record
        In the order of the file names.

    Raises
    ------
    IncompleteRecord
        If a file holds none, or several.
    """
    by_file: dict[str, Record] = {}
    for entry in pkgutil.iter_modules(importlib.import_module(package).__path__):
        if entry.name == "registry":
            continue
        module = importlib.import_module(f"{package}.{entry.name}")
        records = [value for value in vars(module).values() if isinstance(value, kind)]
        if len(records) != 1:
            raise IncompleteRecord(
                f"{path_of(module)} defines {len(records)} records {kind.__name__}: define exactly one"
            )
        by_file[path_of(module)] = records[0]
    return by_file
