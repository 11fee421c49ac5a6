"""What conftest.py promises: who is skipped, who fails, who is left out, and what soffice does."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).resolve().parents[1] / "conftest.py"
PYPROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"

TESTS = """
import pytest

@pytest.mark.needs_libreoffice
def test_marked(): pass

def test_by_fixture(soffice): pass

@pytest.mark.slow
def test_slow(): pass

def test_plain(): pass
"""


def outcomes(folder: Path, tests: str = TESTS, **variables: str) -> tuple[int, str]:
    (folder / "conftest.py").write_text(CONFTEST.read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "pyproject.toml").write_text(PYPROJECT.read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "test_it.py").write_text(tests, encoding="utf-8")
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("TORSIONBOOK_", "PYTEST_"))}
    # Of all plugins that are installed, the one that conftest.py counts on.
    clean["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-p",
            "no:cacheprovider",
            "-p",
            "_hypothesis_pytestplugin",
            "test_it.py",
        ],
        cwd=folder,
        env=clean | variables,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return done.returncode, done.stdout


PROPERTIES = """
from hypothesis import given, strategies as st

@given(st.integers())
def test_property(x):
    print("tried", x)

def test_plain(): pass
"""


def test_properties_try_the_same_examples_each_time(tmp_path):
    (tmp_path / "first").mkdir()
    (tmp_path / "second").mkdir()
    said = [
        outcomes(folder, PROPERTIES, PYTEST_ADDOPTS="-s", TORSIONBOOK_RUN_SLOW="1")[1]
        for folder in (tmp_path / "first", tmp_path / "second")
    ]
    tried = [[line for line in text.split("\n") if "tried" in line] for text in said]
    assert len(tried[0]) >= 50
    assert tried[0] == tried[1]
    assert not (tmp_path / "first" / ".hypothesis" / "examples").exists()


@pytest.mark.parametrize(("until", "outcome"), [("inf", "1 passed"), ("0", "1 skipped")])
def test_explore_runs_the_properties_until_its_time_is_up(tmp_path, until, outcome):
    status, said = outcomes(
        tmp_path,
        PROPERTIES,
        TORSIONBOOK_EXPLORE_UNTIL=until,
        TORSIONBOOK_EXPLORE_SEED="1",
        PYTEST_ADDOPTS="-m hypothesis --hypothesis-profile=explore --hypothesis-seed=1",
    )
    assert status == 0
    assert f"{outcome}, 1 deselected" in said


def test_missing_libreoffice_is_a_skip_with_its_reason(tmp_path):
    status, said = outcomes(tmp_path, TORSIONBOOK_SOFFICE=str(tmp_path / "none"))
    assert status == 0
    assert "1 passed, 2 skipped, 1 deselected" in said
    assert "LibreOffice (soffice) is not installed" in said


def test_require_all_turns_it_into_a_failure(tmp_path):
    status, said = outcomes(
        tmp_path, TORSIONBOOK_SOFFICE=str(tmp_path / "none"), TORSIONBOOK_REQUIRE_ALL="1"
    )
    assert status == 1
    assert "LibreOffice (soffice) is not installed" in said
    assert "2 failed, 1 passed, 1 deselected" in said or "1 passed, 1 deselected, 2 errors" in said


def test_require_all_refuses_a_module_that_skips_itself(tmp_path):
    tests = "import pytest\npytest.importorskip('no_such_module')\ndef test_it(): pass\n"
    assert outcomes(tmp_path, tests)[0] == 5  # nothing was collected
    status, said = outcomes(tmp_path, tests, TORSIONBOOK_REQUIRE_ALL="1")
    assert status not in (0, 5)
    assert "no_such_module" in said


def test_slow_tests_run_when_asked(tmp_path):
    status, said = outcomes(
        tmp_path, TORSIONBOOK_SOFFICE=str(tmp_path / "none"), TORSIONBOOK_RUN_SLOW="1"
    )
    assert status == 0
    assert "2 passed, 2 skipped" in said


def test_tests_measured_to_be_slow_are_there():
    root = Path(__file__).resolve().parents[2]
    names = (root / "tests" / "slow_tests.txt").read_text("utf-8").split()
    texts = {
        file: (root / file).read_text("utf-8") for file in {n.partition("::")[0] for n in names}
    }
    gone = [n for n in names if f"def {n.rpartition('::')[2]}(" not in texts[n.partition("::")[0]]]
    assert names
    assert not gone, "take their lines out of tests/slow_tests.txt"


def test_long_tests_run_when_asked_only(tmp_path):
    tests = "import pytest\n@pytest.mark.long\ndef test_it(): pass\n"
    assert "1 deselected" in outcomes(tmp_path, tests, TORSIONBOOK_RUN_SLOW="1")[1]
    assert "1 passed" in outcomes(tmp_path, tests, TORSIONBOOK_RUN_LONG="1")[1]


def make_stale_workbook(path: Path) -> None:
    """A1 = 3, A2 = 2 × A1 with a wrong cached value."""
    import xlsxwriter

    with xlsxwriter.Workbook(path) as book:
        sheet = book.add_worksheet("Data")
        sheet.write_number("A1", 3.0)
        sheet.write_formula("A2", "=2*A1", None, 99.0)


def test_soffice_recalculates_stale_caches(soffice, tmp_path):
    import openpyxl

    source = tmp_path / "stale.xlsx"
    make_stale_workbook(source)
    assert openpyxl.load_workbook(source, data_only=True)["Data"]["A2"].value == 99.0
    made = soffice.convert(source, "xlsx", tmp_path / "out")
    assert made == tmp_path / "out" / "stale.xlsx"
    assert openpyxl.load_workbook(made, data_only=True)["Data"]["A2"].value == 6.0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out", "stale.xlsx"]


def test_soffice_renders_pages(soffice, tmp_path):
    source = tmp_path / "stale.xlsx"
    make_stale_workbook(source)
    pages = soffice.pages(source, outdir=tmp_path / "png")
    assert len(pages) == 1
    assert pages[0].stat().st_size > 500


@pytest.mark.slow
def test_soffice_says_when_it_made_nothing(soffice, tmp_path):
    broken = tmp_path / "broken.xlsx"
    broken.write_bytes(b"PK\x03\x04 not a workbook")
    with pytest.raises(RuntimeError, match=r"LibreOffice made no xlsx of .*broken\.xlsx"):
        soffice.convert(broken, "xlsx", tmp_path / "out")
