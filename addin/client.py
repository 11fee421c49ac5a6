"""A client of the calculation server, with the standard library alone.

    from addin.client import Client

    server = Client("http://127.0.0.1:8765")
    model = server.model("train.xlsx")
    rows = server.call("TV_PEAKS", model)
    server.recalculate("train.xlsx", "train.out.xlsx")

This file stands by itself: copied elsewhere it works without torsionbook.
"""

from __future__ import annotations

import json
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

__all__ = ["Client", "Refusal"]


class Refusal(Exception):
    """What the server said instead of an answer.

    Parameters
    ----------
    message : str
        Why, and what to do. [sentence]
    code : str
        What a cell would show, such as ``#N/A``; empty for a request as a whole. [code]
    errors : sequence of dict
        Everything wrong with a workbook, each with sheet, table, row and column.
    """

    def __init__(self, message: str, code: str = "", errors: Sequence[dict[str, Any]] = ()) -> None:
        super().__init__(message)
        self.message = message
        self.code = code
        self.errors = tuple(errors)


class Client:
    """One server.

    Parameters
    ----------
    address : str
        Such as ``https://torsion.example.com``. [URL]
    key : str
        API key, where the server asks for one. [text]
    timeout : float
        Longest wait for one answer. [s]
    """

    def __init__(
        self, address: str = "http://127.0.0.1:8765", key: str = "", timeout: float = 900.0
    ) -> None:
        self._address = address.rstrip("/")
        self._headers = {"X-API-Key": key} if key else {}
        self._timeout = timeout

    def call(self, name: str, *arguments: Any) -> list[list[Any]]:
        """The cells a function shows.

        Parameters
        ----------
        name : str
            Name of the function. [name]
        *arguments : object
            A value, a list (one row) or a list of rows each; None for a blank. [as typed]

        Returns
        -------
        list of list
            Rows of cells. [shown units]

        Raises
        ------
        Refusal
            If there is no answer.
        """
        (found,) = self.batch([(name, *arguments)])
        if isinstance(found, Refusal):
            raise found
        return found

    def batch(self, calls: Iterable[Sequence[Any]]) -> list[list[list[Any]] | Refusal]:
        """The answers of many calls in one request.

        Parameters
        ----------
        calls : iterable of sequence
            Name and arguments of each.

        Returns
        -------
        list of (list of list, or Refusal)
            In the same order; what has no answer says why. [shown units]
        """
        sent = {"calls": [{"name": name, "arguments": given} for name, *given in calls]}
        body = json.dumps(sent, allow_nan=False).encode()
        said = json.loads(self._post("/api/v1/batch", body, "application/json"))
        return [
            Refusal(one["error"]["message"], one["error"]["code"])
            if "error" in one
            else one["value"]
            for one in said["results"]
        ]

    def model(self, path: str | Path) -> str:
        """The handle of the model in a workbook or a case JSON.

        Parameters
        ----------
        path : str or Path
            The file. [path]

        Returns
        -------
        str
            For the functions that take a model. [text]

        Raises
        ------
        Refusal
            With everything that is wrong in it.
        """
        return str(json.loads(self._file("/api/v1/model", path))["model"])

    def recalculate(self, path: str | Path, target: str | Path) -> None:
        """Have a workbook recalculated.

        Parameters
        ----------
        path : str or Path
            The workbook. [path]
        target : str or Path
            Where the recalculated one is written. [path]

        Raises
        ------
        Refusal
            With everything that is wrong in it; nothing is written then.
        """
        Path(target).write_bytes(self._file("/api/v1/workbook", path))

    def _file(self, route: str, path: str | Path) -> bytes:
        name = urllib.parse.quote(Path(path).name)
        return self._post(
            f"{route}?name={name}", Path(path).read_bytes(), "application/octet-stream"
        )

    def _post(self, route: str, body: bytes, kind: str) -> bytes:
        headers = {**self._headers, "Content-Type": kind}
        request = urllib.request.Request(self._address + route, body, headers)
        try:
            with urllib.request.urlopen(request, timeout=self._timeout) as said:
                return bytes(said.read())
        except urllib.error.HTTPError as refused:
            raise _refusal(refused) from None
        except urllib.error.URLError as wrong:
            raise Refusal(f"{self._address} cannot be reached: {wrong.reason}.") from None


def _refusal(refused: urllib.error.HTTPError) -> Refusal:
    try:
        content = json.load(refused)
        return Refusal(content["error"]["message"], errors=content.get("errors", ()))
    except (ValueError, KeyError, TypeError):
        return Refusal(f"The server answered with status {refused.code}.")
