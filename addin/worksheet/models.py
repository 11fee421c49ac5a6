"""Handles of cases, and what has been calculated of them.

A handle is made of the case's digest, and of a digest of all that was typed, title block included:
equal inputs have one handle in every front and every session, and nobody is shown the title block of
somebody else. Results belong to the numbers alone: a title that is corrected costs no second start.

Cases are small and many are kept, for each client its share; results are large, so the least used are
dropped and calculated again when asked for. Several servers may share both through a `Store`.
"""

from __future__ import annotations

import hashlib
import json
import sys
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, Protocol

import numpy as np

from addin.reading.typed_case import CaseInput, Typed
from addin.worksheet.registry import FunctionError, ModelForgotten
from engine.case.case import Case
from engine.case.data import ADMINISTRATIVE, case_digest
from engine.errors import InternalError, ModelError

#: Beginning of every handle, digits of the case's digest in it, and of the digest of all typed.
PREFIX, DIGITS, OWN_DIGITS = "tv:", 16, 16
#: Names of the results that need a start, and none.
RUN, AT_SPEED = "run", "at speed"
#: Cases remembered, memory of them, and of the results. [count, B, B]
MOST_CASES, MOST_CASE_MEMORY, MOST_MEMORY = 2000, 300_000_000, 400_000_000
#: Who asks; the server sets it, so that no client makes the cases of another be forgotten.
OWNER: ContextVar[str] = ContextVar("owner", default="")


#: A result that a call brings along, whether it is still kept or not: digest, name and value.
_HANDED: ContextVar[tuple[str, str, Any]] = ContextVar("handed", default=("", "", None))


@contextmanager
def handed(model: Model, what: str, value: Any) -> Iterator[None]:
    """Give a result to the functions that are called meanwhile.

    Parameters
    ----------
    model : Model
        Whose result it is.
    what : str
        Name of the result. [name]
    value : object
        The result, or the `FunctionError` that says why there is none. [SI]
    """
    token = _HANDED.set((model.results, what, value))
    try:
        yield
    finally:
        _HANDED.reset(token)


class Store(Protocol):
    """Where several processes keep models and results; one that is away keeps and finds nothing."""

    def get(self, name: str) -> Any:
        """What is kept under a name, for whoever asks; None if there is nothing."""

    def put(self, name: str, value: Any) -> None:
        """Keep a value under a name."""

    def is_due(self, name: str) -> bool:
        """Whether what is used here ought to be put again, so that the others find it."""


@dataclass(eq=False)
class Model:
    """A case with what has been calculated of it; models of equal numbers share the results."""

    handle: str  #: Its name in the cells.
    case: Case  #: The case. [SI]
    system: str  #: ``US`` or ``SI``: units its results are shown in unless asked otherwise.
    results: str = ""  #: Digest of all that can change a result. [hexadecimal]
    size: int = 0  #: Memory of the case. [B]
    kept: dict[str, Any] = field(default_factory=dict)
    lock: threading.RLock = field(default_factory=threading.RLock)
    sizes: dict[str, int] = field(default_factory=dict)

    @property
    def memory(self) -> int:
        """Memory of the results, measured once when each was kept. [B]"""
        return sum(list(self.sizes.values()))


