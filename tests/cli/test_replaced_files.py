"""No command writes a JSON, or a comparison, over a workbook that is not its own."""

from __future__ import annotations

import errno
import os
import shutil
import struct
import sys
import tempfile
from pathlib import Path

import pytest
import typer

from addin.cli import app
from addin.cli.terminal import writing
from addin.xlsx.errors import SaveRefused
from tests.command_line import ROOT, torsionbook

PROPOSED = ROOT / "templates" / "example_proposed.xlsx"
MODIFIED = ROOT / "templates" / "example_modified.xlsx"


@pytest.mark.parametrize(
    "words",
    [
        ("export", "a.xlsx", "a.xlsx"),
        ("export", "a.xlsx", "b.xlsx"),
        ("recalc", "a.xlsx", "--json", "b.xlsx"),
        ("verify", "a.xlsx", "--json", "b.xlsx"),
        ("diff", "a.xlsx", "c.xlsx", "--json", "b.xlsx"),
        ("diff", "a.xlsx", "c.xlsx", "--xlsx", "b.xlsx"),
        ("accuracy", "a.xlsx", "--json", "b.xlsx"),
        ("calibrate", "a.xlsx", "--case", "b.xlsx"),
    ],
)
def test_a_workbook_is_never_replaced(tmp_path: Path, words: tuple[str, ...]) -> None:
    for name in ("a.xlsx", "b.xlsx"):
        shutil.copy(PROPOSED, tmp_path / name)
    shutil.copy(MODIFIED, tmp_path / "c.xlsx")
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert words[-1] in " ".join(done.stderr.split())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.xlsx", "b.xlsx", "c.xlsx"]
    for name in ("a.xlsx", "b.xlsx"):
        assert (tmp_path / name).read_bytes() == PROPOSED.read_bytes()


@pytest.mark.parametrize("name", ["mine.ods", "mine.json", "mine.txt"])
def test_a_workbook_is_known_by_its_content(tmp_path: Path, name: str) -> None:
    shutil.copy(PROPOSED, tmp_path / name)
    done = torsionbook("export", MODIFIED, name, cwd=tmp_path)
    assert done.returncode == 2
    assert (tmp_path / name).read_bytes() == PROPOSED.read_bytes()


