"""The description of the HTTP interface for programs, in OpenAPI 3.1."""

from __future__ import annotations

from typing import Any

from addin.contract.json_shapes import FLAG, TEXT, Shape, list_of, whole_object
from addin.contract.version import product_version
from addin.worksheet.registry import FUNCTIONS

JSON, LINES = "application/json", "application/x-ndjson"
WORKBOOKS = (
    "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "application/vnd.ms-excel.sheet.macroEnabled.12",
)


def document() -> dict[str, Any]:
    """The whole description."""
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "torsionbook",
            "version": product_version(),
            "description": "Torsional vibration of synchronous-motor starts. A WebSocket at "
            "/api/v1/stream gives stages and results of long calls; see docs/server.md.",
            "license": {"name": "Apache-2.0", "identifier": "Apache-2.0"},
        },
        "security": [{}, {"key": []}, {"bearer": []}],
        "paths": {
            "/api/v1/batch": {
                "post": _post(
                    "Calls functions; results are in the order of the calls.",
                    {JSON: {"schema": _ref("Batch")}},
                    _answer("An answer for each call.", "Answers"),
                    is_file=False,
                )
            },
            "/api/v1/model": {
                "post": _post(
                    "The handle of the model in a workbook or a case JSON.",
                    {kind: {"schema": {}} for kind in (*WORKBOOKS, JSON)},
                    _answer("The handle, for the functions that take a model.", "Model"),
                    is_file=True,
                )
            },
            "/api/v1/workbook": {
                "post": _post(
                    "Recalculate a workbook; closing the connection cancels it.",
                    {kind: {"schema": {}} for kind in WORKBOOKS},
                    {
                        "description": "The same workbook with its result sheets filled.",
                        "content": {kind: {} for kind in WORKBOOKS},
                    },
                    is_file=True,
                )
            },
            "/api/v1/open-workbook": {
                "post": _post(
                    "Recalculate a copy of an open workbook; closing the connection cancels it.",
                    {kind: {"schema": {}} for kind in WORKBOOKS},
                    {
                        "description": "A JSON object a line: stages, at the end the rectangles to write, or errors.",
                        "content": {LINES: {"schema": _ref("OpenWorkbookLine")}},
                    },
                    is_file=True,
                    wrong_inside=True,
                )
            },
            **_documents(),
            "/functions.json": {"get": _get("Custom functions of Office.", JSON)},
            "/functions.js": {"get": _get("Script of the custom functions.", "text/javascript")},
            "/manifest.xml": {"get": _get("Manifest of the Office add-in.", "application/xml")},
            "/taskpane.html": {"get": _get("Page of the Office add-in.", "text/html")},
            "/": {"get": _get("Page for the browser.", "text/html")},
            "/examples.json": {"get": _get("Shipped examples, at /examples/NAME.xlsx.", JSON)},
            "/openapi.json": {"get": _get("This description.", JSON)},
            "/metrics": {
                "get": {
                    **_get("What the server counts, for Prometheus.", "text/plain"),
                    "security": [{}, {"key": []}, {"bearer": []}],
                }
            },
            "/healthz": {"get": _get("Whether the server answers.", JSON, "Health")},
            "/readyz": {"get": _get("Whether it takes further clients.", JSON, "Health")},
            "/version": {"get": _get("Name and version.", JSON, "Version")},
        },
        "components": {
            "securitySchemes": {
                "key": {"type": "apiKey", "in": "header", "name": "X-API-Key"},
                "bearer": {"type": "http", "scheme": "bearer"},
            },
            "schemas": _schemas(),
        },
    }


def _documents() -> dict[str, Any]:
    """What is asked of a file beside its model."""
    body: Shape = {kind: {"schema": {}} for kind in (*WORKBOOKS, JSON)}
    typed = {"description": "Scalars and tables as typed.", "content": {JSON: {}}}
    file = {"description": "The file.", "content": body}
    lines = {
        "description": "A JSON object a line: stages, at the end a document, or errors.",
        "content": {LINES: {"schema": _ref("DocumentLine")}},
    }
    streamed = {
        "report": ("The calc sheet as a document.", _query("form", "pdf or docx.")),
        "verify": ("Whether the results in a workbook follow from its inputs.", ()),
        "diff": (
            "What differs between two files, sent one behind the other.",
            _query("split", "Size of the first."),
        ),
        "study": (
            "A study of a file.",
            (
                *_query("study", "Its command."),
                *_query("settings", "JSON object: settings as on the command line.", False),
            ),
        ),
    }
    of_study = _query("study", "Command of a study: what it reads instead.", False)
    edit = (
        *_query("changes", "JSON object: values by the names of inputs; rows added and removed."),
        *of_study,
    )
    typed_post = _post("Inputs as typed.", body, typed, is_file=True, more=of_study)
    return {
        "/api/v1/inputs": {"post": typed_post},
        "/api/v1/edited": {
            "post": _post("The file with other inputs.", body, file, is_file=True, more=edit)
        },
        **{
            f"/api/v1/{path}": {
                "post": _post(words, body, lines, is_file=True, wrong_inside=True, more=more)
            }
            for path, (words, more) in streamed.items()
        },
    }


def _query(name: str, description: str, required: bool = True) -> tuple[dict[str, Any], ...]:
    return (
        {
            "name": name,
            "in": "query",
            "required": required,
            "description": description,
            "schema": TEXT,
        },
    )


