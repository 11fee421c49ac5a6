"""Routes, put together for one set of settings."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, closing

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from addin.contract.version import product_version
from addin.server import document_routes, office, uploads
from addin.server.answers import Refused, answer, encoded
from addin.server.bodies import read_json, while_connected
from addin.server.calls import Asked, Calls, read_calls
from addin.server.keys import Keys
from addin.server.leaving import Leaving
from addin.server.metrics import MEDIA, Metrics
from addin.server.openapi import document as description
from addin.server.policies import ADD_IN_PAGE, NO_PAGE, PAGE, headers_with
from addin.server.processes import Work
from addin.server.requests import RequestGuard
from addin.server.running_starts import Starts
from addin.server.settings import Settings
from addin.server.shared import SharedMemory
from addin.server.stream import Stream
from addin.server.uploads import MEDIA as WORKBOOK_MEDIA
from addin.workers.processes import most_resident
from addin.worksheet.models import MODELS

#: Scripts of the page; functions.js is filled in.
MODULES = (
    "taskpane", "page", "results", "curves", "plot", "charts", "motion", "inputs", "study_forms", "tools", "kept",
    "lines", "theme", "open_workbook",
)  # fmt: skip
#: Files of the page: name → media type.
FILES = {
    "taskpane.css": "text/css",
    **{f"{name}.js": "text/javascript" for name in MODULES},
    **{f"icon-{size}.png": "image/png" for size in (16, 32, 64, 80)},
}
#: The script of the Office host: the one file that does not come from this server.
OFFICE_JS = b'<script src="https://appsforoffice.microsoft.com/lib/1/hosted/office.js"></script>'
#: What browsers may load for its pages.
POLICIES = {"": PAGE, "taskpane.html": ADD_IN_PAGE}

Answer = Callable[[Request], Awaitable[Response]]


def create_app(settings: Settings) -> Starlette:
    """The server as an ASGI application."""
    limits = settings.limits
    metrics = Metrics(product_version())
    keys, leaving = Keys(settings), Leaving()
    work = Work(settings.workers, limits.waiting, limits.long_time, metrics)
    # a page that shows a workbook does not wait for a start
    reading = Work(1, limits.waiting, limits.short_time, metrics)
    starts = Starts(work)
    calls = Calls(starts, limits, metrics)
    memory = SharedMemory(settings) if settings.shared else None
    metrics.gauges += [
        ("calculations_waiting", "gauge", "Calculations that wait.", lambda: work.waiting() + reading.waiting()),
        ("models", "gauge", "Models in memory.", lambda: MODELS.count),
        ("results_bytes", "gauge", "Memory of results.", lambda: MODELS.memory),
        ("wrong_keys_total", "counter", "Wrong API keys.", lambda: keys.wrong),
        ("unseen_keys_total", "counter", "API keys refused unseen.", lambda: keys.unseen),
        ("memory_bytes", "gauge", "Largest resident memory of the server process.", most_resident),
        ("processor_seconds_total", "counter", "Processor time of the server process.", time.process_time),
    ]  # fmt: skip

    if memory is not None:
        metrics.gauges.append(
            ("shared_memory_up", "gauge", "Whether the shared memory answers.", lambda: int(memory.is_up))
        )  # fmt: skip

    async def batch(request: Request) -> Response:
        content, size = await read_json(request, limits.body, limits.body_time)
        wanted = read_calls(content, limits.calls)
        with closing(calls.new_unsent_cells()) as room:
            answers = await while_connected(request, calls.answers(Asked(wanted, room, size)))
            return answer(await calls.encoded({"results": answers}))

    async def workbook(request: Request) -> Response:
        return await uploads.recalculated(request, work, limits)

    async def open_workbook(request: Request) -> Response:
        return await uploads.open_workbook(request, work, limits)

    async def model(request: Request) -> Response:
        return await uploads.model_of(request, reading, limits)

    def document(answered: Callable[..., Awaitable[Response]], pool: Work) -> Answer:
        async def respond(request: Request) -> Response:
            return await answered(request, pool, limits)

        return respond

    async def stream(socket: WebSocket) -> None:
        await Stream(socket, settings, calls, starts).serve()

    async def manifest(request: Request) -> Response:
        base = settings.public_url or str(request.base_url)
        return _file(office.manifest(base.rstrip("/")), "application/xml")

    @asynccontextmanager
    async def running(app: Starlette) -> AsyncIterator[None]:
        if memory is not None:
            await asyncio.to_thread(memory.begin)
            MODELS.store = memory
        yield
        if memory is not None:
            MODELS.store = None
            memory.close()
        calls.close()
        for pool in (work, reading):
            pool.close()

    async def ready(request: Request) -> Response:
        if leaving.has_begun:
            raise Refused(503, "The server is being stopped. Ask another.")
        return _file(encoded({"ok": True}), "application/json")

    async def counted(request: Request) -> Response:
        return Response(metrics.text(), media_type=MEDIA, headers=headers_with())

    about = {"name": "torsionbook", "version": product_version()}
    constant = {
        "": (_page(b""), "text/html"),
        "taskpane.html": (_page(OFFICE_JS), "text/html"),
        "functions.js": (office.functions_script(), "text/javascript"),
        "functions.json": (encoded(office.functions_json()), "application/json"),
        "openapi.json": (encoded(description()), "application/json"),
        "healthz": (encoded({"ok": True}), "application/json"),
        "version": (encoded(about), "application/json"),
        "examples.json": (encoded(document_routes.EXAMPLES), "application/json"),
        **{
            path: (content, WORKBOOK_MEDIA[".xlsx"])
            for path, content in document_routes.examples().items()
        },
        **{name: (office.static(name), kind) for name, kind in FILES.items()},
    }
    documents = {
        "inputs": (document_routes.inputs, reading),
        "edited": (document_routes.edited, reading),
        "report": (document_routes.report, work),
        "verify": (document_routes.verify, work),
        "diff": (document_routes.diff, work),
        "study": (document_routes.study, work),
    }
    app = Starlette(
        routes=[
            Route("/api/v1/batch", batch, methods=["POST"]),
            Route("/api/v1/model", model, methods=["POST"]),
            Route("/api/v1/workbook", workbook, methods=["POST"]),
            Route("/api/v1/open-workbook", open_workbook, methods=["POST"]),
            *(
                Route(f"/api/v1/{path}", document(answered, pool), methods=["POST"])
                for path, (answered, pool) in documents.items()
            ),
            WebSocketRoute("/api/v1/stream", stream),
            Route("/manifest.xml", manifest),
            Route("/metrics", counted),
            Route("/readyz", ready),
            *(
                Route(f"/{path}", _constant(*what, POLICIES.get(path, NO_PAGE)))
                for path, what in constant.items()
            ),
        ],
        middleware=[
            Middleware(RequestGuard, settings=settings, keys=keys, metrics=metrics, leaving=leaving)
        ],
        exception_handlers={HTTPException: _no_such_thing, Refused: _refused},
        lifespan=running,
    )
    app.state.pools, app.state.leaving = (work, reading), leaving
    return app


def _page(office_js: bytes) -> bytes:
    """The page, with the script of the Office host or without it."""
    return office.static("taskpane.html").replace(b"<!-- the Office host -->", office_js)


def _constant(content: bytes, media_type: str, policy: str = NO_PAGE) -> Answer:
    async def respond(request: Request) -> Response:
        return _file(content, media_type, policy)

    return respond


def _file(content: bytes, media_type: str, policy: str = NO_PAGE) -> Response:
    return Response(content, media_type=media_type, headers=headers_with(policy))


async def _no_such_thing(request: Request, wrong: Exception) -> Response:
    assert isinstance(wrong, HTTPException)
    path = request.url.path[:80]
    sentence = {
        404: f"Unknown address {path}. /openapi.json lists the addresses of this server.",
        405: (
            f"{path} does not accept {request.method[:20]}. /openapi.json lists the accepted "
            "methods."
        ),
    }.get(wrong.status_code, str(wrong.detail))
    return Refused(wrong.status_code, sentence, wrong.headers).response()


async def _refused(request: Request, wrong: Exception) -> Response:
    assert isinstance(wrong, Refused)
    return wrong.response()
