"""Run the notebooks of docs/ and keep what they print: ``python scripts/notebook.py docs/notebooks/*.ipynb``.

A notebook is JSON; its cells are run as a script, in a folder of their own, so that nothing but torsionbook is
needed. tests/docs runs them in the same way and compares.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any


def printed(notebook: dict[str, Any]) -> list[str]:
    """What each code cell prints, run one after the other in one namespace."""
    names: dict[str, Any] = {"__name__": "__main__"}
    texts = []
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for number, cell in enumerate(code_cells(notebook), start=1):
                source = "".join(cell["source"])
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    exec(compile(source, f"cell {number}", "exec"), names)
                texts.append(out.getvalue())
        finally:
            os.chdir(here)
    return texts


def code_cells(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    """The cells that are run."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def kept(cell: dict[str, Any]) -> str:
    """What a notebook says that a cell has printed."""
    return "".join("".join(output["text"]) for output in cell["outputs"])


def main() -> int:
    """Run the named notebooks and write what they print into them."""
    for name in sys.argv[1:]:
        path = Path(name)
        notebook = json.loads(path.read_text(encoding="utf-8"))
        for number, (cell, text) in enumerate(
            zip(code_cells(notebook), printed(notebook), strict=True), start=1
        ):
            cell["execution_count"] = number
            lines = text.splitlines(keepends=True)
            cell["outputs"] = (
                [{"name": "stdout", "output_type": "stream", "text": lines}] if lines else []
            )
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