class Models:
    """The models of one process.

    Parameters
    ----------
    most_cases : int
        Cases remembered. [count]
    most_memory : int
        Memory of all results together. [B]
    most_case_memory : int
        Memory of all cases together. [B]
    """

    def __init__(
        self,
        most_cases: int = MOST_CASES,
        most_memory: int = MOST_MEMORY,
        most_case_memory: int = MOST_CASE_MEMORY,
    ) -> None:
        self._models: OrderedDict[str, Model] = OrderedDict()
        #: Handles each client has used, the last used last.
        self._used: dict[str, OrderedDict[str, None]] = {}
        self._lock = threading.Lock()
        self._most_cases = most_cases
        self._most_memory = most_memory
        self._most_case_memory = most_case_memory
        #: Where other servers find what is made here, and the other way round; None = nowhere.
        self.store: Store | None = None

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
        return self.add_case(found.case(), system_of(found))

    def add_case(self, case: Case, system: str) -> Model:
        """Remember a case.

        Parameters
        ----------
        case : Case
            The case. [SI]
        system : str
            ``US`` or ``SI``: units its results are shown in unless asked otherwise. [word]

        Returns
        -------
        Model
            With its handle.
        """
        model = self._remember(case, system)
        self._share(model)
        return model

    def _remember(self, case: Case, system: str) -> Model:
        own, results, size = _digests(case)
        shown = "" if system == "SI" else f"-{system}"
        handle = f"{PREFIX}{case_digest(case)[:DIGITS]}.{own[:OWN_DIGITS]}{shown}"
        with self._lock:
            model = self._models.get(handle)
            if model is None:
                model = self._models[handle] = Model(handle, case, system, results, size)
                same = next((m for m in self._models.values() if m.results == results), model)
                model.kept, model.sizes, model.lock = same.kept, same.sizes, same.lock
            self._use(model)
            self._forget_cases(model)
        return model

    def _use(self, model: Model) -> None:
        self._models.move_to_end(model.handle)
        used = self._used.setdefault(OWNER.get(), OrderedDict())
        used[model.handle] = None
        used.move_to_end(model.handle)

    def _forget_cases(self, new: Model) -> None:
        """Forget the least used case of whoever has most, until the rest is within bounds."""
        total = sum(model.size for model in self._models.values())
        while len(self._models) > self._most_cases or total > self._most_case_memory:
            held = {
                owner: (sum(self._models[h].size for h in used if h in self._models), len(used))
                for owner, used in self._used.items()
            }
            by_memory = total > self._most_case_memory
            owner = max(held, key=lambda name: held[name][not by_memory])
            oldest = next(iter(self._used[owner]))
            if oldest == new.handle:
                return
            del self._used[owner][oldest]
            if not self._used[owner]:
                del self._used[owner]
            if oldest in self._models and not any(oldest in used for used in self._used.values()):
                total -= self._models.pop(oldest).size

    def _share(self, model: Model) -> None:
        name = f"model:{model.handle}"
        if self.store is not None and self.store.is_due(name):
            self.store.put(name, (model.case, model.system))

    def fetch(self, handles: Iterable[str]) -> None:
        """Take models that other servers have made from the store, and share those in use; both take time.

        Parameters
        ----------
        handles : iterable of str
            What is asked about; unknown ones are left alone. [names]
        """
        for handle in set(handles):
            if self.store is None or not handle.startswith(PREFIX):
                continue
            model = self._models.get(handle)
            if model is not None:
                self._share(model)
            elif (found := self.store.get(f"model:{handle}")) is not None:
                self._remember(*found)

    def result_of_others(self, model: Model, what: str) -> Any:
        """A result from memory or else from the store, which takes time; None if neither has it.

        Parameters
        ----------
        model : Model
            The model.
        what : str
            Name of the result. [name]

        Returns
        -------
        object
            The result, or the `FunctionError` that says why there is none. [SI]
        """
        value = model.kept.get(what)
        if value is None and self.store is not None:
            value = self.store.get(f"result:{model.results}:{what}")
            if value is not None:
                self._hold(model, what, value)
        return value

    def of(self, handle: str) -> Model:
        """The model of a handle.

        Raises
        ------
        FunctionError
            If it is no handle, or none of this session.
        """
        if not handle.startswith(PREFIX):
            raise FunctionError(
                f"'{handle[:60]}' is not a model. Give the cell with =TV_MODEL(...); it shows "
                f"{PREFIX}… "
                "or reports what is wrong with the tables."
            )
        with self._lock:
            model = self._models.get(handle)
            if model is None:
                raise ModelForgotten(
                    f"The model {handle[:40]} is not in the memory of this session. Recalculate "
                    "everything "
                    "(Ctrl+Alt+F9; in Calc Ctrl+Shift+F9). A program must call TV_MODEL or send "
                    "the workbook again.",
                    "#N/A",
                )
            self._use(model)
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
        *name, value = _HANDED.get()
        if not model.results or name != [model.results, what]:
            value = self._kept(model, what, calculate)
        if isinstance(value, FunctionError):
            raise FunctionError(value.message, value.code)
        return value

    def _kept(self, model: Model, what: str, calculate: Callable[[Case], Any]) -> Any:
        with model.lock:
            value = model.kept.get(what)
            if value is None:
                try:
                    value = calculate(model.case)
                except (ModelError, InternalError) as wrong:
                    value = FunctionError(str(wrong), "#NUM!")
                self._hold(model, what, value)
        return value

    def keep(self, model: Model, what: str, value: Any) -> None:
        """Keep a result that took long, for other servers too, and what there is of others within bounds.

        Parameters
        ----------
        model : Model
            The model.
        what : str
            Name of the result. [name]
        value : object
            The result, or the `FunctionError` that says why there is none. [SI]
        """
        self._hold(model, what, value)
        if self.store is not None:
            self.store.put(f"result:{model.results}:{what}", value)

    def _hold(self, model: Model, what: str, value: Any) -> None:
        with model.lock:
            model.kept[what] = value
            model.sizes[what] = _size(value)
        self._drop(model)

    @property
    def count(self) -> int:
        """Models. [count]"""
        return len(self._models)

    @property
    def memory(self) -> int:
        """Memory of all results. [B]"""
        with self._lock:
            return sum(model.memory for model in self._with_results().values())

    def _with_results(self) -> dict[str, Model]:
        """One model for each set of results, the least used first."""
        models: dict[str, Model] = {}
        for model in self._models.values():
            models.pop(model.results, None)
            models[model.results] = model
        return models

    def _drop(self, used: Model) -> None:
        """Forget results of the least used models until the rest is within bounds."""
        with self._lock:
            models = self._with_results()
            total = sum(model.memory for model in models.values())
            for model in models.values():
                if total <= self._most_memory:
                    return
                if model.results != used.results and model.kept:
                    total -= model.memory
                    model.kept.clear()
                    model.sizes.clear()