@pytest.mark.parametrize(
    "words", [("recalc", "case.json", "--out"), ("starts", "a.xlsx", "--json")]
)
def test_results_replace_neither_a_workbook_nor_a_case(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    shutil.copy(PROPOSED, tmp_path / "mine.json")
    for name in ("case.json", "other.json"):
        assert torsionbook("export", "a.xlsx", name, cwd=tmp_path).returncode == 0
    broken = (tmp_path / "other.json").read_text(encoding="utf-8").replace(":", "", 1)
    (tmp_path / "broken.json").write_text(broken, encoding="utf-8")
    for name in ("mine.json", "other.json", "broken.json"):
        before = (tmp_path / name).read_bytes()
        assert torsionbook(*words, name, cwd=tmp_path).returncode == 2
        assert (tmp_path / name).read_bytes() == before


def test_results_of_a_case_replace_no_text_in_their_usual_place(tmp_path: Path) -> None:
    assert torsionbook("export", PROPOSED, "case.json", cwd=tmp_path).returncode == 0
    place = tmp_path / "case.results.json"
    place.write_text("mine", encoding="utf-8")
    assert torsionbook("recalc", "case.json", cwd=tmp_path).returncode == 2
    assert place.read_text(encoding="utf-8") == "mine"
    place.unlink()
    for _ in range(2):  # its own earlier results it does replace
        assert torsionbook("recalc", "case.json", cwd=tmp_path).returncode == 0


def test_a_text_that_is_no_json_is_not_replaced(tmp_path: Path) -> None:
    notes, old = tmp_path / "notes.txt", tmp_path / "old.json"
    notes.write_text("mine", encoding="utf-8")
    old.write_text(' {"a": 1}', encoding="utf-8")
    done = torsionbook("export", MODIFIED, notes.name, cwd=tmp_path)
    assert done.returncode == 2
    assert "is there and is no JSON" in " ".join(done.stderr.split())
    assert notes.read_text(encoding="utf-8") == "mine"
    assert torsionbook("export", MODIFIED, old.name, cwd=tmp_path).returncode == 0


def test_a_file_that_is_replaced_keeps_its_mode_and_a_device_is_refused(tmp_path: Path) -> None:
    private = tmp_path / "private.json"
    private.touch(mode=0o600)
    assert torsionbook("export", MODIFIED, private.name, cwd=tmp_path).returncode == 0
    assert private.stat().st_size > 0
    if sys.platform != "win32":
        assert private.stat().st_mode & 0o777 == 0o600
        for name, *words in (
            ("pipe", "export", MODIFIED),
            ("pipe.pdf", "report", "none.xlsx", "--force", "--pdf"),
        ):
            os.mkfifo(tmp_path / name)
            done = torsionbook(*words, name, cwd=tmp_path)
            assert done.returncode == 2
            assert "is a device or a pipe" in done.stdout + done.stderr
            assert (tmp_path / name).is_fifo()


def test_a_comparison_replaces_an_earlier_one(tmp_path: Path) -> None:
    words = ("diff", PROPOSED, MODIFIED, "--xlsx", "d.xlsx")
    for _ in range(2):
        assert torsionbook(*words, cwd=tmp_path).returncode == 0


def test_out_may_name_the_file_of_one_result(tmp_path: Path) -> None:
    """A folder of the name of a workbook is what nobody means."""
    shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    shutil.copy(MODIFIED, tmp_path / "b.xlsx")
    assert torsionbook("recalc", "a.xlsx", "--out", "sub/mine.xlsx", cwd=tmp_path).returncode == 0
    assert (tmp_path / "sub" / "mine.xlsx").is_file()
    for words, sentence in (
        (("recalc", "a.xlsx", "b.xlsx", "--out", "c.xlsx"), "for several inputs, name a folder"),
        (("recalc", "a.xlsx", "--out", "c.xlsm"), "c.xlsm must end in .xlsx"),
        (("tune", "a.xlsx", "--out", "c.json"), "c.json must end in .xlsx"),
        (("batch", "a.xlsx", "--out", "c.xlsx"), "--out must name a folder"),
    ):
        done = torsionbook(*words, cwd=tmp_path)
        assert done.returncode in (1, 2)
        assert sentence in " ".join((done.stdout + done.stderr).replace("│", " ").split())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.xlsx", "b.xlsx", "sub"]


def test_a_failing_disk_is_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(**_: object) -> None:
        raise OSError(errno.EIO, "Input/output error", "train.json")

    monkeypatch.setattr(app, "app", fail)
    with pytest.raises(SystemExit) as ended:
        app.main()
    assert ended.value.code == 1
    assert capsys.readouterr().err.startswith(
        "train.json: Input/output error. Files that were written are"
    )


def test_no_folder_for_temporary_files_is_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As in a container with a read-only disk."""

    def nowhere() -> str:
        monkeypatch.setattr(tempfile, "tempdir", None)
        monkeypatch.setattr(tempfile, "_candidate_tempdir_list", lambda: ["/none/such"])
        return tempfile.gettempdir()

    monkeypatch.setattr(app, "app", lambda **_: nowhere())
    with pytest.raises(SystemExit) as ended:
        app.main()
    assert ended.value.code == 1
    assert capsys.readouterr().err.startswith(
        "No usable temporary directory found in ['/none/such']. "
    )


@pytest.mark.parametrize("wrong", [SaveRefused("it is full"), OSError(errno.EDQUOT, "it is full")])
def test_what_cannot_be_written_is_a_sentence(
    wrong: Exception, capsys: pytest.CaptureFixture[str]
) -> None:
    """`make kills` has `new`, `import` and `excel` fail at every call."""
    with pytest.raises(typer.Exit) as ended, writing(Path("train.xlsx")):
        raise wrong
    assert ended.value.exit_code == 1
    said = capsys.readouterr().err
    assert said.startswith("train.xlsx")
    assert "it is full" in said
    assert "Errno" not in said


@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "a.xlsx", "--out", "kept.xlsx"),
        ("recalc", "kept.xlsx", "--in-place"),
        ("new", "kept.xlsx", "--force"),
        ("export", "a.xlsx", "kept.json"),
    ],
)
def test_a_write_protected_file_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    (name,) = (word for word in words if word.startswith("kept"))
    kept = tmp_path / name
    if kept.suffix == ".xlsx":
        shutil.copy(MODIFIED, kept)
    else:
        kept.touch()
    before = kept.read_bytes()
    kept.chmod(0o444)
    if sys.platform != "win32" and os.getuid() == 0:  # who may write everywhere
        may = os.access
        monkeypatch.setattr(
            os,
            "access",
            lambda path, mode: (mode != os.W_OK or Path(path).name != name) and may(path, mode),
        )
    done = torsionbook(*words, cwd=tmp_path)
    kept.chmod(0o644)
    assert done.returncode == 1
    assert "write-protected" in done.stdout + done.stderr
    assert kept.read_bytes() == before


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights on Windows")
@pytest.mark.parametrize("is_there", [True, False])
@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "a.xlsx", "--out", "link.xlsx"),
        ("recalc", "a.xlsx", "--json", "link.json"),
        ("new", "link.xlsx", "--force"),
        ("import", "a.csv", "--out", "link.xlsx", "--force"),
        ("export", "a.xlsx", "link.json"),
        ("excel", "install", "a.xlsx", "--out", "link.xlsm", "--force"),
        ("verify", "a.xlsx", "--json", "link.json"),
    ],
)
def test_no_command_writes_through_a_link(
    tmp_path: Path, words: tuple[str, ...], is_there: bool
) -> None:
    """Who may write into the folder of the results must not choose which file is replaced."""
    shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    assert torsionbook("export", "a.xlsx", "a.csv", cwd=tmp_path).returncode == 0
    (name,) = (word for word in words if word.startswith("link"))
    link, other = tmp_path / name, tmp_path / f"other{Path(name).suffix}"
    if is_there:
        other.write_bytes(b"{}")
    link.symlink_to(other.name)
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 1
    assert "is a link to another file, which is not replaced" in done.stdout + done.stderr
    assert link.is_symlink()
    assert other.read_bytes() == b"{}" if is_there else not other.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="owners are otherwise on Windows")
@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "a.xlsx", "--in-place"),
        ("export", "a.xlsx", "a.json"),
        ("new", "a.xlsx", "--force"),
    ],
)
def test_a_file_that_is_replaced_keeps_its_owner(tmp_path: Path, words: tuple[str, ...]) -> None:
    """Else whoever calculates as root takes the workbook from its engineer."""
    if os.getuid() != 0:
        pytest.skip("only root may give files away")
    shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    (tmp_path / "a.json").touch()
    for file in tmp_path.iterdir():
        os.chown(file, 65534, 65533)
        file.chmod(0o640)
    assert torsionbook(*words, cwd=tmp_path).returncode == 0
    for file in tmp_path.iterdir():
        found = file.stat()
        assert (found.st_uid, found.st_gid, found.st_mode & 0o777) == (65534, 65533, 0o640), file


#: An access list of Linux, packed: its version, then each entry's kind, rights and user.
ENGINEER = 1001
ACCESS_LIST = struct.pack("<I", 2) + b"".join(
    struct.pack("<HHI", *entry)
    for entry in (
        (1, 6, 0xFFFFFFFF),  # the owner
        (2, 6, ENGINEER),
        (4, 4, 0xFFFFFFFF),  # the group
        (16, 6, 0xFFFFFFFF),  # the most that both get
        (32, 0, 0xFFFFFFFF),  # others
    )
)


@pytest.mark.skipif(sys.platform != "linux", reason="access lists are otherwise elsewhere")
@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "a.xlsx", "--in-place"),
        ("export", "a.xlsx", "a.json"),
        ("new", "a.xlsx", "--force"),
    ],
)
def test_a_file_that_is_replaced_keeps_its_access_list(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    """Else the colleague who was let in is out; and a folder that lets everybody in does not open a private file."""
    shutil.copy(PROPOSED, tmp_path / "a.xlsx")
    (tmp_path / "a.json").touch()
    wanted = {"user.note": b"revision B", "system.posix_acl_access": ACCESS_LIST}
    for file in tmp_path.iterdir():
        for name, value in wanted.items():
            try:
                os.setxattr(file, name, value)
            except OSError:
                pytest.skip("this disk keeps no access lists")
    assert torsionbook(*words, cwd=tmp_path).returncode == 0
    for file in tmp_path.glob("a.*"):
        assert {name: os.getxattr(file, name) for name in os.listxattr(file)} == wanted, file
        os.removexattr(file, "system.posix_acl_access")
        file.chmod(0o640)
    os.setxattr(tmp_path, "system.posix_acl_default", ACCESS_LIST)
    assert torsionbook(*words, cwd=tmp_path).returncode == 0
    for file in (tmp_path / "a.xlsx", tmp_path / "a.json"):
        assert os.listxattr(file) == ["user.note"], file
        assert file.stat().st_mode & 0o777 == 0o640
