"""The version of torsionbook, as installed."""

from importlib import metadata

#: Versions with which anybody may have calculated; a new release is entered here.
RELEASED = ("0.1.0",)


def product_version() -> str:
    """Version of torsionbook.

    Returns
    -------
    str
        Such as ``0.1.0``; ``unknown (not installed)`` where only the sources are there.
    """
    try:
        return metadata.version("torsionbook")
    except metadata.PackageNotFoundError:
        return "unknown (not installed)"
