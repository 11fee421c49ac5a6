"""What the page asks of a file beside its model: inputs, edits, report, verification, comparison, study."""

from __future__ import annotations

import asyncio
import importlib.util
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import Response

from addin.contract.shipped import template_folder
from addin.reading.one_file import WORKBOOK_ENDINGS
from addin.server.answers import Refused, answer
from addin.server.calls import error
from addin.server.file_tasks import REPORTS, FileTask
from addin.server.processes import Busy, TooLong, Work
from addin.server.running_starts import Tell, waited_for
from addin.server.settings import Limits
from addin.server.studies import STUDIES, limited
from addin.server.uploads import (
    MEDIA,
    TemporaryPaths,
    cleaned,
    done,
    inner_name,
    problems_as_json,
    sent_file,
    streamed,
    without_folder,
    wrong_file,
)
from addin.studies.study import wrong_setting
from addin.worksheet.registry import FunctionError
from addin.xlsx.temporary import temporary_folder

#: Longest list of changes, and most of them in one request. [characters, count]
LONGEST_CHANGES, MOST_CHANGES = 6_000, 200
#: Examples to start from, by file name: what each is.
EXAMPLES = {
    "example_proposed": "The proposed design of the paper",
    "example_modified": "The modified design of the paper",
    "example_backlash": "The proposed design with gear clearance, bearings and pull-in",
    "example_motor": "The modified design with the motor's data sheet and a short circuit",
    "example_studies": "The proposed design with the inputs of every study",
}


async def inputs(request: Request, reading: Work, limits: Limits) -> Response:
    """Answer with everything typed in a file, or with what a study of it reads: its tables and settings."""
    what, settings = _of_study(request, "inputs", {})
    body, name = await sent_file(request, limits)
    with temporary_folder() as folder:
        task, paths = await _task(folder, body, name, settings)
        problems, warnings, value = await done(request, reading, what, task)
    return wrong_file(problems, warnings, paths) if problems else answer(value)


async def edited(request: Request, reading: Work, limits: Limits) -> Response:
    """Answer with the file, some of its inputs typed anew; with those of a study it gets the sheets that it lacks."""
    changes = _changes(request.query_params.get("changes", ""))
    what, settings = _of_study(request, "edited", {"changes": changes})
    body, name = await sent_file(request, limits)
    with temporary_folder() as folder:
        task, paths = await _task(folder, body, name, settings)
        problems, warnings, _ = await done(request, reading, what, task)
        if problems:
            return wrong_file(problems, warnings, paths)
        content = await asyncio.to_thread(task.target.read_bytes)
    media = MEDIA.get(Path(name).suffix.lower(), "application/json")
    headers = {"Content-Disposition": f"attachment; filename*=UTF-8''{quote(name)}"}
    return Response(content, media_type=media, headers=headers)


