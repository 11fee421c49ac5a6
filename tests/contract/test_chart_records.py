"""Records of charts: what they name exists, and every chart of a sheet has its record."""

from addin.contract.chart_tables import CHART_TABLES, LABELS
from addin.contract.charts import FirstCell, Label
from addin.contract.sheets import SHEETS
from addin.contract.studies.registry import EVERY_CHART, with_studies
from addin.contract.tables import EVERY_TABLE


def columns() -> dict[str, set[str]]:
    drawn = {table.name: set(table.columns) for table in CHART_TABLES}
    for table in EVERY_TABLE:
        fields = {field.name for field in (*table.columns, *table.extra_columns)}
        if table.repeated is not None:
            fields |= {table.repeated_column(k).name for k in range(1, 11)}
        drawn[table.name] = fields
    return drawn


def test_a_chart_draws_columns_that_exist():
    known = columns()
    for spec in EVERY_CHART.values():
        for series in spec.series:
            assert {series.x, series.y} <= known[series.table], (spec.name, series)


def test_words_of_a_chart_exist():
    known = columns()
    for spec in EVERY_CHART.values():
        axes = [spec.x, spec.y, *([spec.second] if spec.second else [])]
        for words in (spec.title, *(a.title for a in axes), *(s.name for s in spec.series)):
            if isinstance(words, Label):
                assert words.key in LABELS, (spec.name, words)
            elif isinstance(words, FirstCell):
                assert words.column in known[words.table], (spec.name, words)


def test_every_chart_on_a_sheet_has_its_record_and_the_other_way_round():
    placed = {at.name for sheet in with_studies(SHEETS) for at in sheet.charts}
    assert placed == set(EVERY_CHART)
