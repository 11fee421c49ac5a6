"""VBA projects as users have them: saved by Excel, with modules, a form and compiled code."""

import struct

from addin.excel.compound_file import Storage, read_compound_file, write_compound_file
from addin.excel.ovba import compress
from addin.excel.vba import fresh_project
from addin.excel.vba_project import Module, VbaProject, standard_module

OWN = 'Attribute VB_Name = "Modul1"\nSub Meins()\n    MsgBox "Grüße"\nEnd Sub\n'
#: What Excel would have compiled: bytes of any kind before the source.
COMPILED = bytes(range(256)) * 3
FORM_CLASS = bytes.fromhex("F0694AC6DC16CE119E9800AA00574A4F")


def own_module(name: str = "Modul1", text: str = OWN) -> Module:
    """A module with compiled code before its source, in the code page."""
    plain = standard_module(name, f'Attribute VB_Name = "{name}"\n')
    records = tuple(
        (kind, struct.pack("<I", len(COMPILED))) if kind == 0x31 else (kind, data)
        for kind, data in plain.records
    )
    source = text.replace("\n", "\r\n").encode("cp1252")
    return Module(name, records, COMPILED + compress(source))


def saved_by_excel(*modules: Module, project: VbaProject | None = None) -> bytes:
    """A project with these modules, a form, and what Excel keeps of its compiler."""
    base = fresh_project().with_modules((), without=("xlwings", "Dictionary"))
    data = (project or base).with_modules(modules or (own_module(),)).to_bytes()
    root = read_compound_file(data)
    vba = root.entries["VBA"]
    assert isinstance(vba, Storage)
    vba.entries |= {
        "__SRP_0": b"k" * 700,
        "__SRP_1": b"l",
        "_VBA_PROJECT": b"\xcc\x61" + b"v" * 2800,
    }
    root.entries["Form1"] = Storage(
        {"f": b"f" * 80, "o": b"o" * 5000, "\x03VBFrame": b"x"}, FORM_CLASS
    )
    return write_compound_file(root)
