"""Keys, limits and errors of every request: what is refused is refused in words."""

from __future__ import annotations

import asyncio
import hmac
import json
import logging
from collections.abc import Awaitable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeVar
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from addin.server.processes import OURS
from addin.server.settings import BODY_RATE, LARGE, LOOPBACK, Settings
from addin.worksheet.models import OWNER

__all__ = [
    "Door", "Guard", "Refused", "answer", "encoded", "is_key", "no_key", "read_body", "read_json", "while_connected",
]  # fmt: skip

LOG = logging.getLogger("torsionbook.server")
T = TypeVar("T")


class Refused(Exception):
    """A request that is not answered as asked.

    Parameters
    ----------
    status : int
        HTTP status. [number]
    message : str
        Why, and what to do. [sentence]
    headers : mapping, optional
        Further headers. [texts]
    """

    def __init__(self, status: int, message: str, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(message)
        self.status = status
        self.message = message
        self.headers = dict(headers or {})

    def response(self) -> Response:
        """The refusal as JSON."""
        return answer({"error": {"message": self.message}}, self.status, self.headers)


def encoded(content: Any) -> bytes:
    """JSON in which every double keeps all its digits."""
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode("ascii")


def answer(content: Any, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """A JSON response."""
    body = content if isinstance(content, bytes) else encoded(content)
    return Response(body, status, headers, media_type="application/json")


def is_key(settings: Settings, given: str | None) -> bool:
    """Whether a key is one of ours; compared in a time that tells nothing."""
    if not settings.keys:
        return True
    sent = (given or "").encode("utf-8", "surrogatepass")
    found = [hmac.compare_digest(sent, key.encode()) for key in settings.keys]
    return any(found)


def key_of(headers: Headers) -> str | None:
    """The key a request carries: ``X-API-Key``, or ``Authorization: Bearer``."""
    kind, _, token = headers.get("authorization", "").partition(" ")
    bearer = token.strip() if kind.casefold() == "bearer" else None
    return headers.get("x-api-key") or bearer


def no_key(given: str | None) -> str:
    """Why a client is not answered."""
    if given:
        return (
            "The API key is not one of this server's: wrong, mistyped or withdrawn. Send another in "
            "the header X-API-Key, or as Authorization: Bearer; whoever runs this server has it."
        )
    return (
        "An API key is needed: send it in the header X-API-Key, or as Authorization: Bearer. "
        "Whoever runs this server has it."
    )


async def read_body(request: Request, limit: int, seconds: float = 20.0) -> bytes:
    """The body of a request, given up as soon as it is too large or comes too slowly.

    Parameters
    ----------
    request : Request
        The request.
    limit : int
        Most bytes. [B]
    seconds : float
        How long it may take, and a second more for every `BODY_RATE`. [s]

    Returns
    -------
    bytes
        The body.

    Raises
    ------
    Refused
        With 413 or 408.
    """
    parts, size = [], 0
    began = asyncio.get_running_loop().time()
    try:
        async with asyncio.timeout_at(began + seconds) as until:
            async for part in request.stream():
                size += len(part)
                if size > limit:
                    raise _too_large(limit)
                parts.append(part)
                until.reschedule(began + seconds + size / BODY_RATE)
    except TimeoutError:
        raise Refused(
            408,
            f"The request came too slowly: {size:,} bytes after "
            f"{asyncio.get_running_loop().time() - began:.0f} s. Send it again.",
            {"Connection": "close"},
        ) from None
    except ClientDisconnect:
        raise Refused(400, "The connection was closed before the request was complete.") from None
    return b"".join(parts)


def _too_large(limit: int) -> Refused:
    return Refused(
        413,
        f"The request is larger than {limit / 1e6:g} MB, the most this server takes. Send less at a "
        "time.",
        {"Connection": "close"},
    )


async def read_json(request: Request, limit: int, seconds: float = 20.0) -> tuple[Any, int]:
    """The body of a request as plain values, and its size.

    Parameters
    ----------
    request : Request
        The request.
    limit : int
        Most bytes. [B]
    seconds : float
        As in `read_body`. [s]

    Returns
    -------
    tuple of object and int
        What the JSON holds, and its bytes. [B]

    Raises
    ------
    Refused
        If it is no JSON, or too large.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().casefold()
    if kind != "application/json":
        raise Refused(415, "Send JSON, with the header Content-Type: application/json.")
    body = await read_body(request, limit, seconds)
    return await asyncio.to_thread(parsed, body), len(body)


def parsed(text: bytes | str) -> Any:
    """Plain values of a JSON text.

    Raises
    ------
    Refused
        If it is no JSON, or holds what JSON does not know, such as NaN.
    """
    try:
        return json.loads(text, parse_constant=_no_constant)
    except RecursionError:
        raise Refused(400, "The JSON is nested too deeply.") from None
    except (ValueError, UnicodeDecodeError) as wrong:
        if "set_int_max_str_digits" in str(wrong):
            raise Refused(
                400,
                "The JSON holds a whole number of more digits than any number of a cell has. "
                "Correct it.",
            ) from None
        raise Refused(400, f"This is no JSON that can be read: {wrong}.") from None


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is no number in JSON; leave a blank cell null")


async def while_connected(request: Request, work: Awaitable[T]) -> T:
    """Do something for a client, and give it up when the client is gone.

    Raises
    ------
    Refused
        If the client is gone; nobody will read it.
    """
    task = asyncio.ensure_future(work)
    gone = asyncio.create_task(_gone(request))
    try:
        await asyncio.wait({task, gone}, return_when=asyncio.FIRST_COMPLETED)
        if task.done():
            return task.result()
        raise Refused(400, "The client has closed the connection.")
    finally:
        for one in (task, gone):
            one.cancel()
        await asyncio.gather(task, gone, return_exceptions=True)


async def _gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


class Door:
    """A WebSocket that has not sent its key yet.

    Parameters
    ----------
    guard : Guard
        Who counts it.
    address : str
        Where it comes from. [name]
    """

    def __init__(self, guard: Guard, address: str) -> None:
        self._guard = guard
        self.address = address
        self._limit: asyncio.Timeout | None = None
        self._is_closed = False
        self.has_entered = False

    def enter(self, key: str) -> None:
        """It has sent its key: from now on it counts as a request.

        Raises
        ------
        Refused
            If there are too many requests.
        """
        self._guard.enter(self)
        OWNER.set(f"{key}@{self.address}")

    def wait(self, limit: asyncio.Timeout) -> None:
        """Wait for the key, until then or until the place is needed."""
        self._limit = limit
        if self._is_closed:
            self.close()

    def close(self) -> None:
        """Wait no longer."""
        self._is_closed = True
        if self._limit is not None and not self._limit.expired():
            self._limit.reschedule(0.0)


class Guard:
    """Stands in front of every route.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    settings : Settings
        Keys and limits.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app = app
        self._settings = settings
        self._answering = 0
        self._large = 0
        #: WebSockets without a key, the oldest first.
        self._doors: list[Door] = []

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        begun = False

        async def note(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        try:
            is_large, key = self._check(scope)
            address = (scope.get("client") or ("",))[0]
            OWNER.set(f"{key or ''}@{address}")
            if scope["type"] == "http" and scope["path"] == "/healthz":
                await self._app(scope, receive, note)
            elif scope["type"] == "websocket" and not is_key(self._settings, key):
                await self._at_the_door(scope, receive, note, address)
            else:
                self._not_too_many()
                self._answering += 1
                self._large += is_large
                try:
                    await self._app({**scope, "reading": self._reading}, receive, note)
                finally:
                    self._answering -= 1
                    self._large -= is_large
        except Refused as wrong:
            if not begun:
                await _refuse(wrong, scope, receive, send)
        except Exception:
            LOG.exception("%s failed", scope.get("path"))
            if not begun:
                await _refuse(Refused(500, OURS), scope, receive, send)

    async def _at_the_door(self, scope: Scope, receive: Receive, send: Send, address: str) -> None:
        """A WebSocket that has to send its key: it has little time, and makes room for the next."""
        limits = self._settings.limits
        door = Door(self, address)
        same = [d for d in self._doors if d.address == address and address not in LOOPBACK]
        if len(same) >= limits.strangers_each:
            self._turn_away(same[0])
        elif len(self._doors) >= limits.strangers:
            self._turn_away(self._doors[0])
        self._doors.append(door)
        try:
            await self._app({**scope, "door": door, "reading": self._reading}, receive, send)
        finally:
            if door in self._doors:
                self._doors.remove(door)
            self._answering -= door.has_entered

    def _turn_away(self, door: Door) -> None:
        self._doors.remove(door)
        door.close()

    def enter(self, door: Door) -> None:
        """A WebSocket has sent its key."""
        self._not_too_many()
        if door in self._doors:
            self._doors.remove(door)
        door.has_entered = True
        self._answering += 1

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Something large is read."""
        if self._large >= self._settings.limits.large:
            raise _busy(f"{self._settings.limits.large} large requests")
        self._large += 1
        try:
            yield
        finally:
            self._large -= 1

    def _not_too_many(self) -> None:
        if self._answering >= self._settings.limits.requests:
            raise _busy(f"{self._settings.limits.requests} requests")

    def _check(self, scope: Scope) -> tuple[bool, str | None]:
        """Refuse a request at its door, or tell whether its body is large, and its key."""
        headers, settings = Headers(scope=scope), self._settings
        host = headers.get("host", "")
        if not settings.knows_host(host):
            raise Refused(
                421,
                f"This server does not go by the name '{host[:60]}'. Where a proxy stands in front "
                "of it, start it with --public-url and the address users have.",
            )
        origin = headers.get("origin")
        if origin is not None and not self._is_own(origin, host):
            raise Refused(403, "This server answers its own pages only, not those of another site.")
        given = key_of(headers)
        if scope["type"] == "http" and scope["path"].startswith("/api/"):
            if not is_key(settings, given):
                raise Refused(401, no_key(given), {"WWW-Authenticate": "Bearer"})
            length = headers.get("content-length", "0")
            if length.isdecimal() and int(length[:20]) > settings.limits.body:
                raise _too_large(settings.limits.body)
        length = headers.get("content-length", "0")
        is_large = "transfer-encoding" in headers or (
            length.isdecimal() and int(length[:20]) > LARGE
        )
        if is_large and self._large >= settings.limits.large:
            raise _busy(f"{settings.limits.large} large requests")
        return is_large, given

    def _is_own(self, origin: str, host: str) -> bool:
        try:
            own = {urlsplit(f"//{host}").netloc, urlsplit(self._settings.public_url).netloc}
            return urlsplit(origin).netloc in own - {""}
        except ValueError:
            return False


def _busy(with_what: str) -> Refused:
    return Refused(
        503,
        f"The server is answering {with_what} already. Try again in a few seconds.",
        {"Retry-After": "5"},
    )


async def _refuse(wrong: Refused, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "http":
        await wrong.response()(scope, receive, send)
        return
    # before it is accepted a WebSocket is refused by closing it; the server answers 403
    await send({"type": "websocket.close", "code": 1008, "reason": wrong.message[:120]})
