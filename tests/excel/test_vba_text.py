"""The VBA text against xlwings' own generator, run with the Windows layer stubbed."""

import io
import re
from types import SimpleNamespace
from unittest.mock import MagicMock

import pytest

from addin.excel import vba
from addin.excel.errors import XlwingsMissing
from addin.excel.signatures import excel_functions
from addin.excel.vba_project import standard_module


def test_the_wrappers_are_what_xlwings_generates(excel):
    made = io.StringIO()
    excel.udfs.generate_vba_wrapper(
        vba.UDF_MODULE, excel.module, made, SimpleNamespace(Name="train.xlsm")
    )
    assert vba.wrapper_text().endswith(made.getvalue())
    assert made.getvalue().count("End Function") == len(excel_functions())


def test_the_whole_module_is_what_the_import_button_would_put_there(excel):
    """`import_udfs`, which the ribbon of xlwings calls, up to the file it hands to the editor."""
    texts = []
    book = MagicMock()
    book.Name = "train.xlsm"
    book.Application.Version = "16.0"
    components = book.VBProject.VBComponents

    def imported(path):
        with open(path, encoding="ascii") as file:
            texts.append(file.read())

    components.Import = imported
    excel.udfs.udf_modules[vba.UDF_MODULE] = {
        "filename": "",
        "filetime": None,
        "module": excel.module,
    }
    excel.udfs.import_udfs(vba.UDF_MODULE, book)
    assert texts == [vba.wrapper_text()]
    described = [c.args[0] for c in book.Application.MacroOptions.call_args_list]
    assert described == [f"'train.xlsm'!{one.name}" for one in excel_functions()]


def test_the_macros_call_what_is_there(excel):
    text = vba.macro_text()
    called = re.search(r'RunPython "import ([\w.]+);([\w.]+)\.(\w+)\(\)"', text)
    assert called is not None
    assert called[1] == called[2] == vba.UDF_MODULE == excel.module.__name__
    assert callable(getattr(excel.module, called[3]))
    assert "cannot undo" in text


def test_nothing_runs_by_itself():
    """Of what olevba takes for a start by itself, our modules have nothing."""
    words = re.compile(
        r"\b(auto_?(open|exec|close)|workbook_(open|activate)|document_open)\b", re.I
    )
    for text in (vba.macro_text(), vba.wrapper_text()):
        assert not words.search(text)
        assert "WScript" not in text


def test_the_macros_give_the_wizard_every_help(excel):
    """Each argument of each function, in the order of its parameters, within VBA's limits."""
    text = vba.macro_text()
    for one in excel_functions():
        entry = text.partition(f'Describe "{one.name}",')[2].partition('    Describe "')[0]
        assert entry.count(", _\n") == len(one.arguments) - 1
        assert entry.count(" _\n") <= 24
    assert all(len(line) <= 1023 for line in text.splitlines())
    assert text.isascii()
    assert "ChrW(960)" in text  # the π of the stiffness


def test_quotes_and_other_alphabets_in_a_help():
    assert vba._quoted('say "π" or Ω') == '"say """ & ChrW(960) & """ or " & ChrW(937)'


def test_the_project_has_the_library_of_the_pinned_version():
    source = vba.fresh_project().source("xlwings")
    assert source is not None
    assert f'XLWINGS_VERSION As String = "{vba.XLWINGS_VERSION}"' in source
    for bits in (64, 32):
        assert f'"xlwings{bits}-{vba.XLWINGS_VERSION}.dll"' in source
    assert "BSD 3-clause license" in source


def test_another_xlwings_is_refused(monkeypatch):
    vba._wheel_project.cache_clear()
    monkeypatch.setattr(vba.metadata, "version", lambda name: "0.36.0")
    with pytest.raises(XlwingsMissing, match=r"0\.36\.0.*pip install xlwings==0\.37\.8"):
        vba.fresh_project()


def test_a_missing_xlwings_is_named(monkeypatch):
    def missing(name):
        raise vba.metadata.PackageNotFoundError(name)

    vba._wheel_project.cache_clear()
    monkeypatch.setattr(vba.metadata, "version", missing)
    with pytest.raises(XlwingsMissing, match="xlwings is not installed"):
        vba.fresh_project()


def test_a_module_must_begin_with_its_name():
    with pytest.raises(AssertionError):
        standard_module("A", 'Attribute VB_Name = "B"\n')


def test_nothing_waits_for_a_workbook_that_may_be_closed_by_then() -> None:
    """What `OnTime` waits for opens it again."""
    text = vba.macro_text()
    assert "OnTime" not in text
    recalculate = text.partition("Sub Recalculate()")[2].partition("End Sub")[0]
    assert recalculate.rstrip().endswith("Application.StatusBar = False")
