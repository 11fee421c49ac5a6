"""The maps of a tuning study as rows of its sheets, and the numbers behind its charts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from addin.contract.studies.tuning import LINES, MAP_MODES, MAP_ROWS, NO_VARIABLE
from engine.operation.margins import Band
from engine.studies.tuning.evaluate import EvaluatedCombination
from engine.studies.tuning.options import Variable
from engine.studies.tuning.tuning import TuningResult

Row = dict[str, Any]

#: Strokes across a band. [count]
_STROKES = 60
#: Modes up to this multiple of the highest frequency of a start are drawn. [1]
_REACH = 1.3
#: Half the width of the hatching where there is one value only. [1]
_ALONE = 0.1


def map_tables(result: TuningResult) -> Mapping[str, Sequence[Row]]:
    """Rows of the maps and charts.

    Parameters
    ----------
    result : TuningResult
        The study. [SI]

    Returns
    -------
    mapping of str to list of dict
        Result tables that the workbook alone has. [SI]
    """
    across, up = result.map.across, result.map.up
    shown = spread_out(len(across.options), MAP_ROWS)
    lines = spread_out(1 if up is None else len(up.options), LINES)
    cells = [[result.map.cells[j][i] for j in lines] for i in shown]
    base = across.present or max((o.value for o in across.options), default=0.0) or 1.0
    options: list[Row] = [
        {"option": across.options[i].label, "of_as_is": across.options[i].value / base}
        for i in shown
    ]
    best = [_best(result, i) for i in shown]
    margins = [
        option
        | {f"line_{k}": None if t is None or t.answers is None else t.answers.worst_margin
           for k, t in enumerate(row, 1)}
        | {"required": result.required_margin}
        for option, row in zip(options, cells, strict=True)
    ]  # fmt: skip
    modes = [option | _modes(result, t) for option, t in zip(options, best, strict=True)]
    return {
        "TuningAxes": [_axes(across, up, lines, len(shown), result.map.best_over)],
        "TuningStarts": _starts(options, cells, in_words=True),
        "TuningMargins": margins,
        "TuningModes": modes,
        "TuningLines": _starts(options, cells, in_words=False),
        "TuningHatch": _hatch(result.bands, modes),
    }


def spread_out(count: int, room: int) -> list[int]:
    """So many of some options, both ends among them."""
    if count <= room:
        return list(range(count))
    return [round(k * (count - 1) / (room - 1)) for k in range(room)]


def _axes(
    across: Variable, up: Variable | None, lines: list[int], shown: int, others: Sequence[str]
) -> Row:
    """What rows and columns of the maps stand for."""
    row: Row = {
        "first_variable": f"{across.title}, % of the unchanged case",
        "second_variable": NO_VARIABLE if up is None else up.title,
    }
    if shown < len(across.options):
        row["first_variable"] += f" ({shown} of {len(across.options)} values shown)"
    if up is not None and len(lines) < len(up.options):
        row["second_variable"] += f" ({len(lines)} of {len(up.options)} values shown)"
    if others:
        row["second_variable"] += (
            f"; for each pair of values with the best choice of {', '.join(others)}"
        )
    names = ["all" if up is None else up.options[j].label for j in lines]
    return row | {f"line_{k}": name for k, name in enumerate([*names, *["–"] * LINES][:LINES], 1)}


def _starts(
    options: list[Row], cells: list[list[EvaluatedCombination | None]], *, in_words: bool
) -> list[Row]:
    return [
        option
        | {f"line_{k}": _cell(t, in_words) for k, t in enumerate(row, 1)}
        | {"dimension": "count"}
        for option, row in zip(options, cells, strict=True)
    ]


def _cell(tried: EvaluatedCombination | None, in_words: bool) -> float | str | None:
    """Starts of one combination; a chart can draw no words."""
    if tried is None:
        return None
    a = tried.answers
    if a is not None and a.starts is not None:
        return a.starts
    if not in_words:
        return None
    if a is None:
        return "impossible"
    return "unlimited" if a.unlimited else "not judged"


def _best(result: TuningResult, option: int) -> EvaluatedCombination | None:
    """The best combination with an option of the first variable."""
    return next(
        (r.tried for r in result.rows
         if r.tried.combination.picked and r.tried.combination.picked[0] == option),
        None,
    )  # fmt: skip


def _modes(result: TuningResult, tried: EvaluatedCombination | None) -> Row:
    """Modes that a start crosses, or that come near: higher ones would flatten the chart."""
    a = None if tried is None else tried.answers
    if a is None:
        return {}
    crossed = [c.frequency for c in a.crossings]
    least = a.modes[:3]
    reach = _REACH * max([*crossed, *(f for f in least if not crossed)], default=0.0)
    row: Row = {f"mode_{k}": f for k, f in enumerate(a.modes[:MAP_MODES], 1) if f <= reach}
    row |= {"allowable_starts": a.starts, "worst_margin": a.worst_margin}
    return row | ({"unlimited": a.unlimited} if a.unlimited or a.starts is not None else {})


def _hatch(bands: Sequence[Band], modes: Sequence[Row]) -> list[Row]:
    """One line up and down through each band that modes come near; a blank row ends a band."""
    shares = [row["of_as_is"] for row in modes]
    low, high = min(shares), max(shares)
    if low == high:
        low, high = low - _ALONE, high + _ALONE
    found = [f for row in modes for k in range(1, MAP_MODES + 1) if (f := row.get(f"mode_{k}"))]
    top = _REACH * max(found, default=0.0)
    rows: list[Row] = []
    for band in bands:
        if band.from_ >= top:
            continue
        ends = (band.from_, min(band.to, top))
        for stroke in range(_STROKES + 1):
            at = low + (high - low) * stroke / _STROKES
            pair = ends if stroke % 2 == 0 else ends[::-1]
            rows += [{"of_as_is": at, "frequency": f} for f in pair]
        rows += [{"of_as_is": high, "frequency": ends[0]}, {"of_as_is": low, "frequency": ends[0]}]
        rows += [{"of_as_is": low, "frequency": ends[1]}, {"of_as_is": high, "frequency": ends[1]}]
        rows.append({})
    return rows or [{}]
