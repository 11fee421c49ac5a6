"""Which formula cells depend on changed cells.

The graph is conservative: it may name a formula too many, never one too few.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left, insort
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

from addin.xlsx.formula_text import (
    NameReference,
    Reference,
    Span,
    TableReference,
    parse_formula,
    shifted_range,
)
from addin.xlsx.plain_formulas import Home, PlainFormulas
from addin.xlsx.references import MAX_COLUMN, MAX_ROW, Rect, parse_range, split_sheet
from addin.xlsx.tables import Table
from addin.xlsx.workbook_part import DefinedName

_MOST_NAME_STEPS = 1_000
# Formulas that read each other's columns may have steps like the square of their number.
_MOST_STEPS = 2_000_000
_LANGUAGE_WORDS = frozenset(["TRUE", "FALSE"])
# What is kept of earlier workbooks: maps of so many, none of them larger, and of each what so many sets of changes reach.
_MOST_MAPS = 16
_MOST_FORMULAS_KEPT = 20_000
_MOST_CHANGES_KEPT = 8


#: A cell: sheet, row and column.
Place = tuple[str, int, int]


class FormulaCell(NamedTuple):
    """A formula of the workbook."""

    sheet: str  #: Its sheet.
    #: The cells that show its result; more than one for array formulas, everything below and right
    #: of the first for formulas that spill.
    rect: Rect
    #: The formula as written in its master cell, of a data table what it reads; empty when that
    #: cannot be told.
    text: str
    #: Rows and columns from the master of a shared formula to this cell.
    shift: tuple[int, int] = (0, 0)
    spills: bool = False  #: Whether it is a dynamic-array formula.
    #: Whether it is a data table (What-If Analysis), whose values no other formula gives.
    is_data_table: bool = False

    @property
    def place(self) -> Place:
        """The cell that holds it."""
        return self.sheet, self.rect.top, self.rect.left

    @property
    def home(self) -> Rect:
        """The cell that holds it."""
        return Rect(self.rect.top, self.rect.left, self.rect.top, self.rect.left)


@dataclass
class ChangedCells:
    """Cells whose values changed, by sheet: rectangles for blocks, single cells for the rest."""

    rects: dict[str, set[Rect]] = field(default_factory=lambda: defaultdict(set))
    #: Rows of single cells by sheet and column, in order.
    rows: dict[str, dict[int, list[int]]] = field(
        default_factory=lambda: defaultdict(lambda: defaultdict(list))
    )

    def add(self, sheet: str, rect: Rect) -> None:
        """Note a change."""
        if not rect.is_single:
            self.rects[sheet].add(rect)
        elif not self.touch(sheet, rect):
            insort(self.rows[sheet][rect.left], rect.top)

    def touch(self, sheet: str, rect: Rect) -> bool:
        """Whether any changed cell lies in the rectangle."""
        if any(block.meets(rect) for block in self.rects.get(sheet, ())):
            return True
        columns = self.rows.get(sheet, {})
        return any(_between(columns[column], rect) for column in _columns_in(columns, rect))

    def frozen(self) -> Frozen:
        """The same as something that can be looked up."""
        return (
            frozenset((sheet, frozenset(rects)) for sheet, rects in self.rects.items()),
            frozenset(
                (sheet, column, tuple(rows))
                for sheet, columns in self.rows.items()
                for column, rows in columns.items()
            ),
        )

    def __bool__(self) -> bool:
        return bool(self.rects or self.rows)


#: Changed cells as something that can be looked up: rectangles by sheet, rows by sheet and column.
Frozen = tuple[frozenset[tuple[str, frozenset[Rect]]], frozenset[tuple[str, int, tuple[int, ...]]]]


def _columns_in(columns: Collection[int], area: Rect) -> list[int]:
    """Those of some columns that lie in an area."""
    width = range(area.left, area.right + 1)
    if len(columns) < area.width:
        return [column for column in columns if column in width]
    return [column for column in width if column in columns]


def _between(rows: Sequence[int], area: Rect) -> range:
    """Positions of the sorted row numbers that lie in the rows of the area."""
    return range(bisect_left(rows, area.top), bisect_left(rows, area.bottom + 1))


class ReferenceResolver:
    """Turns the references of a formula into rectangles of sheets.

    Parameters
    ----------
    sheets : sequence of str
        Sheet names of the workbook.
    names : sequence of DefinedName
        All defined names, local ones too.
    """

    def __init__(self, sheets: Sequence[str], names: Sequence[DefinedName]) -> None:
        self._sheets = {sheet.lower(): sheet for sheet in sheets}
        self._folded = {sheet.casefold() for sheet in sheets}
        self._names = {(name.local_sheet.lower(), name.name.lower()): name for name in names}
        self._known: dict[FormulaCell, list[tuple[str, Rect]] | None] = {}
        self._records: dict[tuple[str, Rect], tuple[str, Rect]] = {}
        self._name_steps = 0

    def reads(self, formula: FormulaCell) -> list[tuple[str, Rect]] | None:
        """Rectangles that the formula reads; None = possibly everything."""
        if formula not in self._known:
            self._name_steps = 0
            self._known[formula] = self._reads(formula.text, formula.sheet, formula.shift, depth=0)
        return self._known[formula]

    def _reads(
        self, text: str, sheet: str, shift: tuple[int, int], depth: int
    ) -> list[tuple[str, Rect]] | None:
        parsed = parse_formula(text)
        # Names may lead in circles, and doubling themselves at each turn: beyond some steps they may read everything.
        self._name_steps += depth > 0
        if not text or parsed.unclear or depth > 20 or self._name_steps > _MOST_NAME_STEPS:
            return None
        areas: dict[tuple[str, Rect], None] = {}
        for reference in parsed.references:
            read = self._areas(reference, sheet, shift, depth)
            if read is None:
                return None
            areas |= dict.fromkeys(read)
        # One record for all formulas that read an area.
        return [self._records.setdefault(area, area) for area in areas]

    def _areas(
        self,
        reference: Reference | TableReference | NameReference | Span,
        sheet: str,
        shift: tuple[int, int],
        depth: int,
    ) -> list[tuple[str, Rect]] | None:
        if isinstance(reference, Reference):
            return self._cells(reference.sheet, reference.text, sheet, shift)
        if isinstance(reference, TableReference):
            return None  # formulas come here without tables
        if isinstance(reference, NameReference):
            return self._name_areas(reference.sheet, reference.name, sheet, depth)
        # Of a span the rectangle around both ends.
        start = self._areas(reference.start, sheet, shift, depth)
        end = self._areas(reference.within, sheet, shift, depth)
        if not start or not end or len(end) > 1 or start[0][0] != end[0][0]:
            return None
        return [(start[0][0], start[0][1].join(end[0][1]))]

    def _cells(
        self, prefix: str, text: str, sheet: str, shift: tuple[int, int]
    ) -> list[tuple[str, Rect]] | None:
        target = self._sheet(prefix, sheet)
        if target is None:
            return [] if self._is_nowhere(prefix) else None
        moved = shifted_range(text, *shift) if shift != (0, 0) else text
        if target == "" or moved == "#REF!":
            return []
        try:
            return [(target, parse_range(moved))]
        except ValueError:
            return None

    def _sheet(self, prefix: str, own: str) -> str | None:
        """Sheet of a prefix: the own one, another, empty for other workbooks, None when unclear."""
        if not prefix:
            return own
        name, _ = split_sheet(prefix)
        if "[" in name:
            return ""
        return self._sheets.get(name.lower())

    def _is_nowhere(self, prefix: str) -> bool:
        """Whether a sheet that is not there is no range of sheets either: what names it is an error for good."""
        return ":" not in prefix and split_sheet(prefix)[0].casefold() not in self._folded

    def _name_areas(
        self, prefix: str, name: str, sheet: str, depth: int
    ) -> list[tuple[str, Rect]] | None:
        if not prefix and name.upper() in _LANGUAGE_WORDS:
            return []
        scope = self._sheet(prefix, sheet)
        if scope is None:
            return [] if self._is_nowhere(prefix) else None
        key = name.lower()
        defined = self._names.get((scope.lower(), key)) or self._names.get(("", key))
        if defined is None:
            return []  # a variable of LET, a name of another workbook or of nothing: no cell here
        # References of a name are relative to the cell that uses it unless all carry dollar signs.
        if any("$" not in one.text for one in _written_cells(defined.text)):
            return None
        return self._reads(defined.text, scope or sheet, (0, 0), depth + 1)


def _written_cells(text: str) -> Iterator[Reference]:
    """All references to cells in a formula."""
    for reference in parse_formula(text).references:
        ends = (reference.start, reference.within) if isinstance(reference, Span) else (reference,)
        yield from (end for end in ends if isinstance(end, Reference))


class DependencyGraph:
    """Formulas and the rectangles they read.

    Parameters
    ----------
    formulas : sequence of FormulaCell
        The formulas; results are indices into this sequence.
    reads : callable
        Rectangles of a formula, None = everything (`ReferenceResolver.reads`).
    """

    def __init__(
        self,
        formulas: Sequence[FormulaCell],
        reads: Callable[[FormulaCell], list[tuple[str, Rect]] | None],
    ) -> None:
        self.formulas = formulas
        self._everything: list[int] = []
        self._readers: dict[tuple[str, Rect], list[int]] = defaultdict(list)
        for index, formula in enumerate(formulas):
            areas = reads(formula)
            if areas is None:
                self._everything.append(index)
            else:
                for area in areas:
                    self._readers[area].append(index)

    def downstream_of_cells(self, changed: ChangedCells) -> set[int]:
        """Formulas that read a changed cell, directly or through other formulas."""
        if not changed:
            return set()
        seeds = set(self._everything)
        for (sheet, rect), readers in self._readers.items():
            if changed.touch(sheet, rect):
                seeds.update(readers)
        return self._closure(seeds)

    def downstream_of_formulas(self, sources: Iterable[int]) -> set[int]:
        """The given formulas and all that depend on them."""
        seeds = set(sources)
        return self._closure(seeds | set(self._everything)) if seeds else seeds

    def in_circles(self) -> set[int]:
        """Formulas that depend on themselves, directly or through others; none where that would take long to find."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components

        places = _FormulaIndex(self.formulas)
        starts, ends = array("l"), array("l")
        for node, ((sheet, rect), readers) in enumerate(self._readers.items(), len(self.formulas)):
            shown = places.within(sheet, rect)
            starts.extend([node] * len(readers) + shown)
            ends.extend(readers + [node] * len(shown))
            if len(starts) + places.looked_at > _MOST_STEPS:
                return set()
        size = len(self.formulas) + len(self._readers)
        graph = csr_array(([True] * len(starts), (starts, ends)), shape=(size, size))
        _, groups = connected_components(graph, directed=True, connection="strong")
        # An area that a formula lies in and reads is in its circle: no circle has a single member.
        members = Counter(groups.tolist())
        return {index for index in range(len(self.formulas)) if members[groups[index]] > 1}

    def _closure(self, reached: set[int]) -> set[int]:
        areas = _AreaIndex(self._readers)
        wave = list(reached)
        while wave:
            shown = [(self.formulas[index].sheet, self.formulas[index].rect) for index in wave]
            wave = []
            # An area is taken once: all its readers are reached by then.
            for area in areas.take(shown):
                for reader in self._readers[area]:
                    if reader not in reached:
                        reached.add(reader)
                        wave.append(reader)
        return reached


