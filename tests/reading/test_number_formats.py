"""Built-in number formats, which a workbook names by their number alone."""

from __future__ import annotations

import pytest

from addin.reading.cells import built_in_format, is_date_format, is_percent_format

#: ECMA-376 part 1, 18.8.30: numbers whose code is a date or a time, and those that are percent. The
#: dates of East Asian languages are among the first.
DATES = {*range(14, 23), *range(27, 37), 45, 46, 47, *range(50, 59)}
PERCENT = {9, 10}


@pytest.mark.parametrize("number", range(60))
def test_built_in_formats_are_those_of_the_standard(number: int) -> None:
    code = built_in_format(number)
    assert is_date_format(code) is (number in DATES)
    assert is_percent_format(code) is (number in PERCENT)
