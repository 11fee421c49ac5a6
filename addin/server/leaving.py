"""A server that leaves: what it still takes, and what it still waits for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Leaving:
    """How far a server is with leaving; it begins when it is told to end."""

    has_begun: bool = (
        False  #: It wants no further connections: /readyz says so, each answer closes its own.
    )
    is_closed: bool = False  #: It takes no further calls.
    calls: int = 0  #: Calls of WebSockets whose answer is not sent yet. [count]
