"""The documents as they are read: their numbers, their sections, their pages, in both forms."""

from __future__ import annotations

import json
import math
import re
import zipfile

import docx
import openpyxl
import pytest
from report_files import ROOT, docx_text, flat, in_its_own_process, pdf_text, torsionbook
from typer.testing import CliRunner

from addin.cli import report as commands
from addin.cli.app import app
from addin.reading.one_file import read_checked
from addin.report.make import report, stored_results

FT_LBF = 1.3558179483314004
PSI = 6894.757293168361
SECTIONS = (
    "Summary", "Scope and basis", "Inputs", "Natural frequencies and mode shapes",
    "Interference and separation margins", "Steady-state response", "Start-up", "Torque reversals",
    "Fatigue and allowable starts", "Sheet to the makers",
)  # fmt: skip
APPENDICES = (
    "Effects simulated and left out", "Accuracy and what it cost", "Equations and references",
    "Check calculations", "Audit",
)  # fmt: skip
#: As they are numbered.
NUMBERED = (
    *(f"{k}  {title}" for k, title in enumerate(SECTIONS, start=1)),
    *(f"Appendix {k}  {title}" for k, title in zip("ABCDE", APPENDICES, strict=True)),
)


def expected_numbers(results: dict) -> set[str]:
    """Numbers of the results, formatted here by themselves."""
    found = {f"{r['frequency']:,.2f}" for r in results["natural_frequencies"] if r["frequency"]}
    found |= {f"{r['cpm']:,.0f}" for r in results["natural_frequencies"] if r["frequency"]}
    found |= {f"{100 * r['percent_speed']:.2f}" for r in results["startup_crossings"]}
    found |= {f"{r['time']:.3f}" for r in results["startup_peaks"]}
    for row in results["startup_peaks"]:
        torque = row["maximum_torque"] / FT_LBF
        assert torque > 1000.0
        found.add(f"{torque:,.0f}" if torque >= 1e4 else f"{torque:,.1f}")
    found |= {
        f"{100 * r['margin']:,.2f}" for r in results["separation_margins"] if r["verdict"] == "fail"
    }
    found |= {f"{r['allowable'] / PSI:,.1f}" for r in results["steady_state"] if r.get("allowable")}
    damaged = [r for r in results["allowable_starts"] if r["damage"]]
    assert len(damaged) == 1
    found |= {f"{math.floor(r['allowable_starts']):,}" for r in damaged}
    found |= {f"{r['damage'] * 1e3:.3f}×10⁻³" for r in damaged}
    return found


# --- what stands in them --------------------------------------------------------------------------


def test_the_pdf_holds_the_numbers_of_the_results(proposed):
    text = pdf_text(proposed.pdf, "-layout")
    words = set(text.replace("−", "-").split())
    wanted = expected_numbers(proposed.results)
    assert len(wanted) > 30
    assert {n for n in wanted if n not in words} == set()
    assert proposed.results["case_sha256"] in text


def test_the_docx_holds_the_numbers_of_the_results(proposed):
    words = set(docx_text(proposed.docx).replace("−", "-").split())
    cells = {cell for word in words for cell in (word, word.strip("();,"))}
    found = set()
    for table in docx.Document(str(proposed.docx)).tables:
        found |= {c.text.replace("−", "-") for row in table.rows for c in row.cells}
    assert {n for n in expected_numbers(proposed.results) if n not in found | cells} == set()


def test_pdf_and_docx_say_the_same(proposed):
    """Every sentence and every cell of the .docx stands in the PDF too, but for field codes."""
    # a hyphen at the end of a line is left out by pdftotext
    pdf = re.sub(r"[\s-]+", "", pdf_text(proposed.pdf).replace("\u200b", ""))
    file = docx.Document(str(proposed.docx))
    cells = {c.text for t in file.tables for row in t.rows for c in row.cells if c.text.strip()}
    assert len(cells) > 400
    missing = {
        c for c in cells if any(re.sub(r"[\s-]+", "", line) not in pdf for line in c.split("\n"))
    }
    assert missing == set()
    headings = [p.text for p in file.paragraphs if p.style.name.startswith("Heading")]
    assert [h for h in headings if re.sub(r"[\s-]+", "", h) not in pdf] == []


