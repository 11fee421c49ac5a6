"""The compiled library: loaded once, its structs filled from arrays.

`kernels/kernels.h` is the one description of the structs; the build makes the library and, from that header,
the declarations that cffi reads (`hatch_build.py`). Nothing is compiled at run time.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from engine.errors import InternalError
from engine.stepping.kernels._declarations import ffi

__all__ = ["about", "address", "ffi", "library", "maps_of", "struct"]

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}
_FILE = Path(__file__).parent / "kernels" / f"_loops{_SUFFIX.get(sys.platform, '.so')}"
library: Any = ffi.dlopen(str(_FILE))

#: What an array of each kind is to numpy and to cffi.
_KINDS = {
    "double": (np.dtype(np.float64), ffi.typeof("double[]")),
    "int64_t": (np.dtype(np.int64), ffi.typeof("int64_t[]")),
}
#: Arrays that a struct points to live as long as it does.
_kept: WeakKeyDictionary[Any, tuple[Any, ...]] = WeakKeyDictionary()


def address(values: Any, kind: str = "double") -> Any:
    """Pointer to the numbers of an array; it keeps the array alive.

    Raises `InternalError` unless the array is C-contiguous and of the wanted type.
    """
    dtype, pointer = _KINDS[kind]
    if values.dtype != dtype or not values.flags.c_contiguous:
        raise InternalError(
            f"a loop takes contiguous arrays of {kind}, this one is of {values.dtype}"
        )
    return ffi.from_buffer(pointer, values)


def about() -> str:
    """Compiler and target of the library, and digest of its sources."""
    return str(ffi.string(library.about()).decode())


def struct(name: str, **fields: Any) -> Any:
    """A struct of the library, filled by field: numbers, arrays, other structs.

    Parameters
    ----------
    name : str
        As in `kernels.h`. [word]
    **fields : Any
        Values by the names in `kernels.h`; an array that is left out is none. [SI]

    Returns
    -------
    cdata
        Pointer to it. It keeps its arrays alive.
    """
    made, kept = ffi.new(f"{name} *"), []
    kinds = _kinds(name)
    for field, value in fields.items():
        if isinstance(value, np.ndarray):
            value = address(value, kinds[field])
            kept.append(value)
        elif isinstance(value, ffi.CData):
            kept.append(value)
            value = value[0]
        setattr(made, field, value)
    _kept[made] = tuple(kept)
    return made


@cache
def _kinds(name: str) -> dict[str, str]:
    """What each pointer of a struct points to."""
    return {
        field: kind.type.item.cname.removeprefix("const ")
        for field, kind in ffi.typeof(name).fields
        if kind.type.kind == "pointer"
    }


def maps_of(step: Any, stiffness: Any, rate: Any, h: float) -> tuple[Any, Any]:
    """Maps of one step of each mode, by a function of the library.

    Parameters
    ----------
    step : callable
        Of `library`. [function]
    stiffness, rate : ndarray, shape (n,)
        λ and damping coefficient d. [1/s², 1/s]
    h : float
        Step. [s]

    Returns
    -------
    free, forced : ndarray, shapes (n, 2, 2) and (n, 2, 4)
        Maps of the state and of the force. [SI]
    """
    n = len(stiffness)
    free, forced = np.empty((n, 2, 2)), np.empty((n, 2, 4))
    own = (np.ascontiguousarray(a, dtype=np.float64) for a in (stiffness, rate))
    step(n, *map(address, own), h, address(free), address(forced))
    return free, forced
