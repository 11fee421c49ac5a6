"""Calculations that wait for each other, so that the starts they simulate run side by side.

A whole run asks for one simulation after the other, in functions deep within it. Of several runs each goes on until it
wants a simulation; all of these are made in the lanes of one loop, and each goes on with its own. A thread keeps the
place where a run waits; only one of them calculates at a time, in a fixed order.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextvars import ContextVar, copy_context
from typing import Any, TypeVar

from engine.errors import InternalError
from engine.start.simulation import Simulation, runs_of
from engine.start.trajectory import SingleRun
from engine.stepping import linear_loop as kernels

#: Calculations that wait for each other: the lanes are filled though some want no simulation just then. [count]
AT_ONCE = 2 * kernels.LANES

Unit = TypeVar("Unit")
Result = TypeVar("Result")


class _GivenUp(BaseException):
    """Ends a calculation whose result nobody wants; no handler of errors takes it."""


class _Waiting:
    """A calculation that stops at each simulation it wants."""

    def __init__(self, calculate: Callable[[], Any]) -> None:
        self.calculate = calculate
        self.wanted: Sequence[Simulation] = ()
        self.given: list[SingleRun | InternalError] | None = None
        self.ended = False
        self.result: Any = None
        self.error: BaseException | None = None
        self._goes_on, self._stops = threading.Semaphore(0), threading.Semaphore(0)
        run = copy_context().run  # numpy's handling of errors is kept in it, for one
        self._thread = threading.Thread(target=run, args=(self._to_its_end,), daemon=True)

    def _to_its_end(self) -> None:
        _PRESENT.set(self)
        try:
            self.result = self.calculate()
        except BaseException as error:  # noqa: BLE001 - raised where the results are wanted
            self.error = error
        self.ended = True
        self._stops.release()

    def go_on(self) -> None:
        """Calculate until the next simulation is wanted, or to the end."""
        if self._thread.ident is None:
            self._thread.start()
        else:
            self._goes_on.release()
        self._stops.acquire()

    def runs(self, wanted: Sequence[Simulation]) -> list[SingleRun | InternalError]:
        """Called by the calculation itself: wait for simulations."""
        self.wanted = wanted
        self._stops.release()
        self._goes_on.acquire()
        if self.given is None:
            raise _GivenUp
        return self.given

    def give_up(self) -> None:
        """End where it waits."""
        self.given = None
        while not self.ended and self._thread.ident is not None:
            self.go_on()


_PRESENT: ContextVar[_Waiting | None] = ContextVar("calculation that waits", default=None)


def simulated(wanted: Sequence[Simulation]) -> list[SingleRun]:
    """Starts from rest to their ends; within `by_turns` beside those of the other calculations.

    Parameters
    ----------
    wanted : sequence of Simulation
        Starts. [SI]

    Returns
    -------
    list of SingleRun
        Of each the same bits as alone. [SI]

    Raises
    ------
    InternalError
        If one diverges.
    """
    present = _PRESENT.get()
    found: list[SingleRun] = []
    for run in runs_of(wanted) if present is None else present.runs(wanted):
        if isinstance(run, InternalError):
            raise run
        found.append(run)
    return found


def in_groups(units: Sequence[Unit], size: int = AT_ONCE) -> list[Sequence[Unit]]:
    """Units of work in their order, so many together; the last group may be smaller."""
    return [units[first : first + size] for first in range(0, len(units), size)]


def by_turns(calculations: Sequence[Callable[[], Result]]) -> list[Result]:
    """Results of calculations, whose starts run side by side; the first error is raised.

    Parameters
    ----------
    calculations : sequence of callable
        Each gives the same bits as when it is called alone.

    Returns
    -------
    list
        In the same order.
    """
    results: list[Result] = []
    for some in in_groups(calculations):
        results += [calculate() for calculate in some] if len(some) == 1 else _together(some)
    return results


def _together(calculations: Sequence[Callable[[], Result]]) -> list[Result]:
    every = [_Waiting(calculate) for calculate in calculations]
    waiting = every
    try:
        while waiting:
            for one in waiting:
                one.go_on()
            waiting = [one for one in waiting if not one.ended]
            runs = iter(runs_of([simulation for one in waiting for simulation in one.wanted]))
            for one in waiting:
                one.given = [next(runs) for _ in one.wanted]
    finally:
        for one in every:
            one.give_up()
    for one in every:
        if one.error is not None:
            raise one.error
    return [one.result for one in every]
