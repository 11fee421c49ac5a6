"""What a company brings to its reports: a logo for the cover, and a Word template."""

from __future__ import annotations

import io
import re
import zipfile
from dataclasses import dataclass
from pathlib import Path

from addin.xlsx.places import refuse_no_end

#: Largest file of either kind. [bytes]
LARGEST = 5_000_000
_MAIN = "application/vnd.openxmlformats-officedocument.wordprocessingml.{}.main+xml"


class CompanyFileError(Exception):
    """A logo or template that cannot be used; the sentence names the file and what to do."""


@dataclass(frozen=True)
class Logo:
    """A picture."""

    data: bytes  #: The file.
    form: str  #: ``png``, ``jpg`` or ``svg``. [word]


def _data(path: Path) -> bytes:
    try:
        refuse_no_end(path)
        size = path.stat().st_size
        if size > LARGEST:
            raise CompanyFileError(
                f"{path} has {size / 1e6:.1f} MB; at most {LARGEST / 1e6:.0f} MB are taken. Save it smaller."
            )
        return path.read_bytes()
    except OSError as error:
        raise CompanyFileError(f"{path} cannot be read: {error.strerror or error}.") from None


def read_logo(path: Path, *, for_word: bool) -> Logo:
    """The logo of a file, known by its content.

    Parameters
    ----------
    path : Path
        A PNG, JPEG or SVG picture. [path]
    for_word : bool
        Whether a Word document is made, which takes no SVG. [flag]

    Raises
    ------
    CompanyFileError
        If it cannot be read or is none of these.
    """
    data = _data(path)
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return Logo(data, "png")
    if data.startswith(b"\xff\xd8\xff"):
        return Logo(data, "jpg")
    if (
        re.match(rb"(?:\xef\xbb\xbf)?\s*<(?:\?xml|!--|!DOCTYPE svg|svg)\b", data)
        and b"<svg" in data
    ):
        if for_word:
            raise CompanyFileError(
                f"{path} is an SVG picture, which Word documents do not take. Name a PNG or JPEG."
            )
        return Logo(data, "svg")
    raise CompanyFileError(
        f"{path} is not a PNG, JPEG or SVG picture. Save the logo as one of these."
    )


def read_word_template(path: Path) -> bytes:
    """A Word document or template as a document that can be written into.

    Parameters
    ----------
    path : Path
        A .docx or .dotx file. [path]

    Returns
    -------
    bytes
        The .docx.

    Raises
    ------
    CompanyFileError
        If it cannot be read, is no Word file, or has macros.
    """
    data = _data(path)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
        types = parts["[Content_Types].xml"].decode()
    except (zipfile.BadZipFile, KeyError, UnicodeDecodeError):
        raise CompanyFileError(
            f"{path} is not a Word document. Name a .docx or .dotx file that Word has saved."
        ) from None
    if "macroEnabled" in types:
        raise CompanyFileError(f"{path} has macros. Save it as .docx or .dotx without them.")
    if _MAIN.format("template") in types:
        types = types.replace(_MAIN.format("template"), _MAIN.format("document"))
        parts["[Content_Types].xml"] = types.encode()
    elif _MAIN.format("document") not in types:
        raise CompanyFileError(
            f"{path} is not a Word document. Name a .docx or .dotx file that Word has saved."
        )
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return made.getvalue()
