"""Settings come from flags, environment and file, in this order; a refusal names where one was typed."""

import re
import socket
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.server.configuration import LIMIT_PREFIX, OPTIONS, PREFIX, configured
from addin.server.listening import sockets_of
from addin.server.settings import Limits, Settings, SettingsError

KEYS = "a-key-nobody-guesses\n"


def file_with(folder: Path, text: str) -> dict[str, str]:
    path = folder / "server.toml"
    path.write_text(text, encoding="utf-8")
    return {"config": str(path)}


def test_a_flag_goes_before_the_environment_and_that_before_the_file(tmp_path):
    file = file_with(
        tmp_path,
        "port = 1\nworkers = 1\nhost = 'localhost'\n[limits]\nbody = 1\ncalls = 1\nlarge = 1\n",
    )
    environment = {
        "TORSIONBOOK_PORT": "2",
        "TORSIONBOOK_WORKERS": "2",
        "TORSIONBOOK_PUBLIC_URL": "",  # blank: as if it were not there
        "TORSIONBOOK_LIMIT_BODY": "2",
        "TORSIONBOOK_LIMIT_CALLS": "2",
    }
    found = configured({**file, "port": 3}, environment, ["body=3"])
    assert (found.port, found.workers, found.host, found.public_url) == (3, 2, "localhost", "")
    assert (found.limits.body, found.limits.calls, found.limits.large) == (3, 2, 1)
    assert found.limits.message == Limits().message
    assert configured({"config": None, "port": None}, {}) == Settings()
    by_environment = configured({}, {f"{PREFIX}CONFIG": file["config"]})
    assert (by_environment.port, by_environment.limits.body) == (1, 1)


def test_paths_of_a_file_begin_in_its_folder(tmp_path):
    (tmp_path / "keys").write_text(KEYS)
    found = configured(file_with(tmp_path, "api_key_file = 'keys'\n"), {})
    assert found.keys == {KEYS.strip()}


@pytest.mark.parametrize(
    ("file", "environment", "flags", "limits", "words"),
    [
        ("port = 70000", {}, {}, (), "port in {file} is 70000; it must lie between"),
        ("port = 'x'", {}, {}, (), "port in {file} is 'x'; write a whole number"),
        ("port = true", {}, {}, (), "write a whole number"),
        ("host = 1", {}, {}, (), "host in {file} is 1; write a text"),
        ("prot = 1", {}, {}, (), "unknown setting 'prot'. Is port meant?"),
        ("limits = 1", {}, {}, (), "[limits]"),
        ("[limits]\nbdy = 1", {}, {}, (), "unknown setting 'bdy' in [limits]. Is body meant?"),
        ("[limits]\nbody = 0", {}, {}, (), "limits.body in {file} is 0; it must be above 0"),
        ("port = ", {}, {}, (), "{file} is no TOML"),
        ("", {"TORSIONBOOK_PORT": "x"}, {}, (), "TORSIONBOOK_PORT is 'x'; write a whole number"),
        ("", {"TORSIONBOOK_WORKERS": "0"}, {}, (), "TORSIONBOOK_WORKERS is 0; at least 1"),
        ("", {"TORSIONBOOK_LOG_FORMAT": "xml"}, {}, (), "TORSIONBOOK_LOG_FORMAT is 'xml'; write text or json"),
        ("", {"TORSIONBOOK_GRACE": "-1"}, {}, (), "TORSIONBOOK_GRACE is below 0 s"),
        ("", {"TORSIONBOOK_PROT": "1"}, {}, (), "Is TORSIONBOOK_PORT meant?"),
        ("", {"TORSIONBOOK_LIMIT_BDY": "1"}, {}, (), "Is TORSIONBOOK_LIMIT_BODY meant?"),
        ("", {"TORSIONBOOK_LIMIT_BODY_TIME": "inf"}, {}, (), "write a number"),
        ("", {"TORSIONBOOK_CERT": "none.pem", "TORSIONBOOK_KEY": "none.pem"}, {}, (), "TORSIONBOOK_CERT: file none.pem not found"),
        ("", {"TORSIONBOOK_HOST": "0.0.0.0"}, {}, (), "TORSIONBOOK_HOST 0.0.0.0: other machines"),
        ("", {"TORSIONBOOK_PORT": "1"}, {"port": -1}, (), "--port is -1"),
        ("", {"TORSIONBOOK_SHARED": "http://u:p@x"}, {}, (), "TORSIONBOOK_SHARED is no address of Redis or Valkey"),
        ("shared = 'redis://u:p@x'", {}, {}, (), "shared in {file}: whoever can write there could"),
        ("", {}, {"shared_key_file": "none"}, (), "--shared-key-file: none cannot be read: No such file or directory. Name"),
        ("api_key_file = 'none'", {}, {}, (), "api_key_file in {file}: "),
        ("", {"TORSIONBOOK_SHARED_TIME": "0"}, {}, (), "TORSIONBOOK_SHARED_TIME is 0 s; it must be at least 1 s"),
        ("", {}, {"shared": "redis://x", "shared_time": 0.5}, (), "whoever can write there"),
        ("", {}, {}, ("body",), "--limit body has no value"),
        ("", {}, {}, ("bdy=1",), "--limit bdy: unknown limit. Is body meant?"),
        ("", {}, {}, ("body=x",), "--limit body is 'x'; write a whole number"),
    ],
)  # fmt: skip
def test_a_refusal_names_where_a_setting_was_typed(
    tmp_path, file, environment, flags, limits, words
):
    given = file_with(tmp_path, file)
    with pytest.raises(SettingsError) as wrong:
        configured({**given, **flags}, environment, limits)
    assert words.format(file=given["config"]) in str(wrong.value)


