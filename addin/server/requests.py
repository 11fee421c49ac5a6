"""The guard in front of every route: names, origins, keys and how much is answered at a time."""

from __future__ import annotations

import asyncio
import logging
import re
import secrets
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from addin.server.answers import Refused, too_busy, too_large
from addin.server.keys import Keys, key_of, no_key
from addin.server.leaving import Leaving
from addin.server.logs import REQUEST
from addin.server.logs import REQUESTS as LOG_OF_REQUESTS
from addin.server.metrics import REQUEST_TIME, REQUESTS, Metrics
from addin.server.settings import LARGE, LOOPBACK, OURS, Settings
from addin.worksheet.models import OWNER

LOG = logging.getLogger("torsionbook.server")


@dataclass(eq=False)
class PendingSocket:
    """A WebSocket that has not sent its key yet."""

    guard: RequestGuard  #: Who counts it.
    address: str  #: Where it comes from. [name]
    has_entered: bool = False  #: It has sent its key.
    _limit: asyncio.Timeout | None = None
    _is_closed: bool = False

    def enter(self, key: str) -> None:
        """It has sent its key: from now on it counts as a request.

        Raises
        ------
        Refused
            If there are too many requests.
        """
        self.guard.enter(self)
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


class RequestGuard:
    """Stands in front of every route.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    settings : Settings
        Limits.
    keys : Keys
        Knows whose requests are answered.
    metrics : Metrics
        Counts what is answered.
    leaving : Leaving
        How far the server is with leaving.
    """

    def __init__(
        self,
        app: ASGIApp,
        settings: Settings,
        keys: Keys,
        metrics: Metrics,
        leaving: Leaving,
    ) -> None:
        self._app = app
        self._settings = settings
        self._keys = keys
        self._metrics = metrics
        self._leaving = leaving
        self._sockets = 0
        self._routes: set[str] = set()
        metrics.gauges += [
            ("requests", "gauge", "Requests being answered.", lambda: self._answering),
            ("sockets", "gauge", "WebSockets.", lambda: self._sockets),
        ]
        self._answering = 0
        self._large = 0
        #: WebSockets without a key, the oldest first.
        self._doors: list[PendingSocket] = []

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        begun, status, began = False, 0, time.monotonic()
        address = (scope.get("client") or ("",))[0]
        identity = _identity(Headers(scope=scope).get("x-request-id", ""))
        REQUEST.set(identity)

        async def note(message: Message) -> None:
            nonlocal begun, status
            begun = True
            if message["type"] == "http.response.start":
                status = message["status"]
                more = [(b"x-request-id", identity.encode())]
                if self._leaving.has_begun:
                    more.append((b"connection", b"close"))
                message = {**message, "headers": [*message.get("headers", ()), *more]}
            await send(message)

        self._sockets += scope["type"] == "websocket"
        try:
            is_large, key = self._check(scope, address)
            OWNER.set(f"{key or ''}@{address}")
            if scope["type"] == "http" and scope["path"] in ("/healthz", "/readyz"):
                await self._app(scope, receive, note)
            elif scope["type"] == "websocket" and not self._keys.admits(key, address):
                await self._at_the_door(scope, receive, note, address)
            else:
                self._not_too_many()
                self._answering += 1
                self._large += is_large
                try:
                    more = {"reading": self._reading, "leaving": self._leaving}
                    await self._app({**scope, **more}, receive, note)
                finally:
                    self._answering -= 1
                    self._large -= is_large
        except Refused as wrong:
            if not begun:
                await _refuse(wrong, scope, receive, note)
        except Exception:
            LOG.exception("%s failed", scope.get("path"))
            if not begun:
                await _refuse(Refused(500, OURS), scope, receive, note)
        finally:
            self._sockets -= scope["type"] == "websocket"
            self._told(scope, status, time.monotonic() - began, address)

    def _told(self, scope: Scope, status: int, seconds: float, address: str) -> None:
        """Count a request that has ended, and log it."""
        path = scope["path"]
        method = scope.get("method", "WEBSOCKET")
        if scope["type"] == "http":
            if not self._routes:
                self._routes = {route.path for route in scope["app"].routes}
            # whatever else is asked for counts as one: nobody makes new ones by asking
            route = path if path in self._routes else "other"
            self._metrics.count(REQUESTS, route, str(status))
            self._metrics.took(REQUEST_TIME, seconds, route)
        about = {"method": method, "path": path[:200], "status": status, "seconds": round(seconds, 4), "address": address}  # fmt: skip
        words = "%s %s: %d after %.3f s, for %s"
        LOG_OF_REQUESTS.info(words, method, path[:200], status, seconds, address, extra=about)

    async def _at_the_door(self, scope: Scope, receive: Receive, send: Send, address: str) -> None:
        """A WebSocket that has to send its key: it has little time, and makes room for the next."""
        limits = self._settings.limits
        door = PendingSocket(self, address)
        same = [d for d in self._doors if d.address == address and address not in LOOPBACK]
        if len(same) >= limits.strangers_each:
            self._turn_away(same[0])
        elif len(self._doors) >= limits.strangers:
            self._turn_away(self._doors[0])
        self._doors.append(door)
        try:
            more = {"door": door, "keys": self._keys, "reading": self._reading}
            await self._app({**scope, **more, "leaving": self._leaving}, receive, send)
        finally:
            if door in self._doors:
                self._doors.remove(door)
            self._answering -= door.has_entered

    def _turn_away(self, door: PendingSocket) -> None:
        self._doors.remove(door)
        door.close()

    def enter(self, door: PendingSocket) -> None:
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
            raise too_busy(f"{self._settings.limits.large} large requests")
        self._large += 1
        try:
            yield
        finally:
            self._large -= 1

    def _not_too_many(self) -> None:
        if self._answering >= self._settings.limits.requests:
            raise too_busy(f"{self._settings.limits.requests} requests")

    def _check(self, scope: Scope, address: str) -> tuple[bool, str | None]:
        """Refuse a request at its door, or tell whether its body is large, and its key."""
        headers, settings = Headers(scope=scope), self._settings
        host = headers.get("host", "")
        if not settings.knows_host(host):
            raise Refused(
                421,
                f"The host name '{host[:60]}' is not known to this server. Behind a proxy, start the "
                "server with --public-url and the address that users type.",
            )
        origin = headers.get("origin")
        if origin is not None and not self._is_own(origin, host):
            raise Refused(
                403, "This server accepts requests only from its own pages, not from another site."
            )
        given = key_of(headers)
        length = headers.get("content-length", "0")
        size = int(length[:20]) if length.isdecimal() else 0
        if scope["type"] == "http" and scope["path"].startswith(("/api/", "/metrics")):
            if not self._keys.admits(given, address):
                raise Refused(401, no_key(given), {"WWW-Authenticate": "Bearer"})
            if size > 2 * settings.limits.body:  # what is less is read to its end, see `read_body`
                raise too_large(settings.limits.body)
        is_large = "transfer-encoding" in headers or size > LARGE
        if is_large and self._large >= settings.limits.large:
            raise too_busy(f"{settings.limits.large} large requests")
        return is_large, given

    def _is_own(self, origin: str, host: str) -> bool:
        try:
            own = {urlsplit(f"//{host}").netloc, urlsplit(self._settings.public_url).netloc}
            return urlsplit(origin).netloc in own - {""}
        except ValueError:
            return False


def _identity(given: str) -> str:
    """The identity of a request: what a proxy has called it, or a new one."""
    return given if re.fullmatch(r"[\w.-]{1,64}", given, re.ASCII) else secrets.token_hex(8)


async def _refuse(wrong: Refused, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "http":
        await wrong.response()(scope, receive, send)
        return
    # before it is accepted a WebSocket is refused by closing it; the server answers 403
    await send({"type": "websocket.close", "code": 1008, "reason": wrong.message[:120]})
