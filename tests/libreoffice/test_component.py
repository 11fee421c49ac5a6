"""The component as LibreOffice loads it, with the bridge to UNO made up: processes come and go."""

import importlib.util
import io
import sys
import types
import zipfile

import pytest

from addin.libreoffice.oxt import extension, worker_command
from addin.worksheet.registry import call


def module(name, **content):
    made = types.ModuleType(name)
    vars(made).update(content)
    return made


class Helper:
    def addImplementation(self, made, name, services):  # noqa: N802  (its name in UNO)
        self.added = made, name, services


@pytest.fixture(scope="module")
def load(tmp_path_factory):
    """Unpacks an extension with a command and loads its component."""
    loaded = []

    def loads(command):
        folder = tmp_path_factory.mktemp("extension")
        with zipfile.ZipFile(io.BytesIO(extension(command))) as archive:
            archive.extractall(folder)
        made = {
            "unohelper": {"Base": type("Base", (), {}), "ImplementationHelper": Helper},
            "com": {},
            "com.sun": {},
            "com.sun.star": {},
            "com.sun.star.lang": {"XServiceInfo": type("XServiceInfo", (), {})},
            "org": {},
            "org.torsionbook": {},
            "org.torsionbook.calc": {"XFunctions": type("XFunctions", (), {})},
        }
        spec = importlib.util.spec_from_file_location("component", folder / "component.py")
        component = importlib.util.module_from_spec(spec)
        with pytest.MonkeyPatch.context() as while_it_is_loaded:
            for name, content in made.items():
                while_it_is_loaded.setitem(sys.modules, name, module(name, **content))
            spec.loader.exec_module(component)
        loaded.append(component)
        return component

    yield loads
    for component in loaded:
        if component.Functions.worker is not None:
            component.Functions.worker._end()


@pytest.fixture(scope="module")
def answering(load):
    """A component whose process is started once for several tests."""
    return load(worker_command())


def test_calls_go_to_one_process_and_come_back_as_doubles(answering):
    component = answering
    functions, more = component.Functions(None), component.Functions(None)
    raw = (200.1, None, 500.7, 79300.3)
    assert functions.tv_stiffness(*raw, None) == (tuple(call("TV_STIFFNESS", list(raw))[0]),)
    first = component.Functions.worker.process.pid
    values = ((0.1, ""), (1 / 3, -2.0))
    (first_row, second_row) = call("TV_CONVERT", [values, "ft", "m"])
    assert first_row[1] is None
    rows = more.tv_convert(values, "ft", "m")
    assert rows == ((first_row[0], ""), tuple(second_row))
    assert component.Functions.worker.process.pid == first


def test_errors_are_texts(answering):
    functions = answering.Functions(None)
    ((told,),) = functions.tv_stiffness(200.0, 250.0, 1.0, 1.0)
    assert told.startswith("ID: found 250")
    ((told,),) = functions.tv_peaks("tv:0")
    assert "not in the memory of this session" in told


@pytest.mark.slow
def test_a_process_that_died_is_started_anew(answering):
    component = answering
    functions = component.Functions(None)
    functions.tv_convert(1.0, "m", "mm")
    dead = component.Functions.worker.process
    dead.kill()
    dead.wait(30)
    assert functions.tv_convert(2.0, "m", "mm") == ((2000.0,),)
    assert component.Functions.worker.process.pid != dead.pid


@pytest.mark.slow
def test_the_process_does_not_inherit_libreoffices_python(load, monkeypatch, tmp_path):
    monkeypatch.setenv("PYTHONHOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    (tmp_path / "addin.py").write_text("raise SystemExit('the wrong one')")
    monkeypatch.chdir(tmp_path)
    assert load(worker_command()).Functions(None).tv_convert(2.0, "m", "mm") == ((2000.0,),)


@pytest.mark.parametrize(
    "command",
    [["/no/such/python", "-m", "it"], [sys.executable, "-c", "raise SystemExit(1)"]],
    ids=["not there", "without torsionbook"],
)
def test_a_python_that_does_not_answer_is_named(load, command):
    component = load(command)
    ((told,),) = component.Functions(None).tv_convert(2.0, "m", "mm")
    assert command[0] in told
    assert "torsionbook calc install" in told
    assert component.Functions.worker.process is None


def test_it_registers_as_a_calc_add_in(load):
    component = load(worker_command())
    made, name, services = component.g_ImplementationHelper.added
    assert (made, name) == (component.Functions, "org.torsionbook.calc.Functions")
    assert "com.sun.star.sheet.AddIn" in services
    assert made(None).supportsService("com.sun.star.sheet.AddIn")
