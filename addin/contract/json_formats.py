"""Numbers of the forms of JSON: raised when a reader of the form before would go wrong."""

from __future__ import annotations

CASE_FORMAT = 1  #: Of a case.
RESULTS_FORMAT = 1  #: Of results, of a calculation or a study.
AUDIT_FORMAT = 1  #: Of `verify` and `diff`.
