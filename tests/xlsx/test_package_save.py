"""Saving: whole or not at all."""

import io
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from rich_workbooks import changed_parts, parts_of

from addin.xlsx import Formula, Workbook, open_workbook, places
from addin.xlsx import save as save_module
from addin.xlsx.errors import SaveRefused, SourceChanged, WorkbookLocked
from addin.xlsx.references import Rect
from addin.xlsx.values import FORMULA_CUT, rows_xml
from addin.xlsx.whole_files import write_json
from addin.xlsx.written import Written, places_of_rows

ROOT = Path(__file__).resolve().parents[2]


def edited(path: Path) -> Workbook:
    book = open_workbook(path)
    book.set_name("RatedPower", 5000.0)
    return book


def leftovers(folder: Path) -> list[str]:
    return sorted(one.name for one in folder.iterdir())


def test_new_file_leaves_the_original(train: Path) -> None:
    before = train.read_bytes()
    report = edited(train).save(train.with_name("out.xlsx"))
    assert train.read_bytes() == before
    assert report.backup is None
    assert leftovers(train.parent) == ["out.xlsx", "train.xlsx"]
    assert zipfile.ZipFile(report.path).testzip() is None


def test_in_place_keeps_a_copy(train: Path) -> None:
    before = train.read_bytes()
    backup = train.with_name("train.xlsx.bak")
    backup.write_bytes(b"older copy")
    report = edited(train).save(in_place=True)
    assert report.path == train
    assert report.backup == backup
    assert backup.read_bytes() == before
    assert open_workbook(train).value("Case", "B2") == 5000.0
    assert leftovers(train.parent) == ["train.xlsx", "train.xlsx.bak"]