def test_every_section_is_there_and_every_page_is_numbered(proposed):
    pages = pdf_text(proposed.pdf, "-layout").split("\f")[:-1]
    assert 15 <= len(pages) <= 30
    text = flat(" ".join(pages))
    for title in NUMBERED:
        assert text.count(flat(title)) >= 2, title  # in the contents and as a heading
    for k, page in enumerate(pages, start=1):
        assert f"Page {k} of {len(pages)}" in flat(page)
        assert proposed.results["case_sha256"][:12] in page
        assert k == 1 or "SAMPLE-PRO · rev. 0" in flat(page)


def test_conclusions_name_an_action_for_each_check_that_fails(proposed):
    text = flat(docx_text(proposed.docx))
    # the couplings calculated, with the limits of this train; 27 % is limit over result of the steady state
    assert re.search(
        r"Soften .{5,200} as typed\): every separation margin is kept, the least 2\d\.\d %", text
    )
    assert "frequencies and margins alone were calculated" in text
    steady = next(v for v in proposed.results["verdicts"] if v["check"].startswith("Steady"))
    assert (
        f"lower the excitation to {int(100 * steady['limit'] / steady['result'])} % of what it is"
        in text
    )
    starts = next(v for v in proposed.results["verdicts"] if v["check"] == "Allowable starts")
    assert f"Without a change no more than {int(starts['result']):,} such starts in a life" in text
    assert "not judged: Mesh. State its Backlash or Angular backlash." in text


def test_a_sentence_between_heading_and_figure_stays_with_both(proposed):
    paragraphs = docx.Document(str(proposed.docx)).paragraphs
    at = next(k for k, one in enumerate(paragraphs) if one.text.endswith("separation margins")
              and one.style.name.startswith("Heading"))  # fmt: skip
    heading, sentence, picture = paragraphs[at : at + 3]
    assert "kept" in sentence.text
    assert picture._p.xpath(".//pic:pic")
    assert heading.style.paragraph_format.keep_with_next
    assert sentence.paragraph_format.keep_with_next
    assert picture.paragraph_format.keep_with_next  # with its caption


def test_the_docx_has_headings_fields_and_equations(proposed):
    file = docx.Document(str(proposed.docx))
    first = [p.text for p in file.paragraphs if p.style.name == "Heading 1"]
    assert first == [*NUMBERED]
    with zipfile.ZipFile(proposed.docx) as package:
        body = package.read("word/document.xml").decode()
        feet = [package.read(n).decode() for n in package.namelist() if "footer" in n]
        pictures = [n for n in package.namelist() if n.startswith("word/media/")]
    assert body.count("<m:oMath>") == 12
    assert body.count("<w:tblHeader") >= 20
    assert len(pictures) >= 9
    assert all("NUMPAGES" in foot for foot in feet)
    # each entry of the contents leads to a bookmark that is there
    wanted = set(re.findall(r"PAGEREF (\S+)", body))
    assert len(wanted) > 25
    assert wanted <= set(re.findall(r'w:bookmarkStart [^>]*w:name="([^"]+)"', body))


def test_the_docx_has_no_part_that_word_rewrites(proposed):
    """python-docx begins with a document of Word 2010: styles twice, a list of sources and a picture of its first page."""
    with zipfile.ZipFile(proposed.docx) as package:
        names = {n for n in package.namelist() if "media/" not in n}
        relations = "".join(package.read(n).decode() for n in names if n.endswith(".rels"))
    assert {n for n in names if n.startswith("customXml/")} == set()
    assert {"word/stylesWithEffects.xml", "docProps/thumbnail.jpeg"} & names == set()
    assert not re.search("stylesWithEffects|customXml|thumbnail", relations)


@pytest.mark.slow
def test_libreoffice_opens_the_docx(proposed, soffice):
    try:
        made = soffice.convert(proposed.docx, "pdf")
    except RuntimeError as wrong:
        if "could not be loaded" in str(wrong):
            pytest.skip("LibreOffice Writer is not installed")
        raise
    text = flat(pdf_text(made, "-layout"))
    for title in SECTIONS:
        assert title in text
    pages = pdf_text(made).count("\f")
    assert 15 <= pages <= 35
    assert f"Page {pages} of {pages}" in text


