"""`torsionbook serve`."""

from __future__ import annotations

import importlib.util
import logging
import os
import socket
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from addin.cli.status import INTERNAL, USAGE, failed, failing_on
from addin.server.configuration import configured
from addin.server.dev_certificate import how_to_trust
from addin.server.listening import address_of, sockets_of
from addin.server.settings import Settings, SettingsError, check_certificate

#: Whether the optional packages of the server are there.
INSTALLED = all(map(importlib.util.find_spec, ("starlette", "uvicorn", "websockets")))
if INSTALLED:
    import uvicorn

    from addin.server.app import create_app

LOG = logging.getLogger("uvicorn.error")
#: How long calculations may go on once the server is asked to stop. [s]
GRACE = 3


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
    workers: Annotated[
        int | None, typer.Option(help="Processes for starts; default: number of cores minus one.")
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
        sockets = sockets_of(settings)
    run(settings, sockets)


def run(settings: Settings, sockets: Sequence[socket.socket]) -> None:
    """Serve until Ctrl+C."""
    app = create_app(settings)
    address = address_of(settings, sockets[0].getsockname()[1])

    def give_up() -> None:
        for pool in app.state.pools:
            pool.stop()

    class Server(uvicorn.Server):
        async def startup(self, sockets: Any = None) -> None:
            await super().startup(sockets)
            if settings.is_dev and settings.certificate is not None:
                trust = how_to_trust(settings.certificate)
                LOG.info("Until this machine trusts the certificate, browsers warn: %s", trust)
            LOG.info("torsionbook is running on %s (Ctrl+C ends it)", address)

        def handle_exit(self, sig: int, frame: Any) -> None:
            """Answer calls that do not end in time while their connection is still there."""
            timer = threading.Timer(GRACE, give_up)
            timer.daemon = True
            timer.start()
            super().handle_exit(sig, frame)

    config = uvicorn.Config(
        app,
        ssl_certfile=settings.certificate,
        ssl_keyfile=settings.certificate_key,
        ws_max_size=settings.limits.message,
        ws_per_message_deflate=False,  # a few kB sent would be many MB here
        proxy_headers=False,  # anybody can write them; the address of a proxy counts as one client
        timeout_graceful_shutdown=GRACE + 3,
        log_level="info",
        access_log=False,  # a proxy keeps one; here it would cost as much as a short call
        server_header=False,
    )
    server = Server(config)
    try:
        server.run(list(sockets))
    except KeyboardInterrupt:
        pass
    except OSError as wrong:  # the password of the key, for one
        raise failed(f"The server cannot be started: {wrong}.", USAGE) from wrong
    if not server.started:
        raise typer.Exit(INTERNAL)
