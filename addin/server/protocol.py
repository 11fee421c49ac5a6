"""HTTP of a connection: uvicorn's, with a time limit for headers and a look at who connects."""

from __future__ import annotations

import asyncio
import ipaddress
from collections.abc import Sequence

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from addin.server.settings import Network, Settings

_TOO_SLOW = b"HTTP/1.1 408 Request Timeout\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"


class GuardedProtocol(H11Protocol):
    """One connection.

    Its headers must be complete in time, those of its first request and of each that follows; uvicorn itself
    waits for ever. Where only proxies may connect, others are closed before they are read.
    """

    header_time: float = 0.0
    peers: Sequence[Network] = ()
    _timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        if self.peers and not is_in(self.client[0] if self.client else "", self.peers):
            transport.close()
            return
        self._watch(True)

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        # of the next request only once something of it is there: until then it is kept alive for a while
        self._watch(bool(self.conn.trailing_data[0]))

    def connection_lost(self, exc: Exception | None) -> None:
        self._watch(False)
        super().connection_lost(exc)

    def _watch(self, has_begun: bool) -> None:
        """Begin to wait for headers, or stop."""
        awaited = (
            has_begun and self.conn.their_state is h11.IDLE and not self.transport.is_closing()
        )
        if awaited and self._timer is None:
            self._timer = self.loop.call_later(self.header_time, self._too_slow)
        elif not awaited and self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _too_slow(self) -> None:
        self._timer = None
        if self.conn.their_state is h11.IDLE and not self.transport.is_closing():
            self.transport.write(_TOO_SLOW)
            self.transport.close()


def protocol_of(settings: Settings) -> type[GuardedProtocol]:
    """The protocol of a server's connections."""

    class Protocol(GuardedProtocol):
        header_time = settings.limits.header_time
        peers = settings.peers

    return Protocol


def is_in(address: str, networks: Sequence[Network]) -> bool:
    """Whether an address is in one of these networks."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return False
    mapped = getattr(found, "ipv4_mapped", None)
    return any((mapped or found) in network for network in networks)
