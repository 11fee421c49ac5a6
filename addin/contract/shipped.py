"""Where the shipped workbooks are: `templates/` in a checkout, inside the package in a wheel."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_PLACES = (_PACKAGE / "_templates", _PACKAGE.parent / "templates")


def template_folder() -> Path:
    """The folder of the shipped workbooks.

    Raises
    ------
    FileNotFoundError
        When neither is there; the sentence names both.
    """
    for folder in _PLACES:
        if folder.is_dir():
            return folder
    raise FileNotFoundError(
        "The shipped workbooks are missing: neither "
        + " nor ".join(str(folder) for folder in _PLACES)
        + " is there. Install torsionbook again."
    )


def template_path(name: str) -> Path:
    """The path of one shipped workbook.

    Raises
    ------
    FileNotFoundError
        When there is no such workbook; the sentence lists those there are.
    """
    folder = template_folder()
    path = folder / name
    if not path.is_file():
        there = ", ".join(sorted(p.name for p in folder.glob("*.xlsx"))) or "none"
        raise FileNotFoundError(f"There is no shipped workbook {name!r}; there are: {there}.")
    return path
