"""The journal and the folder of results, cut off anywhere."""

import errno
import os
import subprocess
import sys
from contextlib import closing

import pytest
from command_line import environment

from addin.batch.folder import OWN, FolderRefused, OutFolder, digest_of
from addin.batch.journal import Journal, read_journal
from addin.batch.records import DONE, LOCKED, Output, Record, Stamp, failed, outcome_of
from addin.xlsx.errors import SaveRefused, SourceChanged, WorkbookLocked, WorkbookRefused


def record(name: str, **more: object) -> Record:
    fields = {"stamp": Stamp(12, 34, "ab"), "results": {"verdict": "pass", "tag": "Ω\n=1"}}
    return Record(name, f"/in/{name}", DONE, **(fields | more))


def test_what_is_written_is_read_again(tmp_path):
    path = tmp_path / "journal"
    written = [
        record("a", outputs=(Output("a", 3, "ff", "s/a"),), warnings=("w",)),
        failed("b", "/in/b", LOCKED, "open in Excel"),
    ]
    with closing(Journal(path, keep=False)) as journal:
        for one in written:
            journal.write(one)
    assert read_journal(path) == {"a": written[0], "b": written[1]}


def test_the_last_record_of_a_file_counts(tmp_path):
    with closing(Journal(tmp_path / "j", keep=False)) as journal:
        journal.write(record("a", seconds=1.0))
        journal.write(record("a", seconds=2.0))
    assert read_journal(tmp_path / "j")["a"].seconds == 2.0


@pytest.mark.slow
def test_cut_off_at_any_byte_whole_records_stay_and_writing_goes_on(tmp_path):
    path = tmp_path / "journal"
    with closing(Journal(path, keep=False)) as journal:
        journal.write(record("a"))
        first = path.stat().st_size
        journal.write(record("b"))
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        kept = {"a"} if length >= first else set()
        assert set(read_journal(path)) == kept
        with closing(Journal(path, keep=True)) as journal:
            journal.write(record("c"))
        assert set(read_journal(path)) == kept | {"c"}


def test_a_byte_changed_in_a_line_ends_the_journal_there(tmp_path):
    path = tmp_path / "journal"
    with closing(Journal(path, keep=False)) as journal:
        journal.write(record("a"))
        journal.write(record("b"))
    content = bytearray(path.read_bytes())
    content[len(content) * 3 // 4] ^= 1
    path.write_bytes(bytes(content))
    assert set(read_journal(path)) == {"a"}


def test_a_full_disk_leaves_the_journal_as_it_was(tmp_path, monkeypatch):
    path = tmp_path / "journal"
    with closing(Journal(path, keep=False)) as journal:
        journal.write(record("a"))
        before = path.read_bytes()
        write = os.write

        def half(handle, data):
            write(handle, bytes(data)[:10])
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr("addin.batch.journal.os.write", half)
        with pytest.raises(OSError, match="No space"):
            journal.write(record("b"))
        monkeypatch.undo()
        assert path.read_bytes() == before
        journal.write(record("c"))
    assert set(read_journal(path)) == {"a", "c"}


def staged(folder: OutFolder, name: str, text: str) -> Output:
    path = folder.staging / name
    path.write_text(text)
    place = path.relative_to(folder.path).as_posix()
    return Output(f"sub/{name}", len(text), digest_of(path), place)


def test_recorded_results_of_a_killed_batch_are_put_in_place_others_thrown_away(tmp_path):
    folder = OutFolder(tmp_path / "out")
    with closing(Journal(folder.journal, keep=False)) as journal:
        journal.write(record("a", outputs=(staged(folder, "a.xlsx", "recorded"),)))
        staged(folder, "b.xlsx", "not recorded")
    folder._lock.release()  # as when the process is killed: nothing is tidied
    assert not (tmp_path / "out" / "sub").exists()
    with OutFolder(tmp_path / "out") as again:
        assert (tmp_path / "out" / "sub" / "a.xlsx").read_text() == "recorded"
        assert again.holds(read_journal(again.journal)["a"].outputs)
    left = [path.name for path in (tmp_path / "out").rglob("*") if path.is_file()]
    assert sorted(left) == ["a.xlsx", "journal.jsonl", "lock", "lock.txt"]


def test_results_that_were_changed_are_not_held(tmp_path):
    with OutFolder(tmp_path / "out") as folder:
        output = staged(folder, "a.xlsx", "text")
        folder.put([output])
        assert folder.holds([output])
        folder.place(output.name).write_text("TEXT")
        assert not folder.holds([output])
        folder.place(output.name).unlink()
        assert not folder.holds([output])


def test_two_batches_never_share_a_folder_and_a_killed_one_frees_it(tmp_path):
    script = (
        "import sys; from pathlib import Path; from addin.batch.folder import OutFolder\n"
        "folder = OutFolder(Path(sys.argv[1])); print('held', flush=True); sys.stdin.read()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment(),
    )
    try:
        assert other.stdout.readline().strip() == b"held"
        with pytest.raises(FolderRefused, match=f"Another batch .process {other.pid} on .*--out"):
            OutFolder(tmp_path)
    finally:
        other.kill()
        other.wait()
    with OutFolder(tmp_path):
        assert (tmp_path / OWN).is_dir()


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FolderRefused, match="Results cannot be written to"):
        OutFolder(tmp_path / "file" / "out")


