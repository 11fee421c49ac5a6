"""The study of accuracy and an earlier revision in a report, and what it says of both."""

from __future__ import annotations

import datetime as dt
import json
import math
import re
import shutil

import docx
import numpy as np
import openpyxl
import pytest
import scipy.linalg
from report_files import ROOT, docx_text, flat, pdf_text, torsionbook

from addin.reading.workbook import read_workbook
from addin.report.make import report
from addin.writing.workbook import RunStamp, write_study
from engine.case.data import case_digest

PROPOSED = ROOT / "templates" / "example_proposed.xlsx"
MODIFIED = ROOT / "templates" / "example_modified.xlsx"
ROWS = [
    {"method": "exponential", "setting": "tolerance 0.01", "error_peak": 4.7e-5,
     "error_starts": 3.1e-4, "time": 0.0123},
    {"method": "exponential", "setting": "tolerance 0.001", "error_peak": 5.3e-6,
     "error_starts": 2.2e-5, "time": 0.0456},
    {"method": "newmark", "setting": "step 0.002 s", "error_peak": 0.0172,
     "error_starts": 0.0871, "time": 0.0789},
]  # fmt: skip
WORDS = {"sentence": "You asked for 0.1 %: 12.3 ms.", "reference": "Against a finer one."}


def with_study(source, target, digest=None):
    """A copy of a workbook in which a study stands, of its own inputs unless a digest is given."""
    read = read_workbook(source)
    stamp = RunStamp(
        "torsionbook 9.9", dt.datetime(2026, 1, 2, tzinfo=dt.UTC), digest or case_digest(read.data)
    )
    write_study(read.workbook, target, ROWS, WORDS, stamp, read.data.ratings.rated_torque)


def pictures(path) -> int:
    return len(docx.Document(str(path)).inline_shapes)


@pytest.mark.slow
def test_a_study_in_the_workbook_is_drawn_and_listed(tmp_path):
    with_study(PROPOSED, tmp_path / "a.xlsx")
    done = report(tmp_path / "a.xlsx", pdf=tmp_path / "a.pdf", docx=tmp_path / "a.docx")
    assert done.problems == ()
    for text in (flat(pdf_text(tmp_path / "a.pdf")), docx_text(tmp_path / "a.docx")):
        for words in (
            "You asked for 0.1 %: 12.3 ms.", "Against a finer one.", "torsionbook 9.9",
            "Error against processor time, as measured by the accuracy study", "newmark", "step 0.002 s",
        ):  # fmt: skip
            assert words in text
        # 4.7e-5 in percent, 0.0871 in percent, seconds in ms
        for number in ("0.0047", "8.71", "12.3", "78.9"):
            assert number in text.split()
    report(PROPOSED, docx=tmp_path / "b.docx")
    assert pictures(tmp_path / "a.docx") == pictures(tmp_path / "b.docx") + 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("study_of", "said"),
    [
        (None, "The input file contains no study of error against time."),
        (
            "f" * 64,
            "belongs to other inputs and is omitted (Study of the inputs with SHA-256 fff",
        ),
    ],
)
def test_without_a_study_of_these_inputs_it_is_said_how_to_get_one(tmp_path, study_of, said):
    if study_of is None:
        shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    else:
        with_study(PROPOSED, tmp_path / "a.xlsx", study_of)
    report(tmp_path / "a.xlsx", docx=tmp_path / "a.docx")
    text = docx_text(tmp_path / "a.docx")
    assert said in text
    how = "It is made by the command accuracy, and printed here from the workbook that holds it."
    assert how in text
    assert "You asked for" not in text


def typed(path, table) -> list[dict]:
    """The rows of a table of the train by column, as an independent reader finds them."""
    sheet = openpyxl.load_workbook(path, data_only=True)["Train"]
    head, *rows = ([c.value for c in row] for row in sheet[sheet.tables[table].ref])
    return [dict(zip(head, row, strict=True)) for row in rows if row[0]]


def stiffnesses(path) -> dict[str, float]:
    """Stiffness by element."""
    return {row["Element"]: row["Stiffness"] for row in typed(path, "Elements")}


