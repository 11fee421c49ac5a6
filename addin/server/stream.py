"""Long calls over a WebSocket: stages, results as they come, cancel.

A message is one JSON object. From the client: ``{"key": ...}`` first where keys are asked for, then
``{"id", "name", "arguments"}`` for a function, ``{"id", "view": handle}`` for what the page draws,
``{"id", "cancel": true}``. To the client, always with the ``id``: ``stage``, ``partial``, and at the
end one of ``value``, ``error`` or ``cancelled``.
"""

from __future__ import annotations

import asyncio
import logging
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from addin.server.calls import Calls, error, read_call
from addin.server.guard import Refused, encoded, is_key, key_of, parsed
from addin.server.settings import Settings
from addin.server.starts import Starts
from addin.server.view import speed_view, start_view
from addin.server.work import OURS, Busy, TooLong
from addin.worksheet.models import MODELS, RUN
from addin.worksheet.registry import FunctionError

__all__ = ["Stream"]

LOG = logging.getLogger("torsionbook.server")
#: Close code for a client without a key. [number]
NO_KEY = 4401
#: Longest time a client may take to send its key. [s]
KEY_TIME = 10.0

Identity = int | str


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
        self._out: asyncio.Queue[Any] = asyncio.Queue()

    async def serve(self) -> None:
        """Answer until the client is gone; then nothing of it goes on."""
        await self._socket.accept()
        sender = asyncio.create_task(self._send())
        try:
            if await self._is_welcome():
                while True:
                    self._take(await self._socket.receive_text())
        except (WebSocketDisconnect, KeyError):  # a KeyError is a message of bytes
            pass
        finally:
            tasks = [*self._running.values(), sender]
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _send(self) -> None:
        while True:
            message = await self._out.get()
            body = await self._calls.encoded(message) if "value" in message else encoded(message)
            await self._socket.send_text(body.decode("ascii"))

    async def _is_welcome(self) -> bool:
        settings = self._settings
        if is_key(settings, key_of(self._socket.headers)):
            return True
        given = None
        try:
            async with asyncio.timeout(KEY_TIME):
                first = parsed(await self._socket.receive_text())
            given = first.get("key") if isinstance(first, dict) else None
        except (TimeoutError, Refused):
            pass
        if isinstance(given, str) and is_key(settings, given):
            return True
        wrong = isinstance(given, str) and given
        why = "The API key is not one of this server's" if wrong else "An API key is needed"
        await self._socket.send_text(
            encoded({"id": None, **error(f'{why}: send {{"key": ...}} first.')}).decode()
        )
        await self._socket.close(NO_KEY, f"{why}.")
        return False

    # ---- what is asked for -----------------------------------------------------------------------

    def _take(self, text: str) -> None:
        """One message of the client."""
        identity: Any = None
        try:
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
                self._begin(identity, message)
        except Refused as wrong:
            self._out.put_nowait({"id": identity, **error(wrong.message)})

    def _cancel(self, identity: Identity) -> None:
        task = self._running.get(identity)
        if task is not None:
            task.cancel()

    def _begin(self, identity: Identity, message: dict[str, Any]) -> None:
        if identity in self._running:
            raise Refused(
                400, f"The id {str(identity)[:40]} is being answered already. Use another."
            )
        most = self._settings.limits.streams
        if len(self._running) >= most:
            raise Refused(503, f"There are {most} calls under way already. Wait for one to end.")
        if "view" in message:
            if not isinstance(message["view"], str):
                raise Refused(400, "view is no text. Give the handle of a model.")
            work = self._view(identity, message["view"])
        else:
            work = self._call(identity, message)
        self._running[identity] = asyncio.create_task(self._answer(identity, work))

    async def _answer(self, identity: Identity, work: Any) -> None:
        """One answer, whatever comes of it."""
        try:
            found = await work
        except asyncio.CancelledError:
            found = {"cancelled": True}
        except Refused as wrong:
            found = error(wrong.message)
        except FunctionError as wrong:
            found = error(wrong.message, wrong.code)
        except (Busy, TooLong, RuntimeError) as wrong:
            found = error(str(wrong), "#N/A")
        except Exception:
            LOG.exception("a stream failed")
            found = error(OURS)
        self._running.pop(identity, None)
        self._out.put_nowait({"id": identity, **found})

    async def _call(self, identity: Identity, message: dict[str, Any]) -> dict[str, Any]:
        wanted = read_call(message, "The message")
        return await self._calls.one(wanted, self._teller(identity))

    async def _view(self, identity: Identity, handle: str) -> dict[str, Any]:
        """The page's numbers: first without the start, then with it."""
        model = MODELS.of(handle)
        self._out.put_nowait(
            {"id": identity, "partial": await asyncio.to_thread(speed_view, model)}
        )
        await self._starts.ready(model, self._teller(identity))
        found = model.kept.get(RUN)
        if found is None:
            raise RuntimeError("The results were dropped for want of memory. Ask for them again.")
        if isinstance(found, FunctionError):
            raise found
        return {"value": await asyncio.to_thread(start_view, model, found)}

    def _teller(self, identity: Identity) -> Any:
        return lambda stage: self._out.put_nowait({"id": identity, "stage": stage})
