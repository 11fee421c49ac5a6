"""Six steels that rotors are made of: strengths that a row of `Materials` may leave to their name.

Strengths are the least that the source demands, in the size that it is given for; a shaft of another size needs its own.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Strengths of American tables. [Pa]
KSI = 6894757.293168361


@dataclass(frozen=True)
class Steel:
    """A steel in one condition and size."""

    name: str  #: As typed in column Material.
    uts: float  #: Ultimate tensile strength. [Pa]
    yield_: float  #: Yield strength, or 0.2 % proof stress. [Pa]
    source: str  #: Where the two come from, and for which size.


_EN = "as steelmakers' data sheets quote it; the standard itself was not read"
_ASTM = "Table 1, 2004 edition, as reproduced on the web"
STEELS: tuple[Steel, ...] = (
    Steel(
        "AISI 1045 hot rolled", 570e6, 300e6,
        "lower ends of the typical range, hot rolled or forged, data sheet of Tata Steel New Zealand",
    ),
    Steel("C45 +N", 560e6, 275e6, f"EN 10083-2, normalised, over 100 to 250 mm, {_EN}"),
    Steel(
        "AISI 4140 class BC", 110 * KSI, 85 * KSI, f"ASTM A434 class BC, over 4 to 7 in, {_ASTM}"
    ),
    Steel(
        "AISI 4340 class BD", 135 * KSI, 105 * KSI, f"ASTM A434 class BD, over 4 to 7 in, {_ASTM}"
    ),
    Steel("42CrMo4 +QT 160", 800e6, 550e6, f"EN 10083-3, over 100 to 160 mm, {_EN}"),
    Steel("42CrMo4 +QT 250", 750e6, 500e6, f"EN 10083-3, over 160 to 250 mm, {_EN}"),
)  # fmt: skip
#: Shear modulus and density of all six: carbon and low-alloy steels differ less than their data do.
SHEAR_MODULUS, DENSITY = 79.3e9, 7850.0  # [Pa], [kg/m³]


def _key(name: str) -> str:
    return "".join(name.casefold().split())


_BY_NAME = {_key(steel.name): steel for steel in STEELS}


def steel_named(name: str | None) -> Steel | None:
    """The steel of that name, whatever its capitals and blanks.

    Parameters
    ----------
    name : str or None
        As typed.

    Returns
    -------
    Steel or None
        None where the library has no such steel. [Pa]
    """
    return _BY_NAME.get(_key(name)) if name else None
