"""What shared servers are tested with: a Redis or Valkey of its own, and a small balancer in front of servers."""

import contextlib
import http.client
import itertools
import shutil
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as one:
        return int(one.getsockname()[1])


@contextlib.contextmanager
def redis(port: int) -> Iterator[str]:
    """A server on loopback that keeps nothing on disk; its address."""
    program = next(filter(None, map(shutil.which, ("valkey-server", "redis-server"))))
    words = ["--bind", "127.0.0.1", "--port", str(port), "--save", "", "--appendonly", "no"]
    process = subprocess.Popen([program, *words], stdout=subprocess.DEVNULL)
    try:
        for _ in range(200):
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
                break
            time.sleep(0.05)
        yield f"redis://127.0.0.1:{port}/0"
    finally:
        process.terminate()
        process.wait(20)


class Balancer(ThreadingHTTPServer):
    """Gives each request and each WebSocket to the next server that says it is ready, in turn, and looks ten times a second."""

    daemon_threads = True
    request_queue_size = 100

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.backends: list[str] = []
        self.ready: tuple[str, ...] = ()
        #: How many requests each has answered.
        self.answered: dict[str, int] = {}
        self._turn = itertools.count()
        self._ended = threading.Event()
        threading.Thread(target=self._look, daemon=True).start()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}"

    def end(self) -> None:
        self._ended.set()
        self.shutdown()
        self.server_close()

    def next(self) -> str:
        ready = self.ready
        return ready[next(self._turn) % len(ready)]

    def _look(self) -> None:
        while not self._ended.wait(0.1):
            self.ready = tuple(filter(_is_ready, list(self.backends)))


def _is_ready(address: str) -> bool:
    try:
        with urllib.request.urlopen(f"{address}/readyz", timeout=10):
            return True
    except (OSError, http.client.HTTPException):
        return False


class _Handler(BaseHTTPRequestHandler):
    server: Balancer

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        backend = self.server.next()
        asked = urllib.request.Request(
            backend + self.path, body, {"Content-Type": self.headers["Content-Type"]}
        )
        try:
            with urllib.request.urlopen(asked, timeout=120) as said:
                status, content = said.status, said.read()
        except urllib.error.HTTPError as wrong:
            status, content = wrong.code, wrong.read()
        except OSError as lost:  # never tried again elsewhere: a call that is lost here is lost
            status, content = 502, str(lost).encode()
        self.server.answered[backend] = self.server.answered.get(backend, 0) + 1
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def do_GET(self) -> None:
        """A WebSocket: bytes go both ways until one side ends."""
        host, _, port = self.server.next().removeprefix("http://").partition(":")
        self.headers.replace_header("Host", f"{host}:{port}")
        self.close_connection = True
        with socket.create_connection((host, int(port)), 10) as backend:
            backend.settimeout(None)
            backend.sendall(f"{self.requestline}\r\n{self.headers.as_string()}".encode("latin-1"))
            back = threading.Thread(target=_pass, args=(backend, self.connection), daemon=True)
            back.start()
            _pass(self.connection, backend)
            back.join()

    def log_message(self, format: str, *args: object) -> None:
        """Nothing."""


def _pass(source: socket.socket, target: socket.socket) -> None:
    with contextlib.suppress(OSError):
        while content := source.recv(65_536):
            target.sendall(content)
    for one in (source, target):
        with contextlib.suppress(OSError):
            one.shutdown(socket.SHUT_RDWR)
