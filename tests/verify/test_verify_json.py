"""`torsionbook verify` on result JSON, and its exit status and JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cells_of_tables import cell_of
from typer.testing import CliRunner

from addin.cli.app import app
from addin.verify.file import verify_file

RUN = CliRunner()


def changed(calculated: Path, tmp_path: Path, edit) -> Path:
    content = json.loads((calculated / "train.results.json").read_text(encoding="utf-8"))
    edit(content)
    target = tmp_path / "changed.results.json"
    target.write_text(json.dumps(content), encoding="utf-8")
    return target


def test_a_result_json_follows_from_its_case(calculated):
    found = verify_file(calculated / "train.results.json", case=calculated / "case.xlsx")
    assert found.passes
    assert not found.findings


@pytest.mark.parametrize(
    ("edit", "path"),
    [
        (lambda c: c["steady_state"][4].update(torque=1.0), "steady_state[4].torque"),
        (lambda c: c["startup"].update(outcome="stalled"), "startup.outcome"),
        (lambda c: c["modes"][0]["strain_energy"].update(Mesh=0.5), "modes[0].strain_energy.Mesh"),
        (lambda c: c["mode_shapes"][1].update(mode_2=0.5), "mode_shapes[1].mode_2"),
        (lambda c: c["separation_margins"].pop(3), ""),
        (lambda c: c.pop("startup_peaks"), ""),
        (lambda c: c.update(case_sha256="0" * 64), "case_sha256"),
    ],
)
def test_what_was_changed_in_it_is_named_by_its_path(calculated, tmp_path, edit, path):
    found = verify_file(changed(calculated, tmp_path, edit), case=calculated / "case.xlsx")
    assert not found.passes
    assert path in {finding.cell for finding in found.findings if finding.fails}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "is not JSON"),
        ("[]", "contains no results"),
        ('{"case_sha256": 3, "audit": 7, "steady_state": [1]}', "not follow"),
    ],
)
def test_other_json_is_refused_or_judged_but_never_a_crash(calculated, tmp_path, text, said):
    target = tmp_path / "odd.json"
    target.write_text(text, encoding="utf-8")
    found = verify_file(target, case=calculated / "case.xlsx")
    assert not found.passes
    assert said in f"{found.outcome} {found.sentence}"


@pytest.mark.slow
def test_exit_status_and_json_for_machines(calculated, tmp_path, edited):
    good = calculated / "train.xlsx"
    done = RUN.invoke(app, ["verify", str(good), "--json", str(tmp_path / "good.json")])
    assert done.exit_code == 0, done.output
    said = json.loads((tmp_path / "good.json").read_text(encoding="utf-8"))
    assert said["follows"] is True
    assert said["recorded_sha256"] == said["case_sha256"]

    bad = edited(lambda w: w.set_cell(*cell_of(w, "StartupPeaks", 1, "Time"), 1.0))
    folder = tmp_path / "said"
    done = RUN.invoke(app, ["verify", str(good), str(bad), "--json", str(folder)])
    assert done.exit_code == 1
    assert "Start!G" in done.output
    said = json.loads((folder / "edited.verify.json").read_text(encoding="utf-8"))
    assert [(f["kind"], f["sheet"], f["found"]) for f in said["findings"] if f["fails"]] == [
        ("edited", "Start", 1.0)
    ]
    assert RUN.invoke(app, ["verify", str(good), "--within", "taste"]).exit_code == 2
    missing = RUN.invoke(app, ["verify", str(tmp_path / "none.xlsx")])
    assert missing.exit_code == 1
    assert "does not exist" in missing.output


def test_a_result_json_without_its_case_says_what_to_do(calculated):
    done = RUN.invoke(app, ["verify", str(calculated / "train.results.json")])
    assert done.exit_code == 1
    assert "--case" in done.output
