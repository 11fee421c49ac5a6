"""Any file of a train of others → `CaseInput`, checked as every input is."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from addin.contract.json_formats import CASE_FORMAT
from addin.contract.problems import CellProblem
from addin.contract.tables import EVERY_INPUT
from addin.exchange.foreign import ForeignError, ForeignTrain
from addin.exchange.opentorsion import is_opentorsion, read_opentorsion
from addin.exchange.ross import is_ross, read_ross
from addin.exchange.text_tables import read_tables
from addin.reading.case_json import read_case_json
from addin.reading.typed_case import CaseInput


def read_train(text: str) -> ForeignTrain:
    """A train from the text of a file; what it is, its content says.

    Parameters
    ----------
    text : str
        JSON or TOML of openTorsion or ROSS, or tables. [text]

    Returns
    -------
    ForeignTrain
        Its rows, not yet checked. [as typed]

    Raises
    ------
    ForeignError
        If it is no train.
    """
    content = _parsed(text)
    if content is None:
        return read_tables(text)
    if is_ross(content):
        return read_ross(content)
    if is_opentorsion(content):
        return read_opentorsion(content)
    if "stations" in content:
        raise ForeignError(
            "this is a case JSON. Use it as it is, or: torsionbook new train.xlsx --from FILE."
        )
    raise ForeignError(
        "this is neither a rotor that ROSS saved (elements such as ShaftElement_…) nor a system of openTorsion (components "
        "and structure). Save it there again, or write a table of text."
    )


def _parsed(text: str) -> Mapping[str, Any] | None:
    """The object of a JSON or TOML file; None for other text."""
    start = text.removeprefix("\ufeff").lstrip()
    if start.startswith("{"):
        try:
            content = json.loads(start)
        except (ValueError, RecursionError) as error:
            raise ForeignError(f"the file is not JSON: {error}. Save it again.") from None
        return content if isinstance(content, dict) else {}
    if any(line.startswith('["') or line.startswith("[parameters]") for line in start.splitlines()):
        try:
            return tomllib.loads(start)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise ForeignError(f"the file is not TOML: {error}. Save it again.") from None
    return None


def checked_train(train: ForeignTrain) -> CaseInput:
    """The train as an input, with every problem named by its place in the file.

    Parameters
    ----------
    train : ForeignTrain
        As read. [as typed]

    Returns
    -------
    CaseInput
        Data and problems. [SI]
    """
    read = read_case_json({"format": CASE_FORMAT, **train.content()})
    problems = (*train.problems, *(_placed(p, train) for p in read.problems))
    return replace(read, problems=problems if not train.problems else tuple(train.problems))


def _placed(problem: CellProblem, train: ForeignTrain) -> CellProblem:
    """A problem of a case JSON, with the place in the file from which its row comes."""
    sentence = problem.message.split(": ", 1)[-1]
    place = train.places.get((problem.table, problem.row or 0), train.kind)
    name = next((spec.caption for spec in EVERY_INPUT if spec.name == problem.table), problem.table)
    column = f", {problem.column}" if problem.column else ""
    return replace(
        problem, cell="", message=f"{place[:1].upper()}{place[1:]} ({name}{column}): {sentence}"
    )
