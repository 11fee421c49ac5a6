"""A process of our own ends with the program, and not before."""

from __future__ import annotations

import os

import pytest

from addin.batch.pool import _serve
from addin.processes import Process


@pytest.mark.skipif(os.name != "posix", reason="the sentinel is a pipe on POSIX only")
def test_a_closed_pipe_is_not_taken_for_the_end_of_the_program() -> None:
    process = Process(_serve)
    try:
        process._process._popen.finalizer()  # closes this end of the pipe, as a stray close would
        process.line.send((abs, -3))
        assert process.line.poll(60.0)
        assert process.line.recv() == 3
    finally:
        process.end()
