"""The extension holds what the registry says, in the forms that LibreOffice reads."""

import ast
import io
import json
import struct
import sys
import zipfile
from pathlib import Path

import pytest
from lxml import etree

from addin.libreoffice import oxt
from addin.libreoffice.names import COMPONENT, METHOD_MODULES, identifier, programmatic_name
from addin.libreoffice.oxt import MANIFEST, extension, worker_command
from addin.libreoffice.type_library import MAGIC
from addin.worksheet.registry import FUNCTIONS

OOR = "{http://openoffice.org/2001/registry}"
COMPONENT_FILE = Path(oxt.__file__).with_name("component.py")
COMMAND = ["/somewhere/python", "-m", "it"]


@pytest.fixture(scope="module")
def parts():
    with zipfile.ZipFile(io.BytesIO(extension(COMMAND))) as archive:
        assert archive.testzip() is None
        return {name: archive.read(name) for name in archive.namelist()}


# --- the type library, read from the description of its form ---------------------------------------


class Library:
    """A reader of type libraries with modules and one interface."""

    def __init__(self, data):
        assert data.startswith(MAGIC)
        self.data = data
        self.at, self.end = 0, len(data)

    def number(self):
        (value,) = struct.unpack_from("<I", self.data, self.at)
        self.at += 4
        return value

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def text(self):
        length = self.number()
        self.at += length
        return self.data[self.at - length : self.at].decode("ascii")

    def entry(self, place):
        name, entity = struct.unpack_from("<II", self.data, place)
        return self.data[name : self.data.index(0, name)].decode("ascii"), entity

    def interface(self):
        """Its full name, bases and methods: name → type, parameters, exceptions."""
        self.at = 8
        place, count = self.number(), self.number()
        names = []
        while True:
            assert count == 1
            name, self.at = self.entry(place)
            names.append(name)
            if self.byte() == 5:
                break
            assert self.data[self.at - 1] == 0
            count, place = self.number(), self.at
        bases = [self.text() for _ in range(self.number())]
        assert (self.number(), self.number()) == (0, 0)  # optional bases, attributes
        return names, bases, [self.method() for _ in range(self.number())]

    def method(self):
        name, answer = self.text(), self.text()
        parameters = [(self.byte(), self.text(), self.text()) for _ in range(self.number())]
        return name, answer, parameters, [self.text() for _ in range(self.number())]


def test_the_type_library_has_one_method_a_function(parts):
    names, bases, methods = Library(parts["functions.rdb"]).interface()
    assert names == [*METHOD_MODULES, "XFunctions"]
    assert bases == ["com.sun.star.uno.XInterface"]
    assert methods == [
        (
            name.lower(),
            "any" if function.scalar else "[][]any",
            [(0, identifier(argument.name), "any") for argument in function.arguments],
            [],
        )
        for name, function in FUNCTIONS.items()
    ]


# --- texts and settings ---------------------------------------------------------------------------


def values(node):
    return {prop.get(f"{OOR}name"): prop[0].text for prop in node if prop.tag == "prop"}


def nodes(node):
    return {inner.get(f"{OOR}name"): inner for inner in node if inner.tag == "node"}


def test_the_wizard_shows_the_texts_of_the_registry(parts):
    root = etree.fromstring(parts["CalcAddIns.xcu"])
    (component,) = nodes(nodes(root)["AddInInfo"]).items()
    assert component[0] == COMPONENT
    functions = nodes(nodes(component[1])["AddInFunctions"])
    assert list(functions) == [name.lower() for name in FUNCTIONS]
    for function, node in zip(FUNCTIONS.values(), functions.values(), strict=True):
        assert values(node) == {
            "DisplayName": function.name,
            "Description": function.help,
            "Category": "Add-In",
            "CompatibilityName": function.name,
        }
        told = [(name, values(n)) for name, n in nodes(nodes(node)["Parameters"]).items()]
        assert told == [
            (identifier(a.name), {"DisplayName": a.name, "Description": a.help})
            for a in function.arguments
        ]


def test_the_manifest_names_files_that_are_there(parts):
    root = etree.fromstring(parts[MANIFEST])
    named = [next(v for k, v in e.attrib.items() if k.endswith("full-path")) for e in root]
    # types before the component that needs them
    assert named == ["functions.rdb", "component.py", "CalcAddIns.xcu"]
    assert set(named) <= set(parts)
    etree.fromstring(parts["description.xml"])


def test_the_settings_name_the_python_and_every_function(parts):
    settings = json.loads(parts["settings.json"])
    assert settings["command"] == COMMAND
    assert settings["methods"] == {n.lower(): [n, f.scalar] for n, f in FUNCTIONS.items()}
    assert worker_command() == [sys.executable, "-P", "-m", "addin.libreoffice.worker"]


def test_the_same_input_gives_the_same_bytes():
    assert extension(COMMAND) == extension(COMMAND) != extension(["other"])


def test_names_are_those_uno_takes():
    assert identifier("Shear modulus") == "shearModulus"
    assert identifier("SNPoints") == "snpoints"
    assert programmatic_name("TV_MODE") == "ORG.TORSIONBOOK.CALC.FUNCTIONS.TV_MODE"


def test_the_component_runs_in_a_python_that_has_nothing_of_ours():
    """LibreOffice's own: from 3.7 on, with the standard library and the bridge to UNO."""
    tree = ast.parse(COMPONENT_FILE.read_text(encoding="utf-8"), feature_version=(3, 7))
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            found.add(node.module.split(".")[0])
    assert found - set(sys.stdlib_module_names) == {"unohelper", "com", "org"}
