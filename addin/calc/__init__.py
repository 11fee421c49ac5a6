"""Kept for installed LibreOffice extensions, which start `python -m addin.calc.worker`.

========  ========================================================================================
module    responsibility
========  ========================================================================================
`worker`  the name under which extensions of version 0.1.0 start `addin.libreoffice.worker`
========  ========================================================================================
"""
