"""A verification in words and as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from addin.contract.digests import short_digest
from addin.contract.json_formats import AUDIT_FORMAT
from addin.verify.findings import AGREEMENTS, Agreement, Finding, Verification
from addin.writing.results_json import storable

#: Outcomes that are short as values of JSON, in words.
_OUTCOMES = {
    "follows": "follows from its inputs",
    "does not follow": "does not follow from its inputs",
}
#: Findings listed for people unless all are asked for. [count]
SHOWN = 30


def lines(verification: Verification, everything: bool = False) -> Iterator[str]:
    """A verification in lines for people."""
    outcome = _OUTCOMES.get(verification.outcome, verification.outcome)
    if verification.outcome == "other version":
        outcome = f"calculated by {verification.other_release}: recalculate"
    yield f"{verification.source}: {outcome}. {verification.sentence}"
    if verification.made_by or verification.recorded:
        yield f"  made by {verification.made_by or 'an unknown version'}, verified by {verification.this}"
    if verification.recorded:
        yield f"  inputs  {_digests(verification)}"
    if verification.settings:
        settings = ", ".join(f"{name} = {value}" for name, value in verification.settings.items())
        yield f"  with the recorded settings of the command line: {settings}"
    if verification.counts:
        parts = [
            f"{verification.total(how):,} {AGREEMENTS[how]}"
            for how in Agreement
            if verification.total(how)
        ]
        own = sum(one.not_compared for one in verification.counts)
        if own:
            parts.append(f"{own:,} dates and wall times not compared")
        yield f"  results {'; '.join(parts)}"
    if verification.passes and verification.not_judged:
        yield f"  not judged {', '.join(verification.not_judged)}"
    for problem in verification.problems:
        yield f"  {problem.message}"
    shown = verification.findings if everything else verification.findings[:SHOWN]
    for finding in shown:
        yield f"  {'' if finding.fails else 'note: '}{in_words(finding)}"
    if len(shown) < len(verification.findings):
        more = len(verification.findings) - len(shown)
        yield f"  and {more:,} more: --all lists them, --json FILE writes them."


def in_words(finding: Finding) -> str:
    """A finding with its place."""
    inside = ", ".join(part for part in (finding.table, finding.row, finding.column) if part)
    place = finding.place
    where = f"{place} ({inside})" if place and inside else place or inside
    return f"{where + ', ' if where else ''}{finding.kind}: {finding.sentence}"


def _digests(verification: Verification) -> str:
    if verification.recorded == verification.inputs:
        return f"SHA-256 {short_digest(verification.inputs)}, as recorded"
    return f"SHA-256 {short_digest(verification.inputs)}, but {short_digest(verification.recorded)} is recorded"


def _finding(finding: Finding) -> dict[str, Any]:
    keys = ("kind", "fails", "sheet", "cell", "table", "row", "column", "found", "expected")
    return {key: storable(getattr(finding, key)) for key in keys} | {"message": in_words(finding)}


def as_json(verification: Verification) -> dict[str, Any]:
    """A verification as a JSON object."""
    return {
        "format": AUDIT_FORMAT,
        "file": str(verification.source),
        "outcome": verification.outcome,
        "sentence": verification.sentence,
        "follows": verification.passes,
        "made_by": verification.made_by,
        "verified_by": verification.this,
        "recorded_sha256": verification.recorded,
        "case_sha256": verification.inputs,
        "settings": verification.settings,
        "within": AGREEMENTS[verification.within],
        "looked_at": list(verification.looked_at),
        "not_judged": list(verification.not_judged),
        "tables": [
            {
                "table": one.table,
                "sheet": one.sheet,
                **{AGREEMENTS[how].replace(" ", "_"): one.of[how] for how in Agreement},
                "not_compared": one.not_compared,
            }
            for one in verification.counts
        ],
        "findings": [_finding(finding) for finding in verification.findings],
        "errors": [problem.as_json() for problem in verification.problems],
    }
