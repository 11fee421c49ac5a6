"""Lock files that spreadsheet programs leave beside an open workbook."""

from __future__ import annotations

import os
from pathlib import Path

from addin.xlsx.errors import WorkbookLocked
from addin.xlsx.places import refuse_no_end


def check_not_open(path: Path) -> None:
    """Refuse a workbook that is open in Excel or LibreOffice.

    Raises
    ------
    WorkbookLocked
        With the name of the user who has it open, as far as the lock file tells.
    """
    for program, lock_file, reader in (
        ("Excel", path.with_name(f"~${path.name}"), _excel_owner),
        ("LibreOffice", path.with_name(f".~lock.{path.name}#"), _libreoffice_owner),
    ):
        if not os.path.exists(lock_file):  # its name may be too long for any file
            continue
        try:
            refuse_no_end(lock_file)
            with open(lock_file, "rb") as file:
                owner = reader(file.read(2000))
        except OSError:
            # Excel holds its lock file so that nobody else may read it; that it is there says enough.
            owner = ""
        who = f" by {owner}" if owner else ""
        raise WorkbookLocked(
            f"{path.name} is open in {program}{who}. Save and close it there and run again. If it "
            f"is not open anywhere, delete the leftover lock file {lock_file.name}, or use "
            "--ignore-lock.",
            owner=owner,
            lock_file=lock_file.name,
        )


def _excel_owner(data: bytes) -> str:
    """Excel: a length byte and the name in the ANSI code page, then (from byte 55) the length and name in UTF-16."""
    if len(data) >= 57:
        length = int.from_bytes(data[55:57], "little")
        name = data[57 : 57 + 2 * length].decode("utf-16-le", "ignore").strip("\0 ")
        if 0 < length <= 54 and name.isprintable() and name:
            return name
    if not data:
        return ""
    return data[1 : 1 + data[0]].decode("cp1252", "ignore").strip("\0 ")


def _libreoffice_owner(data: bytes) -> str:
    """LibreOffice: user, system user, host, date and profile, separated by commas."""
    fields = data.decode("utf-8", "replace").split(",")
    named = [field.strip().rstrip(";") for field in fields[:3]]
    user = named[0] or (named[1] if len(named) > 1 else "")
    host = named[2] if len(named) > 2 else ""
    return f"{user} on {host}" if user and host else user
