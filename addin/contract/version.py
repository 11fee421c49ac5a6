"""The version of torsionbook, as installed."""

from functools import cache
from importlib import metadata

#: Versions with which anybody may have calculated; a new release is entered here.
RELEASED = ("0.1.0",)


@cache
def product_version() -> str:
    """Version of torsionbook; it is looked up on the disk, once in a process.

    Returns
    -------
    str
        Such as ``0.1.0``; ``unknown (not installed)`` where only the sources are there.
    """
    try:
        return metadata.version("torsionbook")
    except metadata.PackageNotFoundError:
        return "unknown (not installed)"
