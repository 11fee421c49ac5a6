"""What verification finds: agreement of single results, findings, and the whole of a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from pathlib import Path
from typing import Any

from addin.contract.problems import CellProblem
from addin.contract.tables import EVERY_TABLE
from addin.contract.version import RELEASED


class Agreement(IntEnum):
    """How well what stands there agrees with what follows from the inputs."""

    BITS = 0
    DIGITS = 1
    ERROR = 2
    DIFFERENT = 3


#: In words.
AGREEMENTS = {
    Agreement.BITS: "equal to the bit",
    Agreement.DIGITS: "equal in the digits shown",
    Agreement.ERROR: "within the reported error",
    Agreement.DIFFERENT: "different",
}


@dataclass(frozen=True)
class Finding:
    """One thing that does not follow from the inputs, or that somebody should look at."""

    #: ``different``, ``edited``, ``row missing``, ``row added``, ``not shown``, ``old value``,
    #: ``chart``, ``digest``, ``never calculated``, ``settings``, ``table missing``, ``not
    #: judged``, ``not compared`` (a study), ``hidden``, ``shown otherwise``.
    kind: str
    sheet: str  #: Where; of a JSON file the table's key and the path.
    cell: str  #: Likewise.
    sentence: str  #: What was found, without the place.
    #: Result table, what its row is called, and the header; empty where there is none.
    table: str = ""
    row: str = ""  #: Likewise.
    column: str = ""  #: Likewise.
    found: Any = None  #: What stands there, and what would be written there. [shown unit]
    expected: Any = None  #: Likewise. [shown unit]
    fails: bool = True  #: Whether the file fails by it; else it is a note.

    @property
    def place(self) -> str:
        """``Steady state!G7``, or the path in a JSON file. [cell]"""
        return f"{self.sheet}!{self.cell}" if self.sheet and self.cell else self.sheet or self.cell


@dataclass
class Counts:
    """How many results of one table agree, and how well."""

    table: str  #: Result table and where it stands.
    sheet: str  #: Likewise.
    of: list[int] = field(default_factory=lambda: [0, 0, 0, 0])  #: By `Agreement`.
    not_compared: int = 0  #: Wall times, dates and what else each run has its own of.


@dataclass(frozen=True)
class Verification:
    """What is said of one file."""

    source: Path  #: The file.
    #: ``follows``, ``does not follow``, ``other version`` (differences that another version may have
    #: made), ``never calculated`` or ``not verified`` (its inputs cannot be calculated, it cannot be
    #: read, or its own formulas cannot be judged).
    outcome: str
    sentence: str  #: The outcome in words.
    #: Version that made the results, and this one; the first is empty if nothing says so.
    made_by: str = ""
    this: str = ""  #: Likewise.
    #: Digest of the inputs that the file records, and of the inputs in it. [hex]
    recorded: str = ""
    inputs: str = ""  #: Likewise. [hex]
    #: Settings of the command line that the file records, used again here. [SI]
    settings: dict[str, Any] = field(default_factory=dict)
    within: Agreement = Agreement.ERROR  #: What is accepted.
    counts: tuple[Counts, ...] = ()  #: One a table.
    #: What fails first, notes last; of each the headline answers first.
    findings: tuple[Finding, ...] = ()
    problems: tuple[CellProblem, ...] = ()  #: What is wrong with the inputs.
    #: What was looked at beside the values, and what a reader sees that nobody looked at.
    looked_at: tuple[str, ...] = ()
    not_judged: tuple[str, ...] = ()  #: Likewise.

    @property
    def passes(self) -> bool:
        """Whether everything in it follows from its inputs."""
        return self.outcome == "follows"

    @property
    def same_version(self) -> bool:
        """Whether this version made the results."""
        return self.made_by == self.this

    @property
    def other_release(self) -> str:
        """The release that made the results, if it is another one than this. [version]"""
        names = {f"torsionbook {version}": version for version in RELEASED}
        return "" if self.same_version else names.get(self.made_by, "")

    @property
    def same_inputs(self) -> bool:
        """Whether the results belong to the inputs in the file."""
        return self.recorded == self.inputs

    def total(self, agreement: Agreement) -> int:
        """Results that agree just so well."""
        return sum(one.of[agreement] for one in self.counts)


#: Places of the results in the order in which engineers ask for them; facts of the run with what explains.
_RANKS = {spec.name: spec.rank for spec in EVERY_TABLE if spec.rank is not None} | {"RunFacts": 7}
_ELSEWHERE, _AT_THE_END = 8, 9
#: What is said of the file as a whole comes before all results.
_OF_THE_FILE = frozenset({"digest", "settings", "table missing", "not judged"})
#: What another version alone can explain, with the same inputs.
_OF_THE_VERSION = frozenset(
    {
        "different",
        "row missing",
        "row added",
        "old value",
        "chart",
        "table missing",
        "not judged",
        "settings",
    }
)


def _in_order(findings: Sequence[Finding], counts: Sequence[Counts]) -> list[Finding]:
    """What fails first; of that what engineers ask first, not what the file happens to hold first."""
    sheets: dict[str, int] = {}
    for counted in counts:
        place = _RANKS.get(counted.table, _AT_THE_END)
        sheets[counted.sheet] = min(place, sheets.get(counted.sheet, place))

    def rank(finding: Finding) -> int:
        if finding.kind in _OF_THE_FILE:
            return -1
        if finding.kind == "chart" or finding.table.startswith("Chart"):
            return _AT_THE_END
        if finding.table == "StartCycles":
            return _AT_THE_END
        own = _RANKS.get(finding.table)
        return sheets.get(finding.sheet, _ELSEWHERE) if own is None else own

    return sorted(findings, key=lambda finding: (not finding.fails, rank(finding)))


def concluded(about: Verification, counts: list[Counts], findings: list[Finding]) -> Verification:
    """The outcome of everything found, what fails first."""
    ordered = _in_order(findings, counts)
    failing = sum(finding.fails and finding.kind != "not judged" for finding in ordered)
    unjudged = any(finding.kind == "not judged" for finding in ordered)
    results = sum(sum(one.of) for one in counts)
    if failing == 0 and unjudged:
        outcome = "not verified"
        sentence = (
            f"All {results:,} results in tables agree with the inputs, but formulas for verdicts "
            "or key numbers could not be checked."
        )
    elif failing == 0:
        outcome, sentence = "follows", f"All {results:,} results agree with the inputs."
        if about.looked_at:
            kinds = f"{', '.join(about.looked_at[:-1])} and {about.looked_at[-1]}"
            sentence = f"{sentence} Looked at: values, formulas, {kinds}."
    elif (
        about.other_release
        and about.same_inputs
        and all(finding.kind in _OF_THE_VERSION for finding in ordered if finding.fails)
    ):
        outcome = "other version"
        differences = "1 difference" if failing == 1 else f"{failing:,} differences"
        sentence = (
            f"{differences} from what {about.this} gives for the same inputs, which may come from the "
            f"version: whether the results are those of {about.made_by} is not verified; {results:,} "
            "results were compared."
        )
    else:
        outcome = "does not follow"
        differences = "1 difference" if failing == 1 else f"{failing:,} differences"
        sentence = f"{differences} from what the inputs give; {results:,} results were compared."
        if about.recorded and not about.same_inputs:
            sentence = f"The results belong to other inputs. {sentence}"
    return replace(
        about, outcome=outcome, sentence=sentence, counts=tuple(counts), findings=tuple(ordered)
    )


def not_calculated(
    about: Verification, problems: tuple[CellProblem, ...], findings: Sequence[Finding] = ()
) -> Verification:
    """The outcome where the inputs cannot be calculated."""
    sentence, listed = "Its inputs cannot be calculated. Run torsionbook check.", tuple(findings)
    return replace(
        about, outcome="not verified", sentence=sentence, findings=listed, problems=problems
    )
