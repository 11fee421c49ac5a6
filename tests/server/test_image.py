"""The image of the server: what can be said of its files without building it."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from addin.server.configuration import OPTIONS, PREFIX, configured

ROOT = Path(__file__).resolve().parents[2]
DEPLOY = ROOT / "deploy"


def test_the_image_is_built_as_its_linter_wants():
    linter = shutil.which("hadolint", path=str(Path(sys.executable).parent))
    if linter is None:
        pytest.skip("hadolint is not installed")
    said = subprocess.run([linter, DEPLOY / "Containerfile"], capture_output=True, text=True)
    assert (said.returncode, said.stdout) == (0, "")


def test_what_the_image_copies_is_in_the_checkout_and_not_kept_out():
    text = (DEPLOY / "Containerfile").read_text()
    kept = {
        line[1:] for line in (ROOT / ".dockerignore").read_text().split() if line.startswith("!")
    }
    copied = [name.rstrip("/") for line in re.findall(r"^COPY (?!--from)(.*) \S+$", text, re.MULTILINE) for name in line.split()]  # fmt: skip
    assert set(copied) == kept
    assert all((ROOT / name).exists() for name in copied)
    for name in re.findall(r"-r (\S+)", text):
        assert (ROOT / name).is_file()
    last = text.rpartition("\nFROM ")[2]
    assert "USER 10001" in last
    assert "HEALTHCHECK" in last


def test_the_settings_of_the_compose_file_are_ones_the_server_takes(tmp_path):
    yaml = pytest.importorskip("yaml")
    content = yaml.safe_load((DEPLOY / "compose.yaml").read_text())
    server, proxy = content["services"]["server"], content["services"]["proxy"]
    given = {name: str(value) for name, value in server["environment"].items()}
    assert {name.removeprefix(PREFIX).lower() for name in given} <= set(OPTIONS)
    (tmp_path / "keys").write_text("a-key-nobody-guesses")
    assert given["TORSIONBOOK_API_KEY_FILE"] == f"/run/secrets/{server['secrets'][0]}"
    found = configured({}, given | {
        "TORSIONBOOK_API_KEY_FILE": str(tmp_path / "keys"),
        "TORSIONBOOK_PUBLIC_URL": "https://torsion.example.com",
    })  # fmt: skip
    (network,) = content["networks"]["inside"]["ipam"]["config"]
    assert [str(one) for one in found.trusted_proxies] == [network["subnet"]]
    assert "ports" not in server  # only the proxy is reached from outside
    assert float(server["stop_grace_period"].removesuffix("s")) > found.drain + found.grace + 3
    assert (ROOT / "deploy" / server["build"]["context"] / server["build"]["dockerfile"]).is_file()
    for volume in proxy["volumes"]:
        assert (DEPLOY / volume.split(":")[0]).is_file()
    asked = {name for one in (server, proxy) for name in one["secrets"]}
    assert asked == set(content["secrets"])
    config = (DEPLOY / "nginx.conf.template").read_text()
    assert f"http://server:{found.port};" in config
    for name in ("fullchain.pem", "privkey.pem"):
        assert f"/run/secrets/{name};" in config
