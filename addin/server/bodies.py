"""Bodies of requests: read within limits of size and time, as long as the client is there."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable
from typing import Any, TypeVar

from starlette.requests import ClientDisconnect, Request

from addin.server.answers import Refused, too_large
from addin.server.settings import BODY_RATE

T = TypeVar("T")


async def read_body(request: Request, limit: int, seconds: float = 20.0) -> bytes:
    """The body of a request; reading stops as soon as it is too large or comes too slowly.

    Parameters
    ----------
    request : Request
        The request.
    limit : int
        Most bytes. [B]
    seconds : float
        How long it may take, and a second more for every `BODY_RATE`. [s]

    Returns
    -------
    bytes
        The body.

    Raises
    ------
    Refused
        With 413, 408, or 415 for a body that is packed.
    """
    packed = request.headers.get("content-encoding", "identity").strip()
    if packed.casefold() not in ("", "identity"):
        raise Refused(
            415, f"The body is packed (Content-Encoding: {packed[:20]}). Send it as it is."
        )
    parts, size = [], 0
    began = asyncio.get_running_loop().time()
    try:
        async with asyncio.timeout_at(began + seconds) as until:
            async for part in request.stream():
                size += len(part)
                if size > 2 * limit:
                    raise too_large(limit)
                if size <= limit:
                    parts.append(part)
                until.reschedule(began + seconds + size / BODY_RATE)
    except TimeoutError:
        raise Refused(
            408,
            f"The request arrived too slowly: {size:,} bytes in "
            f"{asyncio.get_running_loop().time() - began:.0f} s. Send it again.",
            {"Connection": "close"},
        ) from None
    except ClientDisconnect:
        raise Refused(
            400, "The connection was closed before the request was complete. Send it again."
        ) from None
    if size > limit:  # whoever is cut off while he sends does not see why
        raise too_large(limit)
    return b"".join(parts)


async def read_json(request: Request, limit: int, seconds: float = 20.0) -> tuple[Any, int]:
    """The body of a request as plain values, and its size.

    Parameters
    ----------
    request : Request
        The request.
    limit : int
        Most bytes. [B]
    seconds : float
        As in `read_body`. [s]

    Returns
    -------
    tuple of object and int
        What the JSON holds, and its bytes. [B]

    Raises
    ------
    Refused
        If it is no JSON, or too large.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().casefold()
    if kind != "application/json":
        raise Refused(415, "Send JSON, with the header Content-Type: application/json.")
    body = await read_body(request, limit, seconds)
    return await asyncio.to_thread(parsed, body), len(body)


def parsed(text: bytes | str) -> Any:
    """Plain values of a JSON text.

    Raises
    ------
    Refused
        If it is no JSON, or holds what JSON does not know, such as NaN.
    """
    try:
        return json.loads(text, parse_constant=_no_constant)
    except RecursionError:
        raise Refused(400, "The JSON is nested too deeply. Send fewer levels.") from None
    except (ValueError, UnicodeDecodeError) as wrong:
        if "set_int_max_str_digits" in str(wrong):
            raise Refused(
                400, "The JSON contains a whole number with too many digits for a cell. Correct it."
            ) from None
        raise Refused(400, f"This is not valid JSON: {wrong}. Correct it.") from None


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is not a JSON number; send null for a blank cell")


async def while_connected(request: Request, work: Awaitable[T]) -> T:
    """Do something for a client, and give it up when the client is gone.

    Raises
    ------
    Refused
        If the client is gone; nobody will read it.
    """
    task = asyncio.ensure_future(work)
    gone = asyncio.create_task(_gone(request))
    try:
        await asyncio.wait({task, gone}, return_when=asyncio.FIRST_COMPLETED)
        if task.done():
            return task.result()
        raise Refused(400, "The client has closed the connection.")
    finally:
        for waiting in (task, gone):
            waiting.cancel()
        await asyncio.gather(task, gone, return_exceptions=True)


async def _gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass
