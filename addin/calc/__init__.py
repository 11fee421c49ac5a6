"""Kept for installed LibreOffice extensions, which start `python -m addin.calc.worker`; see `addin.libreoffice`."""
