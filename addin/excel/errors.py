"""What can go wrong on the way into Excel.

::

    ExcelError                   anything that is reported to a person, in a sentence
    ├── CompoundFileError        the container of a VBA project is damaged or of an unknown kind
    ├── VbaCompressionError      compressed VBA source is damaged, or data that cannot be stored
    ├── VbaProjectError          the VBA project is damaged, or holds what may not be replaced
    └── XlwingsMissing           xlwings is not installed, or in another version than the pinned one
"""


class ExcelError(Exception):
    """Base of what a person can act on."""


class CompoundFileError(ExcelError):
    """A compound file (MS-CFB) that cannot be read."""


class VbaCompressionError(ExcelError):
    """Compressed VBA source (MS-OVBA 2.4.1) that cannot be read or made."""


class VbaProjectError(ExcelError):
    """A VBA project (MS-OVBA 2.3) that cannot be read or changed."""


class XlwingsMissing(ExcelError):
    """No xlwings, or not the version that this version of torsionbook is made for."""
