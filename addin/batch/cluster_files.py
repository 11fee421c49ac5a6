"""How the files of a batch reach a cluster: by a folder that it shares with this machine, or as bytes.

Results come back the same way, and only this machine records them and puts them in place.
"""

from __future__ import annotations

import uuid
from dataclasses import replace
from pathlib import Path
from typing import Any

from addin.batch.folder import digested
from addin.batch.work import Calculated, Examine, Work, is_locked, refused
from addin.contract.version import product_version
from addin.workers.cluster import PATIENCE, Cluster
from addin.workers.pool import Answered, Task


class FileCluster(Cluster):
    """A Dask cluster that calculates files; they reach it by a shared folder or as bytes.

    Parameters
    ----------
    address : str
        Of the scheduler. [address]
    patience : float
        How long it is waited for. [s]
    """

    def __init__(self, address: str, patience: float = PATIENCE) -> None:
        super().__init__(
            address,
            product_version,
            patience,
            "Finished results are kept; run again with --resume.",
        )
        #: Whether files go to the workers as bytes.
        self.sends_bytes = False

    def shares(self, folder: Path, source: Path) -> bool:
        """Whether every worker sees a folder and a file of this machine under the same paths."""
        token = uuid.uuid4().hex
        probe = folder / "probe"
        probe.write_text(token, encoding="ascii")
        try:
            return all(self._client.run(shared, str(folder), token, str(source)).values())
        finally:
            for left in folder.glob("probe*"):
                left.unlink(missing_ok=True)

    def prepare(self, task: Task) -> Any:
        """What is sent for a task; `Answered` where its file is not there or somebody has it open."""
        payload = task.payload
        if not self.sends_bytes or not isinstance(payload, Examine):
            return payload
        wrong = is_locked(payload) if isinstance(payload, Work) else None
        if wrong is None:
            path = Path(payload.source)
            try:
                return replace(payload, stamp=digested(path), content=path.read_bytes())
            except OSError as error:
                wrong = error
        if isinstance(payload, Work):
            return Answered(Calculated(refused(payload, wrong)))
        return Answered(task.do(payload))


def shared(folder: str, token: str, source: str) -> bool:
    """Whether this worker sees the folder and the file, and may write there."""
    place = Path(folder)
    try:
        if (place / "probe").read_text(encoding="ascii") != token:
            return False
        (place / f"probe-{uuid.uuid4().hex}").write_text(token, encoding="ascii")
        with open(source, "rb") as file:
            file.read(1)
    except OSError:
        return False
    return True
