"""Every table of inputs and outputs, and look-ups by name.

Workbook templates, the reader, the writer, both JSON forms and their schemas are made from them.
The names are those of the contract; a `key` is the JSON key, an `attribute` the name of the same
quantity in `engine.case.data`. Nothing here converts or checks a number: see `addin.contract.units`.
"""

from __future__ import annotations

from addin.contract.field import DIMENSIONS, Dimension, Field, TableSpec, complete, json_key
from addin.contract.input_tables import INPUT_TABLES
from addin.contract.result_tables import RESULT_TABLES, WORKBOOK_TABLES
from addin.contract.scalars import SCALAR_SHEET, SCALAR_TABLE, SCALARS, TEMPLATE_VERSION
from addin.contract.studies.registry import STUDIES

complete(INPUT_TABLES, "addin/contract/input_tables.py", results=False)
complete((*RESULT_TABLES, *WORKBOOK_TABLES), "addin/contract/result_tables.py", results=True)

#: Tables of the study sheets, in the order in which problems are reported. A workbook has them only if
#: it was made with ``torsionbook new --studies``; a case JSON may have their keys.
STUDY_INPUT_TABLES: tuple[TableSpec, ...] = tuple(
    spec for study in STUDIES for spec in study.inputs
)
#: Result tables of the studies: rows come from the engine, keys and units are those of the JSON.
STUDY_RESULT_TABLES: tuple[TableSpec, ...] = tuple(
    spec for study in STUDIES for spec in study.results
)
#: Every table that a workbook may have.
EVERY_TABLE: tuple[TableSpec, ...] = (
    *INPUT_TABLES,
    *RESULT_TABLES,
    *WORKBOOK_TABLES,
    *STUDY_INPUT_TABLES,
    *STUDY_RESULT_TABLES,
)
#: Those that the engineer fills in.
EVERY_INPUT: tuple[TableSpec, ...] = (*INPUT_TABLES, *STUDY_INPUT_TABLES)

_SCALARS = {field.name: field for field in SCALARS}
_INPUTS = {table.name: table for table in EVERY_INPUT}
_RESULTS = {table.name: table for table in (*RESULT_TABLES, *STUDY_RESULT_TABLES)}
_TABLES = {table.name: table for table in EVERY_TABLE}
_COLUMNS = {(spec.name, field.name): field for spec in EVERY_TABLE for field in spec.every_column}


def scalar(name: str) -> Field:
    """The scalar of a defined name."""
    return _SCALARS[name]


def input_table(name: str) -> TableSpec:
    """The input table of a name."""
    return _INPUTS[name]


def result_table(name: str) -> TableSpec:
    """The result table of a name."""
    return _RESULTS[name]


def table(name: str) -> TableSpec:
    """The table of a name, of inputs or of results."""
    return _TABLES[name]


def caption(name: str) -> str:
    """Caption of a table; of what is no such table, such as the scalars, its name."""
    spec = _TABLES.get(name)
    return name if spec is None else spec.caption


def find_table(name: str) -> TableSpec | None:
    """The table of a name; None for what is no such table, such as the numbers behind a chart."""
    return _TABLES.get(name)


def find_column(table: str, name: str) -> Field | None:
    """The column of a table, a repeated one by its own name; None where there is none."""
    return _COLUMNS.get((table, name))
