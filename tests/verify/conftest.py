"""One calculated workbook for all tests of verification, copied by each."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from addin.xlsx import Workbook, open_workbook


@pytest.fixture(scope="session")
def calculated(examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the proposed example, calculated: train.xlsx, train.results.json, case.xlsx."""
    folder = tmp_path_factory.mktemp("calculated")
    shutil.copyfile(examples / "proposed.in.xlsx", folder / "case.xlsx")
    shutil.copyfile(examples / "proposed.xlsx", folder / "train.xlsx")
    shutil.copyfile(examples / "proposed.results.json", folder / "train.results.json")
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
