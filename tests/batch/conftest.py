"""Folders of workbooks that differ in a number."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from batch_helpers import make_train


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four trains, and one with the case of the second and a tag of its own."""
    folder = tmp_path_factory.mktemp("made")
    for number in range(4):
        make_train(folder / f"train {number + 7}.xlsx", number)
    make_train(folder / "twin.xlsx", 1, Tag="its own")
    return folder


@pytest.fixture
def trains(made: Path, tmp_path: Path) -> Path:
    """A copy of those, to be changed."""
    return Path(shutil.copytree(made, tmp_path / "trains"))


@pytest.fixture
def pair(made: Path, tmp_path: Path) -> Path:
    """Two of them that differ."""
    (tmp_path / "trains").mkdir()
    for name in ("train 8.xlsx", "train 9.xlsx"):
        shutil.copy2(made / name, tmp_path / "trains")
    return tmp_path / "trains"


@pytest.fixture
def few(made: Path, tmp_path: Path) -> Path:
    """Two of them and the twin."""
    (tmp_path / "trains").mkdir()
    for name in ("train 8.xlsx", "train 9.xlsx", "twin.xlsx"):
        shutil.copy2(made / name, tmp_path / "trains")
    return tmp_path / "trains"
