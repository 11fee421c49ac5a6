"""A list of function calls → their answers in the same order."""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Awaitable, Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from contextvars import copy_context
from dataclasses import dataclass
from functools import partial
from typing import Any

from addin.server.answers import Refused, encoded
from addin.server.metrics import CALLS, Metrics
from addin.server.processes import Busy, TooLong
from addin.server.running_starts import Starts, Tell
from addin.server.settings import OURS, Limits
from addin.worksheet.models import AT_SPEED, MODELS, RUN, Model, handed
from addin.worksheet.registry import FUNCTIONS, FunctionError, ModelForgotten, call

LOG = logging.getLogger("torsionbook.server")
#: Threads for short functions, for requests of many cells, for what a long one shows of its start,
#: and for JSON. [count]
SHORT_THREADS, HEAVY_THREADS, LONG_THREADS, JSON_THREADS = 8, 2, 2, 2
#: A request beyond this is one of many cells. [B]
HEAVY = 250_000
#: How long a request may keep a thread while others wait. [s]
TURN = 0.1
#: Most cells in one answer: what more would take no spreadsheet shows; and in all that have not been
#: sent. [count]
MOST_CELLS, MOST_UNSENT = 3_000_000, 6_000_000
#: A train of more stations takes longer than a cell may wait: it goes to the pool. [count]
LARGE_TRAIN = 120

Answer = dict[str, Any]


@dataclass(frozen=True)
class Call:
    """A function with the arguments given."""

    name: str  #: Name of the function, in capitals.
    arguments: list[Any]  #: As a front hands them over. [as typed]

    @property
    def _kinds(self) -> tuple[str, ...]:
        """Kinds of the function's arguments; none of a function that is not known."""
        function = FUNCTIONS.get(self.name)
        return () if function is None else tuple(argument.kind for argument in function.arguments)

    @property
    def takes_model(self) -> bool:
        """Whether it asks about a model."""
        return "model" in self._kinds

    @property
    def handle(self) -> str:
        """The handle it gives; empty where there is none."""
        kinds = self._kinds[: len(self.arguments)]
        cell = _only_cell(self.arguments[kinds.index("model")]) if "model" in kinds else None
        return cell.strip() if isinstance(cell, str) else ""

    def model(self) -> Model | None:
        """The model it asks about; None where the function itself will say what is wrong."""
        try:
            return MODELS.of(self.handle) if self.handle else None
        except FunctionError:
            return None

    def result(self, model: Model) -> str | None:
        """The result of its model that it waits for; None for one that is answered at once."""
        if FUNCTIONS[self.name].long:
            return RUN
        return AT_SPEED if is_large(model) else None


def _only_cell(given: Any) -> Any:
    """The one cell of an argument; None where there are more, which are not looked at."""
    for _ in range(2):
        if isinstance(given, (list, tuple)):
            given = given[0] if len(given) == 1 else None
    if isinstance(given, dict):
        given = given.get("basicValue")
    return given


def is_large(model: Model) -> bool:
    """Whether even the modes of a train take too long for a thread of the server."""
    return len(model.case.stations) > LARGE_TRAIN


def read_calls(content: Any, most: int) -> list[Call]:
    """The calls of a request.

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
            413,
            f"There are {len(calls):,} calls; one request may contain at most {most:,}. Split "
            "them over several requests.",
        )
    return [read_call(item, f"calls[{i}]") for i, item in enumerate(calls)]


def read_call(content: Any, place: str) -> Call:
    """One call.

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
        raise Refused(400, f"{place}: arguments is not a list. Give one value for each argument.")
    return Call(name.upper(), arguments)


def error(message: str, code: str = "#VALUE!", *, busy: bool = False) -> Answer:
    """The answer of a call that has no value.

    Parameters
    ----------
    message : str
        Why. [sentence]
    code : str
        What a cell shows that can only show codes. [code]
    busy : bool
        Whether the same call may be answered a little later. [flag]
    """
    return {"error": {"message": message, "code": code} | ({"busy": True} if busy else {})}


def refusal(wrong: FunctionError) -> Answer:
    """The answer of a call that a function refuses; `forgotten` where its model is to be sent again."""
    answer = error(wrong.message, wrong.code)
    if isinstance(wrong, ModelForgotten):
        answer["error"]["forgotten"] = True
    return answer