class FormulaMap:
    """The formulas of a workbook, what each of them reads, and which depend on which.

    It follows from texts, names and tables alone, not from any value. Workbooks of one template share it, hence the last
    ones are kept in the process (`formula_map`).

    Parameters
    ----------
    cells : tuple of FormulaCell
        The formulas.
    sheets : tuple of str
        Sheet names of the workbook.
    names : tuple of DefinedName
        All defined names.
    tables : tuple of Table
        All tables, with the size that they have now.
    """

    def __init__(
        self,
        cells: tuple[FormulaCell, ...],
        sheets: tuple[str, ...],
        names: tuple[DefinedName, ...],
        tables: tuple[Table, ...],
    ) -> None:
        plain = PlainFormulas(names, tables)
        #: The formulas without tables (`PlainFormulas`).
        self.cells = tuple(_without_tables(cell, plain) for cell in cells)
        #: What names stand for without tables, by what they stand for in the file.
        self.names = {one.text: new.text for one, new in zip(names, plain.names, strict=True)}
        #: Texts that differ from those of the file, by place: a shared one where it is stated.
        self.rewritten = {
            new.place: new.text
            for one, new in zip(cells, self.cells, strict=True)
            if new is not one and new.shift == (0, 0)
        }
        self.reads = ReferenceResolver(sheets, plain.names).reads
        #: What each formula reads; None = possibly everything. All are resolved here: threads may share the map.
        self.areas = [self.reads(cell) for cell in self.cells]
        self._reached: dict[Frozen, frozenset[int]] = {}

    @cached_property
    def known_areas(self) -> frozenset[tuple[str, Rect]]:
        """What the formulas read of which that is known."""
        return frozenset(area for found in self.areas for area in found or ())

    @cached_property
    def last_rows(self) -> dict[str, int]:
        """The last row of each sheet that they read, as far as known."""
        last: dict[str, int] = {}
        for sheet, rect in self.known_areas:
            last[sheet] = max(last.get(sheet, 0), rect.bottom)
        return last

    @cached_property
    def graph(self) -> DependencyGraph:
        """Which formula depends on which."""
        return DependencyGraph(self.cells, self.reads)

    def downstream_of_cells(self, changed: ChangedCells) -> frozenset[int]:
        """As `DependencyGraph.downstream_of_cells`; the answers to the last questions are kept."""
        asked = changed.frozen()
        reached = self._reached.get(asked)
        if reached is None:
            reached = frozenset(self.graph.downstream_of_cells(changed))
            if len(self._reached) >= _MOST_CHANGES_KEPT:
                self._reached = {}
            self._reached[asked] = reached
        return reached


