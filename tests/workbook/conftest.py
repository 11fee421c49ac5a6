"""Workbooks with results, written once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from addin.xlsx import SaveReport


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example with the results of a made-up run; tests copy what they change."""
    from made_up_run import SOURCE, STAMP, made_up_run

    from addin.writing.workbook import write_results

    target = tmp_path_factory.mktemp("written") / "results.xlsx"
    write_results(SOURCE, target, made_up_run(), STAMP)
    return target


@pytest.fixture(scope="session")
def retyped(tmp_path_factory: pytest.TempPathFactory) -> SaveReport:
    """The same after an engineer typed two other units, one unreadable, and chose what is drawn."""
    from made_up_run import SOURCE, STAMP, made_up_run
    from workbook_checks import type_unit

    from addin.writing.workbook import write_results
    from addin.xlsx import open_workbook

    folder = tmp_path_factory.mktemp("retyped")
    workbook = open_workbook(SOURCE)
    type_unit(workbook, "TorqueReversals", "Transmitted torque", "kN*m")
    type_unit(workbook, "StartupPeaks", "Time", "furlong")
    workbook.set_name("PlotElement2", "Pinion shaft")
    workbook.save(folder / "source.xlsx")
    return write_results(folder / "source.xlsx", folder / "out.xlsx", made_up_run(), STAMP)
