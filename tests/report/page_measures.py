"""How full the pages of a rendered document are, and where its tables are torn: by ink, for PDF and Word alike."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

#: Dots an inch of the rendering, and a millimetre of it.
DPI = 90
_MM = DPI / 25.4
#: Ground of the head of a table, and the line below a row with what rendering makes of it.
_MIST, _RULE, _NEAR = (0xE9, 0xEE, 0xF4), (0xD8, 0xDE, 0xE6), 26
#: Blank that still belongs to what is beside it: between paragraphs, above headings. [mm]
_GAP = 14.0
#: A head is at least so wide and high; nearer heads are one. [mm]
_WIDE, _HIGH, _APART = 12.0, 1.0, 3.0


@dataclass(frozen=True)
class Margins:
    """Of the text. [mm]"""

    above: float
    below: float
    beside: float


@dataclass(frozen=True)
class Part:
    """What a page holds of a table. [mm]"""

    top: float  #: Upper edge of its head, from that of the text.
    head: float  #: Height of the head.
    height: float  #: From there to the line below its last row.


@dataclass(frozen=True)
class Page:
    """One rendered page."""

    text: str  #: Its words.
    height: float  #: Of the text. [mm]
    fill: float  #: Share of that height with something on it. [1]
    outside: float  #: How far ink goes beyond the margins at the sides. [mm]
    parts: tuple[Part, ...]  #: Tables, from the top.

    @property
    def captions(self) -> list[str]:
        """Such as ``Table 3``, in reading order."""
        return re.findall(r"^ *(Table \d+) (?!.*\(continued\))", self.text, re.MULTILINE)


def pages_of(pdf: Path, margins: Margins) -> list[Page]:
    """The pages of a PDF; without poppler the test is skipped."""
    if shutil.which("pdftoppm") is None or shutil.which("pdftotext") is None:
        pytest.skip("poppler is not installed")
    with tempfile.TemporaryDirectory() as folder:
        stem = Path(folder) / "p"
        subprocess.run(["pdftoppm", "-r", str(DPI), pdf, stem], check=True, timeout=300)
        words = subprocess.run(
            ["pdftotext", "-layout", pdf, "-"], capture_output=True, check=True, timeout=60
        )
        texts = words.stdout.decode("utf-8").split("\f")
        pictures = sorted(Path(folder).glob("p-*.ppm"))
        assert len(texts) == len(pictures) + 1
        return [
            _page(np.asarray(Image.open(picture)), text, margins)
            for picture, text in zip(pictures, texts, strict=False)
        ]


def _page(dots: NDArray[np.uint8], text: str, margins: Margins) -> Page:
    height, width = dots.shape[:2]
    body = dots[round((margins.above - 1.0) * _MM) : height - round((margins.below - 1.0) * _MM)]
    left, right = round(margins.beside * _MM), width - round(margins.beside * _MM)
    inked = (body < 250).any(axis=2)
    rows, columns = np.flatnonzero(inked.any(axis=1)), np.flatnonzero(inked.any(axis=0))
    if not rows.size:
        return Page(text, len(body) / _MM, 0.0, 0.0, ())
    steps = np.diff(np.concatenate(([0], rows)))
    fill = float(steps[steps <= _GAP * _MM].sum()) / len(body)
    outside = max(left - columns[0], columns[-1] - right + 1, 0) / _MM
    return Page(text, len(body) / _MM, fill, outside, tuple(_parts(body, left, right)))


def _parts(body: NDArray[np.uint8], left: int, right: int) -> list[Part]:
    """Heads of tables by their colour, and how far down the lines below rows go."""
    mist = (np.abs(body.astype(int) - _MIST) <= 3).all(axis=2)
    found = (mist[:, left:right].sum(axis=1) > _WIDE * _MM).astype(int)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], found, [0]))))
    heads: list[tuple[int, int]] = []
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if heads and begin - heads[-1][1] < _APART * _MM:
            heads[-1] = (heads[-1][0], end)
        elif end - begin > _HIGH * _MM:
            heads.append((begin, end))
    parts = []
    for (begin, end), (below, _) in zip(heads, [*heads[1:], (len(body), 0)], strict=False):
        columns = np.flatnonzero(mist[begin:end].any(axis=0))
        across = slice(int(columns[0]), int(columns[-1]) + 1)
        grey = (np.abs(body[end:below, across].astype(int) - _RULE) <= _NEAR).all(axis=2)
        lines = np.flatnonzero(grey.mean(axis=1) > 0.7)
        last = end + (int(lines[-1]) if lines.size else 0)
        parts.append(Part(begin / _MM, (end - begin) / _MM, (last - begin) / _MM))
    return parts


def half_empty(pages: Sequence[Page], chapters: Sequence[str]) -> list[str]:
    """Pages less than half full that are not the last of a chapter; `chapters` as they are headed."""
    return [
        f"page {k}: {page.fill:.2f}"
        for k, (page, following) in enumerate(zip(pages, [*pages[1:], None], strict=True), start=1)
        if page.fill < 0.5 and following is not None and not _begins(following, chapters)
    ]


def _begins(page: Page, chapters: Sequence[str]) -> bool:
    """Whether a chapter begins a page, below its head."""
    lines = [" ".join(line.split()) for line in page.text.splitlines() if line.strip()]
    return any(line in chapters for line in lines[:3])


def torn(pages: Sequence[Page]) -> list[str]:
    """Tables that are broken over pages although they would fit one, below their caption and above their note."""
    found = []
    for k, (above, page) in enumerate(zip(pages, pages[1:], strict=False), start=2):
        if len(page.parts) > len(page.captions) and above.parts:
            first, second = above.parts[-1], page.parts[0]
            whole = first.height + second.height - second.head
            if whole + 20.0 <= page.height:
                found.append(f"page {k}: {whole:.0f} mm of {page.height:.0f}")
    return found


def smallest_letters(pdf: Path) -> float:
    """The smallest size of letters, those of formulas (with indices) left out. [pt]"""
    if shutil.which("pdftohtml") is None:
        pytest.skip("poppler's pdftohtml is not installed")
    listed = subprocess.run(
        ["pdftohtml", "-xml", "-i", "-stdout", "-zoom", "3", pdf],
        capture_output=True, check=True, timeout=120,
    ).stdout.decode("utf-8")  # fmt: skip
    fonts = re.findall(r'<fontspec id="\d+" size="(\d+)" family="([^"]+)"', listed)
    sizes = [int(size) / 3.0 for size, family in fonts if "Math" not in family]
    assert len(sizes) > 5
    return min(sizes)
