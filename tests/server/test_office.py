"""Manifest and metadata: what Microsoft's descriptions ask for, read with a parser of XML and JSON."""

import re
import uuid
from itertools import pairwise

import pytest
from lxml import etree
from servers import inside

from addin.server.settings import Settings
from addin.worksheet.registry import FUNCTIONS

APP = "{http://schemas.microsoft.com/office/appforoffice/1.1}"
OVERRIDES = "{http://schemas.microsoft.com/office/taskpaneappversionoverrides}"
BASIC = "{http://schemas.microsoft.com/office/officeappbasictypes/1.0}"
TYPE = "{http://www.w3.org/2001/XMLSchema-instance}type"
PUBLIC = "https://torsion.example.com"


@pytest.fixture(scope="module")
def public():
    with inside(Settings(workers=1, public_url=PUBLIC + "/")) as client:
        yield client


@pytest.fixture(scope="module")
def manifest(public):
    said = public.get("/manifest.xml")
    assert said.headers["Content-Type"].startswith("application/xml")
    assert b"<!--" not in said.content
    return etree.fromstring(said.content)


def test_the_elements_of_an_add_in_are_there_in_the_order_of_the_schema(manifest):
    order = [
        "Id", "Version", "ProviderName", "DefaultLocale", "DisplayName", "Description", "IconUrl",
        "HighResolutionIconUrl", "SupportUrl", "AppDomains", "Hosts", "Requirements", "DefaultSettings",
        "Permissions", "VersionOverrides",
    ]  # fmt: skip
    assert manifest.tag == f"{APP}OfficeApp"
    assert manifest.get(TYPE) == "TaskPaneApp"
    assert [etree.QName(child).localname for child in manifest] == order
    assert uuid.UUID(manifest.findtext(f"{APP}Id")).version == 4
    assert re.fullmatch(r"\d+\.\d+\.\d+\.\d+", manifest.findtext(f"{APP}Version"))
    assert manifest.findtext(f"{APP}Permissions") == "ReadWriteDocument"
    needed = manifest.find(f"{APP}Requirements/{APP}Sets/{APP}Set")
    assert (needed.get("Name"), needed.get("MinVersion")) == ("SharedRuntime", "1.1")


def test_functions_and_page_share_one_runtime(manifest):
    host = manifest.find(f"{OVERRIDES}VersionOverrides/{OVERRIDES}Hosts/{OVERRIDES}Host")
    assert host.get(TYPE) == "Workbook"
    runtime = host.find(f"{OVERRIDES}Runtimes/{OVERRIDES}Runtime")
    assert runtime.get("lifetime") == "long"
    point = host.find(f"{OVERRIDES}AllFormFactors/{OVERRIDES}ExtensionPoint")
    assert point.get(TYPE) == "CustomFunctions"
    page = point.find(f"{OVERRIDES}Page/{OVERRIDES}SourceLocation").get("resid")
    assert page == runtime.get("resid")
    parts = [etree.QName(child).localname for child in point]
    assert parts == ["Script", "Page", "Metadata", "Namespace"]


def test_every_resource_named_is_there_once_and_every_one_there_is_named(manifest):
    used = {one.get("resid") for one in manifest.iter() if one.get("resid")}
    resources = manifest.find(f"{OVERRIDES}VersionOverrides/{OVERRIDES}Resources")
    there = [one.get("id") for kind in resources for one in kind]
    assert sorted(there) == sorted(used)
    assert all(len(name) <= 32 for name in there)
    assert [etree.QName(kind).localname for kind in resources] == [
        "Images", "Urls", "ShortStrings", "LongStrings",
    ]  # fmt: skip
    for kind, longest in (("ShortStrings", 125), ("LongStrings", 250)):
        for one in resources.find(f"{BASIC}{kind}"):
            assert len(one.get("DefaultValue")) <= longest


def test_every_address_is_public_encrypted_and_answers(manifest, public):
    addresses = {
        value
        for one in manifest.iter()
        for value in one.attrib.values()
        if value.startswith("http")
    }
    addresses = {value for value in addresses if "schemas.microsoft.com" not in value}
    assert len(addresses) >= 6
    for address in addresses:
        assert address.startswith(PUBLIC + "/")
        assert public.get(address.removeprefix(PUBLIC)).status_code == 200, address


def test_without_a_public_address_it_is_that_of_the_request(client):
    content = client.get("/manifest.xml").content
    root = etree.fromstring(content)
    assert b"HTTPS only, so not this one" in content
    assert root.find(f"{APP}SupportUrl").get("DefaultValue").startswith("http://127.0.0.1:8765/")


def test_metadata_is_the_registry(client):
    content = client.get("/functions.json").json()
    found = content["functions"]
    assert [f"TV_{one['name']}" for one in found] == list(FUNCTIONS)
    assert content["allowErrorForDataTypeAny"] is True
    for one in found:
        function = FUNCTIONS[f"TV_{one['name']}"]
        assert one["description"] == function.help
        assert re.fullmatch(r"[A-Z][A-Z0-9.]*", one["id"])
        assert re.fullmatch(r"[A-Z][A-Z0-9_]*", one["name"])
        assert one["result"] == {"type": "any", "dimensionality": "matrix"}
        assert bool(one["options"].get("stream")) == function.long
        assert "cancelable" not in one["options"]  # a stream is cancelled without it
        optional = [given["optional"] for given in one["parameters"]]
        assert all(a <= b for a, b in pairwise(optional))
        for given, argument in zip(one["parameters"], function.arguments, strict=True):
            assert given["description"] == argument.help
            assert re.fullmatch(r"\w+", given["name"])
            assert (given["type"], given["dimensionality"]) == ("any", "matrix")
    assert len({one["id"] for one in found}) == len(found)


def test_the_script_knows_every_function(client):
    script = client.get("/functions.js").text
    for one in client.get("/functions.json").json()["functions"]:
        assert (
            f'["{one["id"]}", "TV_{one["name"]}", {str(FUNCTIONS["TV_" + one["name"]].long).lower()}]'
            in script
        )
    assert '"the functions"' not in script
