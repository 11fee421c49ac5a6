"""A verification in words and as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from addin.contract.digests import short_digest
from addin.contract.json_formats import AUDIT_FORMAT
from addin.verify.findings import AGREEMENTS, Agreement, Finding, Verification
from addin.writing.results_json import storable

#: Findings listed for people unless all are asked for. [count]
SHOWN = 30


def lines(found: Verification, everything: bool = False) -> Iterator[str]:
    """A verification in lines for people."""
    yield f"{found.source}: {found.outcome}. {found.sentence}"
    if found.made_by or found.recorded:
        yield f"  made by {found.made_by or 'an unknown version'}, verified by {found.this}"
    if found.recorded:
        yield f"  inputs  {_digests(found)}"
    if found.settings:
        settings = ", ".join(f"{name} = {value}" for name, value in found.settings.items())
        yield f"  with the recorded settings of the command line: {settings}"
    if found.counts:
        parts = [f"{found.total(how):,} {AGREEMENTS[how]}" for how in Agreement if found.total(how)]
        own = sum(one.not_compared for one in found.counts)
        if own:
            parts.append(f"{own:,} dates and wall times not compared")
        yield f"  results {'; '.join(parts)}"
    for problem in found.problems:
        yield f"  {problem.message}"
    shown = found.findings if everything else found.findings[:SHOWN]
    for finding in shown:
        yield f"  {'' if finding.fails else 'note: '}{in_words(finding)}"
    if len(shown) < len(found.findings):
        more = len(found.findings) - len(shown)
        yield f"  and {more:,} more; --all lists them, --json FILE writes them."


def in_words(finding: Finding) -> str:
    """A finding with its place."""
    inside = ", ".join(part for part in (finding.table, finding.row, finding.column) if part)
    place = finding.place
    where = f"{place} ({inside})" if place and inside else place or inside
    return f"{where + ', ' if where else ''}{finding.kind}: {finding.sentence}"


def _digests(found: Verification) -> str:
    if found.recorded == found.inputs:
        return f"SHA-256 {short_digest(found.inputs)}, as recorded"
    return f"SHA-256 {short_digest(found.inputs)}, recorded is {short_digest(found.recorded)}"


def as_json(found: Verification) -> dict[str, Any]:
    """A verification as a JSON object."""
    return {
        "format": AUDIT_FORMAT,
        "file": str(found.source),
        "outcome": found.outcome,
        "sentence": found.sentence,
        "follows": found.passes,
        "made_by": found.made_by,
        "verified_by": found.this,
        "recorded_sha256": found.recorded,
        "case_sha256": found.inputs,
        "settings": found.settings,
        "within": AGREEMENTS[found.within],
        "tables": [
            {
                "table": one.table,
                "sheet": one.sheet,
                "equal_to_the_bit": one.of[Agreement.BITS],
                "equal_in_the_digits_shown": one.of[Agreement.DIGITS],
                "within_the_reported_error": one.of[Agreement.ERROR],
                "different": one.of[Agreement.DIFFERENT],
                "not_compared": one.not_compared,
            }
            for one in found.counts
        ],
        "findings": [
            {
                "kind": one.kind,
                "fails": one.fails,
                "sheet": one.sheet,
                "cell": one.cell,
                "table": one.table,
                "row": one.row,
                "column": one.column,
                "found": storable(one.found),
                "expected": storable(one.expected),
                "message": in_words(one),
            }
            for one in found.findings
        ],
        "errors": [problem.as_json() for problem in found.problems],
    }
