"""JSON Schemas of cases, results, verifications, differences and studies, most made from `addin.contract.tables`.

``make generated`` writes them into ``addin/reference/schemas``.
"""

from __future__ import annotations

import json
from pathlib import Path

from addin.contract.json_formats import AUDIT_FORMAT, CASE_FORMAT, RESULTS_FORMAT
from addin.contract.json_shapes import (
    BLANK,
    COUNT,
    FLAG,
    NUMBER,
    TEXT,
    Shape,
    closed_object,
    described,
    list_of,
    whole_object,
)
from addin.contract.studies.registry import STUDIES
from addin.contract.study_spec import StudySpec
from addin.contract.tables import EVERY_INPUT, RESULT_TABLES, SCALARS, Field, TableSpec
from engine.case.result_words import Outcome

#: Where the shipped schemas are.
SCHEMA_FOLDER = Path(__file__).resolve().parent / "schemas"

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_QUANTITY = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[^\s\d.+-].*$"
_SOME: Shape = {**COUNT, "minimum": 0}
_DIGEST: Shape = {**TEXT, "pattern": "^[0-9a-f]{64}$"}
_ANYTHING: Shape = {"type": ["number", "string", "boolean", "null"]}
_SETTINGS: Shape = {"type": "object", "additionalProperties": {"type": ["number", "string"]}}
_SHARES: Shape = {"type": "object", "additionalProperties": NUMBER}
#: Something wrong with an input.
_PROBLEM = whole_object(
    dict.fromkeys(("sheet", "table", "row", "column", "found", "allowed", "message"), TEXT)
    | {
        "row": {"type": ["integer", "null"]},
        "found": {"type": ["string", "number", "boolean", "null"]},
    }
)
_IN_SI = (
    "Numbers in SI: Hz, rad/s, N m, Pa, s, kg m²; ratios and percentages as fractions "
    "(20 % is 0.2)."
)


def case_schema() -> Shape:
    """Schema of a case JSON."""
    properties: Shape = {"format": {"const": CASE_FORMAT}}
    properties |= {spec.key: _input(spec) for spec in SCALARS}
    properties |= {table.key: _input_table(table) for table in EVERY_INPUT}
    words = "Numbers in SI; a string is a number with its unit; absent means blank."
    return _schema("case", words, closed_object(properties, required=["format"]))


def results_schema() -> Shape:
    """Schema of a results JSON."""
    properties: Shape = {
        "format": {"const": RESULTS_FORMAT},
        "case_sha256": _DIGEST,
        "version": TEXT,
        "outcome": TEXT,
        "overall": described("Overall verdict, the worst of all checks.", TEXT),
        "headline": described("Banner of sheet Summary.", TEXT),
        "warnings": list_of(TEXT),
        "errors": list_of(_PROBLEM),
        "startup": _startup(),
    }
    properties |= {table.key: result_table_schema(table) for table in RESULT_TABLES} | _details()
    return _schema("results", _IN_SI, closed_object(properties, required=["format", "errors"]))


def verify_schema() -> Shape:
    """Schema of what `torsionbook verify --json` writes."""
    agreements = ("equal_to_the_bit", "equal_in_the_digits_shown", "within_the_reported_error",
                  "different", "not_compared")  # fmt: skip
    table = {"table": TEXT, "sheet": TEXT} | dict.fromkeys(agreements, _SOME)
    finding = {
        "kind": {"enum": list(_FINDINGS)},
        "fails": described("true: verification fails; false: a note only.", FLAG),
        "sheet": described("Sheet, or key of the table in a result JSON.", TEXT),
        "cell": described("Cell, or path in a result JSON.", TEXT),
        "table": TEXT,
        "row": described("Name of the row: element, mode, excitation.", TEXT),
        "column": TEXT,
        "found": described("Recorded value, in the unit shown.", _ANYTHING),
        "expected": described("Recalculated value, in the unit shown.", _ANYTHING),
        "message": described("The finding as a sentence.", TEXT),
    }
    digest = {**TEXT, "pattern": "^([0-9a-f]{64})?$"}
    settings = "Recorded settings of the command line, applied in the verification. [SI]"
    properties = {
        "format": {"const": AUDIT_FORMAT},
        "file": TEXT,
        "outcome": {
            "enum": [
                "follows",
                "does not follow",
                "other version",
                "never calculated",
                "not verified",
            ]
        },
        "sentence": described("The outcome in words.", TEXT),
        "follows": described("Whether every result agrees with the inputs.", FLAG),
        "made_by": described("Version that made the results; empty = not recorded.", TEXT),
        "verified_by": described("Version that verified them.", TEXT),
        "recorded_sha256": described("Digest recorded in the file; empty = none.", TEXT),
        "case_sha256": described("Digest of the inputs; empty = not readable.", digest),
        "settings": described(settings, _SETTINGS),
        "within": described("Accepted deviation.", TEXT),
        "looked_at": list_of(TEXT, "What was looked at beside values and formulas."),
        "not_judged": list_of(TEXT, "What a reader sees and is not judged."),
        "tables": list_of(whole_object(table)),
        "findings": list_of(whole_object(finding), "Findings: failures first, notes last."),
        "errors": list_of(_PROBLEM, "Errors of the inputs."),
    }
    words = "Verification of the results of a file against its inputs."
    return _schema("verify", words, whole_object(properties))


