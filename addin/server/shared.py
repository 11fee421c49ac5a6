"""Models and results that several servers share, in Redis or Valkey.

The client library is that of Valkey: MIT, nothing else to install, and it speaks with both. What is kept are
objects of Python, which whoever can write there could make do anything; so each has a code of authentication with the
secret of the servers, of its name too, and what has another is not looked at.

While the shared memory is away, a server goes on with its own and says so in the log.
"""

from __future__ import annotations

import hmac
import importlib.util
import logging
import pickle
import threading
import time
from typing import Any
from urllib.parse import urlsplit

from addin.contract.version import product_version
from addin.server.settings import Settings, SettingsError

#: Whether the optional package is there.
INSTALLED = importlib.util.find_spec("valkey") is not None
if INSTALLED:
    import valkey

LOG = logging.getLogger("torsionbook.server")
#: Before every name; another format or version of the program finds nothing.
PREFIX = f"torsionbook:1:{product_version()}:"
#: How long a connection and an answer are waited for, and how long none is tried after a failure. [s]
CONNECT, ANSWER, PAUSE = 0.5, 3.0, 2.0
#: What is in use is put again after so long: the memory may have lost it, or have been away. [s]
RENEW = 60.0
#: Largest value that is shared, and most names of which the time of the last put is known. [B, count]
LARGEST, MOST_NAMES = 64_000_000, 20_000


def check_shared(settings: Settings) -> None:
    """See that the package of a shared memory is there, where one is asked for.

    Raises
    ------
    SettingsError
        If it is not.
    """
    if settings.shared and not INSTALLED:
        raise SettingsError(
            f"{settings.place('shared')} needs the package valkey. Run pip install -r requirements/shared.txt in the "
            "checkout, or install the wheel with its extra [shared]."
        )


class SharedMemory:
    """A `addin.worksheet.models.Store` in Redis or Valkey.

    Parameters
    ----------
    settings : Settings
        With its address, its secret and how long it keeps what nobody uses.
    """

    def __init__(self, settings: Settings) -> None:
        check_shared(settings)
        self._secret = settings.shared_key.encode()
        self._lifetime = max(1, round(settings.shared_time))
        parts = urlsplit(settings.shared)
        #: Without a password.
        self._address = f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"
        self._client = valkey.Valkey.from_url(
            settings.shared,
            socket_connect_timeout=CONNECT,
            socket_timeout=ANSWER,
            client_name="torsionbook",
        )
        self._lock = threading.Lock()
        self._put_at: dict[str, float] = {}
        self._not_before = 0.0
        self.is_up = True  #: Whether it answered the last time.
        self._has_stranger = False

    def begin(self) -> None:
        """Ask for the first time, and say in the log what comes of it."""
        if self._asked("PING") is not None:
            LOG.info("Models and results are shared through %s", self._address)

    def close(self) -> None:
        """Let the connections go."""
        self._client.close()

    def get(self, name: str) -> Any:
        """What is kept under a name, for whoever asks; None if there is nothing.

        It stays there for its whole time again.
        """
        found = self._asked("GETEX", PREFIX + name, "EX", self._lifetime)
        if not isinstance(found, bytes):
            return None
        code, packed = found[:32], found[32:]
        if not hmac.compare_digest(code, self._code(name, packed)):
            if not self._has_stranger:
                self._has_stranger = True
                LOG.warning(
                    "%s holds values that were not written with the secret of this server; they are not used. "
                    "Give all servers the same shared_key_file.",
                    self._address,
                )
            return None
        self._note(name)
        return pickle.loads(packed)

    def put(self, name: str, value: Any) -> None:
        """Keep a value under a name; one that is too large is kept nowhere."""
        packed = pickle.dumps(value)
        if len(packed) > LARGEST:
            return
        content = self._code(name, packed) + packed
        if self._asked("SET", PREFIX + name, content, "EX", self._lifetime) is not None:
            self._note(name)

    def is_due(self, name: str) -> bool:
        """Whether what is used here ought to be put again, so that the others find it."""
        put_at = self._put_at.get(name)
        return put_at is None or time.monotonic() - put_at > min(RENEW, self._lifetime / 4)

    def _note(self, name: str) -> None:
        with self._lock:
            if len(self._put_at) >= MOST_NAMES:
                self._put_at.clear()
            self._put_at[name] = time.monotonic()

    def _code(self, name: str, packed: bytes) -> bytes:
        return hmac.digest(self._secret, (PREFIX + name).encode() + b"\0" + packed, "sha256")

    def _asked(self, *words: Any) -> Any:
        """The answer to a command; None where there is none, and none is asked for while it is away."""
        if time.monotonic() < self._not_before:
            return None
        try:
            answer = self._client.execute_command(*words)
        except (valkey.ValkeyError, OSError) as wrong:
            self._not_before = time.monotonic() + PAUSE
            if self.is_up:
                self.is_up = False
                LOG.warning(
                    "%s does not answer (%s). This server goes on with its own memory; other servers do not know its "
                    "models until %s answers.",
                    self._address,
                    wrong,
                    self._address,
                )
            return None
        if not self.is_up:
            self.is_up = True
            LOG.info("%s answers again", self._address)
        return answer