def _without_tables(cell: FormulaCell, plain: PlainFormulas) -> FormulaCell:
    """A formula with cells in the place of tables; of a shared one as its first cell states it."""
    rect = cell.home if cell.spills else cell.rect
    rows, columns = cell.shift
    first = Rect(rect.top - rows, rect.left - columns, rect.bottom - rows, rect.right - columns)
    text = plain.text(cell.text, Home(cell.sheet, (first, rect)))
    return cell if text == cell.text else cell._replace(text=text or "")


def formula_map(
    cells: tuple[FormulaCell, ...],
    sheets: tuple[str, ...],
    names: tuple[DefinedName, ...],
    tables: tuple[Table, ...],
) -> FormulaMap:
    """The map of a workbook's formulas; that of an equal workbook before it where that is kept."""
    make = _kept_map if len(cells) <= _MOST_FORMULAS_KEPT else FormulaMap
    return make(cells, sheets, names, tables)


_kept_map = lru_cache(maxsize=_MOST_MAPS)(FormulaMap)


class _FormulaIndex:
    """Formulas by the cells that show their results."""

    def __init__(self, formulas: Sequence[FormulaCell]) -> None:
        self._rows: dict[str, dict[int, list[tuple[int, int]]]] = defaultdict(
            lambda: defaultdict(list)
        )
        self._blocks: list[tuple[int, FormulaCell]] = []
        self.looked_at = 0
        for index, formula in enumerate(formulas):
            if formula.rect.is_single:
                self._rows[formula.sheet][formula.rect.left].append((formula.rect.top, index))
            else:
                self._blocks.append((index, formula))
        for columns in self._rows.values():
            for rows in columns.values():
                rows.sort()

    def within(self, sheet: str, area: Rect) -> list[int]:
        """Formulas that show results in an area."""
        columns = self._rows.get(sheet, {})
        self.looked_at += min(len(columns), area.width) + len(self._blocks)
        found = [
            index
            for index, formula in self._blocks
            if formula.sheet == sheet and formula.rect.meets(area)
        ]
        for column in _columns_in(columns, area):
            rows = columns[column]
            first = bisect_left(rows, (area.top, 0))
            found += (index for _, index in rows[first : bisect_left(rows, (area.bottom + 1, 0))])
        return found


