"""`serve --dev-cert`: a certificate that this machine may trust, and nobody else can use."""

import os
import ssl
import subprocess
import sys
import urllib.request

import pytest
from servers import outside

from addin.server import dev_certificate as dev
from addin.server.configuration import configured
from addin.server.settings import SettingsError

pytest.importorskip("cryptography")


def test_it_is_made_once_and_again_before_it_ends(tmp_path, monkeypatch):
    certificate, key = dev.dev_certificate(tmp_path / "new")
    first = certificate.read_bytes()
    if sys.platform != "win32":
        assert key.stat().st_mode & 0o777 == 0o600
    assert dev.dev_certificate(tmp_path / "new")[0].read_bytes() == first
    monkeypatch.setattr(dev, "RENEWED", dev.VALID + 1)
    assert dev.dev_certificate(tmp_path / "new")[0].read_bytes() != first
    read = subprocess.run(
        [sys.executable, "-c", "import ssl, sys; print(ssl._ssl._test_decode_cert(sys.argv[1]))", certificate],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert (
        "('DNS', 'localhost'), ('IP Address', '127.0.0.1'), ('IP Address', '0:0:0:0:0:0:0:1')"
        in read
    )
    assert dev.how_to_trust(certificate).count(str(certificate)) == 1


def test_it_serves_whoever_trusts_it_under_the_names_of_this_machine(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    with outside("--dev-cert") as address:
        assert address.startswith("https://127.0.0.1:")
        certificate = dev.folder_of(os.environ) / dev.CERTIFICATE
        trusting = ssl.create_default_context(cafile=str(certificate))
        trusting.verify_flags |= ssl.VERIFY_X509_STRICT
        for name in ("127.0.0.1", "localhost"):
            there = address.replace("127.0.0.1", name)
            with urllib.request.urlopen(f"{there}/manifest.xml", context=trusting) as said:
                content = said.read().decode()
            assert f'"{there}/functions.json"' in content
            assert "HTTPS only" not in content
        with pytest.raises(OSError, match="CERTIFICATE_VERIFY_FAILED"):
            urllib.request.urlopen(f"{address}/", context=ssl.create_default_context())


def test_it_is_for_this_machine_alone_and_stands_alone(tmp_path):
    environment = {"XDG_DATA_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path)}
    with pytest.raises(SettingsError, match="for this machine alone"):
        configured({"dev_cert": True, "host": "0.0.0.0"}, environment)
    with pytest.raises(SettingsError, match="TORSIONBOOK_DEV_CERT makes a certificate; leave"):
        configured({"cert": "x"}, environment | {"TORSIONBOOK_DEV_CERT": "1"})
    assert not configured({}, {"TORSIONBOOK_DEV_CERT": "no"}).is_dev
    with pytest.raises(SettingsError, match="TORSIONBOOK_DEV_CERT is 'x'; write true or false"):
        configured({}, {"TORSIONBOOK_DEV_CERT": "x"})