def test_servers_that_share_have_one_secret(tmp_path):
    place = tmp_path / "secret"
    place.write_text(KEYS)
    flags = {"shared": "redis://x", "shared_key_file": str(place)}
    assert configured(flags, {}).shared_key == KEYS.strip()
    with pytest.raises(SettingsError, match="--shared-time is 0.5 s; it must be at least 1 s"):
        configured(flags | {"shared_time": 0.5}, {})
    with pytest.raises(
        SettingsError, match="--shared-key-file is the secret of a shared memory, but none"
    ):
        configured({"shared_key_file": str(place)}, {})
    place.write_text(KEYS + "another-key-of-ours\n")
    with pytest.raises(SettingsError, match="contains 2 keys; all servers share one secret"):
        configured(flags, {})


def test_a_file_that_is_not_there_is_told_and_variables_of_others_are_left_alone(tmp_path):
    with pytest.raises(SettingsError, match="none.toml cannot be read: No such file"):
        configured({"config": tmp_path / "none.toml"}, {})
    configured({}, {"TORSIONBOOK_RUN_SLOW": "1", "TORSIONBOOK_SOFFICE": "x", "PORT": "x"})


def test_every_setting_has_a_flag_and_refusals_of_the_command_are_usage(monkeypatch):
    shown = CliRunner().invoke(app, ["serve", "-h"], terminal_width=200).output
    for name in (*OPTIONS, "config", "limit"):
        assert f"--{name.replace('_', '-')} " in shown
    monkeypatch.setenv(f"{LIMIT_PREFIX}BODY", "much")
    refused = CliRunner().invoke(app, ["serve"])
    assert refused.exit_code == 2
    assert refused.output == "TORSIONBOOK_LIMIT_BODY is 'much'; write a whole number.\n"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"host": "192.0.2.1"}, "--host 192.0.2.1: this machine has no such address"),
        ({"host": "no.such.name.invalid"}, "--host: the name 'no.such.name.invalid' is unknown here"),
        ({"host": "a" * 70}, "is unknown here"),
    ],
)  # fmt: skip
def test_a_host_that_is_not_of_this_machine_is_told(settings, words):
    with pytest.raises(SettingsError) as wrong:
        sockets_of(SimpleNamespace(port=0, place=Settings().place, **settings))
    assert words in str(wrong.value)


def test_a_port_in_use_is_told_with_one_that_is_free():
    (first,) = sockets_of(Settings(port=0))
    with first:
        port = first.getsockname()[1]
        refused = CliRunner().invoke(app, ["serve", "--port", str(port)])
        assert refused.exit_code == 2
        assert refused.output.startswith(f"--port {port}: another program listens there")
        other = int(re.search(r"--port (\d+) is free", refused.output)[1])
        (second,) = sockets_of(Settings(port=other))
        second.close()
    (again,) = sockets_of(Settings(port=port))
    again.close()


def test_every_address_of_a_name_gets_the_same_port():
    sockets = sockets_of(Settings(host="localhost", port=0))
    assert len({one.getsockname()[1] for one in sockets}) == 1
    for one in sockets:
        with socket.create_connection(one.getsockname()[:2], 5.0):
            one.accept()[0].close()
        one.close()


def test_a_certificate_that_cannot_be_used_ends_the_command_with_status_2(tmp_path):
    (tmp_path / "cert.pem").write_text("x")
    words = ["serve", "--cert", str(tmp_path / "cert.pem"), "--key", str(tmp_path / "cert.pem")]
    refused = CliRunner().invoke(app, words)
    assert refused.exit_code == 2
    assert "contains no certificate in PEM format" in refused.output
