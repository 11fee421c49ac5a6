"""A certificate for this machine alone, to try the Office add-in with: `serve --dev-cert`."""

from __future__ import annotations

import datetime
import importlib.util
import ipaddress
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from addin.server.settings import LOOPBACK, SettingsError

#: Whether the package that makes it is there; it is loaded where one is made.
INSTALLED = importlib.util.find_spec("cryptography") is not None
#: How long one is valid: systems refuse more than 398 days. And when a new one is made. [days]
VALID, RENEWED = 397, 30
#: Names of its files.
CERTIFICATE, KEY = "dev-cert.pem", "dev-key.pem"


def folder_of(environment: Mapping[str, str]) -> Path:
    """Where the certificate of this user is kept."""
    home = Path.home()
    if sys.platform == "win32":
        base = Path(environment.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = home / "Library" / "Application Support"
    else:
        base = Path(environment.get("XDG_DATA_HOME") or home / ".local" / "share")
    return base / "torsionbook"


def dev_certificate(folder: Path) -> tuple[Path, Path]:
    """The certificate and its key: those of before, or new ones where they are missing or soon end.

    It signs itself and cannot sign others, so that trusting it trusts no other certificate.

    Raises
    ------
    SettingsError
        If they cannot be made or written.
    """
    if not INSTALLED:
        raise SettingsError(
            "--dev-cert needs the package cryptography. Run pip install cryptography."
        )
    certificate, key = folder / CERTIFICATE, folder / KEY
    if not _serves(certificate, key):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _make(certificate, key)
        except OSError as wrong:
            raise SettingsError(
                f"--dev-cert: {wrong.filename} cannot be written: {wrong.strerror}."
            ) from None
    return certificate, key


def how_to_trust(certificate: Path) -> str:
    """The command that has this system trust a certificate, for its user to decide."""
    if sys.platform == "win32":
        return f'certutil -user -addstore Root "{certificate}"'
    if sys.platform == "darwin":
        return (
            "security add-trusted-cert -p ssl -k ~/Library/Keychains/login.keychain-db "
            f'"{certificate}"'
        )
    return (
        f'certutil -d sql:$HOME/.pki/nssdb -A -t P,, -n torsionbook -i "{certificate}" '
        "(browsers of the Chromium family)"
    )


def _serves(certificate: Path, key: Path) -> bool:
    """Whether files of before can be served with for some time yet."""
    from cryptography import x509

    try:
        ends = x509.load_pem_x509_certificate(certificate.read_bytes()).not_valid_after_utc
    except (OSError, ValueError):
        return False
    soon = datetime.datetime.now(datetime.UTC) + datetime.timedelta(days=RENEWED)
    return key.is_file() and ends > soon


def _make(certificate: Path, key: Path) -> None:
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    secret = ec.generate_private_key(ec.SECP256R1())
    public = secret.public_key()
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "torsionbook on this machine")])
    now = datetime.datetime.now(datetime.UTC)
    names = [x509.DNSName("localhost")]
    addresses = [
        x509.IPAddress(ipaddress.ip_address(one)) for one in sorted(LOOPBACK - {"localhost"})
    ]
    use = dict.fromkeys(
        ("content_commitment", "key_encipherment", "data_encipherment", "key_agreement",
         "key_cert_sign", "crl_sign", "encipher_only", "decipher_only"),
        False,
    )  # fmt: skip
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(public)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - datetime.timedelta(hours=1))
        .not_valid_after(now + datetime.timedelta(days=VALID))
        .add_extension(x509.SubjectAlternativeName([*names, *addresses]), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.KeyUsage(digital_signature=True, **use), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(public), critical=False)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(public), critical=False)
        .sign(secret, hashes.SHA256())
    )
    private = secret.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    key.unlink(missing_ok=True)
    with os.fdopen(os.open(key, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(private)
    certificate.write_bytes(made.public_bytes(serialization.Encoding.PEM))
