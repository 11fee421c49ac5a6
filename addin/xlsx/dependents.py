"""Which formula cells depend on changed cells.

The graph is conservative: it may name a formula too many, never one too few.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from addin.xlsx.formula_text import Reference, Span, TableReference, parse_formula, shifted_range
from addin.xlsx.references import MAX_COLUMN, MAX_ROW, Rect, parse_range, split_sheet
from addin.xlsx.tables import Table
from addin.xlsx.workbook_part import DefinedName

_MOST_NAME_STEPS = 1_000
# Formulas that read each other's columns may have steps like the square of their number.
_MOST_STEPS = 2_000_000
_LANGUAGE_WORDS = frozenset(["TRUE", "FALSE"])


@dataclass(frozen=True)
class FormulaCell:
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


@dataclass
class ChangedCells:
    """Cells whose values changed, by sheet: rectangles for blocks, single cells for the rest."""

    rects: dict[str, list[Rect]] = field(default_factory=lambda: defaultdict(list))
    cells: dict[str, set[tuple[int, int]]] = field(default_factory=lambda: defaultdict(set))

    def add(self, sheet: str, rect: Rect) -> None:
        """Note a change."""
        if rect.is_single:
            self.cells[sheet].add((rect.top, rect.left))
        elif rect not in self.rects[sheet]:
            self.rects[sheet].append(rect)

    def touch(self, sheet: str, rect: Rect) -> bool:
        """Whether any changed cell lies in the rectangle."""
        if any(one.meets(rect) for one in self.rects.get(sheet, ())):
            return True
        singles = self.cells.get(sheet)
        if not singles:
            return False
        if rect.is_single:
            return (rect.top, rect.left) in singles
        return any(rect.has(row, column) for row, column in singles)

    def __bool__(self) -> bool:
        return any(self.rects.values()) or any(self.cells.values())


class ReferenceResolver:
    """Turns the references of a formula into rectangles of sheets.

    Parameters
    ----------
    sheets : sequence of str
        Sheet names of the workbook.
    names : sequence of DefinedName
        All defined names, local ones too.
    tables : iterable of Table
        All tables, with the size that they have now.
    """

    def __init__(
        self, sheets: Sequence[str], names: Sequence[DefinedName], tables: Iterable[Table]
    ) -> None:
        self._sheets = {sheet.lower(): sheet for sheet in sheets}
        self._names = {(name.local_sheet.lower(), name.name.lower()): name for name in names}
        self._tables = {table.name.lower(): table for table in tables}
        self._known: dict[FormulaCell, list[tuple[str, Rect]] | None] = {}
        self._name_steps = 0

    def reads(self, formula: FormulaCell) -> list[tuple[str, Rect]] | None:
        """Rectangles that the formula reads; None = possibly everything."""
        if not formula.text:
            return None
        if formula not in self._known:
            self._name_steps = 0
            self._known[formula] = self._reads(
                formula.text, formula.sheet, formula.rect, formula.shift, depth=0
            )
        return self._known[formula]

    def _reads(
        self, text: str, sheet: str, at: Rect, shift: tuple[int, int], depth: int
    ) -> list[tuple[str, Rect]] | None:
        parsed = parse_formula(text)
        # Names may lead in circles, and doubling themselves at each turn: beyond some steps they may read everything.
        self._name_steps += depth > 0
        if parsed.unclear or depth > 20 or self._name_steps > _MOST_NAME_STEPS:
            return None
        found: list[tuple[str, Rect]] = []
        for reference in parsed.cells:
            area = self._area(reference.sheet, reference.text, sheet, shift)
            if area is None:
                return None
            found.extend(area)
        for table_reference in parsed.tables:
            table_area = self._table_area(table_reference.table, table_reference.inside, sheet, at)
            if table_area is None:
                return None
            found.append(table_area)
        for name in parsed.names:
            areas = self._name_areas(name.sheet, name.name, sheet, at, depth)
            if areas is None:
                return None
            found.extend(areas)
        for span in parsed.spans:
            around = self._span_area(span, sheet, at, shift, depth)
            if around is None:
                return None
            found.extend(around)
        return found

    def _span_area(
        self, span: Span, sheet: str, at: Rect, shift: tuple[int, int], depth: int
    ) -> list[tuple[str, Rect]] | None:
        """The rectangle around both ends of a span."""
        start = self._area(span.start.sheet, span.start.text, sheet, shift)
        end: list[tuple[str, Rect]] | None
        if isinstance(span.within, Reference):
            end = self._area(span.within.sheet, span.within.text, sheet, shift)
        elif isinstance(span.within, TableReference):
            area = self._table_area(span.within.table, span.within.inside, sheet, at)
            end = None if area is None else [area]
        else:
            end = self._name_areas(span.within.sheet, span.within.name, sheet, at, depth)
        if not start or not end or len(end) > 1 or start[0][0] != end[0][0]:
            return None
        return [(start[0][0], start[0][1].join(end[0][1]))]

    def _area(
        self, prefix: str, text: str, sheet: str, shift: tuple[int, int]
    ) -> list[tuple[str, Rect]] | None:
        target = self._sheet(prefix, sheet)
        if target is None:
            return None
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

    def _table_area(self, name: str, inside: str, sheet: str, at: Rect) -> tuple[str, Rect] | None:
        table = self._tables.get(name.lower()) if name else self._table_around(sheet, at)
        return None if table is None else (table.sheet, table.read_by(inside, at))

    def _table_around(self, sheet: str, at: Rect) -> Table | None:
        around = (
            table for table in self._tables.values() if table.sheet == sheet and table.ref.meets(at)
        )
        return next(around, None)

    def _name_areas(
        self, prefix: str, name: str, sheet: str, at: Rect, depth: int
    ) -> list[tuple[str, Rect]] | None:
        if not prefix and name.upper() in _LANGUAGE_WORDS:
            return []
        scope = self._sheet(prefix, sheet)
        if scope is None:
            return None
        key = name.lower()
        defined = self._names.get((scope.lower(), key)) or self._names.get(("", key))
        if defined is not None:
            # References of a name are relative to the cell that uses it unless all carry dollar signs.
            if any("$" not in one.text for one in _written_cells(defined.text)):
                return None
            return self._reads(defined.text, scope or sheet, at, (0, 0), depth + 1)
        table = self._tables.get(key)
        return None if table is None else [(table.sheet, table.read_by("", at))]


def _written_cells(text: str) -> Iterator[Reference]:
    """All references to cells in a formula."""
    parsed = parse_formula(text)
    yield from parsed.cells
    for span in parsed.spans:
        yield span.start
        if isinstance(span.within, Reference):
            yield span.within


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
        width = range(area.left, area.right + 1)
        near = [c for c in columns if c in width] if len(columns) < area.width else [
            c for c in width if c in columns
        ]  # fmt: skip
        self.looked_at += min(len(columns), area.width) + len(self._blocks)
        found = [
            index
            for index, formula in self._blocks
            if formula.sheet == sheet and formula.rect.meets(area)
        ]
        for column in near:
            rows = columns[column]
            first = bisect_left(rows, (area.top, 0))
            found += (index for _, index in rows[first : bisect_left(rows, (area.bottom + 1, 0))])
        return found


class _AreaIndex:
    """Areas by place, so that those around changed cells are found without comparing all with all.

    Single cells are looked up; small areas are filed under each column and band of rows that they touch; large ones are
    each asked once a wave whether any cell of the wave lies inside.
    """

    BAND = 64
    LARGEST_WIDTH = 16
    LARGEST_HEIGHT = 1024

    def __init__(self, areas: Iterable[tuple[str, Rect]]) -> None:
        self._singles: set[tuple[str, Rect]] = set()
        self._small: dict[tuple[str, int, int], set[Rect]] = defaultdict(set)
        self._large: set[tuple[str, Rect]] = set()
        for sheet, rect in areas:
            if rect.is_single:
                self._singles.add((sheet, rect))
            elif self._is_small(rect):
                for column, band in self._bands(rect):
                    self._small[sheet, column, band].add(rect)
            else:
                self._large.add((sheet, rect))

    def take(self, wave: Sequence[tuple[str, Rect]]) -> set[tuple[str, Rect]]:
        """Take out all areas that share a cell with any rectangle of the wave."""
        hits = self._large_hits(wave) if self._large else set()
        for sheet, rect in wave:
            hits |= self._hits_around(sheet, rect)
        for sheet, area in hits:
            if self._is_small(area) and not area.is_single:
                for column, band in self._bands(area):
                    self._small[sheet, column, band].discard(area)
        self._singles -= hits
        self._large -= hits
        return hits

    def _hits_around(self, sheet: str, rect: Rect) -> set[tuple[str, Rect]]:
        if rect.is_single:
            band = self._small.get((sheet, rect.left, rect.top // self.BAND), ())
            hits = {(sheet, area) for area in band if area.meets(rect)}
            if (sheet, rect) in self._singles:
                hits.add((sheet, rect))
            return hits
        # Array formulas and spilled results: few, so all areas may be gone through.
        small = {(key[0], area) for key, areas in self._small.items() for area in areas}
        return {
            (one, area) for one, area in small | self._singles if one == sheet and area.meets(rect)
        }

    def _large_hits(self, wave: Sequence[tuple[str, Rect]]) -> set[tuple[str, Rect]]:
        rows: dict[str, dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
        blocks: list[tuple[str, Rect]] = []
        for sheet, rect in wave:
            if rect.is_single:
                rows[sheet][rect.left].append(rect.top)
            else:
                blocks.append((sheet, rect))
        for columns in rows.values():
            for tops in columns.values():
                tops.sort()
        return {
            (sheet, area)
            for sheet, area in self._large
            if any(
                _any_between(tops, area)
                for column, tops in rows[sheet].items()
                if area.left <= column <= area.right
            )
            or any(sheet == one and area.meets(block) for one, block in blocks)
        }

    def _is_small(self, rect: Rect) -> bool:
        return rect.width <= self.LARGEST_WIDTH and rect.height <= self.LARGEST_HEIGHT

    def _bands(self, rect: Rect) -> Iterator[tuple[int, int]]:
        for column in range(rect.left, rect.right + 1):
            for band in range(rect.top // self.BAND, rect.bottom // self.BAND + 1):
                yield column, band


def _any_between(rows: Sequence[int], area: Rect) -> bool:
    """Whether any of the sorted row numbers lies in the rows of the area."""
    position = bisect_left(rows, area.top)
    return position < len(rows) and rows[position] <= area.bottom


def spill_rect(anchor: Rect) -> Rect:
    """All cells into which a spilling formula may grow."""
    return Rect(anchor.top, anchor.left, MAX_ROW, MAX_COLUMN)
