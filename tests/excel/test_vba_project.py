"""Modules into a VBA project: what is ours comes, what is the user's stays."""

import contextlib

import pytest
from olevba_reader import modules_of
from vba_examples import COMPILED, FORM_CLASS, OWN, own_module, saved_by_excel

from addin.excel import vba
from addin.excel.compound_file import Storage, read_compound_file
from addin.excel.errors import ExcelError, VbaProjectError
from addin.excel.vba_project import VbaProject, standard_module


def lines(data):
    return read_compound_file(data).stream("PROJECT").decode("cp1252").split("\r\n")


def test_olevba_lists_the_modules_with_their_exact_source():
    data = vba.fresh_project().with_modules(vba.product_modules()).to_bytes()
    found = modules_of("vbaProject.bin", data)
    assert list(found) == ["ThisWorkbook", "xlwings", "Dictionary", vba.WRAPPERS, vba.MACROS]
    assert found[vba.WRAPPERS] == vba.wrapper_text().replace("\n", "\r\n")
    assert found[vba.MACROS] == vba.macro_text().replace("\n", "\r\n")
    theirs = VbaProject.read(vba._wheel_project())
    assert found["xlwings"] == theirs.source("xlwings")


def test_the_projects_own_list_agrees():
    data = vba.fresh_project().with_modules(vba.product_modules()).to_bytes()
    found = lines(data)
    start = found.index("Document=ThisWorkbook/&H00000000")
    assert found[start + 1 : start + 5] == [
        "Module=xlwings", "Class=Dictionary", "Module=xlwings_udfs", "Module=Torsionbook",
    ]  # fmt: skip
    assert found[start + 5].startswith("Name=")
    windows = found[found.index("[Workspace]") + 1 :]
    assert [w.partition("=")[0] for w in windows] == [
        "ThisWorkbook", "xlwings", "Dictionary", "xlwings_udfs", "Torsionbook", "",
    ]  # fmt: skip
    names = b"".join(
        n.encode() + b"\0" + n.encode("utf-16-le") + b"\0\0"
        for n in ("ThisWorkbook", "xlwings", "Dictionary", "xlwings_udfs", "Torsionbook")
    )
    assert read_compound_file(data).stream("PROJECTwm") == names + b"\0\0"


def test_equal_projects_are_equal_bytes():
    once, again = (
        vba.fresh_project().with_modules(vba.product_modules()).to_bytes() for _ in range(2)
    )
    assert once == again
    assert VbaProject.read(once).to_bytes() == once


def test_modules_of_the_user_stay_byte_for_byte():
    before = saved_by_excel()
    after = VbaProject.read(before).with_modules(vba.product_modules()).to_bytes()
    old, new = read_compound_file(before), read_compound_file(after)
    for path in (("VBA", "Modul1"), ("VBA", "ThisWorkbook"), ("Form1", "f"), ("Form1", "o")):
        assert new.stream(*path) == old.stream(*path)
    assert new.stream("VBA", "Modul1").startswith(COMPILED)
    assert new.entries["Form1"].class_id == FORM_CLASS
    assert modules_of("vbaProject.bin", after)["Modul1"] == OWN.replace("\n", "\r\n")


def test_what_excel_compiled_is_left_out_so_that_it_compiles_anew():
    after = VbaProject.read(saved_by_excel()).with_modules(vba.product_modules()).to_bytes()
    held = read_compound_file(after).entries["VBA"]
    assert isinstance(held, Storage)
    assert held.entries["_VBA_PROJECT"] == bytes.fromhex("CC61FFFF000000")
    assert not [name for name in held.entries if name.startswith("__SRP_")]


def test_a_module_is_replaced_where_it_stands():
    project = VbaProject.read(saved_by_excel(own_module("A"), own_module("B"), own_module("C")))
    new = standard_module("b", 'Attribute VB_Name = "b"\nSub New()\nEnd Sub\n')
    after = VbaProject.read(project.with_modules([new]).to_bytes())
    assert [m.name for m in after.modules] == ["ThisWorkbook", "A", "b", "C"]
    assert after.source("B") == 'Attribute VB_Name = "b"\r\nSub New()\r\nEnd Sub\r\n'
    assert "Module=b" in after.lines or "Module=B" in after.lines


def test_a_module_taken_out_leaves_no_line():
    project = VbaProject.read(saved_by_excel(own_module("A"), own_module("B")))
    after = project.with_modules((), without=("a",)).to_bytes()
    assert [m.name for m in VbaProject.read(after).modules] == ["ThisWorkbook", "B"]
    assert not [line for line in lines(after) if line.startswith(("Module=A", "A="))]
    assert list(modules_of("vbaProject.bin", after)) == ["ThisWorkbook", "B"]
    assert "A" not in read_compound_file(after).entries["VBA"].entries


@pytest.mark.parametrize("cut", range(0, 55_000, 1499))
def test_damage_is_an_error_of_ours_or_harmless(cut):
    data = vba._wheel_project()
    damaged = data[:cut] + bytes(400) + data[cut + 400 :]
    with contextlib.suppress(ExcelError):  # any other error is a fault
        VbaProject.read(damaged)


def test_a_project_without_modules_list_is_named():
    root = read_compound_file(vba._wheel_project())
    from addin.excel.compound_file import write_compound_file
    from addin.excel.ovba import compress

    root.entries["VBA"].entries["dir"] = compress(b"\x10\0\0\0\0\0")
    with pytest.raises(VbaProjectError, match="has no code page"):
        VbaProject.read(write_compound_file(root))
