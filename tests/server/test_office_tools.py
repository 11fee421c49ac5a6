"""The add-in as Microsoft's own tools read it; `npm ci --prefix tests/server/office_tools` installs them."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from addin.server import office
from addin.worksheet.registry import FUNCTIONS

TOOLS = Path(__file__).parent / "office_tools"
PUBLIC = "https://torsion.example.com"


@pytest.mark.slow
def test_the_tools_read_the_manifest_and_generate_the_metadata_that_is_served(tmp_path):
    if shutil.which("node") is None or not (TOOLS / "node_modules").is_dir():
        pytest.skip("the Office tools are not installed")
    manifest, functions = tmp_path / "manifest.xml", tmp_path / "functions.json"
    manifest.write_bytes(office.manifest(PUBLIC))
    functions.write_text(json.dumps(office.functions_json()))
    said = subprocess.run(
        ["node", TOOLS / "check.mjs", manifest, functions], capture_output=True, text=True, check=True
    )  # fmt: skip
    found = json.loads(said.stdout)
    assert found["errors"] == []
    assert found["manifest"]["officeAppType"] == "TaskPaneApp"
    assert found["manifest"]["hosts"] == ["Workbook"]
    assert found["manifest"]["defaultSettings"]["sourceLocation"] == f"{PUBLIC}/taskpane.html"
    assert len(found["functions"]) == len(FUNCTIONS)
    for ours, theirs in zip(office.functions_json()["functions"], found["functions"], strict=True):
        assert without_defaults(ours) == without_defaults(theirs)


def without_defaults(function):
    """Metadata without what the format has by default."""
    kept = [
        {key: value for key, value in one.items() if value is not False}
        for one in function["parameters"]
    ]
    return {**function, "parameters": kept, "result": {"type": "any", **function["result"]}}
