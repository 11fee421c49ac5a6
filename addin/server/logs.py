"""The log of a server: lines of text, or an object of JSON a line."""

from __future__ import annotations

import json
import logging
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any

#: How the log is written.
FORMATS = ("text", "json")
#: Identity of the request that is answered; blank outside of one.
REQUEST: ContextVar[str] = ContextVar("REQUEST", default="")
#: What a line about a request has beside its words.
FIELDS = ("method", "path", "status", "seconds", "address")
REQUESTS = logging.getLogger("torsionbook.requests")


class JsonLines(logging.Formatter):
    """Each line an object."""

    def format(self, record: logging.LogRecord) -> str:
        """The line of a record."""
        content: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        if identity := REQUEST.get():
            content["request"] = identity
        content |= {name: getattr(record, name) for name in FIELDS if hasattr(record, name)}
        if record.exc_info:
            content["exception"] = self.formatException(record.exc_info)
        return json.dumps(content)


def log_config(how: str, *, has_requests: bool) -> dict[str, Any]:
    """What `logging.config.dictConfig` takes.

    Parameters
    ----------
    how : str
        One of `FORMATS`. [word]
    has_requests : bool
        Whether each request has its line. [flag]
    """
    level = "INFO" if has_requests else "WARNING"
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {
            "text": {"format": "%(asctime)s %(levelname)s: %(message)s"},
            "json": {"()": JsonLines},
        },
        "handlers": {"stderr": {"class": "logging.StreamHandler", "formatter": how}},
        "loggers": {
            "uvicorn": {"handlers": ["stderr"], "level": "INFO", "propagate": False},
            "torsionbook": {"handlers": ["stderr"], "level": "INFO", "propagate": False},
            REQUESTS.name: {"level": level},
        },
    }
