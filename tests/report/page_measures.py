"""How full the pages of a rendered document are, and where its tables are torn: by ink, for PDF and Word alike."""

from __future__ import annotations

import re
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

#: Dots an inch of the rendering.
DPI = 90
_MM = DPI / 25.4
#: Ground of the head of a table.
_MIST = (0xE9, 0xEE, 0xF4)
#: Blank that still belongs to what stands beside it: between paragraphs, above headings. [mm]
_GAP = 14.0


@dataclass(frozen=True)
class Part:
    """What a page holds of a table."""

    top: float  #: Upper edge of the head. [mm]
    head: float  #: Height of the head. [mm]
    height: float  #: From there to its last line. [mm]


@dataclass(frozen=True)
class Page:
    """One rendered page."""

    text: str  #: Its words.
    fill: float  #: Share of the height of the text that is used. [1]
    lowest: float  #: How far down the ink goes, of the height of the text. [1]
    outside: float  #: Ink beside the text: farthest distance. [mm]
    parts: tuple[Part, ...]  #: Tables on it, from the top.
    captions: tuple[str, ...]  #: ``Table 3`` and the like, in reading order.


def pages_of(pdf: Path, top: float, bottom: float, side: float) -> list[Page]:
    """The pages of a PDF with these margins. [mm]"""
    with tempfile.TemporaryDirectory() as folder:
        stem = Path(folder) / "p"
        subprocess.run(["pdftoppm", "-r", str(DPI), str(pdf), str(stem)], check=True, timeout=300)
        pictures = sorted(Path(folder).glob("p-*.ppm"))
        words = subprocess.run(
            ["pdftotext", "-layout", str(pdf), "-"], capture_output=True, check=True, timeout=60
        ).stdout.decode("utf-8").split("\f")  # fmt: skip
        return [
            _page(np.asarray(Image.open(picture)), text, top, bottom, side)
            for picture, text in zip(pictures, words, strict=False)
        ]


def _page(dots: np.ndarray, text: str, top: float, bottom: float, side: float) -> Page:
    height, width = dots.shape[:2]
    first, last = round(top * _MM), height - round(bottom * _MM)
    left, right = round(side * _MM), width - round(side * _MM)
    inked = (dots < 250).any(axis=2)
    body = inked[first:last]
    rows = np.flatnonzero(body.any(axis=1))
    beside = np.flatnonzero(body.any(axis=0))
    outside = max(left - beside[0], beside[-1] - right + 1, 0) / _MM if beside.size else 0.0
    used, lowest = 0.0, 0.0
    if rows.size:
        edges = np.concatenate(([0], rows, [rows[-1]]))
        steps = np.diff(edges)
        used = float(steps[steps <= _GAP * _MM].sum()) / (last - first)
        lowest = float(rows[-1]) / (last - first)
    captions = tuple(re.findall(r"^\s*(Table \d+) ", text, re.MULTILINE))
    return Page(text, used, lowest, outside, tuple(_parts(dots[first:last], left, right)), captions)


def _parts(body: np.ndarray, left: int, right: int) -> list[Part]:
    """Heads of tables by their colour, and how far down the lines below them go."""
    mist = (np.abs(body.astype(int) - _MIST) <= 3).all(axis=2)
    share = mist[:, left:right].sum(axis=1)
    # the widest run tells a head from a word of the same grey
    found = share > 12 * _MM
    edges = np.flatnonzero(np.diff(np.concatenate(([0], found.astype(int), [0]))))
    heads: list[tuple[int, int]] = []
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        if heads and a - heads[-1][1] < 3 * _MM:
            heads[-1] = (heads[-1][0], b)
        elif b - a > 1.0 * _MM:
            heads.append((int(a), int(b)))
    parts = []
    for k, (a, b) in enumerate(heads):
        end = heads[k + 1][0] if k + 1 < len(heads) else len(body)
        columns = np.flatnonzero(mist[a:b].any(axis=0))
        wide = columns[-1] - columns[0]
        # lines of the rows: as wide as most of the head, of one light grey
        grey = (np.abs(body[b:end, columns[0] : columns[-1] + 1].astype(int) - (0xD8, 0xDE, 0xE6)) <= 26).all(axis=2)  # fmt: skip
        lines = np.flatnonzero(grey.sum(axis=1) > 0.7 * wide)
        bottom = b + (int(lines[-1]) if lines.size else 0)
        parts.append(Part(a / _MM, (b - a) / _MM, (bottom - a) / _MM))
    return parts


def ends_chapter(pages: Sequence[Page], k: int, titles: Sequence[str]) -> bool:
    """Whether a page is the last of a chapter: the next one begins with the heading of another."""
    if k + 1 == len(pages):
        return True
    lines = [" ".join(line.split()) for line in pages[k + 1].text.splitlines() if line.strip()]
    return any(line in titles for line in lines[:3])


def torn(pages: Sequence[Page], height: float) -> list[str]:
    """Tables that are broken over pages although they would fit one. [height of the text, mm]"""
    found = []
    for k, page in enumerate(pages[1:], start=1):
        if len(page.parts) <= len(page.captions) or k < 1:
            continue
        if not pages[k - 1].parts:
            continue
        above, here = pages[k - 1].parts[-1], page.parts[0]
        whole = above.height + here.height - here.head
        if whole + 12.0 <= height and here.top < 15.0:
            name = next((p.captions[-1] for p in reversed(pages[:k]) if p.captions), "?")
            found.append(f"page {k + 1}: {name}, {whole:.0f} mm")
    return found