def _ref(name: str) -> dict[str, str]:
    return {"$ref": f"#/components/schemas/{name}"}


def _answer(description: str, schema: str) -> dict[str, Any]:
    return {"description": description, "content": {JSON: {"schema": _ref(schema)}}}


def _errors(*statuses: int) -> dict[str, Any]:
    """Everything any request may be refused with, and what is said here besides."""
    words = {
        400: "The request cannot be read.",
        401: "An API key is needed.",
        403: "The request comes from a page of another site.",
        408: "The request arrived too slowly.",
        413: "The request is larger than the server accepts.",
        415: "The content type is not accepted.",
        421: "The host name of the request is not one of this server's names.",
        503: "The server is busy; try again later.",
    }
    return {str(status): _answer(words[status], "Error") for status in statuses}


def _get(summary: str, media: str, schema: str | None = None) -> dict[str, Any]:
    content: dict[str, Any] = {media: {"schema": _ref(schema)} if schema else {}}
    return {
        "summary": summary,
        "security": [],
        "responses": {
            "200": {"description": summary, "content": content},
            **_errors(403, 421, 503),
        },
    }


def _post(
    summary: str, body: Shape, answer: Shape, *, is_file: bool, wrong_inside: bool = False,
    more: tuple[dict[str, Any], ...] = (),
) -> dict[str, Any]:  # fmt: skip
    """A request with a body; that of a file may be wrong in itself, and may have a name."""
    has_status = is_file and not wrong_inside
    wrong = {"422": _answer("All errors of the input.", "Problems")} if has_status else {}
    responses = {"200": answer, **wrong, **_errors(400, 401, 403, 408, 413, 415, 421, 503)}
    content = {"required": True, "content": body}
    parameters = {"parameters": [_NAME, *more]} if is_file else {}
    return {"summary": summary, **parameters, "requestBody": content, "responses": responses}


_NAME = {
    "name": "name",
    "in": "query",
    "required": False,
    "description": "File name; its extension distinguishes .xlsm from .xlsx.",
    "schema": TEXT,
}


def _object(required: Shape, optional: Shape | None = None) -> Shape:
    """An object that always has some keys, and may have others."""
    properties = {**required, **(optional or {})}
    return {"type": "object", "required": list(required), "properties": properties}


def _schemas() -> dict[str, Any]:
    sentence = {"type": "string", "minLength": 1}
    plain = ["number", "string", "boolean"]
    cell = {"type": [*plain, "null"]}
    row = list_of(_ref("Cell"))
    problem = ("sheet", "table", "row", "column", "allowed", "message")
    return {
        "Cell": {
            "description": "null for a blank cell; an error is an object as in Office.js.",
            "anyOf": [cell, _object({"type": TEXT}, {"basicValue": {"type": plain}})],
        },
        "Argument": {
            "description": "One cell, a row of cells, or rows of cells.",
            "anyOf": [_ref("Cell"), row, list_of(row)],
        },
        "Call": _object(
            {"name": {**TEXT, "enum": list(FUNCTIONS)}}, {"arguments": list_of(_ref("Argument"))}
        ),
        "Batch": _object({"calls": list_of(_ref("Call"))}),
        "Error": _object(
            {
                "error": _object(
                    {"message": sentence}, {"code": TEXT, "busy": FLAG, "forgotten": FLAG}
                )
            }
        ),
        "Value": whole_object({"value": {**list_of(list_of(cell)), "minItems": 1}}),
        "Answers": _object({"results": list_of({"anyOf": [_ref("Value"), _ref("Error")]})}),
        "Model": _object(
            {
                "model": {**TEXT, "pattern": "^tv:[0-9a-f]{16}\\.[0-9a-f]{16}(-US)?$"},
                "units": {"enum": ["SI", "US"]},
                "warnings": list_of(TEXT),
            }
        ),
        "Problems": _object(
            {
                "error": _object({"message": sentence}),
                "errors": list_of(
                    {
                        "type": "object",
                        "required": list(problem),
                        "properties": {"message": sentence},
                    }
                ),
            },
            {"format": {"const": 1}, "version": TEXT, "warnings": list_of(TEXT)},
        ),
        "OpenWorkbookLine": {
            "anyOf": [
                _object({"stage": TEXT}),
                _object({"value": _ref("Rectangles"), "warnings": list_of(TEXT)}),
                _ref("Problems"),
                _ref("Error"),
            ]
        },
        "DocumentLine": {
            "anyOf": [
                _object({"stage": TEXT}),
                _object({"value": {"type": "object"}, "warnings": list_of(TEXT)}),
                _ref("Problems"),
                _ref("Error"),
            ]
        },
        "Rectangles": _object({"cells": {"type": "integer"}, "sheets": list_of(_sheet())}),
        "Health": _object({"ok": {"const": True}}),
        "Version": _object({"name": TEXT, "version": TEXT}),
    }


def _sheet() -> Shape:
    """What to write into one sheet."""
    cell = {"type": ["number", "string", "boolean"]}
    table = _object({"name": TEXT, "before": TEXT, "after": TEXT}, {"first": TEXT, "added": TEXT})
    block = _object({"at": TEXT, "rows": list_of(list_of(cell))})
    return _object(
        {
            "name": TEXT,
            "tables": list_of(table),
            "cleared": list_of(TEXT),
            "blocks": list_of(block),
        }
    )
