"""The compiled library: loaded once, its structs filled from arrays.

`kernels/kernels.h` is the one description of the structs; the build makes the library and, from that header,
the declarations that cffi reads (`hatch_build.py`). Nothing is compiled at run time.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from engine.errors import InternalError
from engine.stepping.kernels._declarations import ffi, finite, shapes

__all__ = ["about", "address", "check_lengths", "ffi", "library", "maps_of", "struct"]

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
#: Lengths of the arrays of a struct that are numbers of others: lanes, forces, modes.
_lengths: WeakKeyDictionary[Any, dict[str, int]] = WeakKeyDictionary()


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

    Raises
    ------
    InternalError
        If an array has not the shape that stands in `kernels.h`, or what is read is not finite.
    """
    made, kept = ffi.new(f"{name} *"), []
    kinds, stated, lengths = _kinds(name), shapes[name], dict[str, int]()
    for field, value in fields.items():
        if isinstance(value, np.ndarray):
            place = f"{name}.{field}"
            if field in stated:
                _check_shape(place, value, stated[field], fields, lengths)
            if place in finite and not np.isfinite(value).all():
                raise InternalError(
                    f"a loop takes finite numbers in {place}, this one holds {value[~np.isfinite(value)][0]}"
                )
            value = address(value, kinds[field])
            kept.append(value)
        elif isinstance(value, ffi.CData):
            kept.append(value)
            value = value[0]
        setattr(made, field, value)
    _kept[made], _lengths[made] = tuple(kept), lengths
    return made


def _check_shape(
    name: str,
    values: Any,
    stated: tuple[str, ...],
    fields: Mapping[str, Any],
    lengths: dict[str, int],
) -> None:
    """Whether an array has the shape that stands beside it; the axis of lanes may be missing where it is one."""
    shape = values.shape
    if len(shape) == len(stated) - 1 and "lanes" in stated:
        at = stated.index("lanes")
        shape = (*shape[:at], 1, *shape[at:])
    wanted = tuple(
        _length(one, actual, fields, lengths) for one, actual in zip(stated, shape, strict=False)
    )
    if wanted != shape:
        raise InternalError(
            f"a loop takes {name} with the shape ({', '.join(stated)}), here {wanted}; this one has {values.shape}"
        )


def _length(stated: str, actual: int, fields: Mapping[str, Any], lengths: dict[str, int]) -> int:
    """What the length of an axis has to be; one that no number of the struct tells is noted."""
    if isinstance(own := fields.get(stated), int):
        return own
    if stated.isidentifier():
        return lengths.setdefault(stated, actual)
    words = (term.split() for term in stated.split("+"))  # "n_flux + 3", "n_blocks block"
    return sum(math.prod(int(w) if w.isdigit() else int(fields[w]) for w in term) for term in words)


def check_lengths(given: Any, **wanted: int) -> None:
    """Whether the arrays of a struct fit to those of the others in a call.

    Parameters
    ----------
    given : cdata
        From `struct`.
    **wanted : int
        Lengths that its own numbers do not tell, such as lanes and modes, by their names in `kernels.h`. [count]

    Raises
    ------
    InternalError
        If one differs.
    """
    for name, length in _lengths[given].items():
        if wanted.get(name, length) != length:
            raise InternalError(
                f"a loop takes {wanted[name]} {name} in {ffi.typeof(given).item.cname}, this one has {length}"
            )


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
