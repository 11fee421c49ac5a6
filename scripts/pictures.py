"""Make the pictures of the product in docs/images: `python scripts/pictures.py` (needs LibreOffice and poppler).

The examples are calculated, printed and reported here; no picture is cut by hand.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageChops

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
TORSIONBOOK = Path(sys.executable).with_name("torsionbook")
#: Colours kept: the pages have few, and the files stay small. [count]
COLOURS = 64
#: Headings of the pages shown of a report; pages are found by their words.
REPORT_PAGES = (
    "Prepared by", "1 Summary", "1.4 Conclusions", "5 Interference", "7.4 Histories", "10 Sheet to the makers",
)  # fmt: skip


def _page(pdf: Path, number: int, dpi: int) -> Image.Image:
    """One page of a PDF, counted from 1."""
    stem = pdf.with_name(f"{pdf.stem}-{number}-{dpi}")
    page = ["-f", str(number), "-l", str(number), "-r", str(dpi), "-singlefile", "-png"]
    subprocess.run(["pdftoppm", *page, str(pdf), str(stem)], check=True, stderr=subprocess.DEVNULL)
    return Image.open(f"{stem}.png").convert("RGB")


def _words(pdf: Path) -> list[str]:
    """The words of each page, with single blanks."""
    text = subprocess.run(
        ["pdftotext", "-layout", str(pdf), "-"], check=True, capture_output=True, text=True
    ).stdout
    return [" ".join(page.split()) for page in text.split("\f")]


def _trimmed(image: Image.Image, bottom: float = 1.0, edge: int = 12) -> Image.Image:
    """Without its white margin, nor what stands below so great a share of its height."""
    image = image.crop((0, 0, image.width, round(bottom * image.height)))
    box = ImageChops.difference(image, Image.new("RGB", image.size, "white")).getbbox()
    assert box is not None, "an empty page"
    left, top, right, end = box
    return image.crop((left - edge, top - edge, right + edge, end + edge))


def _side_by_side(pages: list[Image.Image], columns: int, gap: int = 12) -> Image.Image:
    """Pages in rows on grey."""
    width, height = pages[0].width + gap, pages[0].height + gap
    rows = -(-len(pages) // columns)
    sheet = Image.new("RGB", (columns * width + gap, rows * height + gap), "#d9dde2")
    for k, page in enumerate(pages):
        sheet.paste(page, (gap + k % columns * width, gap + k // columns * height))
    return sheet


def _calculated(folder: Path, example: str) -> Path:
    """The printed pages of a calculated example."""
    book = folder / f"{example}.xlsx"
    for words in (["new", book, "--example", example], ["recalc", book, "--in-place"]):
        subprocess.run(
            [TORSIONBOOK, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
    convert = ["soffice", "--headless", "--convert-to", "pdf", "--outdir", folder, book]
    subprocess.run(convert, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return book.with_suffix(".pdf")


def _report(folder: Path, example: str) -> Path:
    pdf = folder / "report.pdf"
    book = folder / f"{example}.xlsx"
    subprocess.run(
        [TORSIONBOOK, "report", book, "--pdf", pdf], check=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    return pdf


def _numbers(words: list[str]) -> list[int]:
    """Pages of a report that have the headings; the contents, on page 2, have them all."""
    found = []
    for heading in REPORT_PAGES:
        pages = [k for k, page in enumerate(words, 1) if heading in page and k != 2]
        if not pages:
            raise SystemExit(f"The report has no page with '{heading}'. Change REPORT_PAGES.")
        found.append(pages[0])
    return found


def main() -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        proposed, motor = _calculated(folder, "proposed"), _calculated(folder, "motor")
        report = _report(folder, "proposed")
        sections = 1 + next(
            k for k, page in enumerate(_words(motor)) if page.startswith("Sections ")
        )
        pages = [_page(report, number, 60) for number in _numbers(_words(report))]
        pictures = {
            "summary": _trimmed(_page(proposed, 1, 110), 0.94),
            "sections": _trimmed(_page(motor, sections, 110), 0.94),
            "report": _side_by_side(pages, 3),
        }
    for name, picture in pictures.items():
        few = picture.quantize(COLOURS, dither=Image.Dither.NONE)
        few.save(IMAGES / f"{name}.png", optimize=True)
        print(f"docs/images/{name}.png")


if __name__ == "__main__":
    main()
