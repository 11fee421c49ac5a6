"""What a file says of its own making: digest of its inputs, software, settings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from addin.contract.audit_items import DIGEST_ITEM, SETTING_ITEM, SOFTWARE_ITEM
from addin.contract.shown_units import ShownUnits
from addin.contract.tables import SCALARS, json_key, result_table
from addin.recorded.results import recorded_rows
from addin.xlsx import Workbook

#: Items that differ from run to run and from machine to machine.
_OWN_OF_EACH_RUN = re.compile(r"Software|Date \(UTC\)|Python|Libraries|Time spent: .*")
_DIGEST = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True)
class Provenance:
    """What a file records of the calculation."""

    digest: str = ""  #: Digest of the inputs; empty when there is none. [hex]
    software: str = ""  #: Name and version.
    #: Fields of the case that the command line set. [SI]
    settings: dict[str, Any] = field(default_factory=dict)
    unreadable: tuple[str, ...] = ()  #: Settings that cannot be used again.


def is_own_of_each_run(item: str) -> bool:
    """Whether an item of the audit trail belongs to one run and not to the inputs."""
    return _OWN_OF_EACH_RUN.fullmatch(item) is not None


def workbook_provenance(workbook: Workbook) -> Provenance:
    """What table `Audit` of a workbook records."""
    rows = recorded_rows(workbook, result_table("Audit"), ShownUnits({}, {}))
    return _of_audit({"item": row.get("Item"), "value": row.get("Value")} for row in rows)


def json_provenance(content: Mapping[str, Any]) -> Provenance:
    """What table `Audit` of a result JSON records.

    Parameters
    ----------
    content : mapping
        What the file holds. [SI]

    Returns
    -------
    Provenance
        Blank where nothing is recorded.
    """
    return _of_audit(rows_of(content, "Audit"))


def rows_of(content: Mapping[str, Any], table: str) -> list[dict[str, Any]]:
    """Rows of a table of a result JSON, whatever a damaged file has in their place.

    Parameters
    ----------
    content : mapping
        What the file holds. [SI]
    table : str
        Result table. [name]

    Returns
    -------
    list of dict
        By JSON key. [SI]
    """
    rows = content.get(json_key(table))
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def _of_audit(rows: Iterable[Mapping[str, Any]]) -> Provenance:
    """What rows with the keys ``item`` and ``value`` record."""
    values = {str(row.get("item") or ""): row.get("value") for row in rows}
    settings: dict[str, Any] = {}
    unreadable = []
    for item, value in values.items():
        if item.startswith(SETTING_ITEM):
            name = item.removeprefix(SETTING_ITEM)
            found = _setting(name, value)
            if found is None:
                unreadable.append(f"{name} = {value}")
            else:
                settings[name] = found
    digest = str(values.get(DIGEST_ITEM) or "").strip().lower()
    return Provenance(
        digest if _DIGEST.fullmatch(digest) else "",
        str(values.get(SOFTWARE_ITEM) or ""),
        settings,
        tuple(unreadable),
    )


def _setting(name: str, value: Any) -> Any:
    """A recorded setting as the case takes it; None when it is not one."""
    spec = next((one for one in SCALARS if one.attribute == name), None)
    text = str(value if value is not None else "").strip()
    if spec is None or not text:
        return None
    if not spec.is_number:
        return text if not spec.choices or text in spec.choices else None
    try:
        return float(text)
    except ValueError:
        return None
