"""Number formats of results on sheets, each by what it shows."""

from __future__ import annotations

#: What may be negative: LibreOffice drops the sign of a negative number in any section but the
#: first, and in that one shows it of itself.
SIGNED = "[<1000]#,##0.00;#,##0"
LARGE = "[>=1000]#,##0;[<=-1000]-#,##0;0.000"
SMALL = "[>=0.01]0.00;[>0]0.00000;0.00"
#: Errors of a study span many decades.
STUDIED = "[>=0.01]0.000;[>=0.000001]0.000000;0.0E+00"
ERROR = "[>=0.01]0.00;[>0]0.00000;0"
ONE_DECIMAL = "0.0"
TWO_DECIMALS = "0.00"
FOUR_DECIMALS = "0.0000"
#: A thousand million starts and more are shown by their power of ten.
WHOLE = "[<1000000000]#,##0;0.00E+00"
STARTS = "[<1000000000]#,##0.0;0.00E+00"
DAMAGE = "0.000E+00"
USED = "[>=0.001]0.0000;[>0]0.00E+00;0"
YEARS = "[>=100]#,##0;0.0"
CHANGE = "+0.00;-0.00;0.00"
SHIFT = "+0.000;-0.000;0.000"
APPROACH = "[>=0.01]0.000;[>0]0.00000;0"
AS_TYPED = "General"
#: Three digits of what is nearly nothing, too: it tells a wrong unit.
TELLING = "[>=1]0.00;[>=0.1]0.000;0.00E+00"
TELLING_LARGE = "[>=100]#,##0;[>=1]0.00;0.00E+00"
TELLING_SMALL = "[>=0.1]0.000;[>0]0.00E+00;0.000"
TELLING_RATIO = "[>=0.1]0.0000;0.00E+00"
TELLING_SHARE = "[>=1]0.0;[>0]0.00E+00;0.0"