#: What a task ends with where it has no result.
NO_RESULT = (FunctionError, Busy, TooLong, RuntimeError)


def without_result(wrong: Exception) -> Answer:
    """The answer to whoever waited for a task that ended with one of `NO_RESULT`."""
    if isinstance(wrong, FunctionError):
        return refusal(wrong)
    return error(str(wrong), "#N/A", busy=isinstance(wrong, Busy))


class _Unsent:
    """Cells of all answers that have not been sent."""

    def __init__(self) -> None:
        self.cells = 0
        self.lock = threading.Lock()


class UnsentCells:
    """Counts the cells of one answer until it is sent."""

    def __init__(self, unsent: _Unsent) -> None:
        self._unsent = unsent
        self._cells = 0
        self._is_sent = False
        self.refused: Answer | None = None

    def take(self, rows: Sequence[Sequence[Any]]) -> Answer | None:
        """Make room for rows; once there is none, there is none for what follows.

        Parameters
        ----------
        rows : sequence of sequence
            Cells. [as shown]

        Returns
        -------
        dict or None
            The answer in their place where there is no room.
        """
        cells = len(rows) * len(rows[0]) if rows else 0
        with self._unsent.lock:
            if self._cells + cells > MOST_CELLS:
                self.refused = error(
                    f"The results of this request exceed {MOST_CELLS:,} cells. Split the calls over "
                    "several requests.",
                    "#N/A",
                )
            elif self._is_sent or self._unsent.cells + cells > MOST_UNSENT:
                self.refused = error(
                    "The server is busy sending results. Try again in a few seconds.",
                    "#N/A",
                    busy=True,
                )
            else:
                self._cells += cells
                self._unsent.cells += cells
        return self.refused

    def close(self) -> None:
        """The answer is sent, or nobody wants it any more."""
        with self._unsent.lock:
            self._unsent.cells -= self._cells
            self._cells, self._is_sent = 0, True


@dataclass(frozen=True)
class Asked:
    """Calls of one request."""

    calls: Sequence[Call]  #: What is asked for.
    room: UnsentCells  #: Counts the cells of the answer.
    size: int = 0  #: Size of the request. [B]
    tell: Tell | None = None  #: Called with each stage. [words]
    #: Awaited before an answer takes memory; for one call only.
    turn: Callable[[], Awaitable[None]] | None = None


