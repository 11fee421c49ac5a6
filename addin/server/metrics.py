"""What a server counts, in the text format of Prometheus."""

from __future__ import annotations

import threading
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

#: What an answer of this format is.
MEDIA = "text/plain; version=0.0.4; charset=utf-8"
#: Upper ends of the classes of a time. [s]
CLASSES = (0.01, 0.05, 0.25, 1.0, 5.0, 30.0, 120.0, 900.0)

Labels = tuple[str, ...]


@dataclass(frozen=True)
class Counted:
    """Something that is counted."""

    name: str  #: Its name, without the prefix.
    help: str  #: What it is.
    labels: tuple[str, ...] = ()  #: What it is told apart by.


REQUESTS = Counted("requests_total", "Requests answered.", ("route", "status"))
REQUEST_TIME = Counted(
    "request_seconds", "Time from a request to the end of its answer.", ("route",)
)
CALLS = Counted(
    "calls_total", "Calls of functions answered: value, error or busy.", ("function", "end")
)
TASKS = Counted(
    "calculations_total",
    "Calculations in processes: done, refused, cancelled, stopped or failed.",
    ("task", "end"),
)
TASK_TIME = Counted("calculation_seconds", "Time of a calculation, waiting included.", ("task",))
COUNTERS, TIMES = (REQUESTS, CALLS, TASKS), (REQUEST_TIME, TASK_TIME)

#: What is looked up when it is asked for: name, kind, help, value.
Gauge = tuple[str, str, str, Callable[[], float]]


class Metrics:
    """Counts what one server does; safe to call from any thread.

    Parameters
    ----------
    version : str
        Version of the product. [words]
    """

    def __init__(self, version: str) -> None:
        self._version = version
        self._lock = threading.Lock()
        self._counts: dict[tuple[str, Labels], int] = defaultdict(int)
        self._times: dict[tuple[str, Labels], list[float]] = {}
        #: What is looked up when it is asked for.
        self.gauges: list[Gauge] = []

    def count(self, what: Counted, *labels: str) -> None:
        """One more."""
        with self._lock:
            self._counts[what.name, labels] += 1

    def took(self, what: Counted, seconds: float, *labels: str) -> None:
        """A time more.

        Parameters
        ----------
        what : Counted
            One of `TIMES`.
        seconds : float
            How long it took. [s]
        *labels : str
            What it is told apart by. [names]
        """
        with self._lock:
            # the classes, the count of all, and the sum
            times = self._times.setdefault((what.name, labels), [0.0] * (len(CLASSES) + 2))
            for k, end in enumerate(CLASSES):
                times[k] += seconds <= end
            times[-2] += 1
            times[-1] += seconds

    def text(self) -> str:
        """Everything, as Prometheus reads it."""
        return "".join(f"{line}\n" for line in self._lines())

    def _lines(self) -> Iterator[str]:
        with self._lock:
            counts = dict(self._counts)
            times = {key: list(value) for key, value in self._times.items()}
        yield from _head("info", "gauge", "The version that runs.")
        yield _line("info", {"version": self._version}, 1)
        for what in COUNTERS:
            yield from _head(what.name, "counter", what.help)
            for labels, value in sorted(_of(counts, what)):
                yield _line(what.name, dict(zip(what.labels, labels, strict=True)), value)
        for what in TIMES:
            yield from _head(what.name, "histogram", what.help)
            for labels, value in sorted(_of(times, what)):
                named = dict(zip(what.labels, labels, strict=True))
                for end, number in zip((*map(str, CLASSES), "+Inf"), value, strict=False):
                    yield _line(f"{what.name}_bucket", named | {"le": end}, number)
                yield _line(f"{what.name}_count", named, value[-2])
                yield _line(f"{what.name}_sum", named, value[-1])
        for name, kind, meaning, look in self.gauges:
            yield from _head(name, kind, meaning)
            yield _line(name, {}, look())


def _of(found: Mapping[tuple[str, Labels], Any], what: Counted) -> Iterator[tuple[Labels, Any]]:
    return ((labels, value) for (name, labels), value in found.items() if name == what.name)


def _head(name: str, kind: str, meaning: str) -> Iterator[str]:
    yield f"# HELP torsionbook_{name} {meaning}"
    yield f"# TYPE torsionbook_{name} {kind}"


def _line(name: str, labels: Mapping[str, str], value: float) -> str:
    told = ",".join(f'{key}="{_escaped(text)}"' for key, text in labels.items())
    return f"torsionbook_{name}{{{told}}} {value!r}" if told else f"torsionbook_{name} {value!r}"


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
