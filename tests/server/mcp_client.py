"""`torsionbook mcp` as a process, asked by the client of the official SDK."""

import json
import os
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from mcp import Client, StdioServerParameters

ROOT = Path(__file__).resolve().parents[2]


@asynccontextmanager
async def client(*words: object) -> AsyncIterator[Client]:
    command = StdioServerParameters(
        command=sys.executable,
        args=["-m", "addin.cli", "mcp", *map(str, words)],
        env=dict(os.environ),
        cwd=ROOT,
    )
    async with Client(command) as found:
        yield found


async def said(server: Client, tool: str, progress: Any = None, **arguments: Any) -> Any:
    """What a tool gives, or its refusal as text; its progress notifications go to `progress`."""
    answer = await server.call_tool(tool, arguments, progress_callback=progress)
    (content,) = answer.content
    return content.text if answer.is_error else json.loads(content.text)
