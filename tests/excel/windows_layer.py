"""xlwings' own Windows modules, imported for real over a stub of pywin32.

`xlwings.udfs`, `xlwings._xlwindows` and `xlwings.com_server` are the installed ones; only COM below
them is made up. `machinery()` puts everything back afterwards.
"""

from __future__ import annotations

import atexit
import ctypes
import datetime as dt
import importlib
import sys
import types
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

RANGE_IID = "{00020846-0000-0000-C000-000000000046}"
#: What VBA hands over for an argument that was left out, and for error cells.
MISSING = -2147352572
ERRORS = {
    "#NULL!": -2146826288,
    "#DIV/0!": -2146826281,
    "#VALUE!": -2146826273,
    "#REF!": -2146826265,
    "#NAME?": -2146826259,
    "#NUM!": -2146826252,
    "#N/A": -2146826246,
}


class ComError(Exception):
    hresult = 0


class FakeRange:
    """A COM Range: `Value` is one value for a cell and a tuple of tuples otherwise, as of pywin32."""

    def __init__(self, values: list[list[Any]], address: str = "$A$1") -> None:
        self.values = values
        self.address = address
        self.Row = self.Column = 1
        self.Rows = SimpleNamespace(Count=len(values))
        self.Columns = SimpleNamespace(Count=len(values[0]))
        self.Count = len(values) * len(values[0])
        self.Worksheet = MagicMock()
        kind = SimpleNamespace(GetTypeAttr=lambda: SimpleNamespace(iid=RANGE_IID))
        self._oleobj_ = SimpleNamespace(GetTypeInfo=lambda: kind)

    @property
    def Value(self) -> Any:
        if self.Count == 1:
            return self.values[0][0]
        return tuple(tuple(row) for row in self.values)

    def GetAddress(self, *_: Any) -> str:
        return self.address


@dataclass
class Machinery:
    """xlwings as on Windows."""

    xlwings: Any
    udfs: Any
    com_server: Any
    module: Any

    def call(self, name: str, *arguments: Any) -> Any:
        """What the VBA wrapper of a function does: `XLPy.CallUDF(...)`."""
        given = [FakeRange(a) if isinstance(a, list) else a for a in arguments]
        caller = FakeRange([[None]], "$F$2")
        return self.com_server.XLPython().CallUDF(
            self.module.__name__, name, tuple(given), None, caller
        )


def _stubs() -> dict[str, types.ModuleType]:
    def module(name: str, **held: Any) -> types.ModuleType:
        made = types.ModuleType(name)
        made.__dict__.update(held)
        return made

    client = module(
        "win32com.client", Dispatch=lambda x, **_: x, DispatchEx=MagicMock(), gencache=MagicMock(),
        CDispatch=type("CDispatch", (), {}), CoClassBaseClass=type("CoClassBaseClass", (), {}),
        DispatchBaseClass=type("DispatchBaseClass", (), {}),
    )  # fmt: skip
    util = module("win32com.server.util", wrap=lambda o, *_: o, unwrap=lambda o: o)
    dispatcher = module("win32com.server.dispatcher")
    policy = module("win32com.server.policy", DefaultPolicy=object)
    server = module("win32com.server", util=util, dispatcher=dispatcher, policy=policy)
    win32com = module("win32com", client=client, server=server)
    win32com.__path__ = server.__path__ = []  # type: ignore[attr-defined]
    pythoncom = module(
        "pythoncom", CoInitialize=lambda: None, ole_error=ComError, com_error=ComError,
        IID_IDispatch="IDispatch", IID_IEnumVARIANT="enum", __file__=None,
        TypeIIDs={"IDispatch": type("PyIDispatch", (), {})},
        CoMarshalInterThreadInterfaceInStream=lambda iid, o: o,
        CoGetInterfaceAndReleaseStream=lambda s, iid: s,
    )  # fmt: skip
    pywintypes = module(
        "pywintypes", com_error=ComError, error=ComError, TimeType=dt.datetime, IID=str.upper
    )
    zones = SimpleNamespace(utc=lambda: dt.UTC)
    made = [client, util, dispatcher, policy, server, win32com, pythoncom, pywintypes]
    made += [module(n) for n in ("win32api", "win32con", "win32gui", "win32event")]
    made += [module("win32process", GetWindowThreadProcessId=lambda h: (1, 4242))]
    made += [module("win32timezone", TimeZoneInfo=zones)]
    return {one.__name__: one for one in made}


@contextmanager
def machinery() -> Iterator[Machinery]:
    """xlwings' Windows modules and, imported with them, the functions it shall export."""
    ours = ("xlwings", "addin.excel.udfs")
    stubs = _stubs()
    kept = {name: sys.modules.pop(name) for name in [*sys.modules] if _belongs(name, ours)}
    held = {name: getattr(ctypes, name) for name in ("windll", "oledll") if hasattr(ctypes, name)}
    real_dll = ctypes.PyDLL
    sys.modules.update(stubs)
    ctypes.windll, ctypes.oledll = MagicMock(), MagicMock()  # type: ignore[attr-defined]
    ctypes.PyDLL = lambda *_, **__: MagicMock()  # type: ignore[assignment, misc]
    try:
        xlwings = importlib.import_module("xlwings")
        windows = importlib.import_module("xlwings._xlwindows")
        ctypes.PyDLL = real_dll  # type: ignore[misc]
        atexit.unregister(windows.cleanup)
        main = importlib.import_module("xlwings.main")
        xlwings.engines.add(main.Engine(impl=windows.engine))
        udfs = importlib.import_module("xlwings.udfs")
        server = importlib.import_module("xlwings.com_server")
        xlwings.func, xlwings.arg, xlwings.ret = udfs.xlfunc, udfs.xlarg, udfs.xlret
        xlwings.script = xlwings.sub = udfs.xlsub
        yield Machinery(xlwings, udfs, server, importlib.import_module("addin.excel.udfs"))
    finally:
        ctypes.PyDLL = real_dll  # type: ignore[misc]
        for name in ("windll", "oledll"):
            if name in held:
                setattr(ctypes, name, held[name])
            else:
                delattr(ctypes, name)
        for name in [n for n in sys.modules if _belongs(n, ours) or n in stubs]:
            del sys.modules[name]
        sys.modules.update(kept)
        package = sys.modules["addin.excel"]
        if hasattr(package, "udfs"):
            del package.udfs


def _belongs(name: str, packages: tuple[str, ...]) -> bool:
    return any(name == one or name.startswith(one + ".") for one in packages)
