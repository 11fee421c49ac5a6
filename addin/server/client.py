"""A client of the calculation server, with the standard library alone.

    from addin.server.client import Client

    server = Client("http://127.0.0.1:8765")
    model = server.model("train.xlsx")
    rows = server.call("TV_PEAKS", model)
    server.recalculate("train.xlsx", "train.out.xlsx")
    server.document("report", "train.xlsx", "train.pdf", form="pdf")

This file stands by itself: copied elsewhere it works without torsionbook.
"""

from __future__ import annotations

import base64
import http.client
import json
import math
import os
import ssl
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any


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
            A value, a list (one row) or a list of rows each; None or NaN for a blank. [as typed]

        Returns
        -------
        list of list
            Rows of cells. [shown units]

        Raises
        ------
        Refusal
            If there is no answer.
        """
        (answer,) = self.batch([(name, *arguments)])
        if isinstance(answer, Refusal):
            raise answer
        return answer

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
        prepared: list[Any] = [_as_json(name, given) for name, *given in calls]
        sent = ",".join(text for text in prepared if isinstance(text, str))
        if not sent:
            return prepared
        body = f'{{"calls": [{sent}]}}'.encode()
        results = iter(json.loads(self._post("/api/v1/batch", body, "application/json"))["results"])
        return [_answer(next(results)) if isinstance(text, str) else text for text in prepared]

    def model(self, path: str | Path) -> str:
        """The handle of the model in a workbook or a case JSON.

        Raises
        ------
        Refusal
            With everything that is wrong in it.
        """
        return str(json.loads(self._file("/api/v1/model", path))["model"])

    def recalculate(self, path: str | Path, target: str | Path) -> None:
        """Have a workbook recalculated.

        Raises
        ------
        Refusal
            With everything that is wrong in it; nothing is written then.
        """
        _write(target, self._file("/api/v1/workbook", path))

    def inputs(self, path: str | Path) -> dict[str, Any]:
        """Scalars and tables of a file as typed.

        Raises
        ------
        Refusal
            With everything that is wrong in it.
        """
        return dict(json.loads(self._file("/api/v1/inputs", path)))

    def edit(self, path: str | Path, target: str | Path, changes: Mapping[str, Any]) -> None:
        """Have a file written with some inputs typed anew.

        Parameters
        ----------
        path, target : path
            The file as it is, and where the new one goes. [path]
        changes : mapping
            Values by the names of the inputs. [as typed]

        Raises
        ------
        Refusal
            If a name or a value is none; nothing is written then.
        """
        wanted = json.dumps(changes, allow_nan=False)
        _write(target, self._file("/api/v1/edited", path, changes=wanted))

    def document(
        self,
        what: str,
        path: str | Path,
        target: str | Path | None = None,
        *,
        earlier: str | Path | None = None,
        **asked: str,
    ) -> list[dict[str, Any]]:
        """What is reported, verified, compared or studied.

        Parameters
        ----------
        what : str
            ``report`` (with ``form="pdf"`` or ``"docx"``), ``verify``, ``diff`` (with `earlier`) or ``study`` (with
            ``study="tune"`` and so on).
        path : path
            The file. [path]
        target : path, optional
            Where the file goes that is made: the report, or the workbook with its study. [path]
        earlier : path, optional
            The file that it is compared with. [path]
        **asked : str
            As above.

        Returns
        -------
        list of dict
            Blocks: ``text``, or ``title`` and ``rows`` of cells. [shown units]

        Raises
        ------
        Refusal
            With everything that is wrong in it; nothing is written then.
        """
        before = b"" if earlier is None else Path(earlier).read_bytes()
        if earlier is not None:
            asked["split"] = str(len(before))
        *_, last = self._file(f"/api/v1/{what}", path, before, **asked).splitlines()
        told = json.loads(last)
        if "error" in told:
            raise _told(told)
        made = told["value"]["files"]
        if target is not None and made:
            _write(target, base64.b64decode(made[0]["content"]))
        return list(told["value"]["blocks"])

    def _file(self, route: str, path: str | Path, before: bytes = b"", **asked: str) -> bytes:
        query = urllib.parse.urlencode({"name": Path(path).name, **asked})
        return self._post(
            f"{route}?{query}", before + Path(path).read_bytes(), "application/octet-stream"
        )

    def _post(self, route: str, body: bytes, kind: str) -> bytes:
        headers = {**self._headers, "Content-Type": kind}
        request = urllib.request.Request(self._address + route, body, headers)
        try:
            with urllib.request.urlopen(request, timeout=self._timeout) as response:
                return bytes(response.read())
        except urllib.error.HTTPError as refused:
            raise _refusal(refused) from None
        except (
            OSError,
            http.client.HTTPException,
        ) as wrong:  # the second where it ends within its answer
            reason = getattr(wrong, "reason", wrong)
            hint = ""
            if isinstance(reason, ssl.SSLCertVerificationError):
                hint = (
                    " Its certificate is not trusted here: set the environment variable SSL_CERT_FILE to "
                    "the file of that certificate or of its issuer."
                )
            raise Refusal(f"{self._address} cannot be reached: {reason}.{hint}") from None


def _write(target: str | Path, content: bytes) -> None:
    """Write a file; one that was there stays until the new one is whole."""
    place = Path(os.path.realpath(target))
    made = place.with_name(f".torsionbook-{os.getpid()}.part")
    try:
        made.write_bytes(content)
        os.replace(made, place)
    finally:
        made.unlink(missing_ok=True)


def _as_json(name: str, given: Sequence[Any]) -> str | Refusal:
    """A call as it is sent, or why it cannot be."""
    try:
        return json.dumps({"name": name, "arguments": _without_nan(given)}, allow_nan=False)
    except ValueError:
        return Refusal(
            f"{name}: an argument is infinite, which no cell holds. Give finite numbers, and None "
            "for a blank."
        )
    except TypeError as wrong:
        return Refusal(
            f"{name}: an argument cannot be sent ({wrong}). Give numbers, texts, True, False, None, "
            "or lists of them."
        )


def _without_nan(value: Any) -> Any:
    """NaN is a blank, as in a table of pandas."""
    if isinstance(value, (list, tuple)):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and math.isnan(value) else value


def _answer(result: dict[str, Any]) -> Any:
    """The rows of one call, or why there are none."""
    if "error" in result:
        return Refusal(result["error"]["message"], result["error"]["code"])
    return result["value"]


def _told(content: dict[str, Any]) -> Refusal:
    error = content["error"]
    return Refusal(error["message"], error.get("code", ""), content.get("errors", ()))


def _refusal(refused: urllib.error.HTTPError) -> Refusal:
    try:
        return _told(json.load(refused))
    except (ValueError, KeyError, TypeError):
        return Refusal(
            f"The server answered with status {refused.code}. See the log of the server."
        )