class _AreaIndex:
    """Areas by place, so that those around changed cells are found without comparing all with all.

    Small areas are filed under each column and band of rows that they touch; large ones are each asked once a wave
    whether any cell of the wave lies inside.
    """

    BAND = 16
    LARGEST_WIDTH = 16
    LARGEST_HEIGHT = 1024

    def __init__(self, areas: Iterable[tuple[str, Rect]]) -> None:
        self._small: dict[tuple[str, int, int], set[Rect]] = defaultdict(set)
        self._large: set[tuple[str, Rect]] = set()
        for sheet, rect in areas:
            if self._is_small(rect):
                for column, band in self._bands(rect):
                    self._small[sheet, column, band].add(rect)
            else:
                self._large.add((sheet, rect))

    def take(self, wave: Sequence[tuple[str, Rect]]) -> set[tuple[str, Rect]]:
        """Take out all areas that share a cell with any rectangle of the wave."""
        reached = ChangedCells()
        hits = set()
        for sheet, rect in wave:
            hits |= self._hits_around(sheet, rect)
            if self._large:
                reached.add(sheet, rect)
        hits |= {area for area in self._large if reached.touch(*area)}
        for sheet, area in hits:
            if self._is_small(area):
                for column, band in self._bands(area):
                    self._small[sheet, column, band].discard(area)
        self._large -= hits
        return hits

    def _hits_around(self, sheet: str, rect: Rect) -> set[tuple[str, Rect]]:
        if rect.is_single:
            band = self._small.get((sheet, rect.left, rect.top // self.BAND), ())
            return {(sheet, area) for area in band if area.meets(rect)}
        # Array formulas and spilled results: few, so all areas may be gone through.
        return {
            (sheet, area)
            for (filed, _, _), areas in self._small.items()
            if filed == sheet
            for area in areas
            if area.meets(rect)
        }

    def _is_small(self, rect: Rect) -> bool:
        return rect.width <= self.LARGEST_WIDTH and rect.height <= self.LARGEST_HEIGHT

    def _bands(self, rect: Rect) -> Iterator[tuple[int, int]]:
        for column in range(rect.left, rect.right + 1):
            for band in range(rect.top // self.BAND, rect.bottom // self.BAND + 1):
                yield column, band


def spill_rect(anchor: Rect) -> Rect:
    """All cells into which a spilling formula may grow."""
    return Rect(anchor.top, anchor.left, MAX_ROW, MAX_COLUMN)
