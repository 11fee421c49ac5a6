"""Digests as people see them: the first digits, which tell inputs apart."""

#: Digits of the short form; a stamp on a sheet holds as many.
DIGITS = 12


def short_digest(digest: str) -> str:
    """The short form of a digest in a sentence."""
    return f"{digest[:DIGITS]}…"
