"""A checked case → everything the sheets, the JSON and the summary show of it.

Between `engine` and the writers: one run of the engine, its tables and curves, and the audit trail.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.calculation.audit import Stamp, audit_rows
from addin.calculation.run_view import RunView, view_of
from engine.case.case import Case
from engine.results.details import modal_details, plan_details
from engine.results.results import Results
from engine.run import run

__all__ = ["Calculation", "calculate", "shown"]


@dataclass(frozen=True, eq=False)
class Calculation:
    """One calculated case, ready to be written."""

    case: Case  #: What was calculated. [SI]
    case_sha256: str  #: Digest of the inputs as typed, before settings of the command line. [hex]
    results: Results  #: The engine's results. [SI]
    #: Result tables of the contract, rows under JSON keys. [SI]
    tables: Mapping[str, Sequence[Mapping[str, Any]]]
    startup: Mapping[str, Any] | None  #: Outcome, time, end speed and sentence. [SI]
    view: RunView  #: Tables and curves as the workbook shows them. [SI]
    warnings: tuple[str, ...]  #: Of the reader and of the engine.
    outcome: str  #: How the run ended.
    #: Energy shares, nodes, damped eigenvalues, plans and sensitivity, for the JSON. [SI]
    details: Mapping[str, Any]
    stamp: Stamp  #: Version and date.


def calculate(
    case: Case,
    *,
    input_warnings: Sequence[str] = (),
    case_sha256: str | None = None,
    overrides: Mapping[str, object] | None = None,
    on_stage: Callable[[str], None] | None = None,
) -> Calculation:
    """Run the engine on a case and gather what is to be shown.

    Parameters
    ----------
    case : Case
        The case. [SI]
    input_warnings : sequence of str
        What the reader found worth saying. [sentences]
    case_sha256 : str, optional
        Digest of the inputs as typed, where `overrides` changed the case. [hex]
    overrides : mapping, optional
        Settings of the command line that differ from the workbook's. [names and values]
    on_stage : callable, optional
        Called with the name of each analysis as it begins.

    Returns
    -------
    Calculation
        Complete. [SI]

    Raises
    ------
    ModelError
        If the train as a whole cannot be calculated.
    """
    results = run(case, on_stage)
    digest = case_sha256 or results.case_sha256
    return shown(results, case, input_warnings, digest, overrides or {})


def shown(
    results: Results,
    case: Case,
    input_warnings: Sequence[str],
    case_sha256: str,
    overrides: Mapping[str, object],
) -> Calculation:
    """Results of the engine with everything that is shown of them.

    Parameters
    ----------
    results : Results
        Of this case, or of one that differs from it in its title block only. [SI]
    case : Case
        The case. [SI]
    input_warnings : sequence of str
        What the reader found worth saying. [sentences]
    case_sha256 : str
        Digest of the inputs as typed. [hex]
    overrides : mapping
        Settings of the command line that differ from the workbook's. [names and values]

    Returns
    -------
    Calculation
        Complete. [SI]
    """
    warnings = tuple(dict.fromkeys([*input_warnings, *results.warnings]))
    stamp = Stamp.now()
    audit = audit_rows(results, stamp, case_sha256, warnings, overrides)
    view = view_of(results, audit)
    return Calculation(
        case=case,
        case_sha256=case_sha256,
        results=results,
        tables=view.tables,
        startup=view.startup,
        view=view,
        warnings=warnings,
        outcome=results.outcome,
        details=modal_details(results) | plan_details(results),
        stamp=stamp,
    )
