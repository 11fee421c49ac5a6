"""The sockets a server listens on, opened before anything else is begun."""

from __future__ import annotations

import errno
import ipaddress
import os
import socket
from collections.abc import Mapping

from addin.server.settings import Settings, SettingsError, flag_of

#: Number of the first file that is handed over, as systemd has it.
_FIRST_HANDED = 3
#: How many ports beyond one in use are looked at for a free one. [count]
NEARBY = 20


def sockets_of(settings: Settings) -> list[socket.socket]:
    """The sockets of a server: bound, one for each address of its host.

    Raises
    ------
    SettingsError
        If the host is none of this machine, or the port cannot be had.
    """
    place = settings.place("host")
    try:
        found = socket.getaddrinfo(
            settings.host, settings.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )
    except (OSError, UnicodeError):
        raise SettingsError(
            f"{place}: the name '{settings.host}' is unknown here. Give an address of this machine, "
            "such as 127.0.0.1."
        ) from None
    sockets: list[socket.socket] = []
    port = settings.port
    for family, kind, protocol, _, address in dict.fromkeys(found):
        try:
            sockets.append(_bound(family, kind, protocol, (address[0], port, *address[2:])))
        except OSError as wrong:
            # a machine without IPv6 may still have a name for it
            if wrong.errno in (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT) and len(found) > 1:
                continue
            for one in sockets:
                one.close()
            raise SettingsError(_why(settings, wrong)) from None
        port = sockets[0].getsockname()[1]
    if not sockets:
        raise SettingsError(_why(settings, OSError(errno.EADDRNOTAVAIL, "")))
    return sockets


def handed_over(settings: Settings, environment: Mapping[str, str]) -> list[socket.socket]:
    """Sockets that the system has opened for this process and keeps over its restarts; none as a rule.

    Raises
    ------
    SettingsError
        If they are open to other machines, and the settings are for this one.
    """
    if environment.get("LISTEN_PID") != str(os.getpid()):
        return []
    number = int(environment.get("LISTEN_FDS", "0"))
    sockets = [socket.socket(fileno=_FIRST_HANDED + k) for k in range(number)]
    for one in sockets:
        here = one.getsockname()[0]
        if settings.is_loopback and not ipaddress.ip_address(here).is_loopback:
            raise SettingsError(
                f"The socket that was handed over listens on {here}, which other machines can reach. "
                f"Give {flag_of('host')} {here}, and what belongs to it."
            )
    return sockets


def address_of(settings: Settings, port: int) -> str:
    """Where a server is reached from its own machine."""
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    return f"http{'' if settings.certificate is None else 's'}://{host}:{port}"


def _bound(family: int, kind: int, protocol: int, address: tuple[object, ...]) -> socket.socket:
    one = socket.socket(family, kind, protocol)
    try:
        if os.name == "posix":  # elsewhere it would let two servers have one port
            one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            one.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        one.bind(address)
        one.listen(2048)
    except OSError:
        one.close()
        raise
    return one


def _why(settings: Settings, wrong: OSError) -> str:
    host, port = settings.host, settings.port
    if wrong.errno == errno.EADDRINUSE:
        free = _free_port(host, port)
        other = f"--port {free} is free; " if free else ""
        return (
            f"{settings.place('port')} {port}: another program listens there, perhaps this server "
            f"already. {other}--port 0 takes any free port."
        )
    if wrong.errno == errno.EACCES:
        return (
            f"{settings.place('port')} {port}: this user may not listen there. Give a port above "
            "1023, or use a reverse proxy."
        )
    if wrong.errno in (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT):
        return (
            f"{settings.place('host')} {host}: this machine has no such address. Give one of its "
            "own, such as 127.0.0.1."
        )
    return f"{settings.place('host')} {host}: cannot listen on port {port}: {wrong.strerror}."


def _free_port(host: str, port: int) -> int | None:
    """The next port that can be had."""
    for other in range(port + 1, min(port + NEARBY, 65535) + 1):
        try:
            family, kind, protocol, _, address = socket.getaddrinfo(
                host, other, type=socket.SOCK_STREAM
            )[0]
            _bound(family, kind, protocol, address).close()
        except OSError:
            continue
        return other
    return None
