"""What is fixed when the server starts: addresses, keys, certificates, limits."""

from __future__ import annotations

import ipaddress
import os
import ssl
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

#: Addresses of a network.
Network = ipaddress.IPv4Network | ipaddress.IPv6Network
#: Names of this machine that no other machine can reach.
LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
#: A body beyond this, or of a size not told, counts as large. [B]
LARGE = 1_000_000
#: What of a body has to arrive in each second beyond the first. [B]
BODY_RATE = 50_000
#: Shortest API key that is accepted: shorter ones can be guessed. [characters]
SHORTEST_KEY = 16
#: What the address of a shared memory begins with.
SHARED_SCHEMES = ("redis", "rediss", "valkey", "valkeys", "unix")


class SettingsError(Exception):
    """Settings that cannot be served with; the sentence says why."""


@dataclass(frozen=True)
class Limits:
    """How much one request, and all of them together, may ask for."""

    body: int = 25_000_000  #: Largest body of a request. [B]
    calls: int = 2_000  #: Most function calls in one request.
    requests: int = 2_000  #: Most requests being answered at a time; further ones get 503.
    #: Most requests at a time with more than `LARGE` to read; further ones get 503.
    large: int = 32
    waiting: int = 64  #: Most long calculations of one client waiting for a process.
    streams: int = 500  #: Most long calls at a time of one WebSocket.
    message: int = 4_000_000  #: Largest message of a WebSocket. [B]
    #: Most WebSockets that have not sent their key; with one more the oldest is closed.
    strangers: int = 64
    strangers_each: int = 8  #: The same of one address beyond this machine.
    #: Time for the body of a request to arrive, and a second more for every `BODY_RATE`. [s]
    body_time: float = 20.0
    header_time: float = 10.0  #: Time for the headers of a request to arrive. [s]
    short_time: float = 60.0  #: Time for the short functions of one request. [s]
    long_time: float = 900.0  #: Time for one start or one workbook, from its beginning. [s]


