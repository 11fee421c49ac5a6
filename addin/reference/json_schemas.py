"""JSON Schemas of cases, results, verifications, differences and studies, most made from `addin.contract.tables`.

``make generated`` writes them into ``addin/reference/schemas``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from addin.contract.json_formats import AUDIT_FORMAT, CASE_FORMAT, RESULTS_FORMAT
from addin.contract.json_shapes import TEXT, closed_object, list_of, whole_object
from addin.contract.studies.registry import STUDIES
from addin.contract.study_spec import StudySpec
from addin.contract.tables import INPUT_TABLES, RESULT_TABLES, SCALARS, Field, TableSpec
from engine.case.result_words import Outcome

#: Where the shipped schemas are.
SCHEMA_FOLDER = Path(__file__).resolve().parent / "schemas"

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_QUANTITY = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[^\s\d.+-].*$"
_PROBLEM_KEYS = ("sheet", "table", "row", "column", "found", "allowed", "message")


def case_schema() -> dict[str, Any]:
    """Schema of a case JSON."""
    properties: dict[str, Any] = {"format": {"const": CASE_FORMAT}}
    properties |= {spec.key: _input(spec) for spec in SCALARS}
    properties |= {table.key: _input_table(table) for table in INPUT_TABLES}
    return {
        "$schema": _DIALECT,
        "title": "torsionbook case",
        "description": "Numbers in SI; a string carries its unit; absent means blank.",
        **closed_object(properties, required=["format"]),
    }


def results_schema() -> dict[str, Any]:
    """Schema of a results JSON."""
    texts = {"type": "array", "items": {"type": "string"}}
    properties: dict[str, Any] = {
        "format": {"const": RESULTS_FORMAT},
        "case_sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$"},
        "version": {"type": "string"},
        "outcome": {"type": "string"},
        "warnings": texts,
        "errors": {"type": "array", "items": problem_schema()},
        "startup": _startup(),
    }
    properties |= {table.key: result_table_schema(table) for table in RESULT_TABLES} | _details()
    return {
        "$schema": _DIALECT,
        "title": "torsionbook results",
        "description": "Numbers in SI: Hz, rad/s, N m, Pa, s, kg m²; ratios and percentages as 1.",
        **closed_object(properties, required=["format", "errors"]),
    }


def verify_schema() -> dict[str, Any]:
    """Schema of what `torsionbook verify --json` writes."""
    text, flag, count = {"type": "string"}, {"type": "boolean"}, {"type": "integer", "minimum": 0}
    agreements = ("equal_to_the_bit", "equal_in_the_digits_shown", "within_the_reported_error",
                  "different", "not_compared")  # fmt: skip
    table = {"table": text, "sheet": text} | dict.fromkeys(agreements, count)
    finding = {
        "kind": {"enum": list(_FINDINGS)},
        "fails": {"description": "Whether the file fails by it; else it is a note.", **flag},
        "sheet": {"description": "Sheet; of a result JSON the key of the table.", **text},
        "cell": {"description": "Cell; of a result JSON the path in it.", **text},
        "table": text,
        "row": {"description": "What the row is called: element, mode, excitation.", **text},
        "column": text,
        "found": {"description": "What stands there, in the unit shown.", **_ANYTHING},
        "expected": {"description": "What follows from the inputs.", **_ANYTHING},
        "message": {"description": "The whole sentence.", **text},
    }
    digest = {"type": "string", "pattern": "^([0-9a-f]{64})?$"}
    properties = {
        "format": {"const": AUDIT_FORMAT},
        "file": text,
        "outcome": {"enum": ["follows", "does not follow", "never calculated", "not verified"]},
        "sentence": {"description": "The outcome in words.", **text},
        "follows": {"description": "Whether every result follows from the inputs.", **flag},
        "made_by": {"description": "Version that made the results; empty = not recorded.", **text},
        "verified_by": {"description": "Version that verified them.", **text},
        "recorded_sha256": {
            "description": "Digest that the file records; empty = none.",
            **text,
        },
        "case_sha256": {"description": "Digest of the inputs; empty = not readable.", **digest},
        "settings": {
            "description": "Settings of the command line that the file records, used again. [SI]",
            **_SETTINGS,
        },
        "within": {"description": "What is accepted.", **text},
        "tables": {"type": "array", "items": whole_object(table)},
        "findings": {
            "description": "What fails first, notes last.",
            "type": "array",
            "items": whole_object(finding),
        },
        "errors": {
            "description": "What is wrong with the inputs.",
            "type": "array",
            "items": problem_schema(),
        },
    }
    return _schema(
        "torsionbook verify", "Which results of a file follow from its inputs.", properties
    )


def diff_schema() -> dict[str, Any]:
    """Schema of what `torsionbook diff --json` writes."""
    text, flag, count = {"type": "string"}, {"type": "boolean"}, {"type": "integer", "minimum": 0}
    number = {"type": ["number", "null"]}
    side = whole_object(
        {
            "file": text,
            "revision": {"description": "Tag, document, revision of the title block.", **text},
            "case_sha256": text,
            "software": text,
            "results": {"description": "Where its results come from, in words.", **text},
            "settings": {"description": "Settings of the command line. [SI]", **_SETTINGS},
        }
    )
    verdict = {
        "table": text,
        "row": {"description": "What is judged.", **text},
        "a": {"description": "Verdict; empty where the check is not made.", **text},
        "b": text,
        "result_a": {"description": "The number judged, with its unit.", **text},
        "result_b": text,
        "limit": text,
        "changed": flag,
    }
    change = {
        "kind": {"enum": ["changed", "row_added", "row_removed", "row_renamed"]},
        "table": {"description": "Input or result table; Case for a scalar.", **text},
        "row": text,
        "column": {"description": "Empty for a whole row.", **text},
        "a": {"description": "In the first file; a number in SI.", **_ANYTHING},
        "b": {"description": "In the second file; a number in SI.", **_ANYTHING},
        "difference": {"description": "Second minus first. [SI]", **number},
        "relative": {"description": "Difference over the first. [1]", **number},
        "shown_unit": {"description": "The unit people are shown; a and b are in SI.", **text},
        "administrative": {"description": "Whether it can change no result.", **flag},
    }
    changes = {"type": "array", "items": whole_object(change)}
    properties = {
        "format": {"const": AUDIT_FORMAT},
        "a": side,
        "b": side,
        "same_inputs": count,
        "same_results": count,
        "verdicts": {"type": "array", "items": whole_object(verdict)},
        "inputs": {
            "description": "null where a side is a result JSON, which holds no inputs.",
            "anyOf": [changes, {"type": "null"}],
        },
        "results": changes,
        "studies": whole_object(
            {
                "notes": {
                    "description": "Studies that are not compared, and why.",
                    "type": "array",
                    "items": text,
                },
                "same_inputs": count,
                "same_results": count,
                "inputs": changes,
                "results": changes,
            }
        ),
    }
    return _schema("torsionbook diff", "What changed between two files.", properties)


def study_schema(study: StudySpec) -> dict[str, Any]:
    """Schema of what a study writes as JSON."""
    digest = {"type": "string", "pattern": "^[0-9a-f]{64}$"}
    always: dict[str, Any] = {
        "format": {"const": RESULTS_FORMAT},
        "study": {"const": study.key},
        "case_sha256": digest,
        "study_sha256": {"description": "Of the rows it was made from."} | digest,
        "version": TEXT,
        "sentence": {"description": "What was found, in words.", **TEXT},
        "warnings": list_of(TEXT),
        "errors": list_of(problem_schema()),
    }
    always |= {spec.key: result_table_schema(spec) for spec in study.json_tables}
    return {
        "$schema": _DIALECT,
        "title": f"torsionbook {study.command}",
        "description": "Numbers in SI: Hz, rad/s, N m, Pa, s, kg m²; ratios and percentages as 1.",
        **closed_object(always | study.details, required=list(always)),
    }


def _schema(title: str, description: str, properties: dict[str, Any]) -> dict[str, Any]:
    head = {"$schema": _DIALECT, "title": title, "description": description}
    return head | whole_object(properties)


_ANYTHING: dict[str, Any] = {"type": ["number", "string", "boolean", "null"]}
_SETTINGS: dict[str, Any] = {
    "type": "object",
    "additionalProperties": {"type": ["number", "string"]},
}
#: Kinds of findings, see `addin.verify.findings`.
_FINDINGS = (
    "different",
    "edited",
    "row missing",
    "row added",
    "not shown",
    "not compared",
    "old value",
    "chart",
    "digest",
    "never calculated",
    "settings",
    "table missing",
    "not judged",
)
#: Every shipped schema by name.
SCHEMAS = {
    "case": case_schema,
    "results": results_schema,
    "verify": verify_schema,
    "diff": diff_schema,
}


def write_schemas(folder: Path = SCHEMA_FOLDER) -> list[Path]:
    """Write every schema; the files written."""
    folder.mkdir(parents=True, exist_ok=True)
    schemas = {name: schema() for name, schema in SCHEMAS.items()}
    schemas |= {study.key: study_schema(study) for study in STUDIES}
    written = []
    for name, schema in schemas.items():
        text = json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
        path = folder / f"{name}.schema.json"
        path.write_text(text, encoding="utf-8", newline="\n")
        written.append(path)
    return written


def _described(schema: dict[str, Any], spec: Field) -> dict[str, Any]:
    unit = f" [{spec.si}]" if spec.si else ""
    return {"description": spec.help + unit, **schema}


def _input(spec: Field) -> dict[str, Any]:
    """One input: a number in SI, a string with its unit, or words."""
    if spec.kind == "choice":
        return _described({"enum": list(spec.choices)}, spec)
    if not spec.is_number:
        return _described({"type": "string"}, spec)
    number = {"type": spec.kind}
    if not spec.has_unit:
        return _described(number, spec)
    return _described({"anyOf": [number, {"type": "string", "pattern": _QUANTITY}]}, spec)


def _input_table(table: TableSpec) -> dict[str, Any]:
    row = closed_object({column.key: _input(column) for column in table.columns})
    return {"description": table.help, "type": "array", "items": row}


def _result(spec: Field) -> dict[str, Any]:
    """One result: a number in SI, or words."""
    if spec.kind == "mixed":
        return _described({"type": ["number", "string", "boolean"]}, spec)
    words = "boolean" if spec.kind in ("flag", "switch") else "string"
    return _described({"type": spec.kind if spec.is_number else words}, spec)


def result_table_schema(table: TableSpec) -> dict[str, Any]:
    """Schema of the rows of a result table."""
    row = closed_object({column.key: _result(column) for column in table.columns})
    row["properties"] |= {field.key: _result(field) for field in table.json_only}
    if table.says_unlimited and "allowable_starts" in row["properties"]:
        row["properties"]["allowable_starts"]["type"] = ["number", "null"]
    if table.repeated is not None:
        row["patternProperties"] = {f"^{table.repeated.key}_[1-9][0-9]*$": _result(table.repeated)}
    return {"description": table.help, "type": "array", "items": row}


def _startup() -> dict[str, Any]:
    number = {"type": "number"}
    pull_in = {
        "field_time": {"description": "When the field was applied. [s]", **number},
        "field_slip": {"description": "The slip then. [1]", **number},
        "synchronised": {"description": "In step at the end of the run.", "type": "boolean"},
        "pole_slips": {"description": "Full turns of the load angle.", "type": "integer"},
        "pull_in_time": {"description": "When it came into step for good. [s]", **number},
        "load_angle": {"description": "Mean load angle at the end. [rad]", **number},
        "swing_frequency": {"description": "Frequency of the swing after it. [Hz]", **number},
    }
    force = {
        "station": {"description": "The gear.", "type": "string"},
        "force": {"description": "Largest radial force of its bearings. [N]", **number},
        "time": {"description": "When. [s]", **number},
    }
    return closed_object(
        {
            "outcome": {
                "description": "How the start ended.",
                "enum": [str(outcome) for outcome in Outcome],
            },
            "time": {"description": "When it ended. [s]", "type": "number"},
            "end_speed": {"description": "Speed at the end. [rad/s]", "type": "number"},
            "pull_in": closed_object(pull_in),
            "bearing_forces": {"type": "array", "items": closed_object(force)},
        }
    )


def _details() -> dict[str, Any]:
    """Energy shares, nodes and damped eigenvalues."""
    number = {"type": "number"}
    shares = {"type": "object", "additionalProperties": number}
    node = closed_object({"element": {"type": "string"}, "position": number})
    mode = closed_object(
        {
            "mode": {"description": "Elastic mode, counted from 1.", "type": "integer"},
            "frequency": {"description": "Natural frequency. [Hz]", "type": "number"},
            "strain_energy": {"description": "Share of each element. [1]", **shares},
            "kinetic_energy": {"description": "Share of each station. [1]", **shares},
            "bearing_strain_energy": {
                "description": "Share of the bearings of each gear that moves on them. [1]",
                **shares,
            },
            "sideways_kinetic_energy": {
                "description": "Share of the lateral motion of each such gear. [1]",
                **shares,
            },
            "nodes": {
                "description": "Where the mode stands still; position from the From end. [1]",
                "type": "array",
                "items": node,
            },
        }
    )
    value = closed_object({"real": number, "imaginary": number})
    plan = closed_object({"number": {"type": "integer"}, "reason": {"type": "string"}})
    sensitivity = {
        "spread": {"description": "Largest change of a peak under 1e-9 of the input. [1]"} | number,
        "sensitive": {"description": "Whether it exceeds the tolerance.", "type": "boolean"},
    }
    text = {"type": "string"}
    return {
        "plans": {
            "description": "The plans in order; the last one is reported.",
            "type": "array",
            "items": plan,
        },
        "sensitivity": closed_object(sensitivity),
        "accuracy": closed_object({"sentence": text, "reference": text}),
        "modes": {"description": "Elastic modes in detail.", "type": "array", "items": mode},
        "damped_eigenvalues": {
            "description": "Where dampers couple the modes. [1/s]",
            "type": "array",
            "items": value,
        },
    }


def problem_schema() -> dict[str, Any]:
    """Schema of something wrong with an input."""
    properties: dict[str, Any] = {key: {"type": "string"} for key in _PROBLEM_KEYS}
    properties["row"] = {"type": ["integer", "null"]}
    properties["found"] = {"type": ["string", "number", "boolean", "null"]}
    return closed_object(properties, required=list(_PROBLEM_KEYS))
