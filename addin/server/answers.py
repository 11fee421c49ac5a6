"""Answers and refusals as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from starlette.responses import Response

from addin.contract.problems import CellProblem


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


def input_errors(problems: Sequence[CellProblem]) -> str:
    """The sentence over everything wrong with an input."""
    count = "one error" if len(problems) == 1 else f"{len(problems)} errors"
    return f"The input has {count}; nothing was calculated. {problems[0].message}"


def too_large(limit: int) -> Refused:
    return Refused(
        413,
        f"The request is larger than {limit / 1e6:g} MB, the most this server takes. Send less at a "
        "time.",
        {"Connection": "close"},
    )


def too_busy(with_what: str) -> Refused:
    return Refused(
        503,
        f"The server is busy with {with_what}. Try again in a few seconds.",
        {"Retry-After": "5"},
    )
