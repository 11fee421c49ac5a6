"""One calculated workbook for all tests of verification, copied by each."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate
from addin.xlsx import Workbook, open_workbook


@pytest.fixture(scope="session")
def calculated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the proposed example, calculated: train.xlsx, train.results.json, case.xlsx."""
    folder = tmp_path_factory.mktemp("calculated")
    case = Path(shutil.copyfile(template_path("example_proposed.xlsx"), folder / "case.xlsx"))
    done = recalculate(
        case, destination=folder / "train.xlsx", json_file=folder / "train.results.json"
    )
    assert not done.problems
    return folder


@pytest.fixture
def train(calculated: Path, tmp_path: Path) -> Path:
    """The calculated workbook, the test's own copy."""
    return Path(shutil.copyfile(calculated / "train.xlsx", tmp_path / "train.xlsx"))


@pytest.fixture
def edited(train: Path, tmp_path: Path) -> Callable[[Callable[[Workbook], None]], Path]:
    """The workbook as somebody saved it after an edit; formulas are calculated anew as Excel does."""

    def save(edit: Callable[[Workbook], None]) -> Path:
        workbook = open_workbook(train)
        edit(workbook)
        workbook.save(tmp_path / "edited.xlsx")
        return tmp_path / "edited.xlsx"

    return save
