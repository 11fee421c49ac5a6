"""API keys: which one a request carries, and whether it is one of ours."""

from __future__ import annotations

import hmac

from starlette.datastructures import Headers

from addin.server.settings import Settings


def is_key(settings: Settings, given: str | None) -> bool:
    """Whether a key is one of ours; compared in constant time."""
    if not settings.keys:
        return True
    sent = (given or "").encode("utf-8", "surrogatepass")
    matches = [hmac.compare_digest(sent, key.encode()) for key in settings.keys]
    return any(matches)


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
