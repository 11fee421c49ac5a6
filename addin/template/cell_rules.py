"""What a cell says of itself: prompts, drop-downs and rules of typed values."""

from __future__ import annotations

from typing import Any

from addin.contract.tables import Field

#: Excel shows no longer prompt. [characters]
_LONGEST_PROMPT = 255


def hint(field: Field) -> str:
    return f"blank = {field.default_text}" if field.default_text else ""


def _prompt(field: Field) -> dict[str, str]:
    """The input prompt: Excel shows at most 32 and 255 characters."""
    words = [field.help]
    if field.default_text:
        words.append(f"Blank = {field.default_text}.")
    return {"input_title": field.name[:32], "input_message": " ".join(words)[:_LONGEST_PROMPT]}


def trace_prompt(field: Field) -> dict[str, Any]:
    """Equation and source of a result behind its header, as far as there is room for them."""
    assert field.trace is not None
    words = f"{field.trace.equation}\n{field.trace.source}\nEquation and inputs: see sheet Notes."
    if len(words) > _LONGEST_PROMPT:
        words = f"{words[: _LONGEST_PROMPT - 1]}…"
    return {"validate": "any", "input_title": field.name[:32], "input_message": words}


#: Dimensions whose numbers may be negative.
_SIGNED = frozenset({"torque", "excitation torque", "angle"})
_NAME_LISTS = {"station": "StationNames", "element": "ElementNames", "material": "MaterialNames"}


def input_rule(field: Field) -> dict[str, Any]:
    """Drop-down, number rule or prompt alone, as the field asks for."""
    prompt = _prompt(field)
    if field.kind == "choice":
        return prompt | {
            "validate": "list",
            "source": list(field.choices),
            "error_title": field.name[:32],
            "error_message": f"Choose one of: {', '.join(field.choices)}."[:255],
        }
    if field.kind in _NAME_LISTS:
        return prompt | {
            "validate": "list",
            "source": f"={_NAME_LISTS[field.kind]}",
            "error_type": "warning",
            "error_title": "Unknown name",
            "error_message": "No row has this name yet. Keep it anyway?",
        }
    if not field.is_number or field.choices:  # a number, or a word in its place
        return prompt | {"validate": "any"}
    kind = "integer" if field.kind == "integer" else "decimal"
    signed = field.signed or field.dimension in _SIGNED
    low, high = (-1e300, 1e300) if signed else (0, 1e300)
    if kind == "integer":
        low, high = 0, 100000
    asked = "a whole number" if kind == "integer" else "a number"
    asked += " of zero or more" if low == 0 else ""
    return prompt | {
        "validate": kind,
        "criteria": "between",
        "minimum": low,
        "maximum": high,
        "error_title": "Invalid number",
        "error_message": f"Type {asked}; its unit is in the unit cell.",
    }


def unit_list(field: Field) -> dict[str, Any]:
    """Drop-down of the usual units; any other of the right dimension may be typed."""
    return {
        "validate": "list",
        "source": list(field.units),
        "show_error": False,
        "input_title": "Unit",
        "input_message": "Choose a unit, or type another of the same dimension. Numbers are read in this "
        "unit; they are not converted.",
    }
