"""`torsionbook version`."""

from __future__ import annotations

import typer

from addin.contract.version import product_version


def version() -> None:
    """Print the version."""
    typer.echo(f"torsionbook {product_version()}")
