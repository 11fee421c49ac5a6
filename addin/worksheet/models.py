"""Handles of cases, and what has been calculated of them.

A handle is made of the case's digest, so equal inputs have one handle in every front and every
session, and a cell that asks for results knows whether its inputs changed. Cases are small and many
are kept; results are large, so the least used are dropped and calculated again when asked for.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from addin.typed_case import CaseInput, Typed
from addin.worksheet.registry import FunctionError
from engine.case import Case, case_digest
from engine.errors import InternalError, ModelError

__all__ = ["MODELS", "Model", "Models", "RUN"]

#: Beginning of every handle, and digits of the digest in it.
PREFIX, DIGITS = "tv:", 16
#: Name of the result that needs a start.
RUN = "run"
#: Cases remembered, and memory of their results. [count, B]
MOST_CASES, MOST_MEMORY = 2000, 400_000_000


@dataclass(eq=False)
class Model:
    """A case with what has been calculated of it.

    Parameters
    ----------
    handle : str
        Its name in the cells. [text]
    case : Case
        The case. [SI]
    system : str
        ``US`` or ``SI``: units its results are shown in unless asked otherwise. [word]
    """

    handle: str
    case: Case
    system: str
    kept: dict[str, Any] = field(default_factory=dict)
    lock: threading.RLock = field(default_factory=threading.RLock)
    sizes: dict[str, int] = field(default_factory=dict)

    @property
    def memory(self) -> int:
        """Memory of the results, measured once when each was kept. [B]"""
        return sum(list(self.sizes.values()))

    def keep(self, what: str, value: Any) -> None:
        """Put a result where the functions look for it.

        Parameters
        ----------
        what : str
            Name of the result. [name]
        value : object
            The result, or the `FunctionError` that says why there is none. [SI]
        """
        with self.lock:
            self.kept[what] = value
            self.sizes[what] = _size(value)


class Models:
    """The models of one process.

    Parameters
    ----------
    most_cases : int
        Cases remembered. [count]
    most_memory : int
        Memory of all results together. [B]
    """

    def __init__(self, most_cases: int = MOST_CASES, most_memory: int = MOST_MEMORY) -> None:
        self._models: OrderedDict[str, Model] = OrderedDict()
        self._lock = threading.Lock()
        self._most_cases = most_cases
        self._most_memory = most_memory

    def add(self, found: CaseInput) -> Model:
        """Remember a case.

        Parameters
        ----------
        found : CaseInput
            Without problems. [SI]

        Returns
        -------
        Model
            With its handle.
        """
        case = found.case()
        system = _system(found)
        handle = f"{PREFIX}{case_digest(case)[:DIGITS]}{'' if system == 'SI' else '-' + system}"
        with self._lock:
            model = self._models.get(handle)
            if model is None:
                model = self._models[handle] = Model(handle, case, system)
            self._models.move_to_end(handle)
            while len(self._models) > self._most_cases:
                self._models.popitem(last=False)
        return model

    def of(self, handle: str) -> Model:
        """The model of a handle.

        Parameters
        ----------
        handle : str
            As a cell holds it. [text]

        Returns
        -------
        Model
            The model.

        Raises
        ------
        FunctionError
            If it is no handle, or none of this session.
        """
        if not handle.startswith(PREFIX):
            raise FunctionError(
                f"'{handle[:60]}' is no model. Give the cell with =TV_MODEL(...); it shows {PREFIX}… "
                "or says what is wrong with the tables."
            )
        with self._lock:
            model = self._models.get(handle)
            if model is None:
                raise FunctionError(
                    f"The model {handle[:40]} is not at hand in this session. Recalculate everything "
                    "(Ctrl+Alt+F9; in Calc Ctrl+Shift+F9). A program asks for the model again, with "
                    "TV_MODEL or the workbook.",
                    "#N/A",
                )
            self._models.move_to_end(handle)
        return model

    def result(self, model: Model, what: str, calculate: Callable[[Case], Any]) -> Any:
        """Something calculated of a model, once.

        Parameters
        ----------
        model : Model
            The model.
        what : str
            Name of the result. [name]
        calculate : callable
            Takes the case. [SI]

        Returns
        -------
        object
            What `calculate` gave.

        Raises
        ------
        FunctionError
            If the train cannot be calculated; kept as well, so that it is not tried again.
        """
        with model.lock:
            found = model.kept.get(what)
            if found is None:
                try:
                    found = calculate(model.case)
                except (ModelError, InternalError) as wrong:
                    found = FunctionError(str(wrong), "#NUM!")
                self.keep(model, what, found)
        if isinstance(found, FunctionError):
            raise FunctionError(found.message, found.code)
        return found

    def keep(self, model: Model, what: str, value: Any) -> None:
        """Keep a result, whoever calculated it, and what there is of others within bounds.

        Parameters
        ----------
        model : Model
            The model.
        what : str
            Name of the result. [name]
        value : object
            The result, or the `FunctionError` that says why there is none. [SI]
        """
        model.keep(what, value)
        self._drop(model)

    @property
    def memory(self) -> int:
        """Memory of all results. [B]"""
        with self._lock:
            return sum(model.memory for model in self._models.values())

    def _drop(self, used: Model) -> None:
        """Forget results of the least used models until the rest is within bounds."""
        with self._lock:
            total = sum(model.memory for model in self._models.values())
            for model in self._models.values():
                if total <= self._most_memory:
                    return
                if model is not used and model.kept:
                    total -= model.memory
                    model.kept.clear()
                    model.sizes.clear()


def _system(found: CaseInput) -> str:
    """Units of the tables: US where inertias or stiffnesses are in pounds."""
    for table, column in (("Stations", "Inertia"), ("Elements", "Stiffness")):
        for row in found.typed.tables.get(table, []):
            entry = row.get(column)
            if isinstance(entry, Typed):
                return "US" if any(u in entry.unit.casefold() for u in ("lb", "kip")) else "SI"
    return "SI"


def _size(value: Any, seen: set[int] | None = None, depth: int = 0) -> int:
    """Memory of the arrays in a result. [B]"""
    seen = set() if seen is None else seen
    if id(value) in seen or depth > 6:
        return 0
    seen.add(id(value))
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    if isinstance(value, dict):
        return sum(_size(v, seen, depth + 1) for v in value.values())
    if isinstance(value, (list, tuple)):
        return sum(_size(v, seen, depth + 1) for v in value[:1000])
    inside = getattr(value, "__dict__", None)
    return 0 if inside is None else sum(_size(v, seen, depth + 1) for v in inside.values())


#: The models of this process.
MODELS = Models()
