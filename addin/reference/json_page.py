"""The page docs/json.md: the keys of each JSON file, from the schemas."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from addin.contract.studies.registry import STUDIES
from addin.reference.json_schemas import SCHEMAS, study_schema

_HEAD = """# JSON files

Made from the schemas by `make generated`; do not edit. The schemas themselves are in `addin/reference/schemas`, one for each heading below.

`torsionbook export` writes a case, `recalc --json` results, the commands of the studies theirs. Numbers are in SI; in a case a string
carries its own unit (`"1800 rpm"`), and an absent key is a blank cell. Keys of tables are the names of their columns in lower case; what the columns
of results mean is on the pages of [results](results.md).
"""


def json_page() -> str:
    """The page."""
    schemas = {name: schema() for name, schema in SCHEMAS.items()}
    schemas |= {study.key: study_schema(study) for study in STUDIES}
    return _HEAD + "".join(
        _section(name, schema, inputs=name == "case") for name, schema in schemas.items()
    )


def _section(name: str, schema: Mapping[str, Any], *, inputs: bool) -> str:
    """A file: its single values first, then each list of rows; of inputs with the words of each column."""
    single, lists = [], []
    for key, content in schema["properties"].items():
        columns = content.get("items", {}).get("properties")
        words = content.get("description", "")
        if not columns:
            single.append(f"| `{key}` | {_plain(words)} |\n")
        elif inputs:
            rows = (
                f"| `{column}` | {_plain(each.get('description', ''))} |\n"
                for column, each in columns.items()
            )
            lists.append(f"\n### {key}\n\n{words}\n\n| key | |\n|---|---|\n{''.join(rows)}")
        else:
            keys = ", ".join(f"`{column}`" for column in columns)
            single.append(f"| `{key}`, a list | {_plain(words)} Keys: {keys}. |\n")
    return f"\n## {name}.schema.json\n\n| key | |\n|---|---|\n{''.join(single)}{''.join(lists)}"


def _plain(text: str) -> str:
    return text.replace("|", "\\|")
