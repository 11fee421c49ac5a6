"""The description of the HTTP interface for programs, in OpenAPI 3.1."""

from __future__ import annotations

from typing import Any

from addin.contract.version import product_version
from addin.worksheet.registry import FUNCTIONS

JSON = "application/json"
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
            "/api/v1/batch": {"post": _batch()},
            "/api/v1/model": {"post": _model()},
            "/api/v1/workbook": {"post": _workbook()},
            "/functions.json": {"get": _get("Custom functions of Office.", JSON)},
            "/functions.js": {"get": _get("Script of the custom functions.", "text/javascript")},
            "/manifest.xml": {"get": _get("Manifest of the Office add-in.", "application/xml")},
            "/taskpane.html": {"get": _get("The page inside Office.", "text/html")},
            "/": {"get": _get("The page in a browser.", "text/html")},
            "/openapi.json": {"get": _get("This description.", JSON)},
            "/healthz": {"get": _get("Whether the server answers.", JSON, "Health")},
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


def _ref(name: str) -> dict[str, str]:
    return {"$ref": f"#/components/schemas/{name}"}


def _said(description: str, schema: str) -> dict[str, Any]:
    return {"description": description, "content": {JSON: {"schema": _ref(schema)}}}


def _errors(*statuses: int) -> dict[str, Any]:
    """Everything any request may be refused with, and what is said here besides."""
    words = {
        400: "The request cannot be read.",
        401: "An API key is needed.",
        403: "Sent by a page of another site.",
        408: "The body came too slowly.",
        413: "Larger than the server takes.",
        415: "Of a kind that is not taken here.",
        421: "Addressed to a name the server does not go by.",
        503: "The server is busy; try again later.",
    }
    return {str(status): _said(words[status], "Error") for status in statuses}


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


def _batch() -> dict[str, Any]:
    return {
        "summary": "Call functions; answers come in the same order.",
        "requestBody": {"required": True, "content": {JSON: {"schema": _ref("Batch")}}},
        "responses": {
            "200": _said("An answer for each call.", "Answers"),
            **_errors(400, 401, 403, 408, 413, 415, 421, 503),
        },
    }


_NAME = {
    "name": "name",
    "in": "query",
    "required": False,
    "description": "Name of the file; its ending tells an .xlsm from an .xlsx.",
    "schema": {"type": "string"},
}


def _file(*kinds: str) -> dict[str, Any]:
    return {"required": True, "content": {kind: {"schema": {}} for kind in kinds}}


def _model() -> dict[str, Any]:
    return {
        "summary": "The handle of the model that a workbook or a case JSON holds.",
        "parameters": [_NAME],
        "requestBody": _file(*WORKBOOKS, JSON),
        "responses": {
            "200": _said("The handle, for the functions that take a model.", "Model"),
            "422": _said("Everything wrong with the input.", "Problems"),
            **_errors(400, 401, 403, 408, 413, 415, 421, 503),
        },
    }


def _workbook() -> dict[str, Any]:
    return {
        "summary": "Recalculate a workbook; closing the connection cancels it.",
        "parameters": [_NAME],
        "requestBody": _file(*WORKBOOKS),
        "responses": {
            "200": {
                "description": "The same workbook with its result sheets filled.",
                "content": {kind: {} for kind in WORKBOOKS},
            },
            "422": _said("Everything wrong with the input.", "Problems"),
            **_errors(400, 401, 403, 408, 413, 415, 421, 503),
        },
    }


def _schemas() -> dict[str, Any]:
    text, sentence = {"type": "string"}, {"type": "string", "minLength": 1}
    cell = {
        "description": "null for a blank cell; an object as Office.js has errors.",
        "anyOf": [
            {"type": ["number", "string", "boolean", "null"]},
            {
                "type": "object",
                "required": ["type"],
                "properties": {
                    "type": text,
                    "basicValue": {"type": ["number", "string", "boolean"]},
                },
            },
        ],
    }
    row = {"type": "array", "items": _ref("Cell")}
    return {
        "Cell": cell,
        "Argument": {
            "description": "One cell, a row of cells, or rows of cells.",
            "anyOf": [_ref("Cell"), row, {"type": "array", "items": row}],
        },
        "Call": {
            "type": "object",
            "required": ["name"],
            "properties": {
                "name": {"type": "string", "enum": list(FUNCTIONS)},
                "arguments": {"type": "array", "items": _ref("Argument")},
            },
        },
        "Batch": {
            "type": "object",
            "required": ["calls"],
            "properties": {"calls": {"type": "array", "items": _ref("Call")}},
        },
        "Error": {
            "type": "object",
            "required": ["error"],
            "properties": {
                "error": {
                    "type": "object",
                    "required": ["message"],
                    "properties": {"message": sentence, "code": text},
                }
            },
        },
        "Value": {
            "type": "object",
            "required": ["value"],
            "additionalProperties": False,
            "properties": {
                "value": {
                    "type": "array",
                    "minItems": 1,
                    "items": {
                        "type": "array",
                        "items": {"type": ["number", "string", "boolean", "null"]},
                    },
                }
            },
        },
        "Answers": {
            "type": "object",
            "required": ["results"],
            "properties": {
                "results": {"type": "array", "items": {"anyOf": [_ref("Value"), _ref("Error")]}}
            },
        },
        "Model": {
            "type": "object",
            "required": ["model", "units", "warnings"],
            "properties": {
                "model": {"type": "string", "pattern": "^tv:[0-9a-f]{16}\\.[0-9a-f]{16}(-US)?$"},
                "units": {"enum": ["SI", "US"]},
                "warnings": {"type": "array", "items": text},
            },
        },
        "Problems": {
            "type": "object",
            "required": ["error", "errors"],
            "properties": {
                "error": {
                    "type": "object",
                    "required": ["message"],
                    "properties": {"message": sentence},
                },
                "format": {"const": 1},
                "version": text,
                "warnings": {"type": "array", "items": text},
                "errors": {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "required": ["sheet", "table", "row", "column", "allowed", "message"],
                        "properties": {"message": sentence},
                    },
                },
            },
        },
        "Health": {
            "type": "object",
            "required": ["ok"],
            "properties": {"ok": {"const": True}},
        },
        "Version": {
            "type": "object",
            "required": ["name", "version"],
            "properties": {"name": text, "version": text},
        },
    }