@pytest.mark.slow
def test_paper_follows_the_units(proposed, tmp_path):
    assert re.search(r'page width="612\.0+" height="792\.0+"', pdf_text(proposed.pdf, "-bbox"))
    us = docx.Document(str(proposed.docx)).sections[0]
    assert round(us.page_width.mm), round(us.page_height.mm) == (216, 279)
    small_report(tmp_path)
    assert re.search(
        r'page width="595\.2\d+" height="841\.8\d+"', pdf_text(tmp_path / "c.pdf", "-bbox")
    )
    assert round(docx.Document(str(tmp_path / "c.docx")).sections[0].page_width.mm) == 210


def test_a_case_file_is_shown_in_the_units_it_is_typed_in(tmp_path, undrawn):
    stations = [
        {"station": "A", "inertia": "10 lb*ft^2"},
        {"station": "B", "inertia": "20 lb*ft^2"},
    ]
    elements = [SMALL["elements"][0] | {"stiffness": "1e6 lbf*in/rad"}]
    for text in small_report(
        tmp_path, stations=stations, elements=elements, rated_torque="1000 lbf*ft"
    ):
        for words in ("lb·ft²", "lbf·in/rad", "1,000 lbf·ft"):
            assert words in text
        assert "N·m" not in text
    assert docx.Document(str(tmp_path / "c.docx")).sections[0].page_width.mm == pytest.approx(
        215.9, abs=0.1
    )


@pytest.mark.slow
def test_two_runs_give_the_same_bytes(proposed, tmp_path):
    source = ROOT / "templates" / "example_proposed.xlsx"
    words = ("report", source, "--pdf", "again.pdf", "--docx", "again.docx")
    done = in_its_own_process(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "again.pdf").read_bytes() == proposed.pdf.read_bytes()
    assert (tmp_path / "again.docx").read_bytes() == proposed.docx.read_bytes()


# --- cases that lack something --------------------------------------------------------------------

SMALL = {
    "format": 1,
    "stations": [{"station": "A", "inertia": 1.0}, {"station": "B", "inertia": 2.0}],
    "elements": [{"element": "S", "kind": "shaft", "from": "A", "to": "B", "stiffness": 1e6}],
    "line_frequency": 60.0,
    "poles": 4,
    "rated_torque": "1 kN*m",
}


def small_report(tmp_path, **fields) -> tuple[str, str]:
    """Text of the PDF and of the .docx of a small case; made in this process, which is quicker."""
    (tmp_path / "case.json").write_text(json.dumps(SMALL | fields), encoding="utf-8")
    done = report(tmp_path / "case.json", pdf=tmp_path / "c.pdf", docx=tmp_path / "c.docx")
    assert done.problems == ()
    assert done.written == (tmp_path / "c.pdf", tmp_path / "c.docx")
    return flat(pdf_text(tmp_path / "c.pdf")), docx_text(tmp_path / "c.docx")


def test_what_is_absent_is_said_in_words(tmp_path, undrawn):
    for text in small_report(tmp_path):
        for sentence in (
            "No start was calculated: the inputs contain no motor torque",
            "All modes are undamped: resonance in continuous operation is unbounded",
            "No start was calculated, hence no reversal.",
            "No start was calculated, hence no damage and no number of starts.",
            "The inputs contain no material and no S-N data",
            "no gear geometry, clearances or bearings",
            "Not judged, or only in part: Steady-state stress (peak-to-peak), Start, Shear yield in the "
            "start, Allowable starts.",
        ):
            assert sentence in text, sentence
        for title in (*SECTIONS, *APPENDICES):
            assert title in text


@pytest.mark.slow
def test_a_stalled_start_is_said_and_nothing_is_unlimited(tmp_path):
    """Data are complete: what is not judged is so because the start ends at half speed."""
    curve = ((0.0, 1.0), (0.5, 0.6), (1.0, 0.0))
    element = SMALL["elements"][0] | {"stress_diameter": 0.1, "scf": 2.0, "material": "steel"}
    fields = {
        "elements": [element],
        "motor_torque": [
            {"station": "A", "speed": x, "average": f"{y} kN*m", "pulsating": 0.0} for x, y in curve
        ],
        "load_torque": [{"station": "B", "speed": x, "torque": "0.6 kN*m"} for x, _ in curve],
        "materials": [{"material": "steel", "uts": 7e8, "yield": 5e8, "endurance": 1.4e8}],
        "sn_points": [
            {"material": "steel", "cycles": n, "stress": s} for n, s in ((1e3, 3e8), (1e6, 1.4e8))
        ],
    }
    for text in small_report(tmp_path, **fields):
        assert "The start is stalled." in text
        assert "no damaging cycle" not in text


