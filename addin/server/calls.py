"""A list of function calls → their answers in the same order."""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from addin.server.guard import Refused, encoded
from addin.server.settings import Limits
from addin.server.starts import Starts, Tell
from addin.server.work import OURS, Busy, TooLong
from addin.worksheet import functions  # noqa: F401  (enters the functions)
from addin.worksheet.models import MODELS, Model
from addin.worksheet.registry import FUNCTIONS, FunctionError, call, rows_of

__all__ = ["Call", "Calls", "error", "read_call", "read_calls"]

LOG = logging.getLogger("torsionbook.server")
#: Threads for short functions, and for what a long one shows of its start. [count]
SHORT_THREADS, LONG_THREADS = 8, 2
#: Most cells in one answer: what more would take no spreadsheet shows. [count]
MOST_CELLS = 3_000_000

Answer = dict[str, Any]


@dataclass(frozen=True)
class Call:
    """A function with the arguments given.

    Parameters
    ----------
    name : str
        Name of the function, in capitals. [name]
    arguments : list
        As a front hands them over. [as typed]
    """

    name: str
    arguments: list[Any]

    @property
    def is_long(self) -> bool:
        """Whether it may have to calculate a start."""
        function = FUNCTIONS.get(self.name)
        return function is not None and function.long

    def model(self) -> Model | None:
        """The model it asks about; None where the function itself will say what is wrong.

        Returns
        -------
        Model or None
            The model.
        """
        function = FUNCTIONS[self.name]
        for argument, given in zip(function.arguments, self.arguments, strict=False):
            if argument.kind == "model":
                try:
                    cell = rows_of(given)[0][0]
                    return MODELS.of(cell) if isinstance(cell, str) else None
                except (FunctionError, IndexError):
                    return None
        return None


def read_calls(content: Any, most: int) -> list[Call]:
    """The calls of a request.

    Parameters
    ----------
    content : object
        What its JSON holds.
    most : int
        How many may be asked for. [count]

    Returns
    -------
    list of Call
        In order.

    Raises
    ------
    Refused
        If it is no list of calls.
    """
    calls = content.get("calls") if isinstance(content, dict) else None
    if not isinstance(calls, list):
        raise Refused(400, 'Send {"calls": [{"name": "TV_CONVERT", "arguments": [1, "m", "ft"]}]}.')
    if len(calls) > most:
        raise Refused(
            413, f"There are {len(calls):,} calls; one request may hold {most:,}. Send several."
        )
    return [read_call(one, f"calls[{i}]") for i, one in enumerate(calls)]


def read_call(content: Any, place: str) -> Call:
    """One call.

    Parameters
    ----------
    content : object
        With ``name`` and ``arguments``.
    place : str
        Where it stands, for the sentence. [text]

    Returns
    -------
    Call
        The call.

    Raises
    ------
    Refused
        If it is none.
    """
    name = content.get("name") if isinstance(content, dict) else None
    if not isinstance(name, str):
        raise Refused(400, f"{place} has no name. Give the name of a function, such as TV_CONVERT.")
    arguments = content.get("arguments", [])
    if not isinstance(arguments, list):
        raise Refused(400, f"{place}: arguments is no list. Give one value for each argument.")
    return Call(name.upper(), arguments)


def error(message: str, code: str = "#VALUE!") -> Answer:
    """The answer of a call that has no value.

    Parameters
    ----------
    message : str
        Why. [sentence]
    code : str
        What a cell shows that can only show codes. [code]

    Returns
    -------
    dict
        As it is sent.
    """
    return {"error": {"message": message, "code": code}}


