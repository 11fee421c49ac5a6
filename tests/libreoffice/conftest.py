"""LibreOffice with the extension in a profile of its own."""

import os
import shlex
import subprocess
from pathlib import Path

import pytest

from addin.libreoffice.oxt import extension, worker_command


@pytest.fixture(scope="session")
def calc(soffice, tmp_path_factory):
    """`soffice` with torsionbook.oxt added by LibreOffice's own unopkg."""
    folder = tmp_path_factory.mktemp("calc")
    made = folder / "torsionbook.oxt"
    made.write_bytes(extension(worker_command()))
    # An administrator may add extensions for all users only; "all" is then a folder of this test.
    shared = os.name == "posix" and os.geteuid() == 0
    places = {
        "UNO_SHARED_PACKAGES_CACHE": folder / "shared",
        "SHARED_EXTENSIONS_USER": folder / "registered",
    }
    words = [f"-env:{name}={place.as_uri()}" for name, place in places.items()] if shared else []
    program = folder / "soffice.sh"
    program.write_text(f'#!/bin/sh\nexec {shlex.join([soffice.program, *words])} "$@"\n')
    program.chmod(0o755)
    with_extension = type(soffice)(str(program), folder)
    unopkg = Path(soffice.program).resolve().with_name("unopkg")
    done = subprocess.run(
        [
            str(unopkg),
            "add",
            *(["--shared"] if shared else []),
            str(made),
            f"-env:UserInstallation={with_extension.profile.as_uri()}",
            *words,
        ],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return with_extension
