"""Columns of a programme's table: which input of the base case each header names, and its unit."""

from __future__ import annotations

from collections.abc import Sequence

from addin.contract.problems import shortened
from addin.reading.input_names import NamedInput, WrongName, named_input
from addin.reading.typed_case import Place, TypedCase


class TableRefused(Exception):
    """The table cannot be used; each sentence names the column or the row."""

    def __init__(self, *sentences: str) -> None:
        super().__init__("\n".join(sentences))
        self.sentences = sentences


_NAMES = ("name", "case")


def read_columns(
    headers: Sequence[str], base: TypedCase
) -> tuple[list[NamedInput | None], int | None]:
    """What the columns of a table name.

    Parameters
    ----------
    headers : sequence of str
        Its first row. [text]
    base : TypedCase
        The base case. [as typed]

    Returns
    -------
    columns : list of (NamedInput or None)
        None for the column of names.
    names : int or None
        Its index, counted from 0.

    Raises
    ------
    TableRefused
        With a sentence for each wrong column.
    """
    wrong: list[str] = []
    columns: list[NamedInput | None] = []
    names: int | None = None
    seen: dict[Place, str] = {}
    for index, header in enumerate(headers):
        text = header.strip()
        if text.casefold() in _NAMES and names is None:
            names = index
            columns.append(None)
            continue
        try:
            column = named_input(text, base)
        except WrongName as problem:
            wrong.append(f"column {index + 1}, '{shortened(text)}': {problem}")
            continue
        if column.place in seen:
            wrong.append(
                f"column {index + 1}, '{text}': column '{seen[column.place]}' names the same input."
            )
        seen[column.place] = text
        columns.append(column)
    if not wrong and not any(columns):
        wrong.append("no column of the table names an input. Add a column such as DampingRatio.")
    if wrong:
        raise TableRefused(*wrong)
    return columns, names