def test_a_workbook_that_is_open_elsewhere_keeps_its_copy(
    train: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Excel leaves no lock file on some drives; Windows refuses to replace what it has open, which is imitated elsewhere."""
    before = train.read_bytes()
    backup = train.with_name("train.xlsx.bak")
    backup.write_bytes(b"older copy")
    book = edited(train)
    if os.name != "nt":
        monkeypatch.setattr(places, "_IS_WINDOWS", True)
        monkeypatch.setattr(os, "rename", Mock(side_effect=PermissionError(13, "open elsewhere")))
    with open(train, "rb"), pytest.raises(SaveRefused, match="probably open in Excel"):
        book.save(in_place=True)
    assert train.read_bytes() == before
    assert backup.read_bytes() == b"older copy"
    assert leftovers(train.parent) == ["train.xlsx", "train.xlsx.bak"]


def test_in_place_twice(train: Path) -> None:
    book = edited(train)
    book.save(in_place=True)
    first = train.read_bytes()
    with pytest.raises(SourceChanged):
        book.save(in_place=True)
    edited(train).save(in_place=True)
    assert train.with_name("train.xlsx.bak").read_bytes() == first


def test_a_workbook_opened_for_reading_is_saved_after_the_checks(train: Path) -> None:
    book = open_workbook(train, read_only=True)
    book.set_name("RatedPower", 5000.0)
    lock = train.with_name(f"~${train.name}")
    lock.write_bytes(b"\x04Anna" + b" " * 160)
    with pytest.raises(WorkbookLocked):
        book.allow_saving()
    with pytest.raises(SaveRefused, match="read-only"):
        book.save(train.with_name("out.xlsx"))
    lock.unlink()
    book.allow_saving()
    book.save(train.with_name("out.xlsx"))
    assert open_workbook(train.with_name("out.xlsx")).value("Case", "B2") == 5000.0


@pytest.mark.parametrize(
    ("change", "stands"),
    [
        (lambda sheet: sheet, True),
        (
            lambda sheet: sheet.replace(
                b"><f>A1*2</f></c>", b' t="str"><f>A1*2</f><v>x</v></c>', 1
            ),
            True,
        ),
        (lambda sheet: sheet.replace(b"<f>A1*2</f>", b"", 1), False),
        (lambda sheet: sheet.replace(b"<v>7</v>", b"<v>8</v>"), False),
        (lambda sheet: sheet.replace(b'<c r="C2"><f>A1*2</f></c>', b""), False),
        (lambda sheet: sheet.replace(b'<row r="2">', b'<row r="3">'), False),
        (lambda sheet: sheet.replace(b"<row ", b"<x:row "), False),  # then cell by cell
    ],
)
def test_written_rows_are_found_again(change: Callable[[bytes], bytes], stands: bool) -> None:
    grid = [[7.0, "a", Formula("A1*2")], [8.0, None, Formula("A1*2")]]
    starts = ('<c r="A', '<c r="B', '<c r="C')
    texts, _ = rows_xml(1, starts, [(None,) * 3] * len(grid), grid)
    sheet = "<sheetData>" + "".join(
        f'<row r="{number}">{text}</row>' for number, text in enumerate(texts, 1)
    )
    sheet = f"{sheet}</sheetData>".replace(FORMULA_CUT, "")
    written = Written(Rect(1, 1, 2, 3), grid, texts)
    part = change(sheet.encode())
    assert written.stands_in(part, places_of_rows(part)) is stands


@pytest.mark.parametrize("when", ["write", "flush", "replace", "permission", "read back", "check"])
@pytest.mark.parametrize("in_place", [True, False])
def test_failures_leave_the_original_and_no_rubbish(
    train: Path, monkeypatch: pytest.MonkeyPatch, when: str, in_place: bool
) -> None:
    before = train.read_bytes()
    book = edited(train)
    out = train.with_name("out.xlsx")
    expected, words = {
        "write": (SaveRefused, "could not be written"),
        "flush": (SaveRefused, "could not be written"),
        "replace": (SaveRefused, "could not be replaced"),
        "permission": (SaveRefused, "open in Excel"),
        "read back": (SaveRefused, "disk returned wrong data"),
        "check": (SaveRefused, "Case!B2 differs when read back"),
    }[when]
    real_replace, real_open = os.replace, Path.open

    def spoiled_reading(path: Path, *mode: Any) -> Any:
        return io.BytesIO(b"rubbish") if path.suffix == ".tmp" else real_open(path, *mode)

    def fail(*arguments: Any) -> None:
        if when in ("replace", "permission") and str(arguments[-1]).endswith(".bak"):
            real_replace(*arguments)
            return
        raise (
            PermissionError(13, "denied")
            if when == "permission"
            else OSError(28, "No space left on device")
        )

    if when == "write":
        monkeypatch.setattr(save_module.os, "chmod", fail)
    elif when == "flush":
        monkeypatch.setattr(save_module.os, "fsync", fail)
    elif when in ("replace", "permission"):
        monkeypatch.setattr(save_module.os, "replace", fail)
    elif when == "read back":
        monkeypatch.setattr(Path, "open", spoiled_reading)
    else:
        monkeypatch.setattr(book, "_misread_cells", lambda parts: ["Case!B2"])
    with pytest.raises(expected, match=words):
        book.save(None if in_place else out, in_place=in_place)
    monkeypatch.undo()
    assert train.read_bytes() == before
    rest = set(leftovers(train.parent)) - {"train.xlsx.bak"}
    assert rest == {"train.xlsx"}


def test_interrupt_leaves_the_original_and_no_rubbish(
    train: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = train.read_bytes()

    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(save_module.os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        edited(train).save(train.with_name("out.xlsx"))
    assert train.read_bytes() == before
    assert leftovers(train.parent) == ["train.xlsx"]


CHILD = """
import os, sys, time
from pathlib import Path
from addin.xlsx import open_workbook

book = open_workbook(sys.argv[1])
book.set_name("RatedPower", 5000.0)
real = os.replace
def replace(source, target):
    if str(target).endswith(".bak"):
        return real(source, target)
    Path(sys.argv[2]).write_text("ready")
    time.sleep(60)
os.replace = replace
book.save(in_place=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_kill_between_write_and_replace(train: Path, tmp_path: Path) -> None:
    before = train.read_bytes()
    flag = tmp_path / "flag"
    child = subprocess.Popen([sys.executable, "-c", CHILD, str(train), str(flag)], cwd=ROOT)
    try:
        deadline = time.monotonic() + 30
        while not flag.exists() and child.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        assert flag.exists()
    finally:
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
    assert train.read_bytes() == before
    assert train.with_name("train.xlsx.bak").read_bytes() == before
    flag.unlink()
    assert len(leftovers(train.parent)) == 3  # the file that was to be put in place
    edited(train).save(in_place=True)
    assert open_workbook(train).value("Case", "B2") == 5000.0
    assert set(leftovers(train.parent)) == {"train.xlsx", "train.xlsx.bak"}


def test_source_changed_meanwhile(train: Path) -> None:
    book = edited(train)
    other = train.read_bytes() + b""
    train.write_bytes(other[:-1] + bytes([other[-1] ^ 1]))
    with pytest.raises(SourceChanged, match="changed by another program"):
        book.save(train.with_name("out.xlsx"))
    train.unlink()
    with pytest.raises(SourceChanged, match="can no longer be read"):
        book.save(train.with_name("out.xlsx"))
    assert leftovers(train.parent) == []


def test_opened_by_somebody_meanwhile(train: Path) -> None:
    book = edited(train)
    lock = train.with_name("~$train.xlsx")
    lock.write_bytes(b"\x03Eng")
    with pytest.raises(WorkbookLocked):
        book.save(in_place=True)
    book.save(train.with_name("out.xlsx"))
    train.with_name("~$out.xlsx").write_bytes(b"\x03Eng")
    with pytest.raises(WorkbookLocked):
        book.save(train.with_name("out.xlsx"))


def test_where_it_may_be_written(train: Path) -> None:
    book = edited(train)
    with pytest.raises(SaveRefused, match="use --in-place to replace it"):
        book.save(train)
    with pytest.raises(SaveRefused, match="No file to write"):
        book.save()
    with pytest.raises(SaveRefused, match=r"must end in \.xlsx"):
        book.save(train.with_name("out.xlsm"))
    with pytest.raises(SaveRefused, match="the file named is"):
        book.save(train.with_name("out.xlsx"), in_place=True)
    with pytest.raises(SaveRefused, match="Nothing can be written in the folder"):
        book.save(train.parent / "nowhere" / "out.xlsx")
    with pytest.raises(SaveRefused, match="read-only"):
        open_workbook(train, read_only=True).save(train.with_name("out.xlsx"))
    book.save(train, in_place=True)


@pytest.mark.skipif(os.name != "posix", reason="modes are those of POSIX")
def test_mode_is_kept(train: Path) -> None:
    train.chmod(0o640)
    out = edited(train).save(train.with_name("out.xlsx")).path
    assert stat.S_IMODE(out.stat().st_mode) == 0o640
    edited(train).save(in_place=True)
    assert stat.S_IMODE(train.stat().st_mode) == 0o640


@pytest.mark.skipif(os.name != "posix", reason="Windows flushes no folders")
def test_a_folder_that_cannot_be_flushed_is_a_note(
    train: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is there by then: it must not be called unwritten."""
    real = os.fsync

    def fail(handle: int) -> None:
        if stat.S_ISDIR(os.fstat(handle).st_mode):
            raise OSError(5, "Input/output error")
        real(handle)

    monkeypatch.setattr(os, "fsync", fail)
    report = edited(train).save(train.with_name("out.xlsx"))
    assert open_workbook(report.path).value("Case", "B2") == 5000.0
    (note,) = report.notes
    assert note.startswith("out.xlsx is written, but the disk did not confirm it (Input/output")
    write_json(train.with_name("case.json"), {"a": 1})
    assert train.with_name("case.json").is_file()


@pytest.mark.skipif(os.name != "posix", reason="Windows flushes no folders")
def test_json_is_on_the_disk_before_it_takes_its_place(
    train: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []
    for name in ("fsync", "replace"):
        real = getattr(os, name)

        def noted(*words: Any, name: str = name, real: Any = real) -> None:
            calls.append(name)
            real(*words)

        monkeypatch.setattr(os, name, noted)
    write_json(train.with_name("case.json"), {"a": 1})
    assert calls == ["fsync", "replace", "fsync"]


@pytest.mark.skipif(sys.platform == "win32", reason="paths there have 260 characters")
def test_names_as_long_as_the_system_takes_them(train: Path) -> None:
    """No lock file, and no file beside it with a longer name, can be there."""
    longest = train.rename(train.with_name("t" * 250 + ".xlsx"))
    report = edited(longest).save(longest.with_name("o" * 250 + ".xlsx"))
    write_json(longest.with_name("j" * 250 + ".json"), {"a": 1})
    assert {len(name) for name in leftovers(train.parent)} == {255}
    assert report.notes == ()


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_nothing_is_written_through_a_link(train: Path) -> None:
    """Who may write into the folder of the results must not choose which file is replaced."""
    other = train.with_name("other.xlsx")
    shutil.copyfile(train, other)
    before = other.read_bytes()
    for target in (other, train.with_name("missing.xlsx")):
        link = train.with_name("out.xlsx")
        link.unlink(missing_ok=True)
        link.symlink_to(target)
        with pytest.raises(SaveRefused, match="is a link to another file, which is not replaced"):
            edited(train).save(link)
        with pytest.raises(OSError, match="is a link to another file, which is not replaced"):
            write_json(link, {"a": 1})
        assert link.is_symlink()
    assert other.read_bytes() == before
    assert not target.exists()


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_links_are_followed(train: Path) -> None:
    link = train.with_name("link.xlsx")
    link.symlink_to(train)
    edited(link).save(in_place=True)
    assert link.is_symlink()
    assert open_workbook(train).value("Case", "B2") == 5000.0


def test_a_part_that_would_change_is_noticed(train: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from addin.xlsx.container import Container

    real = Container.write

    def careless(
        self: Container, stream: Any, replaced: Any, dropped: Any = (), **options: Any
    ) -> None:
        real(self, stream, {**replaced, "xl/styles.xml": b"<oops/>"}, dropped, **options)

    book = edited(train)
    book.refresh_formula_caches()
    monkeypatch.setattr(Container, "write", careless)
    with pytest.raises(SaveRefused, match="the part xl/styles.xml would have changed"):
        book.save(train.with_name("out.xlsx"))


def test_report_names_what_changed(train: Path) -> None:
    report = edited(train).save(train.with_name("out.xlsx"))
    assert set(report.parts) == changed_parts(train, report.path)
    assert set(parts_of(train)) == set(parts_of(report.path))


def test_copies_of_values_that_are_not_renewed_are_told(train: Path) -> None:
    report = edited(train).save(train.with_name("out.xlsx"))
    assert report.notes == ()
    from rich_workbooks import with_parts

    with_parts(
        train,
        {"xl/pivotCache/pivotCacheDefinition1.xml": b"<x/>"},
        {
            "xl/drawings/drawing3.xml": lambda data: data.replace(
                b'textlink=""', b'textlink="Case!$B$2"'
            )
        },
    )
    notes = " ".join(edited(train).save(train.with_name("out.xlsx")).notes)
    assert "Pivot tables" in notes
    assert "Text boxes linked" in notes