def test_one_station_alone_makes_a_report(tmp_path):
    alone = {"stations": [{"station": "A", "inertia": 20.0}], "elements": []}
    for text in small_report(tmp_path, **alone):
        assert "The train has no elastic mode" in text
        assert "Overall verdict: incomplete" in text


HOSTILE = (
    '#import "x": *',
    "<b>bold</b> &amp; </w:t>",
    "$x^2$ \\frac{a}{b} ]",
    "*star* _under_ `code` @ref <lbl> // gone /* gone */",
    "= Heading",
    "-- --- ... ~ 'single' \"double\"",
)


def test_typed_text_stands_as_typed(tmp_path, undrawn):
    """Markup of either writer, in title, names and notes, is text like any other."""
    n = len(HOSTILE)
    stations = [
        {"station": t, "inertia": 1.0, "description": HOSTILE[k - 1]} for k, t in enumerate(HOSTILE)
    ]
    elements = [
        {"element": f"E {HOSTILE[k - 1]}", "kind": "shaft", "from": HOSTILE[k], "to": HOSTILE[k + 1],
         "stiffness": 1e6}
        for k in range(n - 1)
    ]  # fmt: skip
    pdf, word = small_report(
        tmp_path, title=HOSTILE[0], tag=HOSTILE[1], client=HOSTILE[2], prepared_by=HOSTILE[3],
        document=HOSTILE[4], revision=HOSTILE[5][:10], stations=stations, elements=elements,
    )  # fmt: skip
    whole = re.sub(r"\s+", "", pdf)
    for text in HOSTILE:
        assert whole.count(re.sub(r"\s+", "", text)) >= 6, text
        assert word.count(flat(text)) >= 6, text


def test_control_characters_and_very_long_texts_do_no_harm(tmp_path, undrawn):
    pdf, word = small_report(
        tmp_path, title="A\u0000B\u0007C\uffff " + "long title " * 88, tag="x" * 1000
    )
    pages = pdf_text(tmp_path / "c.pdf").split("\f")
    assert "Approved by" in pages[0]  # all of the cover is on one page
    assert "Contents" in pages[1]
    for text in (pdf, word):
        assert "A B C long title long title" in text
        assert "x" * 60 in re.sub(r"\s+", "", text)


LONG = "A_very_long_name_of_a_station_without_any_blank_at_all_number_{:02d}"


@pytest.mark.slow
def test_nothing_runs_off_the_page(tmp_path):
    """Every word of a long train with long names lies between the margins."""
    n = 40
    stations = [
        {"station": LONG.format(k), "description": "words " * 12, "inertia": 1.0 + k}
        for k in range(n)
    ]
    elements = [
        {"element": f"E_{LONG.format(k)}", "kind": "shaft", "from": LONG.format(k), "to": LONG.format(k + 1),
         "stiffness": 123456789.0 + k, "damping": 1234.5, "loss_factor": 0.01, "stress_diameter": 0.1,
         "scf": 2.0, "material": "A steel with a rather long name", "rated_torque": 12345.0,
         "peak_torque_limit": 23456.0, "reversal_limit": 3456.0, "vibratory_limit": 456.0}
        for k in range(n - 1)
    ]  # fmt: skip
    materials = [{"material": "A steel with a rather long name", "uts": 9e8}]
    small_report(
        tmp_path, stations=stations, elements=elements, materials=materials, damping_ratio=0.01
    )
    page, outside, words = (0.0, 0.0), [], 0
    for line in pdf_text(tmp_path / "c.pdf", "-bbox").splitlines():
        if size := re.search(r'<page width="([\d.]+)" height="([\d.]+)"', line):
            page = (float(size[1]), float(size[2]))
        if box := re.search(
            r'xMin="([-\d.]+)" yMin="([-\d.]+)" xMax="([-\d.]+)" yMax="([-\d.]+)">(.*)<', line
        ):
            left, top, right, bottom = map(float, box.groups()[:4])
            words += 1
            margin = (page[0] - 170.0 / 25.4 * 72.0) / 2.0 - 1.0
            if left < margin or right > page[0] - margin or top < 20.0 or bottom > page[1] - 20.0:
                outside.append(box[5])
    assert words > 2000
    assert outside == []