def _wrapped(outer: Exception, inner: Exception) -> Exception:
    outer.__cause__ = inner
    return outer


@pytest.mark.parametrize(
    ("cause", "outcome"),
    [
        (WorkbookLocked("open", owner="Ada", lock_file="~$a.xlsx"), "locked"),
        (SourceChanged("changed"), "changed meanwhile"),
        (_wrapped(SaveRefused("x"), OSError(errno.ENOSPC, "full")), "disk full"),
        (_wrapped(SaveRefused("x"), PermissionError(errno.EACCES, "no")), "no access"),
        (OSError(errno.EROFS, "read-only file system"), "no access"),
        (OSError(errno.EIO, "Input/output error"), "no access"),
        (FileNotFoundError(errno.ENOENT, "gone"), "missing"),
        (WorkbookRefused("bomb", "too large"), "unreadable"),
        (SaveRefused("no room"), "wrong input"),
    ],
)
def test_causes_have_names(cause, outcome):
    assert outcome_of(cause) == outcome


def made_up(folder: OutFolder, *outputs: Output) -> None:
    """A journal that somebody wrote, its check sums right, of a batch that was killed."""
    with closing(Journal(folder.journal, keep=False)) as journal:
        journal.write(record("a", outputs=outputs))


def ended(folder: OutFolder) -> None:
    """As when the process is killed: nothing is tidied."""
    folder._lock.release()


@pytest.mark.parametrize("name", ["a.xlsx", "../stolen.xlsx", "sub/../../stolen.xlsx", "FULL"])
@pytest.mark.parametrize(
    "taken", ["STAGED", "../secret.xlsx", "s/../../secret.xlsx", "FULL", "LINK"]
)
def test_a_made_up_journal_moves_nothing_from_or_to_elsewhere(tmp_path, name, taken):
    secret, stolen = tmp_path / "secret.xlsx", tmp_path / "stolen.xlsx"
    secret.write_text("secret")
    folder = OutFolder(tmp_path / "out")
    there = staged(folder, "a.xlsx", "made up")
    link = folder.staging / "link"
    if os.name == "posix":
        link.symlink_to(secret)
    elif taken == "LINK":
        pytest.skip("links need rights on Windows")
    of_staged = {
        "STAGED": there.staged,
        "FULL": str(secret),
        "LINK": link.relative_to(folder.path).as_posix(),
    }
    harmless = (name, taken) == ("a.xlsx", "STAGED")
    name = str(stolen) if name == "FULL" else name
    made_up(folder, Output(name, 6, digest_of(secret), of_staged.get(taken, taken)))
    ended(folder)
    with OutFolder(tmp_path / "out", tmp_path / "json") as again:
        believed, refused = again.records(tmp_path / "json")
    assert secret.read_text() == "secret"
    assert not stolen.exists()
    assert (tmp_path / "out" / "a.xlsx").exists() == harmless
    outputs = [one for record in believed.values() for one in record.outputs]
    assert bool(outputs) == harmless or taken == "LINK"  # the link is cleared away by now
    if not believed:
        assert "names files outside the folders of the batch" in refused[0]


@pytest.mark.parametrize("name", [f"{OWN}/journal.jsonl", ".", "", 7, None, "a\0b"])
def test_odd_names_in_a_journal_are_not_believed(tmp_path, name):
    with OutFolder(tmp_path / "out") as folder:
        made_up(folder, Output(name, 0, ""))
        assert folder.records()[0] == {}
        made_up(folder, Output("a", 0, "", name))
        assert (folder.records()[0] == {}) == (name != "")


def test_json_elsewhere_is_believed_where_it_is_asked_for_only(tmp_path):
    there = tmp_path / "x" / ".." / "j"  # as the command line may name it
    with OutFolder(tmp_path / "out") as folder:
        made_up(folder, Output("a", 1, ""), Output(str(there / "a.results.json"), 1, ""))
        names = [[o.name for o in folder.records(j)[0]["a"].outputs] for j in (there, None)]
    assert names == [["a", str(there / "a.results.json")], ["a"]]


def test_a_device_is_no_result(tmp_path):
    with OutFolder(tmp_path / "out") as folder:
        assert not folder.holds([Output("/dev/zero", 0, "")])
