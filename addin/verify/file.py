"""A file of any kind to be verified: a workbook, or a result JSON beside its case."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from addin.contract.problems import CellProblem
from addin.reading.one_file import Unreadable, file_problem, read_checked
from addin.reading.workbook import WorkbookInput
from addin.verify.findings import Agreement, Verification
from addin.verify.json_file import read_results_json, verify_results_json
from addin.verify.workbook import verify_workbook


def verify_file(
    source: Path,
    *,
    case: Path | None = None,
    within: Agreement = Agreement.ERROR,
    on_stage: Callable[[str], None] | None = None,
) -> Verification:
    """Verify one file."""
    inputs, content = source, {}
    is_json = source.suffix.lower() == ".json"
    if is_json:
        if case is None:
            sentence = "A result JSON contains no inputs: name its case with --case CASE.json."
            return _not_verified(source, sentence)
        inputs = case
        try:
            content = read_results_json(source)
        except (ValueError, OSError) as error:
            return _not_verified(source, file_problem(source, error).message)
    read = read_checked(inputs)
    if isinstance(read, Unreadable):
        return _not_verified(source, read.problems[0].message, read.problems)
    if read.problems:
        sentence = "Its inputs have errors, so results cannot be verified. Run torsionbook check."
        return _not_verified(source, sentence, read.problems)
    if is_json:
        return verify_results_json(source, content, read, within=within, on_stage=on_stage)
    assert isinstance(read, WorkbookInput)
    return verify_workbook(read, within=within, on_stage=on_stage)


def _not_verified(
    source: Path, sentence: str, problems: tuple[CellProblem, ...] = ()
) -> Verification:
    listed = () if len(problems) == 1 and problems[0].message == sentence else problems
    return Verification(source, "not verified", sentence, problems=listed)
