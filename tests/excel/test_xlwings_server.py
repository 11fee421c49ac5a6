"""The adapter for xlwings Server, with that package's decorators made up.

xlwings Server itself needs a licence key and is not run here (docs/server.md says so).
"""

import asyncio
import importlib
import sys
import types

import pytest
import xlwings
from sheet_ranges import model_arguments

from addin.server.office import functions_json
from addin.worksheet.registry import FUNCTIONS, call

MODULE = "addin.excel.xlwings_server"


@pytest.fixture
def adapter(monkeypatch):
    """The module, imported with decorators that note what they were given."""
    made_up = types.ModuleType("xlwings.server")

    def arg(name, **options):
        def decorate(function):
            function.noted = {**getattr(function, "noted", {}), name: options}
            return function

        return decorate

    def func(**options):
        def decorate(function):
            function.options = options
            return function

        return decorate

    made_up.arg, made_up.func = arg, func
    monkeypatch.setitem(sys.modules, "xlwings.server", made_up)
    monkeypatch.setattr(xlwings, "server", made_up, raising=False)
    monkeypatch.delitem(sys.modules, MODULE, raising=False)
    yield importlib.import_module(MODULE)
    sys.modules.pop(MODULE, None)


def answered(adapter, name, *cells):
    return asyncio.run(getattr(adapter, name.lower())(*cells))


def test_every_function_is_exported_under_the_name_of_our_own_add_in(adapter):
    assert sorted(adapter.__all__) == sorted(name.lower() for name in FUNCTIONS)
    ours = {one["name"] for one in functions_json()["functions"]}
    theirs = [getattr(adapter, name).options for name in adapter.__all__]
    assert {one["name"] for one in theirs} == ours
    assert {one["namespace"] for one in theirs} == {"TV"}


def test_arguments_are_ranges_with_help_and_errors_as_texts(adapter):
    for name in FUNCTIONS:
        noted = getattr(adapter, name.lower()).noted
        assert len(noted) == len(FUNCTIONS[name].arguments)
        assert all(one["ndim"] == 2 and one["err_to_str"] and one["doc"] for one in noted.values())


def test_answers_are_those_of_the_registry(adapter):
    handle = call("TV_MODEL", model_arguments())[0][0]
    for name in ("TV_FREQUENCIES", "TV_STARTS"):
        plain = [["" if v is None else v for v in row] for row in call(name, [handle])]
        assert answered(adapter, name, [[handle]]) == plain


def test_what_is_wrong_is_told(adapter):
    with pytest.raises(xlwings.XlwingsError, match="OD: found 0; it must be above 0"):
        answered(adapter, "TV_STIFFNESS", [[0.0]], [[0.0]], [[500.0]], [[79300.0]])


def test_a_table_with_a_zero_that_may_be_a_blank_has_no_answer(adapter):
    arguments = model_arguments()
    handed = [[[0 if v is None else v for v in row] for row in one] for one in arguments]
    with pytest.raises(xlwings.XlwingsError, match="Argument 1 contains a 0 or a blank cell"):
        answered(adapter, "TV_MODEL", *handed)
    assert answered(adapter, "TV_CONVERT", [[0]], [["m"]], [["mm"]]) == [[0]]


def test_without_a_licence_the_import_is_refused(monkeypatch):
    """By xlwings, with its own words; nothing of ours imports it."""
    monkeypatch.delenv("XLWINGS_LICENSE_KEY", raising=False)
    assert MODULE not in sys.modules
    from xlwings import XlwingsError

    with pytest.raises(XlwingsError, match="(?i)licen"):
        importlib.import_module(MODULE)
