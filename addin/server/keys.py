"""API keys: which one a request carries, whether it is one of ours, and who guesses."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import logging
import time
from collections import OrderedDict, deque
from collections.abc import Callable

from starlette.datastructures import Headers

from addin.server.answers import Refused
from addin.server.settings import Settings

LOG = logging.getLogger("torsionbook.server")
#: How many wrong keys an address may send within how long. [count, s]
GUESSES, WITHIN = 10, 60.0
#: Addresses, and keys with their addresses, that are remembered. [count]
MOST = 10_000


class Keys:
    """Knows our keys, and counts the wrong ones of each address.

    An address that has sent `GUESSES` wrong keys within `WITHIN` has further keys refused without a look at
    them, but for those that were accepted from there before: behind a proxy one address is that of everybody.

    Parameters
    ----------
    settings : Settings
        Its keys.
    now : callable
        A clock. [s]
    """

    def __init__(self, settings: Settings, now: Callable[[], float] = time.monotonic) -> None:
        self._settings = settings
        self._now = now
        self._wrong: OrderedDict[str, deque[float]] = OrderedDict()
        self._accepted: OrderedDict[tuple[str, bytes], None] = OrderedDict()
        self.wrong = 0  #: Wrong keys so far. [count]
        self.unseen = 0  #: Keys refused without a look at them. [count]

    def admits(self, given: str | None, address: str) -> bool:
        """Whether a client may ask.

        Parameters
        ----------
        given : str or None
            The key it sent.
        address : str
            Where it is. [name]

        Raises
        ------
        Refused
            If too many wrong keys came from there.
        """
        if not self._settings.keys:
            return True
        if not given:
            return False
        place = network_of(address)
        sent = given.encode("utf-8", "surrogatepass")
        known = place, hashlib.sha256(sent).digest()
        guesses = self._guesses(place)
        if len(guesses) >= GUESSES and known not in self._accepted:
            self.unseen += 1
            wait = max(1, round(guesses[0] + WITHIN - self._now()))
            raise Refused(
                429,
                f"Too many wrong API keys came from this address. Try again in {wait} s.",
                {"Retry-After": str(wait)},
            )
        # every key is compared, each in constant time
        matches = [hmac.compare_digest(sent, key.encode()) for key in self._settings.keys]
        if any(matches):
            _remember(self._accepted, known, None)
            return True
        self.wrong += 1
        guesses.append(self._now())
        _remember(self._wrong, place, guesses)
        if len(guesses) == GUESSES:
            LOG.warning("wrong API keys from %s: further ones are not looked at for now", place)
        else:
            LOG.warning("wrong API key from %s, %d within %g s", place, len(guesses), WITHIN)
        return False

    def _guesses(self, place: str) -> deque[float]:
        """When wrong keys came from a place of late."""
        guesses = self._wrong.get(place, deque())
        while guesses and guesses[0] + WITHIN <= self._now():
            guesses.popleft()
        return guesses


def _remember(where: OrderedDict, key: object, value: object) -> None:
    where[key] = value
    where.move_to_end(key)
    if len(where) > MOST:
        where.popitem(last=False)


def network_of(address: str) -> str:
    """An address, or the network of IPv6 that one client has as a rule."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    return address if found.version == 4 else str(ipaddress.ip_network((found, 64), strict=False))


def key_of(headers: Headers) -> str | None:
    """The key a request carries: ``X-API-Key``, or ``Authorization: Bearer``."""
    kind, _, token = headers.get("authorization", "").partition(" ")
    bearer = token.strip() if kind.casefold() == "bearer" else None
    return headers.get("x-api-key") or bearer


def no_key(given: str | None) -> str:
    """Why a client is not answered."""
    if given:
        return (
            "The API key is not valid on this server: wrong, mistyped or withdrawn. Ask the "
            "administrator of the server for a key, and send it in the header X-API-Key or as "
            "Authorization: Bearer."
        )
    return (
        "An API key is needed: send it in the header X-API-Key, or as Authorization: Bearer. "
        "Ask the administrator of the server for a key."
    )
