"""What the worksheet functions are called inside LibreOffice.

In a cell they have the names of the contract. Files of type .ods, and .xlsx that LibreOffice reads,
hold the programmatic name: that of the component and of the method, in capitals.
"""

from __future__ import annotations

import re

#: Modules of the interface, from the outside in.
METHOD_MODULES = ("org", "torsionbook", "calc")
#: Name of the interface with one method a function.
INTERFACE = "XFunctions"
#: Name of the component; LibreOffice calls it the service and the implementation.
COMPONENT = "org.torsionbook.calc.Functions"


def identifier(text: str) -> str:
    """A name that UNO takes for a parameter: a small letter, then letters and digits."""
    first, *others = re.findall("[A-Za-z0-9]+", text)
    return first.lower() + "".join(word[0].upper() + word[1:] for word in others)


def method_name(function: str) -> str:
    """The method of a function."""
    return function.lower()


def parameter_names(arguments: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the parameters of a method."""
    parameters = tuple(identifier(name) for name in arguments)
    assert len(set(parameters)) == len(parameters), parameters
    return parameters


def programmatic_name(function: str) -> str:
    """How a file names a function."""
    return f"{COMPONENT}.{method_name(function)}".upper()
