"""A workbook in, the same workbook recalculated out; or what to write into it; or a model of it.

Files live in a temporary folder of one request and are gone before its answer is complete.
"""

from __future__ import annotations

import asyncio
import logging
import re
import secrets
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from addin.contract.problems import CellProblem
from addin.contract.version import product_version
from addin.reading.one_file import WORKBOOK_ENDINGS
from addin.server.answers import Refused, answer, encoded, input_errors
from addin.server.bodies import read_body, while_connected
from addin.server.calls import NO_RESULT, error, without_result
from addin.server.processes import Work
from addin.server.running_starts import Tell, waited_for
from addin.server.settings import OURS, Limits
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FunctionError
from addin.writing.results_json import errors_to_json
from addin.xlsx.temporary import temporary_folder

LOG = logging.getLogger("torsionbook.server")
#: What a workbook is sent back as.
MEDIA = {
    ".xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    ".xlsm": "application/vnd.ms-excel.sheet.macroEnabled.12",
}


async def recalculated(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with the workbook of a request, its result sheets filled."""
    body, name = await sent_file(request, limits)
    _refuse_no_workbook(name)
    with temporary_folder() as folder:
        inner = inner_name(name)
        source, target = Path(folder, inner), Path(folder, f"out-{inner}")
        await asyncio.to_thread(source.write_bytes, body)
        paths = str(source), str(target)
        problems, warnings, _ = await done(request, work, "workbook", paths)
        if problems:
            return wrong_file(problems, warnings, TemporaryPaths(folder, inner, name))
        content = await asyncio.to_thread(target.read_bytes)
    stem, ending = Path(name).stem, Path(name).suffix
    disposition = f"attachment; filename*=UTF-8''{quote(f'{stem}.out{ending}')}"
    return Response(
        content, media_type=MEDIA[ending.lower()], headers={"Content-Disposition": disposition}
    )


async def open_workbook(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with the stages of a recalculation, and what to write into the workbook that is open.

    Each line is one JSON object: ``{"stage": ...}`` as it goes on, at the end ``{"value": ..., "warnings": [...]}``
    with what `addin.writing.open_workbook.rectangles` gives, or ``{"error": ..., "errors": [...]}``.
    """
    body, name = await sent_file(request, limits)
    _refuse_no_workbook(name)
    return streamed(request, lambda tell: _rectangles(work, body, name, tell))


def streamed(request: Request, work: Callable[[Tell], Awaitable[dict[str, Any]]]) -> Response:
    """Answer with the stages of some work and its end, a JSON object a line."""
    # what a proxy in front collects would come at the end
    headers = {"X-Accel-Buffering": "no", "Cache-Control": "no-store"}
    lines = _lines(request, work)
    return StreamingResponse(lines, media_type="application/x-ndjson", headers=headers)


async def _lines(
    request: Request, work: Callable[[Tell], Awaitable[dict[str, Any]]]
) -> AsyncIterator[bytes]:
    """Stages and the end; whoever closes the connection gives the work up."""
    stages: asyncio.Queue[str] = asyncio.Queue()
    ended = asyncio.create_task(while_connected(request, work(stages.put_nowait)))
    stage = asyncio.create_task(stages.get())
    try:
        while True:
            await asyncio.wait({ended, stage}, return_when=asyncio.FIRST_COMPLETED)
            if not stage.done():
                break
            yield encoded({"stage": stage.result()}) + b"\n"
            stage = asyncio.create_task(stages.get())
        try:
            yield await asyncio.to_thread(encoded, ended.result()) + b"\n"
        except Refused:
            return  # nobody reads it
        except Exception:
            LOG.exception("a stream of lines failed")
            yield encoded(error(OURS)) + b"\n"
    finally:
        for task in (ended, stage):
            task.cancel()
        await asyncio.gather(ended, stage, return_exceptions=True)


async def _rectangles(work: Work, body: bytes, name: str, tell: Tell) -> dict[str, Any]:
    """The last line."""
    with temporary_folder() as folder:
        inner = inner_name(name)
        source, target = Path(folder, inner), Path(folder, f"out-{inner}")
        await asyncio.to_thread(source.write_bytes, body)
        try:
            job = work.submit("rectangles", (str(source), str(target)))
            problems, warnings, value = await waited_for(job, tell)
        except NO_RESULT as wrong:
            return without_result(wrong)
    hidden = TemporaryPaths(folder, inner, name)
    if problems:
        return problems_as_json(problems, warnings, hidden)
    return {"value": value, "warnings": cleaned(warnings, hidden)}


async def model_of(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with the handle of the model that a workbook or a case JSON holds."""
    body, name = await sent_file(request, limits)
    if name.endswith(".json"):
        _refuse_no_case(body)
    with temporary_folder() as folder:
        inner = inner_name(name)
        source = Path(folder, inner)
        await asyncio.to_thread(source.write_bytes, body)
        problems, warnings, case, system = await done(request, work, "read", str(source))
    hidden = TemporaryPaths(folder, inner, name)
    if problems:
        return wrong_file(problems, warnings, hidden)
    try:
        model = await asyncio.to_thread(MODELS.add_case, case, system)
    except UnicodeEncodeError:
        raise Refused(
            422,
            "A name or a text of the case contains an invalid character (a lone surrogate, such "
            "as \\ud800). Correct it.",
        ) from None
    return answer(
        {"model": model.handle, "units": model.system, "warnings": cleaned(warnings, hidden)}
    )


def inner_name(name: str) -> str:
    """What a file is called here: the name given may be one that no file can have.

    Nobody has typed this one, so that sentences about the file get the name it has outside.
    """
    return f"{secrets.token_hex(8)}{Path(name).suffix}"


async def done(request: Request, work: Work, task: str, payload: Any) -> Any:
    """The result of a task for a client that waits; 503 or 422 where there is none."""
    try:
        return await while_connected(request, waited_for(work.submit(task, payload)))
    except NO_RESULT as wrong:
        found = without_result(wrong)["error"]
        status = 422 if isinstance(wrong, FunctionError) else 503
        retry = {"Retry-After": "30"} if found.get("busy") else None
        raise Refused(status, found["message"], retry) from None


async def sent_file(request: Request, limits: Limits) -> tuple[bytes, str]:
    """The file and the name it is worked on under: harmless, with the ending of what it is."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().casefold()
    if kind.startswith("multipart/"):
        raise Refused(
            415, "Send the file itself as the body, not as a form (curl --data-binary @train.xlsx)."
        )
    body = await read_body(request, limits.body, limits.body_time)
    if not body:
        raise Refused(
            400, "The body is empty. Send the file itself (curl --data-binary @train.xlsx)."
        )
    last = request.query_params.get("name", "").replace("\\", "/").rpartition("/")[2]
    given = re.sub(r"[^\w .()\-]", "_", last[-80:])
    stem = Path(given).stem.strip(" .") or "train"
    ending = Path(given).suffix.lower()
    if body[:2] != b"PK":
        ending = ".xlsx" if ending in WORKBOOK_ENDINGS else ".json"
    elif ending not in WORKBOOK_ENDINGS:
        ending = ".xlsx"
    return body, f"{stem}{ending}"


def _refuse_no_workbook(name: str) -> None:
    """Refuse what is no workbook."""
    if Path(name).suffix.lower() not in WORKBOOK_ENDINGS:
        raise Refused(415, "Send a workbook, .xlsx or .xlsm. /api/v1/model also takes a case JSON.")


def _refuse_no_case(body: bytes) -> None:
    """Refuse what is neither a workbook nor JSON in braces; of those the reader says what is wrong."""
    begin = body[:200].removeprefix(b"\xef\xbb\xbf").lstrip()
    if begin[:1] in (b"{", b"[") or begin[:2] in (b"\xff\xfe", b"\xfe\xff"):  # UTF-16 is told there
        return
    words = begin[:30].decode("ascii", "replace")
    shown = f", it begins with '{words}'" if words.isprintable() and "\ufffd" not in words else ""
    raise Refused(
        415,
        f"The body is neither a workbook (.xlsx, .xlsm) nor a case JSON{shown}. Send the file itself "
        "(curl --data-binary @train.xlsx).",
    )


@dataclass(frozen=True)
class TemporaryPaths:
    """The folder a file was worked on in, its name there, and the name it goes by outside."""

    folder: Path
    inner: str
    name: str


def wrong_file(
    problems: Iterable[CellProblem], warnings: Iterable[str], folder: TemporaryPaths
) -> Response:
    """422 with every error."""
    return answer(problems_as_json(problems, warnings, folder), 422)


def problems_as_json(
    problems: Iterable[CellProblem], warnings: Iterable[str], folder: TemporaryPaths
) -> dict[str, Any]:
    """Every error, in the form of a result JSON, and one sentence over them."""
    shown = [
        replace(p, message=without_folder(p.message, folder), found=without_folder(p.found, folder))
        for p in problems
    ]
    content: dict[str, Any] = errors_to_json(shown, product_version(), cleaned(warnings, folder))
    return content | {"error": {"message": input_errors(shown)}}


def cleaned(sentences: Iterable[str], folder: TemporaryPaths) -> list[str]:
    return [without_folder(sentence, folder) for sentence in sentences]


def without_folder(text: Any, hidden: TemporaryPaths) -> Any:
    """A sentence with the name of the file outside, without the folder it was worked on in."""
    if not isinstance(text, str):
        return text
    for slash in "/\\":
        text = text.replace(f"{hidden.folder}{slash}{hidden.inner}", hidden.name)
        text = text.replace(f"{hidden.folder}{slash}", "")
    return text.replace(f"out-{hidden.inner}", hidden.name).replace(hidden.inner, hidden.name)
