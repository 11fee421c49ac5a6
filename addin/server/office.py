"""What the Office host loads: metadata of the functions, their script, the manifest."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

from lxml import etree

from addin.contract.version import product_version
from addin.worksheet.registry import FUNCTIONS, Function

#: Before every name in a cell of Excel: =TV.FREQUENCIES(...).
NAMESPACE = "TV"
#: The add-in's own number; a new one would be another add-in to Office.
ADD_IN_ID = "6f0b5a52-6d0e-4f0b-9c57-1a7e3c2f84d1"
STATIC = Path(__file__).parent / "static"


@cache
def static(name: str) -> bytes:
    """A file of the page."""
    return (STATIC / name).read_bytes()


def function_id(name: str) -> str:
    """The id of a function in the Office host, which may hold letters, digits and points only."""
    return name.replace("_", ".")


def functions_json() -> dict[str, Any]:
    """The metadata of custom functions, as Office.js wants it."""
    return {
        "allowCustomDataForDataTypeAny": True,
        "allowErrorForDataTypeAny": True,
        "functions": [_metadata(one) for one in FUNCTIONS.values()],
    }


def _metadata(function: Function) -> dict[str, Any]:
    # the addresses of the arguments tell blank cells from zeros (functions.js)
    options = (
        {"stream": True, "requiresStreamParameterAddresses": True}
        if function.long
        else {"requiresParameterAddresses": True}
    )
    return {
        "id": function_id(function.name),
        "name": function.name.removeprefix(f"{NAMESPACE}_"),
        "description": function.help,
        "options": options,
        "result": {"type": "any", "dimensionality": "matrix"},
        "parameters": [
            {
                "name": argument.name.replace(" ", "_"),
                "description": argument.help,
                "type": "any",
                "dimensionality": "matrix",
                "optional": argument.optional,
            }
            for argument in function.arguments
        ],
    }


def functions_script() -> bytes:
    """The script that connects the functions with the server."""
    table = [[function_id(f.name), f.name, f.long] for f in FUNCTIONS.values()]
    return static("functions.js").replace(b'"the functions"', json.dumps(table).encode())


# --- the manifest ---------------------------------------------------------------------------------

APP = "http://schemas.microsoft.com/office/appforoffice/1.1"
BASIC = "http://schemas.microsoft.com/office/officeappbasictypes/1.0"
OVERRIDES = "http://schemas.microsoft.com/office/taskpaneappversionoverrides"
TYPE = "{http://www.w3.org/2001/XMLSchema-instance}type"
ABOUT = "Torsional vibration of synchronous-motor starts, calculated as you type."


def manifest(base: str) -> bytes:
    """The add-in's manifest, after Microsoft's description of the add-in only XML."""
    numbers = (re.findall(r"\d+", product_version()) + ["0"] * 4)[:4]
    root = etree.Element(f"{{{APP}}}OfficeApp", nsmap={None: APP, "bt": BASIC, "ov": OVERRIDES})
    root.set(TYPE, "TaskPaneApp")
    for tag, text in (
        ("Id", ADD_IN_ID),
        ("Version", ".".join(numbers)),
        ("ProviderName", "torsionbook"),
        ("DefaultLocale", "en-US"),
    ):
        _child(root, APP, tag).text = text
    _child(root, APP, "DisplayName", DefaultValue="torsionbook")
    _child(root, APP, "Description", DefaultValue=ABOUT)
    _child(root, APP, "IconUrl", DefaultValue=f"{base}/icon-32.png")
    _child(root, APP, "HighResolutionIconUrl", DefaultValue=f"{base}/icon-64.png")
    _child(root, APP, "SupportUrl", DefaultValue=f"{base}/taskpane.html")
    _child(_child(root, APP, "AppDomains"), APP, "AppDomain").text = base
    _child(_child(root, APP, "Hosts"), APP, "Host", Name="Workbook")
    needed = _child(_child(root, APP, "Requirements"), APP, "Sets", DefaultMinVersion="1.1")
    _child(needed, APP, "Set", Name="SharedRuntime", MinVersion="1.1")
    _child(
        _child(root, APP, "DefaultSettings"), APP, "SourceLocation",
        DefaultValue=f"{base}/taskpane.html",
    )  # fmt: skip
    _child(root, APP, "Permissions").text = "ReadWriteDocument"
    _overrides(root, base)
    etree.cleanup_namespaces(root, keep_ns_prefixes=["bt"])
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def _overrides(root: Any, base: str) -> None:
    """Shared runtime, custom functions, and the button that shows the page."""
    versions = etree.SubElement(root, f"{{{OVERRIDES}}}VersionOverrides", nsmap={None: OVERRIDES})
    versions.set(TYPE, "VersionOverridesV1_0")
    host = _child(_child(versions, OVERRIDES, "Hosts"), OVERRIDES, "Host")
    host.set(TYPE, "Workbook")
    runtimes = _child(host, OVERRIDES, "Runtimes")
    _child(runtimes, OVERRIDES, "Runtime", resid="Page.Url", lifetime="long")
    _functions(_child(host, OVERRIDES, "AllFormFactors"))
    desktop = _child(host, OVERRIDES, "DesktopFormFactor")
    start = _child(desktop, OVERRIDES, "GetStarted")
    for tag, name in (("Title", "Title"), ("Description", "About"), ("LearnMoreUrl", "Page.Url")):
        _child(start, OVERRIDES, tag, resid=name)
    _child(desktop, OVERRIDES, "FunctionFile", resid="Page.Url")
    _button(desktop)
    _resources(versions, base)


def _functions(factors: Any) -> None:
    point = _child(factors, OVERRIDES, "ExtensionPoint")
    point.set(TYPE, "CustomFunctions")
    for tag, name in (("Script", "Script.Url"), ("Page", "Page.Url"), ("Metadata", "Metadata.Url")):
        _child(_child(point, OVERRIDES, tag), OVERRIDES, "SourceLocation", resid=name)
    _child(point, OVERRIDES, "Namespace", resid="Namespace")


def _button(desktop: Any) -> None:
    point = _child(desktop, OVERRIDES, "ExtensionPoint")
    point.set(TYPE, "PrimaryCommandSurface")
    tab = _child(point, OVERRIDES, "OfficeTab", id="TabHome")
    group = _child(tab, OVERRIDES, "Group", id="Torsionbook.Group")
    _child(group, OVERRIDES, "Label", resid="Title")
    _icon(group)
    button = _child(group, OVERRIDES, "Control", id="Torsionbook.Show")
    button.set(TYPE, "Button")
    _child(button, OVERRIDES, "Label", resid="Title")
    tip = _child(button, OVERRIDES, "Supertip")
    _child(tip, OVERRIDES, "Title", resid="Title")
    _child(tip, OVERRIDES, "Description", resid="About")
    _icon(button)
    action = _child(button, OVERRIDES, "Action")
    action.set(TYPE, "ShowTaskpane")
    _child(action, OVERRIDES, "TaskpaneId").text = "Torsionbook.Pane"
    _child(action, OVERRIDES, "SourceLocation", resid="Page.Url")


def _icon(parent: Any) -> None:
    icon = _child(parent, OVERRIDES, "Icon")
    for size in (16, 32, 80):
        _child(icon, BASIC, "Image", size=str(size), resid=f"Icon.{size}")


def _resources(versions: Any, base: str) -> None:
    resources = _child(versions, OVERRIDES, "Resources")
    images = _child(resources, BASIC, "Images")
    for size in (16, 32, 80):
        _child(images, BASIC, "Image", id=f"Icon.{size}", DefaultValue=f"{base}/icon-{size}.png")
    urls = _child(resources, BASIC, "Urls")
    for name, path in (
        ("Page", "taskpane.html"),
        ("Script", "functions.js"),
        ("Metadata", "functions.json"),
    ):
        _child(urls, BASIC, "Url", id=f"{name}.Url", DefaultValue=f"{base}/{path}")
    short = _child(resources, BASIC, "ShortStrings")
    _child(short, BASIC, "String", id="Namespace", DefaultValue=NAMESPACE)
    _child(short, BASIC, "String", id="Title", DefaultValue="torsionbook")
    _child(_child(resources, BASIC, "LongStrings"), BASIC, "String", id="About", DefaultValue=ABOUT)


def _child(parent: Any, space: str, tag: str, **attributes: str) -> Any:
    return etree.SubElement(parent, f"{{{space}}}{tag}", attributes)
