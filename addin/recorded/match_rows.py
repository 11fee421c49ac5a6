"""Which columns name a row, and rows of two tables matched by them.

Rows may be sorted, inserted and removed; what a row is called stays: its station, its element, its
mode and excitation.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from typing import Any

from addin.contract.tables import find_table

#: Places in the first and in the second table; None = no such row there.
Pair = tuple[int | None, int | None]


def row_columns(table: str) -> tuple[str, ...]:
    """Columns that name a row of a table of inputs or results; empty where rows have no names."""
    spec = find_table(table)
    return () if spec is None else spec.row_name


def row_name(table: str, row: Mapping[str, Any]) -> tuple[Hashable, ...]:
    """What a row is called.

    Parameters
    ----------
    table : str
        Input or result table. [name]
    row : mapping
        Its values by header. [any unit]

    Returns
    -------
    tuple
        Words as they are, numbers to 6 significant digits; None for a blank.
    """
    return tuple(_plain(row.get(column)) for column in row_columns(table))


def match_rows(first: Sequence[Hashable], second: Sequence[Hashable]) -> list[Pair]:
    """Rows of two tables by their names; those of one name in their order.

    Returns
    -------
    list of (int or None, int or None)
        In the order of the second table; rows that only the first has stand where they stood there.
    """
    numbered_first = _numbered(first)
    at_first = {name: i for i, name in enumerate(numbered_first)}
    pairs: list[Pair] = [(at_first.get(name), j) for j, name in enumerate(_numbered(second))]
    taken = {i for i, _ in pairs if i is not None}
    for i in range(len(first)):
        if i not in taken:
            after = next(
                (k for k, (one, _) in enumerate(pairs) if one is not None and one > i), None
            )
            pairs.insert(len(pairs) if after is None else after, (i, None))
    return pairs


def _numbered(names: Sequence[Hashable]) -> list[tuple[Hashable, int]]:
    """Names with a count, so that equal ones differ."""
    seen: Counter[Hashable] = Counter()
    numbered = []
    for name in names:
        numbered.append((name, seen[name]))
        seen[name] += 1
    return numbered


def _plain(value: Any) -> Hashable:
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return float(f"{value:.5e}") + 0.0
    return str(value) or None  # of a JSON file it may be anything
