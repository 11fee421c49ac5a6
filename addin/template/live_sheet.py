"""Sheet `Live`: frequencies, margins and shaft stiffness by worksheet functions, as inputs are typed.

No start is calculated here: two cells check the inputs and make a model of them, array formulas of
fixed size show its modes and margins, and one row per shaft shows its stiffness from geometry. Formulas
are the same in every variant but for the spelling of the functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from xlsxwriter.utility import xl_col_to_name, xl_rowcol_to_cell

from addin.contract import tables as fields
from addin.contract.banner import CHANGED_WORDS, IS_CHANGED
from addin.contract.sheets import Sheet
from addin.contract.tables import Field
from addin.reading.typed_case import CaseInput, Entry, Typed
from addin.template.reference_sheets import ReferenceSheets
from addin.worksheet.functions.model import TABLES
from addin.worksheet.models import MODELS
from addin.worksheet.registry import call
from addin.xlsx.references import quoted_sheet

#: Name of the cell that holds the model shown.
MODEL_NAME = "LiveModel"
#: Rows of the array formulas, headers included.
MODE_ROWS, MARGIN_ROWS = 17, 121
#: Shafts shown.
SHAFTS = 40
#: Cells, counted from 0: the state of the model, frequencies, margins, shafts.
_STATE, _MODES, _MARGINS = 4, 11, 11 + MODE_ROWS + 3
_LEFT, _LEAST, _SHAFT = 1, 9, 10
_ALL_INPUTS, _TRAIN_ONLY, _SHOWN, _STORED = range(_STATE + 1, _STATE + 5)
_VALUE = 2
#: Cells of models, rows and columns counted from 1.
MODEL_CELLS = tuple((row + 1, _VALUE + 1) for row in (_ALL_INPUTS, _TRAIN_ONLY, _SHOWN))
#: Input tables that modes and margins need; a material is named by an element.
_OF_TRAIN = ("Stations", "Elements", "Case", "Meshes", "ModeDamping", "Materials", "Excitations")
#: Where a cell shows only a mark, as custom functions do.
_SEE_ERROR = "Errors: select the cell at the left; the warning mark shows the message."
#: Dimensions of the columns of the block of shafts.
_GEOMETRY = (
    ("OD", "length"), ("ID", "length"), ("Length", "length"), ("Shear modulus", "pressure"),
)  # fmt: skip

LIVE_SHEET = Sheet(
    "Live",
    "live",
    {"A": 1.5, "B": 25, "C": 27, "D": 11, "E": 12, "F": 11, "G": 24, "H": 24, "I": 20, "J": 12,
     "K": 27, "L:N": 12, "O:Q": 15},
    {},
    freeze="A4",
    intro="Modes, margins and shaft stiffness of the present inputs, without a start. For "
    "other results, use functions of LiveModel, such as TV_STARTS, in your own cells.",
)  # fmt: skip


@dataclass(frozen=True)
class LiveAnswers:
    """What the functions say of the shipped inputs, so that a file opens with its numbers."""

    handle: str = ""  #: The model; empty while the inputs have errors, and all else with it.
    modes: Sequence[Sequence[Any]] = ()  #: Cells of the two array formulas. [shown units]
    margins: Sequence[Sequence[Any]] = ()  #: Likewise. [shown units]
    #: Element, geometry, stiffness from geometry and as typed, one row per shaft. [shown units]
    shafts: Sequence[Sequence[Any]] = ()


NO_ANSWERS = LiveAnswers()


def live_answers(read: CaseInput, system: str) -> LiveAnswers:
    """Ask the functions what the sheet will show.

    Parameters
    ----------
    read : CaseInput
        The inputs of a workbook. [SI]
    system : str
        ``us`` or ``si``, of the block of shafts. [word]

    Returns
    -------
    LiveAnswers
        None of them while the inputs have errors.
    """
    if read.problems:
        return NO_ANSWERS
    handle = MODELS.add(read).handle
    shafts = []
    for row in read.typed.tables["Elements"][:SHAFTS]:
        geometry = [_converted(row.get(name), dimension, system) for name, dimension in _GEOMETRY]
        outer, _, length, modulus = geometry
        whole = None not in (outer, length, modulus)
        shafts.append(
            [
                row.get("Element"),
                *geometry,
                call("TV_STIFFNESS", [*geometry, system.upper()])[0][0] if whole else None,
                _converted(row.get("Stiffness"), "torsional stiffness", system),
            ]
        )
    return LiveAnswers(
        handle,
        call("TV_FREQUENCIES", [handle, None, True, MODE_ROWS]),
        call("TV_MARGINS", [handle, None, True, MARGIN_ROWS]),
        shafts,
    )


def _unit(dimension: str, system: str) -> str:
    known = fields.DIMENSIONS[dimension]
    return known.unit_us if system == "us" else known.unit_si


def _converted(entry: Entry | None, dimension: str, system: str) -> Any:
    """An input in the unit of the block of shafts."""
    if not isinstance(entry, Typed):
        return None
    return call("TV_CONVERT", [entry.number, entry.unit, _unit(dimension, system)])[0][0]


#: Cells with verdicts: first row and column, last row and column.
_VERDICTS = (
    (_MODES + 1, _LEAST + 2, _MODES + MODE_ROWS - 1, _LEAST + 2),
    (_MARGINS + 1, _LEFT + 6, _MARGINS + MARGIN_ROWS - 1, _LEFT + 6),
)


class LiveSheets(ReferenceSheets):
    """Sheets with `Live` among them, in variants that have functions."""

    def _live(self, answers: LiveAnswers) -> None:
        """All of sheet `Live`."""
        self._answers = answers
        self._page = self.sheets[LIVE_SHEET.name]
        self._state()
        self._modes()
        self._margins()
        self._shafts()
        for area in _VERDICTS:
            self._colours(LIVE_SHEET.name, *area)

    def _spelled(self, function: str) -> str:
        assert self.variant.spelled is not None, f"{self.variant.name} has no functions"
        return self.variant.spelled(function)

    def _write_array(self, *cells_formula_style_value: Any) -> None:
        page = self._page
        write = (
            page.write_dynamic_array_formula if self.variant.dynamic else page.write_array_formula
        )
        write(*cells_formula_style_value)

    # ---- the model -------------------------------------------------------------------------------

    def _state(self) -> None:
        """Whether the inputs are right, which model is shown, and whether the results are its own.

        Functions stand in cells of their own, since arrays are refused in merged ones; the words
        beside them may be long.
        """
        shown = self._answers.handle
        self._page.write_string(_STATE, _LEFT, "Model", self.style("caption"))
        every, train, model = (self._cell(row) for row in (_ALL_INPUTS, _TRAIN_ONLY, _SHOWN))
        good = {cell: f'IFERROR(LEFT({cell},3)="tv:",FALSE)' for cell in (every, train)}
        text = f'IF(ISERROR({{0}}),"{_SEE_ERROR}",{{0}}&"")'
        rows = (
            (
                _ALL_INPUTS, "All inputs", self._model(None), shown,
                f'=IF({good[every]},"No errors.",{text.format(every)})',
                "No errors." if shown else "", 42.0,
            ),
            (
                _TRAIN_ONLY, "Train, speeds, excitations",
                f'=IF({good[every]},"",{self._model(_OF_TRAIN)[1:]})', "",
                f'=IF({good[every]},"",IF({good[train]},"No errors.",{text.format(train)}))', "",
                42.0,
            ),
            (
                _SHOWN, "Model shown below",
                f'=IF({good[every]},{every},IF({good[train]},{train},""))', shown,
                f'=IF({model}="","No model yet.",IF({good[every]},"All inputs.",'
                '"Train, speeds and excitations only: the other inputs have errors."))',
                "All inputs." if shown else "No model yet.", 15.0,
            ),
            (
                _STORED, "Results on the other sheets", "", "",
                f'=IF(run_SHA256="","Not calculated yet.",IF({IS_CHANGED},"{CHANGED_WORDS}",IF({good[every]},'
                f'IF(MID({every},4,16)=LEFT(run_SHA256,16),"Results belong to the present inputs.",'
                f'"{CHANGED_WORDS}"),"The inputs have errors.")))',
                "Not calculated yet.", 15.0,
            ),
        )  # fmt: skip
        style, wrapped = self.style("result_text"), self.style("result_wrap")
        for row, label, formula, value, sentence, shown_sentence, height in rows:
            self._page.write_string(row, _LEFT, label, self.style("label"))
            if formula:
                self._formula(row, _VALUE, formula, style, value)
            else:
                self._page.write_blank(row, _VALUE, None, style)
            self._page.merge_range(row, _VALUE + 1, row, _LEAST + 2, "", wrapped)
            self._page.write_formula(
                row, _VALUE + 1, self._by_cells(sentence), wrapped, shown_sentence
            )
            self._page.set_row(row, height)
        self.workbook.define_name(MODEL_NAME, f"=Live!{model}")

    def _cell(self, row: int, column: int = _VALUE) -> str:
        return str(xl_rowcol_to_cell(row, column, True, True))

    def _model(self, tables: Sequence[str] | None) -> str:
        """``=TV_MODEL(...)`` of some input tables, or of all."""

        names = ("Stations", "Elements", "Case", *TABLES[2:])
        blocks = [self._block(n) if tables is None or n in tables else "" for n in names]
        while not blocks[-1]:
            blocks.pop()
        return f"={self._spelled('TV_MODEL')}({','.join(blocks)})"

    def _block(self, name: str) -> str:
        """A table with its headers and the row of units; it grows with the table."""
        if name == "Case":
            rows, columns = zip(*self.scalar_cells, strict=True)
            first, last = self._cell(min(rows), min(columns)), self._cell(max(rows), max(columns))
            return f"{fields.SCALAR_SHEET}!{first}:{last}"
        spec, place = fields.input_table(name), self.places[name]
        top = place.first - (2 if any(field.has_unit for field in spec.columns) else 1)
        corner = xl_rowcol_to_cell(top, min(place.columns.values()), True, True)
        # LibreOffice does not know [#All], so the data alone; the corner takes in what is above.
        whole = f"{name}[]"
        return f"{quoted_sheet(place.sheet)}!{corner}:INDEX({whole},ROWS({whole}),COLUMNS({whole}))"

    # ---- modes and margins -----------------------------------------------------------------------

    def _modes(self) -> None:
        spec = fields.result_table("NaturalFrequencies")
        self._worded_caption(
            self._page,
            _MODES - 1,
            _LEFT,
            "Natural frequencies",
            "and the least margin of each mode",
        )
        values = self._answers.modes
        self._array(_MODES, MODE_ROWS, "TV_FREQUENCIES", spec.columns, values)
        for k, words in enumerate(("Least margin [%]", "From", "Verdict")):
            self._page.write_string(_MODES, _LEAST + k, words, self.style("header_check"))
        for row in range(_MODES + 1, _MODES + MODE_ROWS):
            self._least(row, values[row - _MODES][0] if values else None)

    def _least(self, row: int, mode: Any) -> None:
        """The margin of one mode that is smallest, from which excitation, and what it means."""
        first, last = _MARGINS + 1, _MARGINS + MARGIN_ROWS - 1
        modes, names, margins, verdicts = (
            f"{self._cell(first, _LEFT + k)}:{self._cell(last, _LEFT + k)}" for k in (0, 1, 4, 6)
        )
        this = f"${xl_col_to_name(_LEFT)}{row + 1}"
        least = f"${xl_col_to_name(_LEAST)}{row + 1}"
        # the last row holds a text where margins were left out
        left_out = f"ISTEXT({self._cell(last, _LEFT)})*LEN({self._cell(last, _LEFT)})"
        judged = f'IF(ISNUMBER({this}),IF(COUNTIF({modes},{this})>0,{{}},""),"")'
        at = f"MATCH(1,({modes}={this})*({margins}={least}),0)"
        found = self._least_of(mode)
        formulas = (
            (
                judged.format(f'IF({left_out}>0,"see Margins",MIN(IF({modes}={this},{margins})))'),
                self.style("check", "0.00"),
            ),
            (f'IF(ISNUMBER({least}),INDEX({names},{at}),"")', self.style("result_text")),
            (f'IF(ISNUMBER({least}),INDEX({verdicts},{at}),"")', self.style("verdict")),
        )
        for k, ((formula, style), value) in enumerate(zip(formulas, found, strict=True)):
            at_column = _LEAST + k
            self._write_array(row, at_column, row, at_column, f"={formula}", style, value)

    def _least_of(self, mode: Any) -> tuple[Any, Any, Any]:
        rows = [row for row in self._answers.margins[1:] if row[0] == mode]
        if mode is None or not rows:
            return "", "", ""
        worst = min(rows, key=lambda row: row[4])
        return worst[4], worst[1], worst[6]

    def _margins(self) -> None:
        spec = fields.result_table("SeparationMargins")
        self._worded_caption(
            self._page, _MARGINS - 1, _LEFT, "Separation margins", "of every mode and excitation"
        )
        self._array(_MARGINS, MARGIN_ROWS, "TV_MARGINS", spec.columns, self._answers.margins)

    def _array(
        self,
        top: int,
        rows: int,
        function: str,
        columns: Sequence[Field],
        values: Sequence[Sequence[Any]],
    ) -> None:
        """A table of a function, header included, as one array formula."""
        text = f'=IF({MODEL_NAME}="","",{self._spelled(function)}({MODEL_NAME},"",TRUE,{rows}))'
        header = self.style("header_result")
        last = top + rows - 1, _LEFT + len(columns) - 1
        first = values[0][0] if values else ""
        self._write_array(top, _LEFT, *last, text, header, first)
        self._page.set_row(top, 30)
        for i in range(rows):
            for j, field in enumerate(columns):
                if i or j:
                    style = header if i == 0 else self._column_style(field)
                    value = values[i][j] if values else None
                    self._put(self._page, top + i, _LEFT + j, value, style)

    def _column_style(self, field: Field) -> Any:
        if field.name == "Verdict":
            return self.style("verdict")
        if field.kind == "integer":
            return self.style("result_center")
        if field.is_number:
            return self.style("result", field.format)
        return self.style("result_text")

    # ---- shafts ----------------------------------------------------------------------------------

    def _shafts(self) -> None:
        """Stiffness from geometry beside the stiffness typed, one row per element of sheet Train."""
        self._worded_caption(
            self._page,
            _MARGINS - 1,
            _SHAFT,
            "Shaft stiffness",
            "from geometry, compared with the stiffness typed",
        )
        stiffness = _unit("torsional stiffness", self.system)
        headers = (
            "Element",
            *(f"{name} [{_unit(dimension, self.system)}]" for name, dimension in _GEOMETRY),
            f"From geometry [{stiffness}]",
            f"Typed [{stiffness}]",
        )
        for k, words in enumerate(headers):
            style = "header_check" if 0 < k < len(headers) - 1 else "header_result"
            self._page.write_string(_MARGINS, _SHAFT + k, words, self.style(style))
        shafts = self._answers.shafts
        for k in range(SHAFTS):
            self._shaft(k, shafts[k] if k < len(shafts) else [""] * len(headers))

    def _shaft(self, k: int, values: Sequence[Any]) -> None:
        row = _MARGINS + 1 + k
        cells = [f"${xl_col_to_name(_SHAFT + j)}{row + 1}" for j in range(len(_GEOMETRY) + 1)]
        large = fields.DIMENSIONS["torsional stiffness"].format
        formulas: list[tuple[str, Any]] = [
            (self._typed("Element", k, '{0}&""'), self.style("result_text"))
        ]
        formulas += [
            (self._in_unit(column, dimension, k), self.style("check", "General"))
            for column, dimension in _GEOMETRY
        ]
        _, outer, bore, length, modulus = cells
        formulas += [
            (
                f'=IF(OR({outer}="",{length}="",{modulus}=""),"",{self._spelled("TV_STIFFNESS")}'
                f'({outer},{bore},{length},{modulus},"{self.system.upper()}"))',
                self.style("check", large),
            ),
            (self._in_unit("Stiffness", "torsional stiffness", k), self.style("result", large)),
        ]
        for j, ((formula, style), value) in enumerate(zip(formulas, values, strict=True)):
            self._formula(row, _SHAFT + j, formula, style, "" if value is None else value)

    def _typed(self, column: str, k: int, shown: str) -> str:
        """Something made of a cell of table Elements; blank below its end."""
        cell = f"INDEX(Elements[{column}],{k + 1})"
        return f'=IF(ROWS(Elements[{column}])<{k + 1},"",{shown.format(cell)})'

    def _in_unit(self, column: str, dimension: str, k: int) -> str:
        """A cell of table Elements in the unit of this block; blank stays blank."""
        place = self.places["Elements"]
        unit = xl_rowcol_to_cell(place.first - 2, place.columns[column], True, True)
        convert = (
            f'IF({{0}}="","",{self._spelled("TV_CONVERT")}({{0}},{quoted_sheet(place.sheet)}!{unit},'
            f'"{_unit(dimension, self.system)}"))'
        )
        return self._typed(column, k, convert)

    # ---- cells -----------------------------------------------------------------------------------

    def _formula(self, row: int, column: int, formula: str, style: Any, value: Any) -> None:
        """A formula of one cell; a dynamic one where Excel would else cut the answer to one cell."""
        if self.variant.dynamic and self._spelled("TV_") in formula:
            self._write_array(row, column, row, column, formula, style, value)
        else:
            self._page.write_formula(row, column, formula, style, value)
