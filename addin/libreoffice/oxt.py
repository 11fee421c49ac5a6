"""The extension torsionbook.oxt, made from the registry.

It holds the type library (one method a function), the texts of the function wizard, the component
and its settings: the command of the process that calculates, and which method is which function.
"""

from __future__ import annotations

import io
import json
import re
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from addin.contract.version import product_version
from addin.libreoffice.names import (
    COMPONENT,
    INTERFACE,
    METHOD_MODULES,
    method_name,
    parameter_names,
)
from addin.libreoffice.type_library import Method, type_library
from addin.worksheet.registry import FUNCTIONS, Function

#: Identifier of the extension; a newer one of the same replaces it.
IDENTIFIER = "org.torsionbook.calc"
MANIFEST = "META-INF/manifest.xml"
#: File in the extension → what LibreOffice takes it for.
REGISTERED = {
    "functions.rdb": "application/vnd.sun.star.uno-typelibrary;type=RDB",
    "component.py": "application/vnd.sun.star.uno-component;type=Python",
    "CalcAddIns.xcu": "application/vnd.sun.star.configuration-data",
}
#: Categories of Calc's function wizard are its own; functions from outside stand under this one.
CATEGORY = "Add-In"
XML = '<?xml version="1.0" encoding="UTF-8"?>\n'


def worker_command(python: str = sys.executable) -> list[str]:
    """The command of the process that calculates."""
    return [python, "-P", "-m", "addin.libreoffice.worker"]


def extension(command: Sequence[str]) -> bytes:
    """The extension as a file."""
    settings = {
        "command": list(command),
        "methods": {method_name(name): [name, f.scalar] for name, f in FUNCTIONS.items()},
    }
    parts = {
        MANIFEST: _manifest().encode(),
        "description.xml": _description().encode(),
        "functions.rdb": type_library(METHOD_MODULES, INTERFACE, _methods()),
        "component.py": Path(__file__).with_name("component.py").read_bytes(),
        "CalcAddIns.xcu": _texts().encode(),
        "settings.json": json.dumps(settings, indent=1).encode(),
    }
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return file.getvalue()


def _methods() -> list[Method]:
    """All parameters are ``any``: a value, a range, or nothing where the formula leaves it out."""
    return [
        Method(
            method_name(function.name),
            "any" if function.scalar else "[][]any",
            tuple((parameter, "any") for parameter in _parameters(function)),
        )
        for function in FUNCTIONS.values()
    ]


def _parameters(function: Function) -> tuple[str, ...]:
    return parameter_names(tuple(argument.name for argument in function.arguments))


def _manifest() -> str:
    entries = "".join(
        f'<manifest:file-entry manifest:full-path="{name}" manifest:media-type="{kind}"/>\n'
        for name, kind in REGISTERED.items()
    )
    return (
        f'{XML}<manifest:manifest xmlns:manifest="http://openoffice.org/2001/manifest">\n'
        f"{entries}</manifest:manifest>\n"
    )


def _description() -> str:
    numbers = re.match(r"\d+(\.\d+)*", product_version())
    return (
        f'{XML}<description xmlns="http://openoffice.org/extensions/description/2006">\n'
        f'<identifier value="{IDENTIFIER}"/>\n'
        f'<version value="{numbers[0] if numbers else "0"}"/>\n'
        '<display-name><name lang="en">torsionbook: torsional vibration functions</name>'
        "</display-name>\n</description>\n"
    )


def _texts() -> str:
    """What Calc shows of the functions; its name for this file is CalcAddIns."""
    functions = "".join(_function(function) for function in FUNCTIONS.values())
    return (
        f'{XML}<oor:component-data xmlns:oor="http://openoffice.org/2001/registry"'
        ' oor:name="CalcAddIns" oor:package="org.openoffice.Office">\n<node oor:name="AddInInfo">'
        f'<node oor:name="{COMPONENT}" oor:op="replace"><node oor:name="AddInFunctions">\n'
        f"{functions}</node></node></node>\n</oor:component-data>\n"
    )


def _function(function: Function) -> str:
    arguments = "".join(
        _node(
            parameter, _shown("DisplayName", argument.name) + _shown("Description", argument.help)
        )
        for parameter, argument in zip(_parameters(function), function.arguments, strict=True)
    )
    inside = (
        _shown("DisplayName", function.name)
        + _shown("Description", function.help)
        + f'<prop oor:name="Category"><value>{CATEGORY}</value></prop>\n'
        + _shown("CompatibilityName", function.name)
        + f'<node oor:name="Parameters">\n{arguments}</node>\n'
    )
    return _node(method_name(function.name), inside)


def _node(name: str, inside: str) -> str:
    return f'<node oor:name={quoteattr(name)} oor:op="replace">\n{inside}</node>\n'


def _shown(name: str, text: str) -> str:
    return f'<prop oor:name="{name}"><value xml:lang="en-US">{escape(text)}</value></prop>\n'
