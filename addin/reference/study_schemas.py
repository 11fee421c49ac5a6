"""JSON Schemas of what the studies write, made from `addin.contract.tables`; see `addin.reference.json_schemas`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from addin.contract.tables import result_table
from addin.reference.json_schemas import closed_object, problem_schema, result_table_schema
from addin.writing.results_json import FORMAT

if TYPE_CHECKING:
    from addin.studies.study import Study

__all__ = ["study_schema"]

_NUMBER, _TEXT, _COUNT = {"type": "number"}, {"type": "string"}, {"type": "integer"}
_FLAG = {"type": "boolean"}
_BLANK = {"type": ["number", "null"]}
#: A number, the word unlimited, or nothing.
_OR_WORD = ["number", "string", "null"]


def study_schema(study: Study) -> dict[str, Any]:
    """Schema of what a study writes as JSON."""
    digest = {"type": "string", "pattern": "^[0-9a-f]{64}$"}
    always: dict[str, Any] = {
        "format": {"const": FORMAT},
        "study": {"const": study.key},
        "case_sha256": digest,
        "study_sha256": {"description": "Of the rows it was made from."} | digest,
        "version": _TEXT,
        "sentence": {"description": "What was found, in words.", **_TEXT},
        "warnings": _list(_TEXT),
        "errors": _list(problem_schema()),
    }
    specs = [result_table(name) for name in study.results]
    always |= {spec.key: result_table_schema(spec) for spec in specs}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"torsionbook {study.command}",
        "description": "Numbers in SI: Hz, rad/s, N m, Pa, s, kg m²; ratios and percentages as 1.",
        **closed_object(always | _DETAILS[study.key](), required=list(always)),
    }


def _list(items: dict[str, Any], says: str = "") -> dict[str, Any]:
    return ({"description": says} if says else {}) | {"type": "array", "items": items}


def _cut_short(what: str) -> dict[str, Any]:
    """How far a study came that Ctrl-C ended."""
    part = {"calculated": {"description": what, **_COUNT}, "planned": _COUNT}
    told = {"description": "Absent where the study came to its end."} | closed_object(part)
    return {"cut_short": told}


def _tuning() -> dict[str, Any]:
    option = closed_object({"label": _TEXT, "value": _NUMBER})
    variable = {
        "name": {"description": "Element, or the station of an inertia.", **_TEXT},
        "quantity": _TEXT,
        "unit": {"description": "Of the values below; backlash is m or rad.", **_TEXT},
        "present": {"description": "What the case says.", **_NUMBER},
        "options": _list(option),
    }
    choice = {"rank": _COUNT, "values": _list(_BLANK)}
    window = {"from": _NUMBER, "to": {"description": "Absent above the highest band.", **_NUMBER}}
    cell = {
        "across": {"description": "Option of the first variable.", **_TEXT},
        "across_value": _NUMBER,
        "up": {"description": "Option of the second variable.", **_TEXT},
        "up_value": _NUMBER,
        "rank": {"description": "Of the best combination with both.", **_COUNT},
        "limits_broken": _COUNT,
        "allowable_starts": {"description": "Absent where unlimited or not judged.", **_NUMBER},
        "unlimited": {"description": "Absent where starts were not judged.", **_FLAG},
        "worst_margin": _NUMBER,
    }
    cells = closed_object(cell) | {"patternProperties": {"^mode_[1-9][0-9]*$": _NUMBER}}
    return {
        **_cut_short("Combinations."),
        "variables": _list(closed_object(variable)),
        "choices": _list(
            closed_object(choice), "Values of the variables of each combination, by rank."
        ),
        "free_windows": _list(closed_object(window), "Frequencies that no band forbids. [Hz]"),
        "tuning_map": _list(cells),
    }


def _tolerances() -> dict[str, Any]:
    end = {"description": "Null where more samples would be needed.", "type": _OR_WORD}
    nominal = {"description": "Of the plain run; null where not judged.", "type": _OR_WORD}
    percentile = {
        "probability": _NUMBER,
        "value": {"description": "A number, or unlimited.", "type": ["number", "string"]},
        "low": end,
        "high": end,
    }
    answer = {
        "quantity": _TEXT,
        "of": _TEXT,
        "nominal": nominal,
        "unlimited": {"description": "Share of the samples without any damage.", **_NUMBER},
        "samples": _COUNT,
        "percentiles": _list(closed_object(percentile)),
    }
    share = {
        "check": _TEXT,
        "of": _TEXT,
        "required": {"type": _OR_WORD},
        "nominal": nominal,
        "probability": {"description": "Share of the samples that meet it.", **_NUMBER},
        "low": _NUMBER,
        "high": _NUMBER,
        "samples": _COUNT,
    }
    told = {
        "samples": {"description": "Asked for.", **_COUNT},
        "seed": _COUNT,
        "method": {"enum": ["lhs", "sobol"]},
        "replan": _FLAG,
        "samples_planned": _COUNT,
        "samples_calculated": _COUNT,
        "converged": _FLAG,
        "driven": {"description": "The answer whose drivers are told.", **_TEXT},
        "explained": {"description": "Share that the ranks explain; null = not told.", **_BLANK},
        "sentences": _list(_TEXT),
        "percentiles": _list(closed_object(answer)),
        "probabilities": _list(closed_object(share)),
    }
    return _cut_short("Samples.") | {"tolerances": closed_object(told)}


def _sensitivities() -> dict[str, Any]:
    row = {
        "quantity": _TEXT,
        "of": _TEXT,
        "element": _TEXT,
        "peak_torque": {"description": "Change of its peak torque for + 1 %.", **_NUMBER},
        "peak_error": _NUMBER,
        "allowable_starts": {"description": "Change of its starts for + 1 %.", **_NUMBER},
        "starts_error": _NUMBER,
    }
    return {
        "sensitivities_of_elements": _list(closed_object(row)),
        "largest_difference_of_two_ways": {
            "description": "Between differences and the tangent of the start; null without one.",
            **_BLANK,
        },
    }


def _starts() -> dict[str, Any]:
    return {
        **_cut_short("Starts; one that is aborted in the standard matrix is eight."),
        "standard": {"description": "The standard matrix is in it.", **_FLAG},
        "starts_factor": _NUMBER,
        "assumption": {"description": "The rule behind the ledger.", **_TEXT},
        "verdict": {"description": "The worst of the ledger.", **_TEXT},
    }


def _calibration() -> dict[str, Any]:
    return {
        "chi_square": {"description": "Least sum of squares.", **_NUMBER},
        "degrees": {"description": "Measurements used.", **_COUNT},
        "probability": {"description": "That chance makes it as large.", **_NUMBER},
        "explained": {"description": "Everything measured is explained.", **_FLAG},
        "margin_basis": _TEXT,
        "margin_basis_justified": _FLAG,
        "margin_basis_reason": _TEXT,
        "starts": {"description": "Calculated for the peak torques.", **_COUNT},
    }


#: What the JSON of a study has beside its tables, by the key of the study.
_DETAILS = {
    "tuning": _tuning,
    "tolerances": _tolerances,
    "sensitivities": _sensitivities,
    "starts": _starts,
    "calibration": _calibration,
}