def diff_schema() -> Shape:
    """Schema of what `torsionbook diff --json` writes."""
    side = whole_object(
        {
            "file": TEXT,
            "revision": described("Tag, document, revision of the title block.", TEXT),
            "case_sha256": TEXT,
            "software": TEXT,
            "results": described("Origin of its results.", TEXT),
            "settings": described("Settings of the command line. [SI]", _SETTINGS),
        }
    )
    verdict = {
        "table": TEXT,
        "row": described("What is judged.", TEXT),
        "a": described("Verdict; empty where the check is not made.", TEXT),
        "b": TEXT,
        "result_a": described("Result that is judged, with its unit.", TEXT),
        "result_b": TEXT,
        "limit": TEXT,
        "changed": FLAG,
    }
    change = {
        "kind": {"enum": ["changed", "row_added", "row_removed", "row_renamed"]},
        "table": described("Input or result table; Case for a scalar.", TEXT),
        "row": TEXT,
        "column": described("Empty for a whole row.", TEXT),
        "a": described("Value in the first file; numbers in SI.", _ANYTHING),
        "b": described("Value in the second file; numbers in SI.", _ANYTHING),
        "difference": described("Second value minus first value. [SI]", BLANK),
        "relative": described("Difference divided by the first value. [1]", BLANK),
        "shown_unit": described("Display unit; a and b are in SI.", TEXT),
        "administrative": described("true: cannot affect results.", FLAG),
    }
    changes = list_of(whole_object(change))
    counts = {"same_inputs": _SOME, "same_results": _SOME}
    notes = list_of(TEXT, "Studies that are not compared, and why.")
    of_studies = {"notes": notes, **counts, "inputs": changes, "results": changes}
    of_inputs = described(
        "null where one of the files is a result JSON, which contains no inputs.",
        {"anyOf": [changes, {"type": "null"}]},
    )
    properties = {
        "format": {"const": AUDIT_FORMAT},
        "a": side,
        "b": side,
        **counts,
        "verdicts": list_of(whole_object(verdict)),
        "inputs": of_inputs,
        "results": changes,
        "studies": whole_object(of_studies),
    }
    return _schema("diff", "What changed between two files.", whole_object(properties))


def study_schema(study: StudySpec) -> Shape:
    """Schema of what a study writes as JSON."""
    always: Shape = {
        "format": {"const": RESULTS_FORMAT},
        "study": {"const": study.key},
        "case_sha256": _DIGEST,
        "study_sha256": described(
            "SHA-256 of the study rows that it was calculated from.", _DIGEST
        ),
        "version": TEXT,
        "sentence": described("Summary of the result.", TEXT),
        "warnings": list_of(TEXT),
        "errors": list_of(_PROBLEM),
    }
    always |= {spec.key: result_table_schema(spec) for spec in study.json_tables}
    content = closed_object(always | study.details, required=list(always))
    return _schema(study.command, _IN_SI, content)


def _schema(title: str, words: str, content: Shape) -> Shape:
    return {
        "$schema": _DIALECT,
        "title": f"torsionbook {title}",
        "description": words,
        **content,
    }