@dataclass(frozen=True)
class Settings:
    """One server.

    Raises
    ------
    SettingsError
        If these settings would expose the server, or contradict each other.
    """

    host: str = "127.0.0.1"  #: Address to listen on.
    port: int = 8765  #: Port; 0 = any that is free. [number]
    keys: frozenset[str] = frozenset()  #: API keys; empty = none is asked for.
    certificate: Path | None = None  #: Certificate chain in PEM.
    certificate_key: Path | None = None  #: Its private key in PEM.
    is_dev: bool = False  #: Whether that certificate is for this machine alone.
    #: Address users have in their browser, where a proxy stands in front; empty = as asked. [URL]
    public_url: str = ""
    #: Reverse proxies whose word for the address of a client is taken.
    trusted_proxies: tuple[Network, ...] = ()
    log_format: str = "text"  #: How the log is written: text, or JSON a line. [word]
    log_requests: bool = False  #: Whether each request has a line in it.
    #: How long all is answered once the server is told to end, so that a balancer sends no more to it. [s]
    drain: float = 0.0
    grace: float = 3.0  #: How long calls under way may go on after that. [s]
    #: Redis or Valkey through which servers share models and results; empty = none. [URL]
    shared: str = ""
    shared_key: str = field(default="", repr=False)  #: The secret that they share.
    shared_time: float = 86_400.0  #: How long what nobody uses stays there. [s]
    #: Processes for long calculations.
    workers: int = field(default_factory=lambda: max(1, min(4, (os.cpu_count() or 2) - 1)))
    limits: Limits = field(default_factory=Limits)  #: Limits.
    #: Where settings were typed, by their names here; those not in it count as flags. [words]
    places: Mapping[str, str] = field(default_factory=dict, compare=False)

    def place(self, name: str) -> str:
        """Where a setting was typed, for a sentence that refuses it."""
        return self.places.get(name) or flag_of(_FLAGS.get(name, name))

    def __post_init__(self) -> None:
        if (self.certificate is None) != (self.certificate_key is None):
            raise SettingsError(
                "HTTPS needs a certificate and its private key: give both --cert and --key."
            )
        for name in ("certificate", "certificate_key"):
            path = getattr(self, name)
            if path is not None and not path.is_file():
                raise SettingsError(f"{self.place(name)}: file {path} not found. Check the path.")
        if not self.is_loopback and self.is_dev:
            raise SettingsError(
                f"{self.place('host')} {self.host}: the certificate of --dev-cert is for this machine "
                "alone. Keep 127.0.0.1, or give --cert and --key."
            )
        if not self.is_loopback and self.certificate is None and not self.trusted_proxies:
            raise SettingsError(
                f"{self.place('host')} {self.host}: other machines can reach it; without encryption, data and API "
                "keys can be read in transit. Give --cert and --key, or use a reverse proxy with "
                "HTTPS and give its address with --trusted-proxies (docs/server.md)."
            )
        if not self.is_loopback and not self.keys:
            raise SettingsError(
                f"{self.place('host')} {self.host}: other machines can reach it; without API keys anyone there can "
                "use this machine. Give --api-key-file with one key per line."
            )
        self._check_shared()
        if self.shared_time < 1:
            raise SettingsError(
                f"{self.place('shared_time')} is {self.shared_time:g} s; it must be at least 1 s."
            )
        if self.workers < 1:
            raise SettingsError(
                f"{self.place('workers')} is {self.workers}; at least 1 process is needed."
            )
        for name in ("drain", "grace"):
            if getattr(self, name) < 0:
                raise SettingsError(f"{self.place(name)} is below 0 s; it must not be.")
        if not 0 <= self.port <= 65535:
            raise SettingsError(
                f"{self.place('port')} is {self.port}; it must lie between 0 and 65535."
            )
        if self.public_url and not _is_address(self.public_url):
            raise SettingsError(
                f"{self.place('public_url')} is '{self.public_url}'; write an address such as "
                "https://torsion.example.com."
            )

    def _check_shared(self) -> None:
        """Refuse a shared memory that cannot be one, without its password in the sentence."""
        if not self.shared:
            if self.shared_key:
                raise SettingsError(
                    f"{self.place('shared_key')} is the secret of a shared memory, but none is given. Give --shared."
                )
            return
        scheme, found, rest = self.shared.partition("://")
        if not found or scheme not in SHARED_SCHEMES or not rest:
            raise SettingsError(
                f"{self.place('shared')} is no address of Redis or Valkey; write one such as redis://127.0.0.1:6379/0."
            )
        if not self.shared_key:
            raise SettingsError(
                f"{self.place('shared')}: whoever can write there could have this server run anything. Give all servers "
                "one secret with --shared-key-file."
            )

    @property
    def peers(self) -> tuple[Network, ...]:
        """Who may connect where nothing is encrypted beyond this machine; empty = anybody."""
        if self.is_loopback or self.certificate is not None:
            return ()
        return (*self.trusted_proxies, *map(ipaddress.ip_network, ("127.0.0.1", "::1")))

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine can reach the server."""
        return self.host in LOOPBACK

    def knows_host(self, name: str) -> bool:
        """Whether a request may be addressed to a name.

        A page of somebody else can make a browser send requests to a loopback address under a name
        of its own; those are refused here. Beyond loopback the certificate does this, and behind a proxy
        the public URL.
        """
        try:
            host = urlsplit(f"//{name}").hostname or ""
        except ValueError:
            return False
        own = urlsplit(self.public_url).hostname
        if not self.is_loopback and not (self.peers and own):
            return True
        return host in LOOPBACK or (own is not None and host == own)


#: Flags of settings that are called otherwise here.
_FLAGS = {
    "certificate": "cert",
    "certificate_key": "key",
    "keys": "api_key_file",
    "shared_key": "shared_key_file",
}


def flag_of(name: str) -> str:
    """The flag of a setting."""
    return f"--{name.replace('_', '-')}"


def _is_address(url: str) -> bool:
    """Whether a text is an address a browser can be sent to."""
    try:
        parts = urlsplit(url)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:  # brackets that do not match, a port beyond 65535
        return False


def check_certificate(settings: Settings) -> None:
    """See that certificate and key can be served with, before the server starts.

    Raises
    ------
    SettingsError
        If a file holds something else, or the key is not that of the certificate.
    """
    chain, key = settings.certificate, settings.certificate_key
    if chain is None or key is None:
        return
    cert_place, key_place = settings.place("certificate"), settings.place("certificate_key")
    try:
        text = {path: path.read_text("ascii", "replace") for path in (chain, key)}
    except OSError as wrong:
        raise SettingsError(
            f"{wrong.filename} cannot be read: {wrong.strerror}. Check the path and its "
            "permissions."
        ) from None
    marks = "BEGIN CERTIFICATE", "PRIVATE KEY"
    if marks[0] not in text[chain] and marks[0] in text[key]:
        raise SettingsError(
            f"{cert_place} {chain} contains no certificate, but {key_place} {key} does: swap them."
        )
    for option, path, mark in zip((cert_place, key_place), (chain, key), marks, strict=True):
        if mark not in text[path]:
            what = "certificate" if path == chain else "private key"
            raise SettingsError(
                f"{option} {path} contains no {what} in PEM format (-----BEGIN ...-----)."
            )
    if "ENCRYPTED" in text[key]:
        if sys.stdin is not None and sys.stdin.isatty():
            return  # its password is asked for when the server starts
        raise SettingsError(
            f"{key_place} {key} is encrypted, and there is no terminal to enter its password. Use an "
            "unencrypted key: openssl pkey -in KEY -out NEW, and restrict its permissions to "
            "this service."
        )
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(chain, key)
    except (OSError, ValueError) as wrong:  # an SSLError is an OSError
        reason = getattr(wrong, "reason", None) or str(wrong)
        why = (
            "the key does not match the certificate"
            if reason == "KEY_VALUES_MISMATCH"
            else f"they cannot be read ({reason})"
        )
        raise SettingsError(
            f"{cert_place} {chain} and {key_place} {key} cannot be used: {why}."
        ) from None


def read_keys(path: Path, place: str = "--api-key-file") -> frozenset[str]:
    """API keys of a file: one per line, text after # is a remark.

    Parameters
    ----------
    path : Path
        The file.
    place : str
        Where it was named. [words]

    Raises
    ------
    SettingsError
        If the file cannot be read, holds no key, or a key that can be guessed.
    """
    try:
        lines: Iterable[str] = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as wrong:
        why = wrong.strerror if isinstance(wrong, OSError) else "it is no text in UTF-8"
        raise SettingsError(
            f"{place}: {path} cannot be read: {why}. Name a file with one key per line."
        ) from None
    keys = {key for line in lines if (key := line.partition("#")[0].strip())}
    if not keys:
        raise SettingsError(f"{place}: {path} contains no key. Write one key per line.")
    for key in keys:
        if len(key) < SHORTEST_KEY or not key.isascii() or " " in key:
            raise SettingsError(
                f"{place}: the key '{key[:3]}…' in {path} cannot be used. A key has at least {SHORTEST_KEY} letters "
                'and digits, such as: python -c "import secrets; print(secrets.token_urlsafe(24))"'
            )
    return frozenset(keys)


def read_secret(path: Path, place: str = "--shared-key-file") -> str:
    """The one secret of a file, which all servers of a shared memory have.

    Parameters
    ----------
    path : Path
        The file.
    place : str
        Where it was named. [words]

    Raises
    ------
    SettingsError
        If the file cannot be read, holds none, several, or one that can be guessed.
    """
    found = read_keys(path, place)
    if len(found) > 1:
        raise SettingsError(
            f"{place}: {path} contains {len(found)} keys; all servers share one secret."
        )
    return next(iter(found))


#: The message on an error inside torsionbook; the rest is in the log.
OURS = "This is an error inside torsionbook. See the server log and please report it."
