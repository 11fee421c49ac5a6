"""Long calls over a WebSocket: stages, results as they come, cancel.

A message is one JSON object. From the client: ``{"key": ...}`` first where keys are asked for, then
``{"id", "name", "arguments"}`` for a function, ``{"id", "view": handle}`` for what the page draws,
``{"id", "histories": handle, "elements", "from", "to"}`` for histories in a window of time, ``{"id", "study", "case", "settings"}`` for a study, ``{"id", "cancel": true}``. To the client, always with the ``id``: ``stage``, ``partial``, and at the
end one of ``value``, ``error`` or ``cancelled``.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from addin.server.answers import Refused, encoded
from addin.server.bodies import parsed
from addin.server.calls import (
    NO_RESULT,
    Asked,
    Calls,
    UnsentCells,
    error,
    is_large,
    read_call,
    without_result,
)
from addin.server.keys import Keys
from addin.server.leaving import Leaving
from addin.server.processes import STOPPING
from addin.server.requests import PendingSocket
from addin.server.running_starts import Starts
from addin.server.settings import LARGE, OURS, Settings
from addin.server.studies import StudyRequest, read_study
from addin.server.view import HistoriesWanted, histories_view, speed_view, start_view
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FunctionError

LOG = logging.getLogger("torsionbook.server")
#: Close codes for a client without a key, and of a busy server. [number]
NO_KEY, TRY_AGAIN = 4401, 1013
#: Longest time a client may take to send its key, and longest message with a key. [s, characters]
KEY_TIME, LONGEST_KEY = 10.0, 4096
#: Values of one WebSocket that are made but not sent, and messages of any kind. [count]
MOST_VALUES, MOST_MESSAGES = 4, 1000
#: Histories of one message. [count]
MOST_HISTORIES = 24
#: Longest time a client may take to read a message. [s]
READ_TIME = 60.0

Identity = int | str


@dataclass
class _Answering:
    """One request under way: what it holds until its message is sent."""

    identity: Identity
    room: UnsentCells
    has_turn: bool = False
    found: dict[str, Any] | None = None
    is_counted: bool = False  #: The server does not end before its message is sent.


Work = Callable[[_Answering], Awaitable[dict[str, Any]]]


class Stream:
    """One WebSocket and what it has asked for.

    Parameters
    ----------
    socket : WebSocket
        Not accepted yet.
    settings : Settings
        Keys and limits.
    calls : Calls
        Answers functions.
    starts : Starts
        Calculates starts.
    """

    def __init__(self, socket: WebSocket, settings: Settings, calls: Calls, starts: Starts) -> None:
        self._socket = socket
        self._settings = settings
        self._calls = calls
        self._starts = starts
        self._running: dict[Identity, asyncio.Task[None]] = {}
        self._out: asyncio.Queue[tuple[dict[str, Any], _Answering | None]] = asyncio.Queue()
        self._sent = asyncio.Event()
        self._leaving: Leaving = socket.scope.get("leaving") or Leaving()
        self._turns = asyncio.Semaphore(MOST_VALUES)

    async def serve(self) -> None:
        """Answer until the client is gone; then nothing of it goes on."""
        await self._socket.accept()
        sender = asyncio.create_task(self._send())
        receiver = asyncio.create_task(self._receive())
        try:
            # a client that does not read any more is as good as gone
            await asyncio.wait({sender, receiver}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            tasks = [*self._running.values(), sender, receiver]
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks)
            for task in (sender, receiver):
                wrong = None if task.cancelled() else task.exception()
                if wrong is not None and not isinstance(wrong, (WebSocketDisconnect, TimeoutError)):
                    LOG.error("a stream failed", exc_info=wrong)
            await asyncio.sleep(0)  # their ends are put into the queue
            while not self._out.empty():
                self._free(self._out.get_nowait()[1])

    async def _receive(self) -> None:
        if not await self._is_welcome():
            return
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            text = message.get("text")
            if text is None:
                return  # a message of bytes
            await self._take(text)
            while self._out.qsize() >= MOST_MESSAGES:  # whoever does not read is not listened to
                self._sent.clear()
                await self._sent.wait()

    async def _send(self) -> None:
        while True:
            message, answering = await self._out.get()
            is_long = "value" in message or "partial" in message
            try:
                body = await self._calls.encoded(message) if is_long else encoded(message)
                async with asyncio.timeout(READ_TIME):
                    await self._socket.send_text(body.decode("ascii"))
            finally:
                self._free(answering)
                self._sent.set()

    def _free(self, answering: _Answering | None) -> None:
        """What an answer held is free again."""
        if answering is None:
            return
        answering.room.close()
        if answering.is_counted:
            answering.is_counted = False
            self._leaving.calls -= 1
        if answering.has_turn:
            answering.has_turn = False
            self._turns.release()

    async def _is_welcome(self) -> bool:
        door: PendingSocket | None = self._socket.scope.get("door")
        keys: Keys | None = self._socket.scope.get("keys")
        if door is None or keys is None:  # the guard has seen its key
            return True
        given = None
        try:
            async with asyncio.timeout(KEY_TIME) as limit:
                door.wait(limit)
                first = await self._socket.receive()
            text = first.get("text")
            if text is not None and len(text) <= LONGEST_KEY:  # not even looked at beyond that
                content = parsed(text)
                given = content.get("key") if isinstance(content, dict) else None
        except (TimeoutError, Refused):
            pass
        try:
            if isinstance(given, str) and keys.admits(given, door.address):
                door.enter(given)
                return True
        except Refused as wait:
            is_busy = wait.status == 503
            reason = "The server is busy. Try again in a few seconds." if is_busy else wait.message
            await self._refuse(wait.message, TRY_AGAIN if is_busy else NO_KEY, reason)
            return False
        wrong = isinstance(given, str) and given
        why = "The API key is not valid on this server" if wrong else "An API key is needed"
        await self._refuse(f'{why}: send {{"key": ...}} first.', NO_KEY, f"{why}.")
        return False

    async def _refuse(self, sentence: str, code: int, reason: str) -> None:
        async with asyncio.timeout(KEY_TIME):
            await self._socket.send_text(encoded({"id": None, **error(sentence)}).decode())
            await self._socket.close(code, reason)

    # ---- what is asked for -----------------------------------------------------------------------

    async def _take(self, text: str) -> None:
        """One message of the client."""
        identity: Any = None
        try:
            if len(text) > LARGE:
                with self._reading():
                    message = await asyncio.to_thread(parsed, text)
            else:
                message = parsed(text)
            if not isinstance(message, dict):
                raise Refused(400, 'Send objects, such as {"id": 1, "name": ..., "arguments": []}.')
            if "key" in message and "id" not in message:
                return  # a key where none is needed
            identity = message.get("id")
            if isinstance(identity, bool) or not isinstance(identity, (int, str)):
                identity = None
                raise Refused(400, "Give each message an id, a whole number or a text.")
            if message.get("cancel") is True:
                self._cancel(identity)
            else:
                self._begin(identity, message, len(text))
        except Refused as wrong:
            refused = error(wrong.message, busy=wrong.status == 503)
            self._out.put_nowait(({"id": identity, **refused}, None))

    def _reading(self) -> Any:
        reading = self._socket.scope.get("reading")
        return nullcontext() if reading is None else reading()

    def _cancel(self, identity: Identity) -> None:
        task = self._running.get(identity)
        if task is not None:
            task.cancel()

    def _begin(self, identity: Identity, message: dict[str, Any], size: int) -> None:
        if self._leaving.is_closed:
            raise Refused(503, STOPPING)
        if identity in self._running:
            raise Refused(400, f"The id {str(identity)[:40]} is in use. Use another.")
        most = self._settings.limits.streams
        if len(self._running) >= most:
            raise Refused(503, f"{most} calls are in progress, the limit. Wait for one to end.")
        if "view" in message:
            if not isinstance(message["view"], str):
                raise Refused(400, "view is not text. Give the handle of a model.")
            work = partial(self._view, message["view"])
        elif "histories" in message:
            work = partial(self._histories, *_read_histories(message))
        elif "study" in message:
            work = partial(self._study, read_study(message))
        else:
            work = partial(self._call, message, size)
        answering = _Answering(identity, self._calls.new_unsent_cells(), is_counted=True)
        self._leaving.calls += 1
        task = asyncio.create_task(self._answer(answering, work))
        self._running[identity] = task
        # also of one that is cancelled before it begins
        task.add_done_callback(partial(self._end, answering))

    def _end(self, answering: _Answering, task: asyncio.Task[None]) -> None:
        """One request is over, whatever came of it."""
        if self._running.get(answering.identity) is task:
            del self._running[answering.identity]
        answer = answering.found or {"cancelled": True}
        self._out.put_nowait(({"id": answering.identity, **answer}, answering))

    async def _answer(self, answering: _Answering, work: Work) -> None:
        try:
            answering.found = await work(answering)
        except Refused as wrong:
            answering.found = error(wrong.message, busy=wrong.status == 503)
        except NO_RESULT as wrong:
            answering.found = without_result(wrong)
        except Exception:
            LOG.exception("a stream failed")
            answering.found = error(OURS)

    async def _turn(self, answering: _Answering) -> None:
        """Wait until few enough values are on their way."""
        await self._turns.acquire()
        answering.has_turn = True

    async def _call(
        self, message: dict[str, Any], size: int, answering: _Answering
    ) -> dict[str, Any]:
        wanted = read_call(message, "The message")
        turn = partial(self._turn, answering)
        tell = self._teller(answering.identity)
        (answer,) = await self._calls.answers(Asked([wanted], answering.room, size, tell, turn))
        return answer

    async def _view(self, handle: str, answering: _Answering) -> dict[str, Any]:
        """The page's numbers: first without the start, then with it."""
        await self._calls.fetch([handle])
        model = MODELS.of(handle)
        first = _Answering(answering.identity, self._calls.new_unsent_cells())
        await self._turn(first)
        try:
            if is_large(model):
                case = model.handle, model.case, model.system
                partly = await self._starts.task("view", case)
            else:
                partly = await self._calls.in_thread(speed_view, model)
        except BaseException:
            self._free(first)
            raise
        self._out.put_nowait(({"id": answering.identity, "partial": partly}, first))
        calculation = await self._starts.ready(model, self._teller(answering.identity))
        if isinstance(calculation, FunctionError):
            raise calculation
        await self._turn(answering)
        return {"value": await self._calls.in_thread(start_view, model, calculation)}

    async def _histories(
        self, handle: str, wanted: HistoriesWanted, answering: _Answering
    ) -> dict[str, Any]:
        """Histories of a start, which is calculated if it is not kept."""
        model = MODELS.of(handle)
        calculation = await self._starts.ready(model, self._teller(answering.identity))
        if isinstance(calculation, FunctionError):
            raise calculation
        await self._turn(answering)
        return {"value": await self._calls.in_thread(histories_view, model, calculation, wanted)}

    async def _study(self, asked: StudyRequest, answering: _Answering) -> dict[str, Any]:
        """The JSON of a study of a case."""
        answer = await self._starts.task("study", asked, self._teller(answering.identity))
        await self._turn(answering)
        return dict(answer)

    def _teller(self, identity: Identity) -> Any:
        return lambda stage: self._out.put_nowait(({"id": identity, "stage": stage}, None))


def _read_histories(message: dict[str, Any]) -> tuple[str, HistoriesWanted]:
    """The model and the histories that a message asks for."""
    handle, elements = message["histories"], message.get("elements")
    if not isinstance(handle, str):
        raise Refused(400, "histories is not text. Give the handle of a model.")
    if not isinstance(elements, list) or not all(isinstance(name, str) for name in elements):
        raise Refused(400, "elements is not a list of names.")
    if len(elements) > MOST_HISTORIES:
        raise Refused(400, f"{len(elements)} elements; at most {MOST_HISTORIES} at a time.")
    window = [message.get("from", -inf), message.get("to", inf)]
    if any(isinstance(end, bool) or not isinstance(end, int | float) for end in window):
        raise Refused(400, "from and to must be numbers, in seconds.")
    begin, end = map(float, window)
    if begin > end:
        raise Refused(400, f"from is {begin:g} s, behind to, {end:g} s.")
    return handle, HistoriesWanted(tuple(elements), (begin, end))
