"""The worksheet functions of torsionbook, as LibreOffice Calc sees them.

This file runs in the Python of LibreOffice, which knows no torsionbook. It starts one process of the
Python that does (its path and the functions stand in settings.json beside this file), hands it what
the cells hold and gives back what it answers:

- a message is its length (4 bytes, the highest first), then JSON in UTF-8; a number goes as the
  shortest text that gives the same double again;
- a request is {"function": name, "arguments": [...]}, an answer {"rows": [[...]]} or {"error": text};
- the process ends when this side closes; one that has ended is started anew.
"""

import json
import os
import struct
import subprocess
import threading
from typing import Any

import unohelper  # type: ignore[import-not-found]
from com.sun.star.lang import XServiceInfo  # type: ignore[import-not-found]
from org.torsionbook.calc import XFunctions  # type: ignore[import-not-found]

COMPONENT = "org.torsionbook.calc.Functions"
SERVICES = (COMPONENT, "com.sun.star.sheet.AddIn")
#: What a broken connection looks like.
BROKEN = (OSError, EOFError, ValueError)
#: What a cell cannot do without an answer is said in words, like every other error.
NOT_STARTED = (
    "torsionbook does not answer. Its Python was {python}. If that Python was moved or removed, "
    "run torsionbook calc install in the new one and add the new .oxt. {wrong}"
)


def _settings():
    place = os.path.join(os.path.dirname(os.path.abspath(__file__)), "settings.json")
    with open(place, encoding="utf-8") as file:
        return json.load(file)


class Worker:
    """The process that calculates; started when it is first needed."""

    def __init__(self, command):
        self.command = command
        self.process: Any = None
        self.lock = threading.Lock()

    def ask(self, request):
        """The answer to a request; a process that has died is replaced once."""
        message = json.dumps(request).encode("utf-8")
        with self.lock:
            if self.process is not None:
                try:
                    return self._exchange(message)
                except BROKEN:
                    self._end()
            try:
                self._start()
                return self._exchange(message)
            except BROKEN as wrong:
                self._end()
                sentence = NOT_STARTED.format(python=self.command[0], wrong=wrong)
                return {"error": sentence.strip()}

    def _start(self):
        # LibreOffice points these at its own Python.
        clean = {k: v for k, v in os.environ.items() if not k.upper().startswith("PYTHON")}
        self.process = subprocess.Popen(
            self.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=clean,
            # Windows would open a console.
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )

    def _exchange(self, message):
        self.process.stdin.write(struct.pack(">I", len(message)) + message)
        self.process.stdin.flush()
        (length,) = struct.unpack(">I", self._read(4))
        return json.loads(self._read(length).decode("utf-8"))

    def _read(self, count):
        content = self.process.stdout.read(count)
        if len(content) < count:
            raise EOFError("Its process stopped.")
        return content

    def _end(self):
        process, self.process = self.process, None
        if process is None:
            return
        for stream in (process.stdin, process.stdout):
            try:
                stream.close()
            except OSError:
                pass
        try:
            process.kill()
            process.wait(10)
        except (OSError, subprocess.TimeoutExpired):
            pass


def _cells(rows):
    """Rows as Calc takes them: all equally long, a blank as an empty text."""
    width = max(len(row) for row in rows)
    return tuple(
        tuple("" if cell is None else cell for cell in row) + ("",) * (width - len(row))
        for row in rows
    )


def _plain(value):
    """An argument without types of UNO."""
    if isinstance(value, (tuple, list)):
        return [_plain(inner) for inner in value]
    if value is None or isinstance(value, (bool, float, str)):
        return value
    return float(value) if isinstance(value, int) else str(value)


class Functions(unohelper.Base, XFunctions, XServiceInfo):
    """One method a worksheet function; Calc calls them by name."""

    worker: Any = None

    def __init__(self, context, *arguments):
        self.context = context

    def answer(self, function, scalar, arguments):
        """What the cells show: one value, or rows."""
        if Functions.worker is None:
            Functions.worker = Worker(_settings()["command"])
        answer = Functions.worker.ask(
            {"function": function, "arguments": [_plain(argument) for argument in arguments]}
        )
        rows = _cells(answer["rows"] if "rows" in answer else [[answer["error"]]])
        return rows[0][0] if scalar else rows

    def getImplementationName(self):
        return COMPONENT

    def supportsService(self, name):
        return name in SERVICES

    def getSupportedServiceNames(self):
        return SERVICES


def _method(function, scalar):
    def method(self, *arguments):
        return self.answer(function, scalar, arguments)

    return method


for _name, _of in _settings()["methods"].items():
    setattr(Functions, _name, _method(*_of))

g_ImplementationHelper = unohelper.ImplementationHelper()
g_ImplementationHelper.addImplementation(Functions, COMPONENT, SERVICES)