#: Kinds of findings, see `addin.verify.findings`.
_FINDINGS = (
    "different",
    "hidden",
    "shown otherwise",
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


def _described(schema: Shape, spec: Field) -> Shape:
    unit = f" [{spec.si}]" if spec.si else ""
    return described(spec.help + unit, schema)


def _input(spec: Field) -> Shape:
    """One input: a number in SI, a string with its unit, or words."""
    if spec.kind == "choice":
        return _described({"enum": list(spec.choices)}, spec)
    if not spec.is_number:
        return _described(TEXT, spec)
    number = {"type": spec.kind}
    if not spec.has_unit:
        return _described(number, spec)
    words = [{"enum": list(spec.choices)}] if spec.choices else []
    return _described({"anyOf": [number, {**TEXT, "pattern": _QUANTITY}, *words]}, spec)


def _input_table(table: TableSpec) -> Shape:
    row = closed_object({column.key: _input(column) for column in table.columns})
    return list_of(row, table.help)


def _result(spec: Field) -> Shape:
    """One result: a number in SI, or words."""
    if spec.kind == "mixed":
        return _described({"type": ["number", "string", "boolean"]}, spec)
    words = "boolean" if spec.kind in ("flag", "switch") else "string"
    return _described({"type": spec.kind if spec.is_number else words}, spec)


def result_table_schema(table: TableSpec) -> Shape:
    """Schema of the rows of a result table."""
    row = closed_object({field.key: _result(field) for field in (*table.columns, *table.json_only)})
    if table.says_unlimited and "allowable_starts" in row["properties"]:
        row["properties"]["allowable_starts"] |= BLANK
    if table.repeated is not None:
        row["patternProperties"] = {f"^{table.repeated.key}_[1-9][0-9]*$": _result(table.repeated)}
    return list_of(row, table.help)


def _startup() -> Shape:
    pull_in = {
        "field_time": described("When the field was applied. [s]", NUMBER),
        "field_slip": described("Slip at field application. [1]", NUMBER),
        "synchronised": described("Whether the motor is in step at the end of the run.", FLAG),
        "pole_slips": described("Full turns of the load angle.", COUNT),
        "pull_in_time": described("Time from which the motor stays synchronised. [s]", NUMBER),
        "load_angle": described("Mean load angle at the end. [rad]", NUMBER),
        "swing_frequency": described(
            "Frequency of the load-angle swing after pull-in. [Hz]", NUMBER
        ),
    }
    force = {
        "station": described("The gear.", TEXT),
        "force": described("Largest radial bearing force. [N]", NUMBER),
        "time": described("When. [s]", NUMBER),
    }
    outcomes = {"enum": [str(outcome) for outcome in Outcome]}
    return closed_object(
        {
            "outcome": described("How the start ended.", outcomes),
            "time": described("Time at the end of the start. [s]", NUMBER),
            "end_speed": described("Speed at the end. [rad/s]", NUMBER),
            "in_step_time": described(
                "Time from which slip stays below in_step_slip; absent where it does not. [s]",
                NUMBER,
            ),
            "in_step_slip": described("Slip below which the motor is in step. [1]", NUMBER),
            "pull_in": closed_object(pull_in),
            "bearing_forces": list_of(closed_object(force)),
        }
    )


def _details() -> Shape:
    """Energy shares, nodes and damped eigenvalues."""
    node = closed_object({"element": TEXT, "position": NUMBER})
    of_bearings = "Share of the bearings of each gear in the strain energy. [1]"
    of_nodes = "Nodes of the mode: element, and position from its From end. [1]"
    mode = {
        "mode": described("Elastic mode, counted from 1.", COUNT),
        "frequency": described("Natural frequency. [Hz]", NUMBER),
        "strain_energy": described("Share of each element in the strain energy. [1]", _SHARES),
        "kinetic_energy": described("Share of each station in the kinetic energy. [1]", _SHARES),
        "bearing_strain_energy": described(of_bearings, _SHARES),
        "sideways_kinetic_energy": described(
            "Share of the lateral motion of each gear in the kinetic energy. [1]", _SHARES
        ),
        "nodes": list_of(node, of_nodes),
    }
    value = closed_object({"real": NUMBER, "imaginary": NUMBER})
    plan = closed_object({"number": COUNT, "reason": TEXT})
    sensitivity = {
        "spread": described(
            "Largest relative distance of a reported peak from an end of its interval over several runs, "
            "their torques changed by billionths. [1]",
            NUMBER,
        ),
        "sensitive": described("Whether this exceeds the tolerance.", FLAG),
        "runs": described("Runs of which the intervals are made.", COUNT),
    }
    shaft = {
        "station": described("First station of that speed in table Stations.", TEXT),
        "speed": described("With the motor at synchronous speed. [rad/s]", NUMBER),
    }
    full_speed = {
        "line_frequency": described("Line frequency. [Hz]", NUMBER),
        "poles": described("Number of poles.", COUNT),
        "rated_power": described("Rated power. [W]", NUMBER),
        "rated_torque": described("Rated torque. [N m]", NUMBER),
        "shafts": list_of(closed_object(shaft), "Every speed of the train."),
        "total_ratio": described("Speed ratio that is farthest from 1. [1]", NUMBER),
        "inertia_constant": described(
            "H of the train: kinetic energy over rated power. [s]", NUMBER
        ),
        "motor_inertia_constant": described("H of the Inertia typed at the motors. [s]", NUMBER),
        "load": described("LoadTorque, referred to the motor, over rated torque. [1]", NUMBER),
        "running_load": described(
            "Running load, or what is taken for it where all are blank, referred to the motor, over rated torque. [1]",
            NUMBER,
        ),
    }
    return {
        "full_speed": closed_object(full_speed),
        "plans": list_of(plan, "The plans in order; the last one is reported."),
        "sensitivity": closed_object(sensitivity),
        "accuracy": closed_object({"sentence": TEXT, "reference": TEXT}),
        "modes": list_of(closed_object(mode), "Elastic modes in detail."),
        "damped_eigenvalues": list_of(
            value, "Eigenvalues of the damped train, where dampers couple the modes. [1/s]"
        ),
    }