# --- inputs that are wrong, files that are in the way ----------------------------------------------


def test_wrong_inputs_are_listed_as_by_check(tmp_path):
    wrong = SMALL | {"elements": [SMALL["elements"][0] | {"stiffness": -1.0, "to": "C"}]}
    (tmp_path / "case.json").write_text(json.dumps(wrong), encoding="utf-8")
    checked = torsionbook("check", "case.json", cwd=tmp_path)
    done = torsionbook("report", "case.json", "--pdf", "c.pdf", "--docx", "c.docx", cwd=tmp_path)
    assert checked.returncode == done.returncode == 1
    assert len(checked.stderr.splitlines()) == 3
    assert done.stderr.splitlines() == checked.stderr.splitlines()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.json"]


@pytest.mark.slow
def test_a_file_that_is_there_is_kept_unless_forced(tmp_path):
    (tmp_path / "case.json").write_text(json.dumps(SMALL), encoding="utf-8")
    (tmp_path / "c.pdf").write_bytes(b"mine")
    done = torsionbook("report", "case.json", "--pdf", "c.pdf", "--docx", "c.docx", cwd=tmp_path)
    assert (done.returncode, (tmp_path / "c.pdf").read_bytes()) == (1, b"mine")
    assert "c.pdf exists" in done.stderr
    assert not (tmp_path / "c.docx").exists()
    done = torsionbook("report", "case.json", "--pdf", "c.pdf", "--force", cwd=tmp_path)
    assert done.returncode == 0
    assert (tmp_path / "c.pdf").read_bytes().startswith(b"%PDF-")


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (("--pdf", "nowhere/c.pdf"), 1, "The folder nowhere does not exist."),
        (("--pdf", "folder.pdf"), 1, "folder.pdf is a folder"),
        (("--pdf", "c.docx"), 2, "must end in .pdf"),
        ((), 2, "--pdf"),
    ],
)
def test_wrong_targets(tmp_path, monkeypatch, words, status, said):
    (tmp_path / "case.json").write_text(json.dumps(SMALL), encoding="utf-8")
    (tmp_path / "folder.pdf").mkdir()
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["report", "case.json", *words])
    assert done.exit_code == status
    assert said in flat(re.sub(r"[│╭╮╰╯─]", " ", done.output))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.json", "folder.pdf"]


def test_a_missing_package_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(commands.importlib.util, "find_spec", lambda name: None)
    done = CliRunner().invoke(app, ["report", "x.xlsx", "--pdf", str(tmp_path / "c.pdf")])
    assert done.exit_code == 1
    assert "requirements/report.txt" in " ".join(done.output.split())


# --- a workbook with results ----------------------------------------------------------------------


@pytest.mark.slow
def test_results_of_other_inputs_are_told(proposed, examples, tmp_path):
    calculated = examples / "proposed.xlsx"
    read = read_checked(calculated)
    assert stored_results(read, proposed.results["case_sha256"]) == ()
    book = openpyxl.load_workbook(calculated)
    sheet, cell = next(book.defined_names["DampingRatio"].destinations)
    book[sheet][cell.replace("$", "")].value = 2.0
    book.save(tmp_path / "edited.xlsx")
    done = torsionbook("report", "edited.xlsx", "--pdf", "edited.pdf", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    text = flat(pdf_text(tmp_path / "edited.pdf", "-l", "1"))
    said = "The results stored in the workbook belong to other inputs, with SHA-256 "
    assert said in text
    assert said in done.stderr
    assert proposed.results["case_sha256"][:12] in text  # whose the stored ones are
    assert "2026-01-02 03:04" in text


def test_a_report_tells_what_it_wrote_and_a_blank_workbook_has_no_results(proposed):
    assert proposed.printed.splitlines() == ["written: r.pdf", "written: r.docx"]
    blank = read_checked(ROOT / "templates" / "blank_us.xlsx")
    assert stored_results(blank, "0" * 64) == ()
