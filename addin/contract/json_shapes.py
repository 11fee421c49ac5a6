"""Shapes of JSON objects, as fragments of a JSON Schema."""

from __future__ import annotations

from typing import Any

Shape = dict[str, Any]

NUMBER: Shape = {"type": "number"}
TEXT: Shape = {"type": "string"}
COUNT: Shape = {"type": "integer"}
FLAG: Shape = {"type": "boolean"}
#: A number or nothing.
BLANK: Shape = {"type": ["number", "null"]}
#: A number, the word unlimited, or nothing.
OR_WORD: Shape = {"type": ["number", "string", "null"]}


def described(words: str, shape: Shape) -> Shape:
    """A shape with what it is."""
    return {"description": words, **shape}


def closed_object(properties: Shape, required: list[str] | None = None) -> Shape:
    """An object that has these keys and no others."""
    content: Shape = {"type": "object", "properties": properties}
    if required:
        content["required"] = required
    return {**content, "additionalProperties": False}


def whole_object(properties: Shape) -> Shape:
    """An object that always has all its keys."""
    return closed_object(properties, required=list(properties))


def list_of(items: Shape, words: str = "") -> Shape:
    """A list; with what it is, where that is said."""
    return ({"description": words} if words else {}) | {"type": "array", "items": items}


def cut_short(counted: str) -> Shape:
    """How far a study came that Ctrl-C ended, counted in such units of work."""
    part = {"calculated": described(counted, COUNT), "planned": COUNT}
    return {"cut_short": described("Absent when the study was completed.", closed_object(part))}
