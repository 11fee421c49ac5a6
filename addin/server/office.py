"""What the Office host loads: metadata of the functions, their script, the manifest."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from addin.contract.version import product_version
from addin.worksheet.registry import FUNCTIONS, Function

#: Before every name in a cell of Excel: =TV.FREQUENCIES(...).
NAMESPACE = "TV"
STATIC = Path(__file__).parent / "static"


@cache
def static(name: str) -> bytes:
    """A file of the page."""
    return (STATIC / name).read_bytes()


def function_id(name: str) -> str:
    """The id of a function in the Office host, which may hold letters, digits and points only."""
    return name.replace("_", ".")


def functions_json() -> dict[str, Any]:
    """The metadata of custom functions, as Office.js wants it."""
    return {
        "allowCustomDataForDataTypeAny": True,
        "allowErrorForDataTypeAny": True,
        "functions": [_metadata(function) for function in FUNCTIONS.values()],
    }


def _metadata(function: Function) -> dict[str, Any]:
    # the addresses of the arguments tell blank cells from zeros (functions.js)
    options = (
        {"stream": True, "requiresStreamParameterAddresses": True}
        if function.long
        else {"requiresParameterAddresses": True}
    )
    return {
        "id": function_id(function.name),
        "name": function.name.removeprefix(f"{NAMESPACE}_"),
        "description": function.help,
        "options": options,
        "result": {"type": "any", "dimensionality": "matrix"},
        "parameters": [
            {
                "name": argument.name.replace(" ", "_"),
                "description": argument.help,
                "type": "any",
                "dimensionality": "matrix",
                "optional": argument.optional,
            }
            for argument in function.arguments
        ],
    }


def functions_script() -> bytes:
    """The script that connects the functions with the server."""
    table = [[function_id(f.name), f.name, f.long] for f in FUNCTIONS.values()]
    return static("functions.js").replace(b'"the functions"', json.dumps(table).encode())


def manifest(base: str) -> bytes:
    """The add-in's manifest for a server at an address, after Microsoft's add-in only XML.

    Over HTTP it begins with a remark: Office does not load it.
    """
    numbers = (re.findall(r"\d+", product_version()) + ["0"] * 4)[:4]
    page = static("manifest.xml").replace(b"the version", ".".join(numbers).encode())
    if not base.startswith("https:"):
        first, line, rest = page.partition(b"\n")
        page = first + line + _NOT_ENCRYPTED + rest
    return page.replace(b"the address", escape(base, {'"': "&quot;"}).encode())


_NOT_ENCRYPTED = b"""<!-- Office loads add-ins over HTTPS only, so not this one. Start the server with a certificate, or with
     the public URL of an HTTPS proxy, and fetch the manifest again. -->
"""
