"""The process that calculates for LibreOffice: ``python -m addin.libreoffice.worker``.

Reads requests from its input, writes answers to its output, one after the other, until the input
ends. A message is its length (4 bytes, the highest first), then JSON in UTF-8; numbers are written
as the shortest text that gives the same double again. Request: ``{"function": name,
"arguments": [...]}``; answer: ``{"rows": [[...]]}`` or ``{"error": sentence, "code": code}``.
"""

from __future__ import annotations

import json
import os
import struct
import sys
from itertools import zip_longest
from typing import Any, BinaryIO

from addin.worksheet.registry import FUNCTIONS, FunctionError, call

#: Longest request. [B] An argument has a quarter of a million cells at the most.
LONGEST = 256 * 1024 * 1024
FAULT = "An error occurred inside torsionbook ({kind}). Please report it with the workbook."


def main() -> None:
    """Serve standard input; whatever else is printed goes to standard error."""
    requests = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    serve(requests, answers)


def serve(requests: BinaryIO, answers: BinaryIO) -> None:
    """Answer until the requests end."""
    while (message := _read(requests)) is not None:
        content = json.dumps(_answer_to(message), allow_nan=False).encode()
        answers.write(struct.pack(">I", len(content)) + content)
        answers.flush()


def answer(function: str, arguments: list[Any]) -> dict[str, Any]:
    """The answer to one call.

    Parameters
    ----------
    function : str
        Name of the function. [name]
    arguments : list
        What its cells hold. [as typed]

    Returns
    -------
    dict
        Key ``rows``, or ``error`` and ``code``. [shown units]
    """
    try:
        return {"rows": call(function, _blanks(function, arguments))}
    except FunctionError as wrong:
        return {"error": wrong.message, "code": wrong.code}
    except Exception as fault:  # a fault of ours: said in the cell, and the next call is served
        sys.excepthook(type(fault), fault, fault.__traceback__)
        return {"error": FAULT.format(kind=type(fault).__name__), "code": "#VALUE!"}


def _blanks(function: str, arguments: list[Any]) -> list[Any]:
    """The arguments, with None for the blank cells that Calc hands over as numbers.

    Calc gives a reference to one blank cell as the number 0, and a blank in a range as an empty
    text. Where 0 means nothing (a text, a handle, a table) it is a blank; elsewhere it stays a
    number, which the function refuses or not.
    """
    known = FUNCTIONS.get(function.upper())
    kinds = [argument.kind for argument in known.arguments] if known else []
    return [
        None if value == 0.0 and kind in ("text", "model", "block") else value
        for value, kind in zip_longest(arguments, kinds[: len(arguments)])
    ]


def _answer_to(message: bytes) -> dict[str, Any]:
    try:
        request = json.loads(message)
        function, arguments = request["function"], request["arguments"]
        if not isinstance(function, str) or not isinstance(arguments, list):
            raise TypeError
    except (ValueError, KeyError, TypeError, RecursionError):
        return {"error": "Invalid request: see addin/libreoffice/worker.py.", "code": "#VALUE!"}
    return answer(function, arguments)


def _read(requests: BinaryIO) -> bytes | None:
    """The next message; None at the end, also in the midst of one."""
    head = requests.read(4)
    if len(head) < 4:
        return None
    (length,) = struct.unpack(">I", head)
    if length > LONGEST:
        return None
    content = requests.read(length)
    return content if len(content) == length else None


if __name__ == "__main__":
    main()
