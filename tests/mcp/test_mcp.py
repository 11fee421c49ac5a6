"""The MCP server, asked by the client of the official SDK over standard input and output."""

import asyncio
import json
import os
import shutil
import sys
from pathlib import Path

import pytest
from mcp import Client
from mcp.server.mcpserver.exceptions import ToolError
from mcp_client import client, said
from sheet_ranges import SAME_CELLS, TEMPLATES
from typer.testing import CliRunner

from addin.cli.app import app
from addin.mcp.front import Tools, server_of
from addin.mcp.places import PlaceRefused, Places
from addin.reading.one_file import read_checked
from addin.server.bounded_reading import LIMITS
from addin.verify.trace import traced
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FUNCTIONS, call
from addin.writing.recalculate import recalculate

READING = {"check", "run", "explain", "verify", "model", "functions", "call"}


@pytest.mark.slow
def test_a_workbook_is_read_calculated_explained_and_written_as_on_the_command_line(tmp_path):
    trains, results = tmp_path / "trains", tmp_path / "results"
    results.mkdir()
    trains.mkdir()
    shutil.copy(TEMPLATES / "example_proposed.xlsx", trains / "train.xlsx")
    (trains / "broken.json").write_text('{"format": 1}')
    source = trains / "train.xlsx"
    stages_here = []
    recalculate(
        source, destination=tmp_path / "train.out.xlsx", json_file=tmp_path / "train.json",
        on_stage=stages_here.append,
    )  # fmt: skip
    wanted = json.loads((tmp_path / "train.json").read_text())
    handle = MODELS.add(read_checked(source)).handle
    seen, told = {}, {}

    def stages_of(name):
        """Takes progress notifications: how far, of how much, and in words."""
        told[name] = []

        async def take(progress, total, message):
            told[name].append((progress, total, message))

        return take

    async def ask():
        async with client("--read", trains, "--folder", results) as server:
            seen["tools"] = {tool.name: tool for tool in (await server.list_tools()).tools}
            seen["check"] = await said(server, "check", path="train.xlsx")
            seen["broken"] = await said(server, "run", path="broken.json")
            tables = ["startup_peaks", "separation_margins"]
            seen["run"] = await said(
                server, "run", stages_of("run"), path=str(source), tables=tables
            )
            seen["no table"] = await said(server, "run", path="train.xlsx", tables=["peaks"])
            seen["explain"] = await said(
                server, "explain", path="train.xlsx", result="separation margin"
            )
            seen["no result"] = await said(server, "explain", path="train.xlsx", result="nothing")
            seen["model"] = await said(server, "model", path="train.xlsx")
            for name in SAME_CELLS:
                seen[name] = await said(server, "call", function=name, arguments=[handle])
            seen["no function"] = await said(server, "call", function="TV_NONE", arguments=[])
            written = await said(
                server, "recalculate", stages_of("written"), path="train.xlsx", name="a.xlsx"
            )
            seen["written"] = written
            seen["again"] = await said(server, "recalculate", path="train.xlsx", name="a.xlsx")
            seen["verify"] = await said(
                server, "verify", stages_of("verify"), path=written["written"]
            )
            seen["outside"] = await said(server, "check", path="../train.out.xlsx")

    asyncio.run(ask())
    assert set(seen["tools"]) == {*READING, "recalculate"}
    assert {n for n, t in seen["tools"].items() if t.annotations.read_only_hint} == READING
    for stages in told.values():  # each once and in order; how many there will be is not known
        assert [(far, whole) for far, whole, _ in stages] == [
            (number, None) for number in range(1, len(stages) + 1)
        ]
    of_run, of_recalculation = (
        [words for _, _, words in told[name]] for name in ("run", "written")
    )
    for told_words, whole in ((of_recalculation, stages_here), (of_run, stages_here[1:-1])):
        named = told_words[told_words[0] == "waiting for a free process" :]
        in_order = iter(whole)  # one that is over before anybody looks is not told
        assert len(named) > 1
        assert all(one in in_order for one in named)
    assert "start" in [words for _, _, words in told["verify"]]
    for tool in seen["tools"].values():
        assert "context" not in tool.input_schema["properties"]
    assert seen["check"]["problems"] == []
    assert seen["check"]["inputs"]["stations"][0]["station"] == "Motor"
    assert seen["check"]["full_speed"]
    assert seen["broken"]["errors"] != []
    for name in (
        "overall",
        "headline",
        "verdicts",
        "startup",
        "startup_peaks",
        "separation_margins",
    ):
        assert seen["run"][name] == wanted[name]
    assert "mode_shapes" in seen["run"]["other_tables"]
    assert "no such table" in seen["no table"]
    lines = seen["explain"]["trace"]
    (first, *_) = [line for line in lines if line.startswith("Summary!")]
    assert lines == list(traced(tmp_path / "train.out.xlsx", first.partition(" = ")[0]))
    assert "is not a result table" in seen["no result"]
    assert seen["model"]["model"] == handle
    for name in SAME_CELLS:
        assert seen[name]["value"] == json.loads(json.dumps(call(name, [handle])))
    assert "TV_NONE" in seen["no function"]
    written = Path(seen["written"]["written"])
    assert written == results / "a.xlsx"
    assert read_checked(written).data == read_checked(source).data
    assert "is there already" in seen["again"]
    assert seen["verify"]["follows"] is True
    assert "Other files are not read" in seen["outside"]
    assert sorted(p.name for p in results.iterdir()) == ["a.xlsx"]


