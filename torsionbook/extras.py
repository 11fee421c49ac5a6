"""Packages that are installed by choice: ``torsionbook[python]`` brings all of them."""

from __future__ import annotations

import importlib
from typing import Any


def extra(module: str, purpose: str) -> Any:
    """A module of a package that is installed by choice.

    Raises
    ------
    ImportError
        If it is not installed; the sentence says how to install it.
    """
    package = module.partition(".")[0]
    try:
        return importlib.import_module(module)
    except ImportError as missing:
        raise ImportError(
            f"{purpose} need {package}, which is not installed. Install it: pip install "
            f"'torsionbook[python]', or pip install {package}."
        ) from missing