class Calls:
    """Answers calls: short ones in threads, long ones once their start is there.

    Parameters
    ----------
    starts : Starts
        Where starts come from.
    limits : Limits
        Limits of one request.
    metrics : Metrics, optional
        Counts them.
    """

    def __init__(self, starts: Starts, limits: Limits, metrics: Metrics | None = None) -> None:
        self._starts = starts
        self._metrics = metrics
        self._limits = limits
        self._unsent = _Unsent()
        self._short = ThreadPoolExecutor(SHORT_THREADS, "short")
        self._heavy = ThreadPoolExecutor(HEAVY_THREADS, "heavy")
        self._long = ThreadPoolExecutor(LONG_THREADS, "long")
        self._json = ThreadPoolExecutor(JSON_THREADS, "json")

    def close(self) -> None:
        """Let the threads go."""
        for pool in (self._short, self._heavy, self._long, self._json):
            pool.shutdown(wait=False, cancel_futures=True)

    def new_unsent_cells(self) -> UnsentCells:
        """Count of the cells of one answer, to be closed when it is sent."""
        return UnsentCells(self._unsent)

    async def answers(self, asked: Asked) -> list[Answer]:
        """Answers in the order of the calls.

        Parameters
        ----------
        asked : Asked
            The calls.

        Returns
        -------
        list of dict
            ``value``, rows of cells, or ``error`` each. [shown units]
        """
        calls = asked.calls
        pool = self._heavy if asked.size > HEAVY else self._short
        # those without a model first: a TV_MODEL among them makes the handle that others ask about
        bare = [i for i, each in enumerate(calls) if not each.takes_model]
        answers = await self._in_thread(pool, asked, bare)
        await self.fetch(each.handle for each in calls)
        at_once: list[int] = []
        waiting: dict[tuple[str, str], tuple[Model, list[int]]] = {}
        for i, each in enumerate(calls):
            if i in answers:
                continue
            model = each.model()
            what = None if model is None else each.result(model)
            if model is None or what is None:
                at_once.append(i)
            else:
                waiting.setdefault((model.handle, what), (model, []))[1].append(i)
        parts = await asyncio.gather(
            self._in_thread(pool, asked, at_once),
            *(
                self._with_result(asked, indices, model, what)
                for (_, what), (model, indices) in waiting.items()
            ),
        )
        for part in parts:
            answers |= part
        if self._metrics is not None:
            for i, each in enumerate(calls):
                name = each.name if each.name in FUNCTIONS else "unknown"
                self._metrics.count(CALLS, name, _end(answers[i]))
        return [answers[i] for i in range(len(calls))]

    async def fetch(self, handles: Iterable[str]) -> None:
        """Have models here that other servers have made, as far as they are shared."""
        if MODELS.store is not None:
            await asyncio.to_thread(MODELS.fetch, list(handles))

    async def encoded(self, content: Any) -> bytes:
        """JSON, made in a thread since it may be large."""
        return await asyncio.get_running_loop().run_in_executor(self._json, encoded, content)

    async def in_thread(self, work: Callable[..., Any], *given: Any) -> Any:
        """Something of the page's, in a thread of the long calls."""
        act = partial(copy_context().run, work, *given)
        return await asyncio.get_running_loop().run_in_executor(self._long, act)

    async def _with_result(
        self, asked: Asked, wanted: Sequence[int], model: Model, what: str
    ) -> dict[int, Answer]:
        """Calls about one model, once its result is there; they get it from here."""
        try:
            value = await self._starts.ready(model, asked.tell, what)
        except NO_RESULT as wrong:
            return dict.fromkeys(wanted, without_result(wrong))
        brought = partial(handed, model, what, value)
        return await self._in_thread(self._long, asked, wanted, brought)

    async def _in_thread(
        self,
        pool: ThreadPoolExecutor,
        asked: Asked,
        wanted: Sequence[int],
        brought: Callable[[], AbstractContextManager[Any]] = nullcontext,
    ) -> dict[int, Answer]:
        """Some of the calls, turn about with those of other requests, as many as the time allows."""
        if wanted and asked.turn is not None:
            await asked.turn()
        answers: dict[int, Answer] = {}
        remaining = iter(wanted)
        given_up = threading.Event()
        has_begun = False

        def work() -> None:
            nonlocal has_begun
            has_begun = True
            began = time.monotonic()
            with brought():
                while not given_up.is_set() and time.monotonic() - began < TURN:
                    i = next(remaining, None)
                    if i is None:
                        break
                    answers[i] = asked.room.refused or _answer(asked.calls[i], asked.room)

        loop = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(self._limits.short_time):
                while len(answers) < len(wanted):
                    await loop.run_in_executor(pool, partial(copy_context().run, work))
        except TimeoutError:
            pass
        finally:
            given_up.set()
        if len(answers) < len(wanted):
            # alone it would take as long again
            busy = not has_begun or len(wanted) > 1
            late = error(self._too_late(has_begun), "#N/A", busy=busy)
            return {i: answers.get(i, late) for i in wanted}
        return answers

    def _too_late(self, has_begun: bool) -> str:
        seconds = f"{self._limits.short_time:g} s"
        if has_begun:
            return (
                f"The calls of this request took longer than {seconds}. Send fewer calls at a time."
            )
        return f"The server was busy: this call waited {seconds}. Try again in a minute."


def _end(found: Answer) -> str:
    """What an answer is, in the words of `CALLS`."""
    if "error" not in found:
        return "value"
    return "busy" if found["error"].get("busy") else "error"


def _answer(wanted: Call, room: UnsentCells) -> Answer:
    try:
        rows = call(wanted.name, wanted.arguments)
        return room.take(rows) or {"value": rows}
    except FunctionError as wrong:
        return refusal(wrong)
    except Exception:
        LOG.exception("%s failed", wanted.name[:60])
        return error(OURS)
