"""Workbooks for the tests of the package writer, built once and copied for each test."""

import shutil
from pathlib import Path

import pytest
from rich_workbooks import rich_workbook, with_calc_chain

# openpyxl says of each extension that it would lose it; here it only reads.
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("built")
    return {
        "xlsx": with_calc_chain(rich_workbook(folder / "train.xlsx")),
        "xlsm": with_calc_chain(rich_workbook(folder / "train.xlsm", macros=True)),
    }


@pytest.fixture
def train(built: dict[str, Path], tmp_path: Path) -> Path:
    """A rich workbook, the test's own copy."""
    return Path(shutil.copyfile(built["xlsx"], tmp_path / "train.xlsx"))


@pytest.fixture
def macro_train(built: dict[str, Path], tmp_path: Path) -> Path:
    """The same with macros."""
    return Path(shutil.copyfile(built["xlsm"], tmp_path / "train.xlsm"))
