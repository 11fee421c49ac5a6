"""Serving until the process is told to end, and then ending without losing a call."""

from __future__ import annotations

import asyncio
import logging
import signal
import threading
import time
from typing import Any

import uvicorn
from starlette.applications import Starlette

from addin.server.dev_certificate import how_to_trust
from addin.server.leaving import Leaving
from addin.server.logs import log_config
from addin.server.protocol import protocol_of
from addin.server.settings import Settings

LOG = logging.getLogger("torsionbook.server")
#: Time for the answers of calls that were stopped, and how often it is looked for the last. [s]
LAST_WORDS, LOOK = 3.0, 0.05


class Server(uvicorn.Server):
    """A server that leaves in three steps.

    Told to end by SIGTERM, it answers as before for `Settings.drain`, while it says that it leaves. Then it
    closes its sockets to new connections and new calls, and lets those under way go on for `Settings.grace`.
    What is not done by then is stopped and answered with a sentence. Ctrl+C and a second signal skip the
    first step.

    Parameters
    ----------
    settings : Settings
        What is served with.
    app : Starlette
        What `addin.server.app.create_app` has made of them.
    address : str
        Where it listens. [URL]
    """

    def __init__(self, settings: Settings, app: Starlette, address: str) -> None:
        super().__init__(_config(settings, app))
        self._settings = settings
        self._address = address
        self._pools = app.state.pools
        self._leaving: Leaving = app.state.leaving
        self._told: tuple[float, int, Any] | None = None

    async def startup(self, sockets: Any = None) -> None:
        """Begin to listen, and say where."""
        await super().startup(sockets)
        if self._settings.is_dev and self._settings.certificate is not None:
            trust = how_to_trust(self._settings.certificate)
            LOG.info("Until this machine trusts the certificate, browsers warn: %s", trust)
        LOG.info("torsionbook is running on %s (Ctrl+C ends it)", self._address)

    def handle_exit(self, sig: int, frame: Any) -> None:
        """Begin to leave."""
        is_first = not self._leaving.has_begun
        self._leaving.has_begun = True
        if is_first and sig == signal.SIGTERM and self._settings.drain:
            self._told = time.monotonic(), sig, frame
        else:
            self._told = None
            super().handle_exit(sig, frame)

    async def on_tick(self, counter: int) -> bool:
        """Whether to end, asked ten times a second."""
        if self._told is not None and time.monotonic() - self._told[0] >= self._settings.drain:
            _, sig, frame = self._told
            self._told = None
            super().handle_exit(sig, frame)
        return await super().on_tick(counter)

    async def shutdown(self, sockets: Any = None) -> None:
        """Take nothing new, and end when what is under way has ended."""
        self._leaving.is_closed = True
        timer = threading.Timer(self._settings.grace, self._give_up)
        timer.daemon = True
        timer.start()
        for server in self.servers:
            server.close()
        until = time.monotonic() + self._settings.grace + LAST_WORDS
        # uvicorn would close a WebSocket whose call is under way
        while self._leaving.calls and time.monotonic() < until and not self.force_exit:
            await asyncio.sleep(LOOK)
        await super().shutdown(sockets)

    def _give_up(self) -> None:
        """Have calls that do not end in time answered while their connection is still there."""
        for pool in self._pools:
            pool.stop()


def _config(settings: Settings, app: Starlette) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        ssl_certfile=settings.certificate,
        ssl_keyfile=settings.certificate_key,
        ws_max_size=settings.limits.message,
        ws_per_message_deflate=False,  # a few kB sent would be many MB here
        http=protocol_of(settings),
        # anybody can write them; the address of a proxy that is not named counts as one client
        proxy_headers=bool(settings.trusted_proxies),
        forwarded_allow_ips=[str(network) for network in settings.trusted_proxies],
        timeout_graceful_shutdown=round(settings.grace + LAST_WORDS),
        log_config=log_config(settings.log_format, has_requests=settings.log_requests),
        access_log=False,  # ours has more
        server_header=False,
    )
