"""Compiled on first call, kept on disk beside the source or in the user's cache folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import njit

__all__ = ["is_compiled", "kernel"]


def kernel(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Mark a function as compiled loop.

    numba keeps the machine code in `__pycache__` beside the source, in the user's cache folder
    where the package is read-only, or where NUMBA_CACHE_DIR says. Where none of them can be
    written the function is compiled anew in each process rather than refused.

    Parameters
    ----------
    **options : Any
        Options of `numba.njit`.

    Returns
    -------
    callable
        Decorator.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        try:
            return njit(cache=True, **options)(function)
        except RuntimeError:  # numba found no place for the cache
            return njit(**options)(function)

    return compiled


def is_compiled(function: Any) -> bool:
    """Whether the machine code of a kernel is at hand, so that its first call is quick.

    Parameters
    ----------
    function : Any
        A function marked by `kernel`.

    Returns
    -------
    bool
        False if the next call has to compile it.
    """
    if function.signatures:
        return True
    folder = function.stats.cache_path
    if folder is None:
        return False
    source = Path(function.py_func.__code__.co_filename)
    pattern = f"{source.stem}.{function.py_func.__qualname__}-*.nbi"
    try:
        changed = source.stat().st_mtime
        return any(file.stat().st_mtime >= changed for file in Path(folder).glob(pattern))
    except OSError:
        return False