def test_without_a_folder_there_is_no_tool_that_writes(tmp_path):
    shutil.copy(TEMPLATES / "example_modified.xlsx", tmp_path / "train.xlsx")
    tools = Tools(Places([tmp_path]))

    async def ask():
        async with Client(server_of(tools, writes=False)) as server:
            names = {tool.name for tool in (await server.list_tools()).tools}
            listed = await said(server, "functions")
            return (
                names,
                listed,
                await said(server, "recalculate", path="train.xlsx", name="a.xlsx"),
            )

    names, listed, refused = asyncio.run(ask())
    assert names == READING
    assert listed.keys() == FUNCTIONS.keys()
    assert isinstance(refused, str)
    with pytest.raises(ToolError, match="without --folder"):
        asyncio.run(tools.recalculate("train.xlsx", "a.xlsx"))
    assert [path.name for path in tmp_path.iterdir()] == ["train.xlsx"]


@pytest.mark.skipif(sys.platform == "win32", reason="links and pipes as POSIX has them")
def test_files_elsewhere_are_not_read_and_nothing_is_written_elsewhere(tmp_path):
    inside, outside = tmp_path / "in", tmp_path / "out"
    inside.mkdir()
    outside.mkdir()
    (outside / "a.xlsx").write_bytes(b"PK")
    (inside / "link.xlsx").symlink_to(outside / "a.xlsx")
    (inside / "deep").symlink_to(outside)
    (inside / "own.xlsx").write_bytes(b"PK")
    (inside / "text.txt").write_text("x")
    os.mkfifo(inside / "pipe.xlsx")
    (inside / "folder.xlsx").mkdir()
    with (inside / "large.xlsx").open("wb") as file:
        file.truncate(LIMITS.file_size + 1)
    places = Places([inside], inside)
    assert places.source("own.xlsx") == inside / "own.xlsx"
    assert places.source("none/../own.xlsx") == inside / "own.xlsx"
    for name, words in (
        ("../out/a.xlsx", "Other files are not read"),
        (str(outside / "a.xlsx"), "Other files are not read"),
        ("link.xlsx", "Other files are not read"),
        ("deep/a.xlsx", "Other files are not read"),
        ("/proc/self/environ", "Other files are not read"),
        ("text.txt", "is no workbook"),
        ("none.xlsx", "is not there"),
        ("pipe.xlsx", "is no file"),
        ("folder.xlsx", "is no file"),
        ("large.xlsx", "at most"),
        ("a\0.xlsx", "cannot be read"),
        ("x" * 5000 + ".xlsx", "cannot be read"),
    ):
        with pytest.raises(PlaceRefused, match=words):
            places.source(name)
    own = inside / "own.xlsx"
    (inside / "nowhere.xlsx").symlink_to(outside / "new.xlsx")
    for name, words in (
        ("../b.xlsx", "is no name of a file"),
        (str(outside / "b.xlsx"), "is no name of a file"),
        ("deep/b.xlsx", "is no name of a file"),
        ("..\\b.xlsx", "is no name of a file"),
        ("", "is no name of a file"),
        ("..", "must end with"),
        ("b.xlsm", "must end with .xlsx"),
        ("own.xlsx", "is there already"),
        ("nowhere.xlsx", "is there already"),
    ):
        with pytest.raises(PlaceRefused, match=words):
            places.target(name, own)
    assert places.target("b.xlsx", own) == inside / "b.xlsx"
    with pytest.raises(PlaceRefused, match="without --folder"):
        Places([inside]).target("b.xlsx", own)
    with pytest.raises(PlaceRefused, match="is no folder"):
        Places([inside / "none"])


def test_without_the_sdk_the_command_says_what_to_install(monkeypatch):
    from addin.cli import mcp

    monkeypatch.setattr(mcp, "INSTALLED", False)
    refused = CliRunner().invoke(app, ["mcp"])
    assert refused.exit_code == 2
    assert "requirements/mcp.txt" in refused.output
    assert "extra [mcp]" in refused.output
