"""The picture of docs/report.md: pages of the report of the example `backlash`.

Run as `python -m benchmarks.report_pages`; needs the extra `report` and poppler's pdftoppm.
"""

from __future__ import annotations

import io
import subprocess
import tempfile
from pathlib import Path

from PIL import Image

from addin.contract.shipped import template_path
from addin.report.make import report

PAGES = (1, 3, 12, 16, 18, 22)
PICTURE = Path(__file__).resolve().parents[1] / "docs" / "images" / "report.png"


def main() -> None:
    """Make the report, take some pages, put them side by side."""
    with tempfile.TemporaryDirectory() as folder:
        pdf = Path(folder) / "report.pdf"
        report(template_path("example_backlash.xlsx"), pdf=pdf)
        pages = [page_of(pdf, number) for number in PAGES]
    width, height = pages[0].size
    sheet = Image.new("RGB", (3 * width + 40, 2 * height + 30), "#9A9A9A")
    for k, page in enumerate(pages):
        sheet.paste(page, (10 + (k % 3) * (width + 10), 10 + (k // 3) * (height + 10)))
    sheet.quantize(128).save(PICTURE, optimize=True)
    print(f"{PICTURE}: {PICTURE.stat().st_size / 1e3:.0f} kB")


def page_of(pdf: Path, number: int) -> Image.Image:
    """One page as a picture."""
    made = subprocess.run(
        ["pdftoppm", "-r", "56", "-png", "-f", str(number), "-l", str(number), str(pdf)],
        check=True,
        capture_output=True,
    )
    return Image.open(io.BytesIO(made.stdout)).convert("RGB")


if __name__ == "__main__":
    main()
