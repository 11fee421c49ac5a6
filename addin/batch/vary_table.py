"""A programme's table, CSV or Parquet, read as a stream."""

from __future__ import annotations

import codecs
import contextlib
import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.batch.vary_columns import TableRefused
from addin.reading.input_names import NamedInput
from addin.xlsx.places import refuse_no_end

#: Rows of a chunk. [count]
ROWS = 50


#: Marks at the begin of a file in UTF-16, Excel's "Unicode text".
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


#: A number with a decimal comma; the second cannot be a comma between thousands either.
_COMMA = re.compile(r"\s*[+-]?[\d.]*,\d+(?:[eE][+-]?\d+)?(?:\s.*)?", re.ASCII | re.DOTALL)


_SURE_COMMA = re.compile(
    r"\s*[+-]?[\d.]*,(?!\d{3}(?:\s|$))\d+(?:[eE][+-]?\d+)?(?:\s.*)?|\s*[+-]?0,\d+(?:\s.*)?",
    re.ASCII | re.DOTALL,
)


@dataclass(frozen=True)
class CsvForm:
    """How a CSV is written."""

    encoding: str = "utf-8-sig"  #: UTF-8, or UTF-16 where the file begins with its mark.
    separator: str = ","  #: Comma, semicolon or tab. [character]
    states: bool = False  #: Its first line is Excel's ``sep=;``.


@dataclass(frozen=True)
class VariedTable:
    """A table that is read as a stream."""

    path: Path  #: CSV or Parquet.

    def headers(self) -> list[str]:
        """Its column names. [text]

        Raises
        ------
        TableRefused
            If it cannot be read.
        """
        with _reading():
            if self._is_parquet:
                return [str(name) for name in self._parquet().schema_arrow.names]
            return next(iter(self._csv()), [])

    def count(self) -> int:
        """Its rows. [count]"""
        with _reading():
            if self._is_parquet:
                return int(self._parquet().metadata.num_rows)
            return max(sum(1 for row in self._csv() if row) - 1, 0)

    def rows(self) -> Iterator[list[Any]]:
        """Its rows, one at a time."""
        with _reading():
            if not self._is_parquet:
                rows = self._csv()
                next(rows, None)
                yield from (row for row in rows if row)
                return
            for batch in self._parquet().iter_batches(batch_size=ROWS):
                columns = [column.to_pylist() for column in batch.columns]
                yield from (list(row) for row in zip(*columns, strict=True))

    @property
    def _is_parquet(self) -> bool:
        return self.path.suffix.lower() in (".parquet", ".pq")

    def _parquet(self) -> Any:
        from pyarrow.parquet import ParquetFile

        return ParquetFile(self.path)

    def form(self) -> CsvForm:
        """Encoding and separator of a CSV, by its begin.

        Raises
        ------
        TableRefused
            If it cannot be read.
        """
        if self._is_parquet:
            return CsvForm()
        with _reading():
            refuse_no_end(self.path)
            with open(self.path, "rb") as file:
                encoding = "utf-16" if file.read(2) in _UTF_16 else "utf-8-sig"
            with open(self.path, encoding=encoding, newline="") as text:
                first = text.readline().rstrip("\r\n")
        stated = re.fullmatch(r'"?sep=(.)"?', first, re.IGNORECASE)
        if stated:
            return CsvForm(encoding, stated.group(1), states=True)
        return CsvForm(encoding, max((",", ";", "\t"), key=first.count))

    def has_decimal_commas(self, columns: Sequence[NamedInput | None]) -> bool:
        """Whether the comma is the decimal sign: a table has one, never both."""
        separator = self.form().separator
        if self._is_parquet or separator == ",":
            return False
        # Excel writes semicolons where the comma is the decimal sign, tabs anywhere.
        comma = _COMMA if separator == ";" else _SURE_COMMA
        numbers = [i for i, column in enumerate(columns) if column and column.spec.is_number]
        return any(comma.fullmatch(row[i]) for row in self.rows() for i in numbers if i < len(row))

    def _csv(self) -> Iterator[list[str]]:
        form = self.form()
        with open(self.path, encoding=form.encoding, newline="") as file:
            if form.states:
                file.readline()
            yield from csv.reader(file, delimiter=form.separator)


@contextlib.contextmanager
def _reading() -> Iterator[None]:
    """What goes wrong while a table is read, as one sentence."""
    try:
        yield
    except UnicodeDecodeError as wrong:
        raise TableRefused(
            "it is not UTF-8 text. Save the CSV as CSV UTF-8, or give a .parquet file."
        ) from wrong
    except (OSError, csv.Error) as wrong:
        why = getattr(wrong, "strerror", None) or wrong
        raise TableRefused(f"it cannot be read: {why}. Check the file.") from wrong
    except ImportError as wrong:
        raise TableRefused(
            "it is Parquet, and pyarrow is not installed. Give a CSV, or run pip install -r "
            "requirements/parquet.txt in the checkout, or install the wheel with its extra [parquet]."
        ) from wrong
    except Exception as wrong:
        if not type(wrong).__module__.startswith("pyarrow"):
            raise
        raise TableRefused("it is not a readable Parquet file. Save it again.") from wrong
