"""`torsionbook serve`."""

from __future__ import annotations

import importlib.util
import os
import socket
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import INTERNAL, USAGE, failed, failing_on
from addin.server.configuration import configured
from addin.server.listening import address_of, handed_over, sockets_of
from addin.server.settings import Settings, SettingsError, check_certificate
from addin.server.shared import check_shared

#: Whether the optional packages of the server are there.
INSTALLED = all(map(importlib.util.find_spec, ("starlette", "uvicorn", "websockets")))
if INSTALLED:
    from addin.server.app import create_app
    from addin.server.serving import Server


def serve(
    config: Annotated[
        Path | None, typer.Option(help="File with settings, in TOML; see docs/server.md.")
    ] = None,
    host: Annotated[
        str | None, typer.Option(help="Address to listen on.", show_default="127.0.0.1")
    ] = None,
    port: Annotated[
        int | None, typer.Option(help="Port; 0 = any free port.", show_default="8765")
    ] = None,
    cert: Annotated[
        str | None,
        typer.Option(metavar="path", help="Certificate chain in PEM, for HTTPS."),
    ] = None,
    key: Annotated[str | None, typer.Option(metavar="path", help="Its private key in PEM.")] = None,
    dev_cert: Annotated[
        bool | None,
        typer.Option(
            "--dev-cert",
            help="HTTPS with a certificate made for this machine alone, to try the Office add-in.",
        ),
    ] = None,
    api_key_file: Annotated[
        str | None, typer.Option(metavar="path", help="File with the API keys, one per line.")
    ] = None,
    public_url: Annotated[
        str | None,
        typer.Option(
            help="The address that users type, where a reverse proxy stands in front of the server."
        ),
    ] = None,
    trusted_proxies: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESSES",
            help="Addresses or networks of reverse proxies whose X-Forwarded-For is read. Beyond this "
            "machine HTTP is then allowed, to them alone.",
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="Processes for starts; default: number of cores minus one.")
    ] = None,
    log_format: Annotated[
        str | None,
        typer.Option(metavar="text|json", help="How the log is written.", show_default="text"),
    ] = None,
    log_requests: Annotated[
        bool | None, typer.Option("--log-requests", help="A line of the log for each request.")
    ] = None,
    drain: Annotated[
        float | None,
        typer.Option(
            help="Seconds after SIGTERM in which all is still answered, while /readyz says that the server leaves.",
            show_default="0",
        ),
    ] = None,
    shared: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Redis or Valkey through which servers behind a balancer share models and results.",
        ),
    ] = None,
    shared_key_file: Annotated[
        str | None, typer.Option(metavar="path", help="File with the one secret of these servers.")
    ] = None,
    shared_time: Annotated[
        float | None,
        typer.Option(help="Seconds that it keeps what nobody uses.", show_default="86400"),
    ] = None,
    grace: Annotated[
        float | None,
        typer.Option(
            help="Seconds that calls under way may go on when the server ends.", show_default="3"
        ),
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Another limit, such as body=50000000."),
    ] = None,
) -> None:
    """Serve the worksheet functions, the Office add-in and recalculation over HTTP.

    Listens on this machine only. Other machines need HTTPS and API keys, or a reverse proxy.

    Each option may also stand in the file of --config or in the environment, as TORSIONBOOK_PORT for
    --port. A flag goes before the environment, the environment before the file.

    Example: `torsionbook serve`, then open http://127.0.0.1:8765/ in a browser.
    """
    flags = {name: value for name, value in locals().items() if name != "limit"}
    if not INSTALLED:
        raise failed(
            "The packages of the server are not installed. Run pip install -r "
            "requirements/server.txt in the checkout, or install the wheel with its extra [server]."
        )
    with failing_on(SettingsError, status=USAGE):
        settings = configured(flags, os.environ, limit or ())
        check_certificate(settings)
        check_shared(settings)
        sockets = handed_over(settings, os.environ) or sockets_of(settings)
    run(settings, sockets)


def run(settings: Settings, sockets: Sequence[socket.socket]) -> None:
    """Serve until the process is told to end."""
    address = address_of(settings, sockets[0].getsockname()[1])
    try:
        server = Server(settings, create_app(settings), address)
        server.run(list(sockets))
    except KeyboardInterrupt:
        return
    except OSError as wrong:  # the password of the key, for one
        raise failed(f"The server cannot be started: {wrong}.", USAGE) from wrong
    if not server.started:
        raise typer.Exit(INTERNAL)
