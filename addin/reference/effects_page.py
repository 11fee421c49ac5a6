"""The table of effects in docs/effects.md, from the records of the effects."""

from __future__ import annotations

from engine.case.effects import EFFECTS

#: The table stands between these two lines; everything else on the page is written by hand.
BEGIN = "<!-- made from the records of the effects by `make generated` -->"
END = "<!-- end of the table -->"
_HEAD = (
    "| effect | what it is | called for by | deciding number, and when it is on | bound while off |\n"
    "|---|---|---|---|---|\n"
)


def effects_table() -> str:
    """One row an effect, in the order of the sheet."""
    rows = []
    for effect in EFFECTS.values():
        inputs = effect.called_for_by or (effect.inputs.cells if effect.inputs else "–")
        sentence = effect.sentence[0].upper() + effect.sentence[1:]
        rows.append(
            f"| {effect.name} | {sentence} | {inputs} | {effect.number} | {effect.bound} |\n"
        )
    return _HEAD + "".join(rows)


def effects_page(page: str) -> str:
    """The page with its table made anew.

    Parameters
    ----------
    page : str
        Text of docs/effects.md.

    Returns
    -------
    str
        The same text, the table that of the records.

    Raises
    ------
    ValueError
        If one of the two lines around the table is missing.
    """
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ValueError(f"docs/effects.md needs the lines {BEGIN} and {END} around its table")
    return f"{before}{BEGIN}\n\n{effects_table()}\n{END}{after}"
