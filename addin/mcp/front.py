"""The tools of the MCP server, over standard input and output."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, closing
from functools import cached_property
from pathlib import Path
from typing import Any

from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from addin.contract.problems import CellProblem, printable
from addin.contract.version import product_version
from addin.mcp.places import PlaceRefused, Places
from addin.mcp.tasks import answer_of
from addin.server.calls import NO_RESULT, Asked, Calls, read_call, without_result
from addin.server.processes import Work
from addin.server.running_starts import Starts, Tell, waited_for
from addin.server.settings import OURS, Limits
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FUNCTIONS
from addin.writing.results_json import errors_to_json, results_to_json
from addin.xlsx.temporary import temporary_folder

#: What an assistant reads of this server.
INSTRUCTIONS = (
    "Torsional vibration of synchronous-motor trains. Inputs are workbooks and case JSON of torsionbook. "
    "`check` says what is wrong or missing, `run` calculates, `explain` traces a verdict or another result to its "
    "equation and inputs, `verify` says whether recorded results follow from the inputs. Report a verdict with what it "
    "does not cover, as `run` gives it; never a number of your own. Numbers of `run` are SI."
)
#: Tables of `run` that are given without being asked for; the other tables are named.
_ALWAYS = ("verdicts", "case_verdicts", "full_speed", "startup", "warnings", "errors")
_READS = ToolAnnotations(read_only_hint=True, open_world_hint=False)
_WRITES = ToolAnnotations(read_only_hint=False, destructive_hint=False, open_world_hint=False)


@asynccontextmanager
async def _stages(context: Context[Any] | None) -> AsyncIterator[Tell]:
    """Something to tell the stages of a task, which are reported in order and before its answer.

    Progress counts the stages that were told; how many there will be is not known, and no total is given.
    A client that asked for no progress gets none.
    """
    told: asyncio.Queue[str | None] = asyncio.Queue()

    async def report() -> None:
        number = 0
        while (stage := await told.get()) is not None:
            number += 1
            if context is not None:
                await context.report_progress(number, message=stage)

    reporting = asyncio.create_task(report())
    try:
        yield told.put_nowait
        told.put_nowait(None)
        await reporting
    finally:
        reporting.cancel()


class Tools:
    """What an assistant can ask for; each tool's documentation is what it reads.

    Parameters
    ----------
    places : Places
        Which files may be read, and where one may be written.
    """

    def __init__(self, places: Places) -> None:
        self._places = places

    @cached_property
    def _work(self) -> Work:
        """The process that calculates, started when it is first needed."""
        limits = Limits()
        return Work(1, limits.waiting, limits.long_time, answer_of=answer_of)

    @cached_property
    def _starts(self) -> Starts:
        return Starts(self._work)

    @cached_property
    def _calls(self) -> Calls:
        return Calls(self._starts, Limits())

    def close(self) -> None:
        """End what was started."""
        for started in ("_calls", "_work"):
            if started in vars(self):
                vars(self)[started].close()

    async def check(self, path: str, context: Context[Any] | None = None) -> dict[str, Any]:
        """Read a workbook or case JSON without calculating: errors with their cells, notes, what is missing, the inputs in SI."""
        source = self._source(path)
        checked, inputs = await self._done("check", str(source), context)
        return {
            "problems": _problems(checked.problems)["errors"],
            "notes": list(checked.notes),
            "full_speed": checked.full_speed,
            "not_yet_available": list(checked.open_answers),
            "inputs": inputs,
        }

    async def run(
        self, path: str, tables: list[str] | None = None, context: Context[Any] | None = None
    ) -> dict[str, Any]:
        """Calculate a workbook or case JSON and give verdicts, warnings and the result tables named; SI, nothing is written."""
        problems, warnings, model = await self._model(path)
        if problems:
            return _problems(problems, warnings)
        async with _stages(context) as tell:
            result = await self._waited(self._starts.ready(model, tell))
        if isinstance(result, Exception):
            raise ToolError(str(result))
        content = results_to_json(result, product_version())
        listed = [name for name, value in content.items() if isinstance(value, (list, dict))]
        wrong = [name for name in tables or () if name not in listed]
        if wrong:
            raise ToolError(f"{', '.join(wrong)}: no such table. There are {', '.join(listed)}.")
        left_out = [n for n in listed if n not in (*_ALWAYS, *(tables or ()))]
        return {
            **{name: value for name, value in content.items() if name not in left_out},
            "warnings": [*warnings, *(w for w in content["warnings"] if w not in warnings)],
            "other_tables": left_out,
        }

    async def explain(
        self, path: str, result: str, context: Context[Any] | None = None
    ) -> dict[str, Any]:
        """Explain a result of a workbook, calculated anew from its inputs: meaning, equation, and the cells it comes from.

        `result` is the beginning of a check in the verdicts (Separation margin), a table (SteadyState), a column
        (SteadyState.Torque) or a cell (Results!AW9).
        """
        source = self._source(path)
        with temporary_folder() as folder:
            target = Path(folder, f"calculated{source.suffix}")
            asked = str(source), str(target), result
            problems, lines = await self._done("explain", asked, context)
        return _problems(problems) if problems else {"trace": lines}

    async def verify(self, path: str, context: Context[Any] | None = None) -> dict[str, Any]:
        """Calculate from the inputs in a workbook and compare every result recorded in it."""
        found = await self._done("verify", str(self._source(path)), context)
        return dict(found)

    async def model(self, path: str) -> dict[str, Any]:
        """The handle of a workbook or case JSON, for the functions that take a model."""
        problems, warnings, model = await self._model(path)
        if problems:
            return _problems(problems, warnings)
        return {"model": model.handle, "units": model.system, "warnings": list(warnings)}

    async def functions(self) -> dict[str, Any]:
        """The worksheet functions: what each shows and takes."""
        return {
            name: {"help": one.help, "arguments": {a.name: a.help for a in one.arguments}}
            for name, one in FUNCTIONS.items()
        }

    async def call(
        self, function: str, arguments: list[Any], context: Context[Any] | None = None
    ) -> dict[str, Any]:
        """The cells a worksheet function shows: rows. An argument is a value, a row or rows; null is a blank."""
        wanted = read_call({"name": function, "arguments": arguments}, "The call")
        with closing(self._calls.new_unsent_cells()) as room:
            async with _stages(context) as tell:
                (answer,) = await self._calls.answers(Asked([wanted], room, tell=tell))
        if "error" in answer:
            raise ToolError(f"{answer['error']['code']}: {answer['error']['message']}")
        return answer

    async def recalculate(
        self, path: str, name: str, context: Context[Any] | None = None
    ) -> dict[str, Any]:
        """Write a workbook with its result sheets filled to a new file of the folder this server may write to."""
        source = self._source(path)
        if source.suffix.lower() == ".json":
            raise ToolError("A case JSON has no result sheets. Use the tool run.")
        target = self._place(lambda: self._places.target(name, source))
        with temporary_folder() as folder:
            inner = Path(folder, target.name)
            paths = str(source), str(inner)
            problems, warnings, _ = await self._done("workbook", paths, context)
            if problems:
                return _problems(problems, warnings)
            try:
                await asyncio.to_thread(_write_new, target, inner)
            except FileExistsError:
                raise ToolError(f"{name} is there already. Give another name.") from None
            except OSError as wrong:
                raise ToolError(f"{name} cannot be written: {wrong.strerror}.") from None
        return {"written": str(target), "warnings": list(map(printable, warnings))}

    def _source(self, path: str) -> Path:
        return self._place(lambda: self._places.source(path))

    def _place(self, find: Callable[[], Path]) -> Path:
        try:
            return find()
        except PlaceRefused as wrong:
            raise ToolError(str(wrong)) from None

    async def _model(self, path: str) -> tuple[Sequence[CellProblem], Sequence[str], Any]:
        """Problems and warnings of an input, and its model where there are no problems."""
        source = self._source(path)
        problems, warnings, case, system = await self._done("read", str(source))
        model = None if problems else await asyncio.to_thread(MODELS.add_case, case, system)
        return problems, warnings, model

    async def _done(self, task: str, payload: Any, context: Context[Any] | None = None) -> Any:
        async with _stages(context) as tell:
            return await self._waited(waited_for(self._work.submit(task, payload), tell))

    async def _waited(self, ending: Awaitable[Any]) -> Any:
        """What a task gives, or why there is nothing as what an assistant reads."""
        try:
            return await ending
        except NO_RESULT as wrong:
            raise ToolError(without_result(wrong)["error"]["message"]) from None
        except Exception:
            raise ToolError(OURS) from None


def _problems(problems: Sequence[CellProblem], warnings: Sequence[str] = ()) -> dict[str, Any]:
    """Every error, in the form of a result JSON."""
    found: dict[str, Any] = errors_to_json(problems, product_version(), warnings)
    return found


def _write_new(target: Path, made: Path) -> None:
    """Write a file that must not be there yet, not even as a link."""
    content = made.read_bytes()
    with target.open("xb") as file:
        try:
            file.write(content)
            file.flush()
        except OSError:  # such as a full disk: no part of a workbook stays
            target.unlink()
            raise


def server_of(tools: Tools, *, writes: bool) -> MCPServer[Any]:
    """The server, with the tool that writes where there is a folder for it."""
    server: MCPServer[Any] = MCPServer(
        "torsionbook", version=product_version(), instructions=INSTRUCTIONS, log_level="WARNING"
    )
    reading = (
        tools.check, tools.run, tools.explain, tools.verify, tools.model, tools.functions, tools.call,
    )  # fmt: skip
    for tool in reading:
        server.tool(annotations=_READS, structured_output=False)(tool)
    if writes:
        server.tool(annotations=_WRITES, structured_output=False)(tools.recalculate)
    return server


def run(places: Places) -> None:
    """Serve on standard input and output until the input ends."""
    tools = Tools(places)
    try:
        server_of(tools, writes=places.write is not None).run("stdio")
    finally:
        tools.close()