def _of_study(request: Request, task: str, settings: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """A task and its settings; where a study is named, the task of that name for studies."""
    if not request.query_params.get("study"):
        return task, settings
    return f"study_{task}", settings | {"study": _one_of("study", request, STUDIES)}


def _changes(text: str) -> dict[str, Any]:
    """The changes of a request."""
    try:
        changes = json.loads(text) if len(text) <= LONGEST_CHANGES else None
    except ValueError:
        changes = None
    if not isinstance(changes, dict) or not 0 < len(changes) <= MOST_CHANGES:
        raise Refused(
            400,
            f'Give changes as a JSON object of 1 to {MOST_CHANGES} inputs, such as {{"DampingRatio": 1}}, in at most '
            f"{LONGEST_CHANGES:,} characters.",
        )
    return changes


async def report(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with stages and the report, a JSON object a line."""
    form = _one_of("form", request, REPORTS)
    if not all(map(importlib.util.find_spec, REPORTS[form][0])):
        raise Refused(
            501,
            "This server makes no reports. Its administrator can install torsionbook[report].",
        )
    return await _document(request, work, limits, "report", {"form": form})


async def verify(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with stages and the verification, a JSON object a line."""
    return await _document(request, work, limits, "verified", {})


async def study(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with stages and the study, a JSON object a line."""
    command = _one_of("study", request, STUDIES)
    settings = _settings(command, request.query_params.get("settings", "{}"))
    asked = {"study": command, "settings": settings}
    return await _document(request, work, limits, "studied", asked)


def _settings(command: str, text: str) -> dict[str, Any]:
    """The settings of a study, as on the command line."""
    try:
        settings = json.loads(text) if len(text) <= LONGEST_CHANGES else None
    except ValueError:
        settings = None
    if not isinstance(settings, dict):
        raise Refused(400, 'Give settings as a JSON object, such as {"samples": 1000}.')
    if wrong := wrong_setting(command, [*map(limited, STUDIES[command].options)], settings):
        raise Refused(400, wrong)
    return settings


async def diff(request: Request, work: Work, limits: Limits) -> Response:
    """Answer with stages and what differs between two files, a JSON object a line.

    The body is the earlier file and the later one behind it; ``split`` is the size of the first.
    """
    body, name = await sent_file(request, limits)
    split = request.query_params.get("split", "")
    if not split.isascii() or not split.isdigit() or not 0 < int(split) < len(body):
        raise Refused(400, "split must be the size of the first of the two files, in bytes.")
    earlier, later = body[: int(split)], body[int(split) :]
    return _streamed(request, work, (later, _ending(later, name)), "compared", {}, earlier)


def _ending(content: bytes, name: str) -> str:
    """A file name with the ending of what it is."""
    suffix = Path(name).suffix
    if content[:2] != b"PK":
        return f"{Path(name).stem}.json"
    return f"{Path(name).stem}{suffix if suffix in WORKBOOK_ENDINGS else '.xlsx'}"


def _one_of(key: str, request: Request, known: Mapping[str, Any]) -> str:
    word = request.query_params.get(key, "")
    if word not in known:
        raise Refused(400, f"{key} must be one of {', '.join(known)}.")
    return word


async def _document(
    request: Request, work: Work, limits: Limits, name: str, settings: dict[str, Any]
) -> Response:
    return _streamed(request, work, await sent_file(request, limits), name, settings)


def _streamed(
    request: Request, work: Work, file: tuple[bytes, str], task: str, settings: dict[str, Any],
    earlier: bytes | None = None,
) -> Response:  # fmt: skip
    return streamed(request, lambda tell: _last_line(work, file, task, settings, earlier, tell))


async def _last_line(
    work: Work, file: tuple[bytes, str], name: str, settings: dict[str, Any],
    earlier: bytes | None, tell: Tell,
) -> dict[str, Any]:  # fmt: skip
    """What the task gives, or everything wrong with the file."""
    with temporary_folder() as folder:
        if earlier is not None:
            path = Path(folder, _ending(earlier, "earlier.xlsx"))
            await asyncio.to_thread(path.write_bytes, earlier)
            settings = settings | {"earlier": str(path)}
        task, paths = await _task(folder, *file, settings)
        try:
            problems, warnings, value = await waited_for(work.submit(name, task), tell)
        except FunctionError as wrong:
            return error(wrong.message, wrong.code)
        except (Busy, TooLong, RuntimeError) as wrong:
            return error(str(wrong), "#N/A", busy=isinstance(wrong, Busy))
    if problems:
        return problems_as_json(problems, warnings, paths)
    return {"value": _with_own_names(value, paths), "warnings": cleaned(warnings, paths)}


def _with_own_names(value: Any, paths: TemporaryPaths) -> Any:
    """Every sentence with the name of the file outside; contents of files are none."""
    if isinstance(value, dict):
        return {k: v if k == "content" else _with_own_names(v, paths) for k, v in value.items()}
    if isinstance(value, list):
        return [_with_own_names(one, paths) for one in value]
    return without_folder(value, paths)


async def _task(
    folder: str | Path, body: bytes, name: str, settings: Mapping[str, Any]
) -> tuple[FileTask, TemporaryPaths]:
    """The file of a request in its folder."""
    inner = inner_name(name)
    source = Path(folder, inner)
    await asyncio.to_thread(source.write_bytes, body)
    task = FileTask(source, Path(folder, f"out-{inner}"), settings)
    return task, TemporaryPaths(Path(folder), inner, name)


def examples() -> dict[str, bytes]:
    """The shipped examples, by address."""
    folder = template_folder()
    return {f"examples/{name}.xlsx": (folder / f"{name}.xlsx").read_bytes() for name in EXAMPLES}