def first_frequency(path) -> float:
    """The lowest elastic natural frequency of what is typed, by LAPACK: lb ft^2 and lbf in/rad. [Hz]"""
    stations = typed(path, "Stations")
    at = {row["Station"]: k for k, row in enumerate(stations)}
    ratio = np.array([row["Speed ratio"] for row in stations])
    inertia = np.array([row["Inertia"] for row in stations]) * 0.45359237 * 0.3048**2
    stiffness = np.zeros((len(at), len(at)))
    for row in typed(path, "Elements"):
        ends = [at[row["From"]], at[row["To"]]]
        own = row["Stiffness"] * 4.4482216152605 * 0.0254 * ratio[ends[0]] ** 2
        stiffness[np.ix_(ends, ends)] += own * np.array([[1.0, -1.0], [-1.0, 1.0]])
    squares = scipy.linalg.eigvalsh(stiffness, np.diag(inertia * ratio**2))
    return math.sqrt(squares[1]) / (2.0 * math.pi)  # the first is the rigid body's


def line_of_first_mode() -> list[str]:
    """As it is printed for both systems, which are the paper's: 30 and 21 Hz in its Table 1."""
    old, new = first_frequency(PROPOSED), first_frequency(MODIFIED)
    assert (round(old), round(new)) == (30, 21)
    share = f"−{100.0 * (1.0 - new / old):.0f} %"
    return ["mode 1", "Frequency", "Hz", f"{old:.2f}", f"{new:.2f}", share]


@pytest.mark.slow
def test_changes_since_an_earlier_revision(tmp_path):
    done = report(MODIFIED, pdf=tmp_path / "a.pdf", docx=tmp_path / "a.docx", against=PROPOSED)
    assert done.problems == ()
    old, new = stiffnesses(PROPOSED), stiffnesses(MODIFIED)
    changed = {name for name in old if old[name] != new[name]}
    assert len(changed) == 3
    tables = docx.Document(str(tmp_path / "a.docx")).tables
    lines = [[c.text for c in row.cells] for t in tables for row in t.rows]
    listed = {line[1]: line for line in lines if line[0] == "Elements" and line[2] == "Stiffness"}
    assert set(listed) == changed
    for name, line in listed.items():
        before, after = (float(cell.replace(",", "")) for cell in line[4:6])
        assert (before, after) == pytest.approx((old[name], new[name]), rel=1e-9)
        share = float(line[6].replace("−", "-").rstrip(" %"))
        assert share == pytest.approx(100 * (new[name] / old[name] - 1), abs=0.06)
    starts = next(line for line in lines if line[0] == "Allowable starts" and line[-2] == "fail")
    assert starts[-1] == "incomplete"  # the mesh torque reverses, its backlash is not given
    assert line_of_first_mode() in lines
    for text in (flat(pdf_text(tmp_path / "a.pdf")), docx_text(tmp_path / "a.docx")):
        assert "Changes since SAMPLE-PRO" in text
        assert "3 inputs differ" in text
        assert re.search(r"Document \(SAMPLE-PRO → SAMPLE-MOD\)", text)
        assert "No other design is compared here" not in text


@pytest.mark.slow
def test_an_earlier_revision_is_compared_in_words_and_tables(tmp_path, undrawn):
    """The stiffnesses and frequencies of the paper's two systems, in one form of the report."""
    report(MODIFIED, docx=tmp_path / "a.docx", against=PROPOSED)
    old, new = stiffnesses(PROPOSED), stiffnesses(MODIFIED)
    tables = docx.Document(str(tmp_path / "a.docx")).tables
    lines = [[c.text for c in row.cells] for t in tables for row in t.rows]
    listed = {line[1] for line in lines if line[0] == "Elements" and line[2] == "Stiffness"}
    assert listed == {name for name in old if old[name] != new[name]}
    assert line_of_first_mode() in lines
    assert "3 inputs differ" in docx_text(tmp_path / "a.docx")