class Calls:
    """Answers calls: short ones in threads, long ones once their start is there.

    Parameters
    ----------
    starts : Starts
        Where starts come from.
    limits : Limits
        Limits of one request.
    """

    def __init__(self, starts: Starts, limits: Limits) -> None:
        self._starts = starts
        self._limits = limits
        self._short = ThreadPoolExecutor(SHORT_THREADS, "short")
        self._long = ThreadPoolExecutor(LONG_THREADS, "long")

    def close(self) -> None:
        """Let the threads go."""
        for pool in (self._short, self._long):
            pool.shutdown(wait=False, cancel_futures=True)

    async def answers(self, calls: Sequence[Call]) -> list[Answer]:
        """Answers in the order of the calls.

        Parameters
        ----------
        calls : sequence of Call
            What is asked for.

        Returns
        -------
        list of dict
            ``value``, rows of cells, or ``error`` each. [shown units]
        """
        found: dict[int, Answer] = {}
        short = [i for i, one in enumerate(calls) if not one.is_long]
        long = [i for i, one in enumerate(calls) if one.is_long]
        # the short ones first: a TV_MODEL among them makes the handle that a long one asks about
        found |= await self._in_thread(self._short, calls, short)
        found |= await self._wait_for_starts(calls, long)
        found |= await self._in_thread(self._long, calls, [i for i in long if i not in found])
        return _bounded(found[i] for i in range(len(calls)))

    async def one(self, wanted: Call, tell: Tell | None = None) -> Answer:
        """The answer of one call, its stages told.

        Parameters
        ----------
        wanted : Call
            What is asked for.
        tell : callable, optional
            Called with each stage. [words]

        Returns
        -------
        dict
            ``value`` or ``error``. [shown units]
        """
        if not wanted.is_long:
            return (await self._in_thread(self._short, [wanted], [0]))[0]
        failed = await self._start_of(wanted.model(), tell)
        return failed or (await self._in_thread(self._long, [wanted], [0]))[0]

    async def encoded(self, content: Any) -> bytes:
        """JSON, made in a thread since it may be large.

        Parameters
        ----------
        content : object
            Plain values.

        Returns
        -------
        bytes
            JSON.
        """
        return await asyncio.get_running_loop().run_in_executor(self._short, encoded, content)

    async def _wait_for_starts(
        self, calls: Sequence[Call], long: Iterable[int]
    ) -> dict[int, Answer]:
        """Have every start asked for; the answers of calls whose start could not be had."""
        models = {i: model for i in long if (model := calls[i].model()) is not None}
        distinct = {model.handle: model for model in models.values()}
        failed = await asyncio.gather(*(self._start_of(model) for model in distinct.values()))
        of_handle = dict(zip(distinct, failed, strict=True))
        return {i: told for i, m in models.items() if (told := of_handle[m.handle]) is not None}

    async def _start_of(self, model: Model | None, tell: Tell | None = None) -> Answer | None:
        try:
            if model is not None:
                await self._starts.ready(model, tell)
        except (Busy, TooLong, RuntimeError) as wrong:
            return error(str(wrong), "#N/A")
        return None

    async def _in_thread(
        self, pool: ThreadPoolExecutor, calls: Sequence[Call], wanted: Sequence[int]
    ) -> dict[int, Answer]:
        """Some of the calls, one after the other in one thread, as many as the time allows."""
        if not wanted:
            return {}
        found: dict[int, Answer] = {}
        given_up = threading.Event()

        def work() -> None:
            until = time.monotonic() + self._limits.short_time
            for i in wanted:
                if given_up.is_set() or time.monotonic() > until:
                    return
                found[i] = _answer(calls[i])

        try:
            async with asyncio.timeout(self._limits.short_time):
                await asyncio.get_running_loop().run_in_executor(pool, work)
        except TimeoutError:
            pass
        finally:
            given_up.set()
        late = error(
            f"The calls of this request took longer than {self._limits.short_time:g} s. Ask for fewer "
            "at a time.",
            "#N/A",
        )
        return {i: found.get(i, late) for i in wanted}


def _answer(wanted: Call) -> Answer:
    try:
        return {"value": call(wanted.name, wanted.arguments)}
    except FunctionError as wrong:
        return error(wrong.message, wrong.code)
    except Exception:
        LOG.exception("%s failed", wanted.name[:60])
        return error(OURS)


def _bounded(answers: Iterable[Answer]) -> list[Answer]:
    """The answers as far as one request may carry them."""
    cells, kept = 0, []
    for one in answers:
        rows = one.get("value") or ()
        cells += len(rows) * len(rows[0]) if rows else 0
        if cells > MOST_CELLS:
            one = error(
                f"The answers of this request hold more than {MOST_CELLS:,} cells. Send several.",
                "#N/A",
            )
        kept.append(one)
    return kept
