"""What the command line and the server say of workbooks made to do harm: the same sentences."""

import json
import os
import sys
from pathlib import Path

import pytest
from command_line import torsionbook, torsionbook_process
from spoiled import Packed, archive, honest
from starlette.testclient import TestClient

from addin.server.app import create_app
from addin.server.settings import Settings
from benchmarks.workbook_fuzz import sentence_fault

BOMB = archive(
    [
        *(Packed(n.encode(), d) for n, d in honest().items()),
        Packed(b"xl/media/a.bin", bytes(40 * 2**20)),
    ]
)
WORDS = "as in an attack file"


@pytest.mark.parametrize(
    "words", [["check", "bomb.xlsx"], ["recalc", "bomb.xlsx"], ["export", "bomb.xlsx", "case.json"]]
)
def test_the_command_line(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / "bomb.xlsx").write_bytes(BOMB)
    said = torsionbook(*words, cwd=tmp_path)
    assert said.returncode == 1
    assert WORDS in said.stderr
    assert "Traceback" not in said.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["bomb.xlsx"]


@pytest.mark.skipif(sys.platform == "win32", reason="every name is text there")
def test_a_file_name_that_is_no_text(tmp_path: Path) -> None:
    name = b"-tr\xffin\n.xlsx"
    (tmp_path / os.fsdecode(name)).write_bytes(BOMB)
    said = torsionbook_process("check", "--", os.fsdecode(name), cwd=tmp_path)
    assert said.returncode == 1, said.stderr
    assert WORDS in said.stderr


@pytest.mark.slow
def test_the_server() -> None:
    with TestClient(
        create_app(Settings(workers=1)), base_url="http://127.0.0.1:8765", raise_server_exceptions=False
    ) as client:  # fmt: skip
        for path in ("/api/v1/workbook", "/api/v1/model"):
            said = client.post(path, params={"name": "../../etc/bomb.xlsx"}, content=BOMB)
            assert said.status_code == 422
            message = said.json()["error"]["message"]
            assert WORDS in message
            assert not sentence_fault(message)
            assert "/etc" not in json.dumps(said.json())
            assert "tmp" not in json.dumps(said.json())


def test_every_error_of_a_refused_file_is_in_its_json(tmp_path: Path) -> None:
    """A program that reads the JSON is told the same."""
    (tmp_path / "bomb.xlsx").write_bytes(BOMB)
    said = torsionbook("recalc", "bomb.xlsx", "--json", "bomb.json", cwd=tmp_path)
    assert said.returncode == 1
    content = json.loads((tmp_path / "bomb.json").read_text(encoding="utf-8"))
    assert WORDS in json.dumps(content)