@pytest.mark.slow
def test_the_same_train_shows_no_change(tmp_path):
    shutil.copy(PROPOSED, tmp_path / "old.xlsx")
    report(PROPOSED, docx=tmp_path / "a.docx", against=tmp_path / "old.xlsx")
    text = docx_text(tmp_path / "a.docx")
    assert "All inputs that affect results are the same. No verdict changed." in text
    assert "Changes since old.xlsx" in text


@pytest.mark.slow
def test_a_wrong_earlier_revision_is_named_and_nothing_written(tmp_path):
    (tmp_path / "bad.json").write_text('{"format": 1, "stations": [{"station": "A"}]}', "utf-8")
    done = torsionbook("report", PROPOSED, "--pdf", "a.pdf", "--against", "bad.json", cwd=tmp_path)
    assert done.returncode == 1
    assert "bad.json: " in done.stderr
    assert "Inertia" in done.stderr
    assert not (tmp_path / "a.pdf").exists()
    done = torsionbook("report", PROPOSED, "--pdf", "a.pdf", "--against", PROPOSED, cwd=tmp_path)
    assert done.returncode == 2
    said = flat(re.sub(r"[│╭╮╰╯─]", "", done.stderr))
    assert "the same file. Name an earlier revision of it." in said


CASE = {
    "format": 1,
    "stations": [{"station": "A", "inertia": 1.0}, {"station": "B", "inertia": 2.0}],
    "elements": [{"element": "K", "kind": "coupling", "from": "A", "to": "B", "stiffness": 1e5,
                  "damping": 5.0}],
    "line_frequency": 60.0,
    "poles": 4,
    "rated_torque": "1 kN*m",
    "voltage": "85 %",
    "motor_torque": [{"station": "A", "speed": s, "average": 1500.0, "pulsating": 200.0}
                     for s in (0.0, 0.95)] + [{"station": "A", "speed": 1.0, "average": 0.0, "pulsating": 0.0}],
    "load_torque": [{"station": "B", "speed": s, "torque": 10.0} for s in (0.0, 1.0)],
}  # fmt: skip


@pytest.mark.slow
def test_conditions_tolerances_and_conclusions(tmp_path):
    (tmp_path / "case.json").write_text(json.dumps(CASE), encoding="utf-8")
    done = report(tmp_path / "case.json", docx=tmp_path / "a.docx")
    assert done.problems == ()
    text = docx_text(tmp_path / "a.docx")
    # 0.85² of the torque
    assert "85 % of the voltage of the torque curves; motor torques times 0.7225" in text
    assert "made by the command accuracy, and printed here from a workbook" in text
    assert "No other design is compared here" in text
    # all energy is in the one coupling: half of 10 %
    tables = docx.Document(str(tmp_path / "a.docx")).tables
    lines = [[c.text for c in row.cells] for t in tables for row in t.rows]
    assert ["K", "5.00"] in lines


def test_a_makers_vibratory_limit_stands_beside_the_torque(tmp_path, undrawn):
    element = CASE["elements"][0] | {"vibratory_limit": "0.4 kN*m"}
    case = CASE | {
        "elements": [element],
        "excitations": [{"name": "E", "frequency": 60.0, "station": "A", "torque": 500.0}],
        "damping_ratio": 0.01,
    }
    (tmp_path / "case.json").write_text(json.dumps(case), encoding="utf-8")
    assert report(tmp_path / "case.json", docx=tmp_path / "a.docx").problems == ()
    text = docx_text(tmp_path / "a.docx")
    assert (
        "Elements whose zero-to-peak torque is compared with the maker's vibratory limit: 1."
        in text
    )
    tables = docx.Document(str(tmp_path / "a.docx")).tables
    rows = next(
        [[c.text for c in row.cells] for row in t.rows]
        for t in tables
        if any(c.text.startswith("Vibratory limit") for c in t.rows[0].cells)
        and any("Excitation" in c.text for c in t.rows[0].cells)
    )
    at = next(k for k, head in enumerate(rows[0]) if head.startswith("Vibratory limit"))
    assert float(rows[1][at].replace(",", "")) in (400.0, 0.4)
