"""The full histories of a start in a file, of a start made by hand."""

from __future__ import annotations

import errno
import hashlib
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from addin.writing.history_file import write_history
from addin.xlsx import whole_files

TIME = np.array([0.0, 1.0, 2.0, 3.0])


def calculated() -> Any:
    """Two outputs in another order than their elements, a third element without one; end at 2 s."""
    trajectory = SimpleNamespace(
        time=TIME,
        mean_speed=10.0 * TIME,
        torque=np.array([[0.0, -7.0, 5.0, 9.0], [0.0, 400.0, -300.0, 900.0]]),
    )
    forces = SimpleNamespace(
        teeth=("Mesh",),
        tooth_force=np.array([[0.0, 50.0, -60.0, 70.0]]),
        bearings=("Pinion",),
        bearing_force=np.array([[1.0, 2.0, 3.0, 4.0]]),
    )
    start = SimpleNamespace(
        outcome=SimpleNamespace(time=2.0),
        trajectory=trajectory,
        output_of_element=np.array([1, -1, 0]),
        forces=forces,
    )
    train = SimpleNamespace(elements=("Mesh", "Rigid", "Shaft"))
    return SimpleNamespace(results=SimpleNamespace(start=start, train=train))


def test_every_column_up_to_the_end_of_the_start_in_si(tmp_path: Path) -> None:
    found = write_history(calculated(), tmp_path / "train.results.xlsx", "npz")
    assert found is not None
    path, digest = found
    assert path == tmp_path / "train.results.history.npz"
    assert digest == hashlib.sha256(path.read_bytes()).hexdigest()
    assert {name: values.tolist() for name, values in np.load(path).items()} == {
        "time_s": [0.0, 1.0, 2.0],
        "speed_rad_per_s": [0.0, 10.0, 20.0],
        "torque_N_m: Mesh": [0.0, 400.0, -300.0],
        "torque_N_m: Shaft": [0.0, -7.0, 5.0],
        "tooth_force_N: Mesh": [0.0, 50.0, -60.0],
        "bearing_force_N: Pinion": [1.0, 2.0, 3.0],
    }


def test_parquet_holds_the_same_columns(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    import pandas as pd

    beside = tmp_path / "train.json"
    pairs = [write_history(calculated(), beside, kind) for kind in ("npz", "parquet")]
    (npz, _), (parquet, _) = (pair for pair in pairs if pair is not None)
    table = pd.read_parquet(parquet)
    assert {k: v.tolist() for k, v in np.load(npz).items()} == table.to_dict("list")


@pytest.mark.parametrize("kind", ["npz", "parquet"])
def test_a_history_that_cannot_be_finished_leaves_the_one_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    if kind == "parquet":
        pytest.importorskip("pyarrow")
    place = tmp_path / f"train.history.{kind}"
    place.write_bytes(b"before")

    def full(_: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(whole_files, "flush_file", full)
    with pytest.raises(OSError, match="No space left"):
        write_history(calculated(), tmp_path / "train.xlsx", kind)
    assert place.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [place]


@pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")
def test_a_history_does_not_go_through_a_link(tmp_path: Path) -> None:
    (tmp_path / "mine").write_bytes(b"mine")
    (tmp_path / "train.history.npz").symlink_to("mine")
    with pytest.raises(OSError, match="is a link"):
        write_history(calculated(), tmp_path / "train.xlsx", "npz")
    assert (tmp_path / "mine").read_bytes() == b"mine"