def _digests(case: Case) -> tuple[str, str, int]:
    """Digests of all that was typed, and of what can change a result, to the last digit; memory."""
    texts = [json.dumps(case, default=row) for row in (vars, _without_titles)]
    whole, bare = (hashlib.sha256(text.encode("ascii")).hexdigest() for text in texts)
    # a case takes some five times the memory of its text
    return whole, bare, 5 * len(texts[0])


def _without_titles(row: Any) -> dict[str, Any]:
    """What is left of a row when title block and description are left out."""
    return {name: value for name, value in vars(row).items() if name not in ADMINISTRATIVE}


def system_of(found: CaseInput) -> str:
    """Units of the tables: US where inertias or stiffnesses are in pounds.

    Parameters
    ----------
    found : CaseInput
        A case as typed. [as typed]

    Returns
    -------
    str
        US or SI. [word]
    """
    for table, column in (("Stations", "Inertia"), ("Elements", "Stiffness")):
        for row in found.typed.tables.get(table, []):
            entry = row.get(column)
            if isinstance(entry, Typed):
                return "US" if any(u in entry.unit.casefold() for u in ("lb", "kip")) else "SI"
    return "SI"


def _size(value: Any) -> int:
    """Memory of a result: its arrays, and every number and text in its tables. [B]"""
    total, seen, left = 0, set[int](), [value]
    while left:
        value = left.pop()
        if isinstance(value, (float, int)):
            total += 24  # equal numbers of different rows are different objects
            continue
        if value is None or id(value) in seen:
            continue
        seen.add(id(value))
        total += value.nbytes if isinstance(value, np.ndarray) else sys.getsizeof(value)
        if isinstance(value, dict):
            left.extend(value)
            left.extend(value.values())
        elif isinstance(value, (list, tuple, set, frozenset)):
            left.extend(value)
        elif not isinstance(value, (str, bytes, type, ModuleType)):
            left.extend(getattr(value, "__dict__", {}).values())
    return total


#: The models of this process.
MODELS = Models()
