"""LibreOffice Calc as a person uses it: cells typed into, rows inserted and deleted, and what a cell then shows."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from xml.sax.saxutils import escape

from tests.conftest import Soffice, end_group, write_profile

#: What a person does, one step a line, its words parted by tabs: ``open FILE``, ``number SHEET CELL X``,
#: ``text SHEET CELL WORDS``, ``formula SHEET CELL FORMULA``, ``clear SHEET CELL``, ``insert SHEET ROW``, ``delete SHEET ROW``, ``undo``,
#: ``read SHEET CELL``.
_BASIC = """
Sub Main(steps As String, answers As String)
  Dim book, sheet, cell, words, step_ As String, hidden(0) As New com.sun.star.beans.PropertyValue
  On Error GoTo Failed
  hidden(0).Name = "Hidden"
  hidden(0).Value = True
  Open steps For Input As #1
  Open answers For Output As #2
  Do While Not EOF(1)
    Line Input #1, step_
    words = Split(step_, Chr(9))
    Select Case words(0)
      Case "open"
        If Not IsEmpty(book) Then book.close(True)
        book = StarDesktop.loadComponentFromURL(ConvertToURL(words(1)), "_blank", 0, hidden())
      Case "undo"
        book.UndoManager.undo()
      Case "insert"
        book.Sheets.getByName(words(1)).Rows.insertByIndex(CLng(words(2)) - 1, 1)
      Case "delete"
        book.Sheets.getByName(words(1)).Rows.removeByIndex(CLng(words(2)) - 1, 1)
      Case Else
        cell = book.Sheets.getByName(words(1)).getCellRangeByName(words(2))
        Select Case words(0)
          Case "number" : cell.Value = Val(words(3))
          Case "text" : cell.String = words(3)
          Case "formula" : cell.Formula = words(3)
          Case "clear" : cell.clearContents(23)
          Case "read" : Print #2, cell.String
        End Select
    End Select
  Loop
  book.close(True)
  Close #2
  Close #1
  StarDesktop.terminate()
  Exit Sub
Failed:
  Print #2, "ERROR " & Error$ & " in " & step_
  Close #2
  StarDesktop.terminate()
End Sub
"""
_MODULE = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<!DOCTYPE script:module PUBLIC "-//OpenOffice.org//DTD OfficeDocument 1.0//EN" "module.dtd">\n'
    '<script:module xmlns:script="http://openoffice.org/2000/script" script:name="Module1" '
    'script:language="StarBasic">{}</script:module>'
)


def answers(soffice: Soffice, folder: Path, steps: Iterable[tuple[object, ...]]) -> list[str]:
    """What each ``read`` of the steps shows, in one session of LibreOffice with a profile of its own."""
    profile = folder / "typing"
    if not profile.exists():
        write_profile(profile)
        settings = profile / "user" / "registrymodifications.xcu"
        allowed = settings.read_text().replace(
            '"DisableMacrosExecution" oor:op="fuse"><value>true',
            '"DisableMacrosExecution" oor:op="fuse"><value>false',
        )
        settings.write_text(allowed)
        _run(soffice, profile, "--terminate_after_init")
    module = profile / "user" / "basic" / "Standard" / "Module1.xba"
    module.write_text(_MODULE.format(escape(_BASIC)), encoding="utf-8")
    todo, done = folder / "steps.txt", folder / "answers.txt"
    done.unlink(missing_ok=True)
    steps = list(steps)
    for step in steps:
        if step[0] == "open":  # a copy, so that no lock file appears beside the workbook
            shutil.copyfile(Path(str(step[1])), _beside(folder, step[1]))
    steps = [("open", _beside(folder, s[1])) if s[0] == "open" else s for s in steps]
    todo.write_text("".join("\t".join(map(str, step)) + "\n" for step in steps), encoding="utf-8")
    _run(soffice, profile, f'macro:///Standard.Module1.Main("{todo}","{done}")')
    return done.read_text(encoding="utf-8").splitlines()


def _beside(folder: Path, path: object) -> Path:
    return folder / f"open-{Path(str(path)).name}"


def _run(soffice: Soffice, profile: Path, last: str) -> None:
    words = [soffice.program, f"-env:UserInstallation={profile.as_uri()}", "--headless"]
    with subprocess.Popen(
        [*words, "--norestore", "--nolockcheck", "--nologo", last],
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:  # fmt: skip
        try:
            process.wait(timeout=soffice.timeout)
        except subprocess.TimeoutExpired:
            end_group(process)
            raise
