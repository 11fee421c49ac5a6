"""What result sheets show besides tables: facts, notes, colours, results of studies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from xlsxwriter.utility import xl_cell_to_rowcol, xl_rowcol_to_cell

from addin.contract import tables as fields
from addin.contract.field import SHAPE_COLUMNS
from addin.contract.live_formulas import CHANGE_NAME
from addin.contract.number_formats import SIGNED
from addin.contract.print_areas import page_columns
from addin.contract.sheets import (
    CYCLE_FACTS,
    CYCLE_FACTS_AT,
    EFFECT_NOTES_AT,
    FACT_LINES,
    part_named,
)
from addin.contract.studies.registry import COLOUR_SCALE, STUDIES, STUDY_SHEETS, printed_parts
from addin.contract.study_spec import StudyScale
from addin.contract.tables import TableSpec
from addin.contract.texts import EFFECT_NOTES
from addin.template.front_sheets import FrontSheets
from addin.xlsx.references import quoted_sheet
from engine.case.effects import EFFECTS

#: Lines of words with letters of 8 pt on paper are so much taller than with the usual ones. [1]
_TALLER = 1.1


class ResultSheets(FrontSheets):
    """Facts, notes and colours."""

    def _frequencies_note(self) -> None:
        part = part_named("Mode shapes")
        self.page(part).write_string(
            part.at("B4"),
            f"Mode shapes of the first {SHAPE_COLUMNS} elastic modes; further modes are in the "
            "JSON results.",
            self.style("note"),
        )

    def _cycle_facts(self) -> None:
        """Data of the governing shaft and the sum over its cycles, above table `StartCycles`."""
        part = part_named("Fatigue")
        page = self.page(part)
        self.style.of(part)
        row, left = xl_cell_to_rowcol(part.at(CYCLE_FACTS_AT))
        page.write_string(
            row, left, "From stress cycles to allowable starts 1 / q", self.style("caption")
        )
        for k, fact in enumerate(CYCLE_FACTS, row + 1):
            page.merge_range(k, left, k, left + 2, fact.label, self.style("key_label"))
            value = self.style("check_value", fact.number_format)
            page.merge_range(k, left + 3, k, left + 4, "", value)
            page.write_formula(k, left + 3, fact.formula, value, "")
            if fact.unit:
                self._unit_of_column(page, k, left + 5, fact.unit)
            else:
                page.write_blank(k, left + 5, None, self.style("key_unit"))
        self.style.usual()

    def _fact_lines(self) -> None:
        """Lines of words that the calculation writes into `RunFacts`."""
        for name, first, last, formula, style, height in FACT_LINES:
            part = part_named(name)
            self.style.of(part)
            shown = self.style(style)
            page = self.page(part)
            page.merge_range(part.at(f"{first}:{last}"), "", shown)
            page.write_formula(part.at(first), formula, shown, "")
            page.set_row(xl_cell_to_rowcol(first)[0], height)
        self.style.usual()

    def _sheet_notes(self) -> None:
        """How to read the effects, and what those on `Case` are."""
        part = part_named("Effects")
        self.style.of(part)
        row, left = xl_cell_to_rowcol(part.at(EFFECT_NOTES_AT))
        for k, text in enumerate(EFFECT_NOTES, row + 1):
            self.page(part).write_string(k, left, text, self.style("note"))
        choices = self.places["EffectChoices"]
        for k, effect in enumerate(EFFECTS.values(), choices.first):
            self.sheets[choices.sheet].write_string(
                k, choices.columns["Choice"] + 1, effect.sentence, self.style("note_beside")
            )
        self.style.usual()

    def _study_lines(self) -> None:
        """On each result sheet of a study what it found, and which inputs it belongs to."""
        for study in STUDIES:
            for part in printed_parts(study):
                page = self.page(part)
                self.style.of(part)
                first, last = part.shift + 1, page_columns(part)[0][1] - 1
                for row, (formula, style, height) in enumerate(study.lines, 3):
                    page.merge_range(row, first, row, last, "", self.style(style))
                    shown = study.not_yet if row == 3 else ""
                    page.write_formula(
                        row, first, self._by_cells(formula), self.style(style), shown
                    )
                    page.set_row(row, _TALLER * height)
            self.style.usual()
            self._colour_verdicts(study.results)
        for study in STUDIES:
            for scale in study.scales:
                self._scale(scale)

    def _scale(self, scale: StudyScale) -> None:
        """Colours of a map: by size, or against the limit in the same row."""
        place = self.places[scale.table]
        judged = self.places[scale.over or scale.table]
        left, right = place.columns[scale.first], place.columns[scale.last]
        area = (place.first, left, place.last, right)
        page = self.sheets[place.sheet]
        cell = xl_rowcol_to_cell(judged.first, judged.columns[scale.first])
        limit = xl_rowcol_to_cell(judged.first, judged.columns[scale.limit], col_abs=True)

        def against(sign: str, style: Any) -> dict[str, Any]:
            rule = f"=AND(ISNUMBER({cell}),{cell}{sign}{limit})"
            return {"type": "formula", "criteria": rule, "format": style}

        if not scale.over:
            page.conditional_format(*area, against("<", self.style("cf_fail")))
            page.conditional_format(*area, against(">=", self.style("cf_pass")))
            return
        pale = self.workbook.add_format({"italic": True, "font_color": "#8A8A8A"})
        page.conditional_format(*area, against("<", pale))
        self._colours(place.sheet, *area)
        good = {"type": "cell", "criteria": "==", "value": '"unlimited"'}
        page.conditional_format(*area, good | {"format": self.style("cf_pass")})
        page.conditional_format(*area, dict(COLOUR_SCALE))

    def _change_cell(self) -> None:
        """The change whose shifts of frequency are shown: typed above table `EnergyShares`."""
        place = self.places["EnergyShares"]
        page, left = self.sheets[place.sheet], place.columns["Quantity"]
        row = place.first - 4
        page.write_string(row, left, "Change", self.style("key_label"))
        page.write_number(row, left + 1, 0.01, self.style("input", "0.0%"))
        words = "of one stiffness or inertia at a time; type your own value"
        page.write_string(row, left + 2, words, self.style("note_beside"))
        cell = xl_rowcol_to_cell(row, left + 1, True, True)
        self.workbook.define_name(CHANGE_NAME, f"='{place.sheet}'!{cell}")
        if self.studies:
            there, place = place.sheet, self.places["FrequencySensitivities"]
            page, left = self.sheets[place.sheet], place.columns["Quantity"]
            self.style.of(
                next(part for part in STUDY_SHEETS if "FrequencySensitivities" in part.tables)
            )
            row = place.first - 4
            page.write_string(row, left, "Change", self.style("note"))
            page.write_formula(row, left + 1, f"={CHANGE_NAME}", self.style("check", "0.0%"), 0.01)
            link = self.style("note_beside")
            page.write_url(
                row, left + 2, f"internal:{quoted_sheet(there)}!{cell}", link,
                f"typed on sheet {there}",
            )  # fmt: skip
            self.style.usual()

    def _verdict_colours(self) -> None:
        """Pass green, accepted amber, fail red, not judged grey, wherever a verdict stands."""
        self._colour_verdicts(fields.RESULT_TABLES)
        self._colours("Summary", 8, 1, 8, 7)
        place = self.places["Effects"]
        column = place.columns["On"]
        for word, style in (("on", "cf_pass"), ("off", "cf_open")):
            self.sheets[place.sheet].conditional_format(
                place.first, column, place.last, column,
                {"type": "cell", "criteria": "==", "value": f'"{word}"',
                 "format": self.style(style)},
            )  # fmt: skip

    def _colour_verdicts(self, specs: Sequence[TableSpec]) -> None:
        """Colours of verdicts; large negative numbers without decimals, as large positive ones."""
        for spec in specs:
            place = self.places[spec.name]
            for field in spec.columns:
                if field.kind == "verdict":
                    at = place.columns[field.name]
                    self._colours(place.sheet, place.first, at, place.last, at)
                elif field.own_format == SIGNED:  # its format knows no second limit
                    at = place.columns[field.name]
                    self.sheets[place.sheet].conditional_format(
                        place.first, at, place.last, at,
                        {"type": "cell", "criteria": "<=", "value": -1000,
                         "format": self.style("cf_whole", "#,##0")},
                    )  # fmt: skip
