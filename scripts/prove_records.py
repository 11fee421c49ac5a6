"""Prove by doing that a column, an effect, a study and a worksheet function are one record each.

Four small patches are applied to a copy of the tree, one after the other. After each, `make generated`
rewrites what is derived, the derived files are searched for what is new, and the tests of the touched rooms
run. How many hand-written files a patch adds or changes, tests apart, is asserted.

    python scripts/prove_records.py [PATCH ...] [--no-tests]
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: What derived files are below: `make generated` writes them, nobody else.
DERIVED = (
    "addin/reference/schemas/",
    "templates/",
    "docs/results",
    "docs/functions.md",
    "docs/validation.md",
    "docs/commands.md",
    "docs/json.md",
    "docs/effects.md",
    "addin/cli/study_commands.py",
    "scripts/sentences.txt",
)


@dataclass(frozen=True)
class Edit:
    """Words put before others that stand once in a file."""

    path: str
    before: str
    words: str


@dataclass(frozen=True)
class Patch:
    """One thing that is added, and what must follow from it."""

    name: str
    files: int  #: Hand-written files that it adds or changes, tests apart.
    edits: tuple[Edit, ...] = ()
    new: tuple[tuple[str, str], ...] = ()  #: New files: path and text.
    #: Derived files, and words that must stand in them afterwards.
    derived: tuple[tuple[str, str], ...] = ()
    #: Python that must run in the patched copy.
    check: str = ""
    tests: tuple[str, ...] = ()  #: Of the touched rooms.

    @property
    def touched(self) -> list[str]:
        """Hand-written files. [paths]"""
        return sorted({edit.path for edit in self.edits} | {path for path, _ in self.new})


COLUMN = Patch(
    "column",
    3,
    edits=(
        Edit(
            "engine/model/modes.py",
            "    @property\n    def n_modes(self)",
            "    @property\n"
            "    def period(self) -> Floats:\n"
            '        """Natural periods, 0 of rigid-body modes, shape (n_modes,). [s]"""\n'
            "        return 2.0 * math.pi / np.where(self.omega > 0.0, self.omega, np.inf)\n\n",
        ),
        Edit(
            "engine/results/tables.py",
            '                "cpm": 60.0 * f,\n',
            '                "period": float(modes.period[r]) if elastic else None,\n',
        ),
        Edit(
            "addin/contract/result_tables.py",
            '            number(\n                "CPM", "cycles per minute",',
            "            number(\n"
            '                "Period", "time", "Natural period.", "1 / f",\n'
            '                LABEL, of_row=("NaturalFrequencies.Frequency",), error=ReportedError.FREQUENCIES,\n'
            '                printed="Frequency",\n'
            "            ),\n",
        ),
    ),
    derived=(
        ("docs/results-train.md", "| Period [s] | Natural period.<br>"),
        ("addin/reference/schemas/results.schema.json", '"period": {'),
    ),
    check="""
import json, pathlib, subprocess, sys
import openpyxl
from addin.worksheet.registry import FUNCTIONS
import addin.worksheet.functions
book = openpyxl.load_workbook("templates/blank_si.xlsx")
sheet = book["Results"]
cells = [cell.value for row in sheet[sheet.tables["NaturalFrequencies"].ref] for cell in row]
assert "Period" in cells, cells
rows = [[c.value for c in row] for row in book["Notes"].iter_rows()]
assert any("Period" in row for row in rows)
folder = pathlib.Path("build/proof")
folder.mkdir(parents=True, exist_ok=True)
subprocess.run([sys.executable, "-m", "addin.cli", "recalc", "templates/example_proposed.xlsx",
                "--out", str(folder), "--json", str(folder)], check=True)
results = json.loads(next(folder.glob("*.json")).read_text())
elastic = [row for row in results["natural_frequencies"] if row["mode"]]
assert len(elastic) > 5
for row in elastic:
    assert abs(row["period"] * row["frequency"] - 1.0) < 1e-12
out = next(folder.glob("*.xlsx"))
subprocess.run([sys.executable, "-m", "addin.cli", "verify", str(out)], check=True)
""",
    tests=(
        "tests/boundaries/test_generated.py",
        "tests/contract/test_traces.py",
        "tests/writing/test_results_json.py",
        "tests/template/test_templates.py",
    ),
)

FUNCTION = Patch(
    "function",
    1,
    edits=(
        Edit(
            "addin/worksheet/functions/modes.py",
            '@registered(\n    "TV_MODE",\n',
            '@registered("TV_STATIONS", MODEL, scalar=True, example="=TV_STATIONS(A1)")\n'
            "def tv_stations(model: str) -> int:\n"
            '    """How many stations the train has."""\n'
            "    return len(at_speed_tables(model)[0].case.stations)\n\n\n",
        ),
    ),
    derived=(("docs/functions.md", "## TV_STATIONS"),),
    check="""
import json
from addin.reading.workbook import read_workbook
from addin.server.office import functions_json
from addin.worksheet.models import MODELS
from addin.worksheet import functions
from addin.worksheet.registry import call
read = read_workbook("templates/example_proposed.xlsx")
answer = call("TV_STATIONS", [MODELS.add(read).handle])
assert answer in (len(read.data.stations), [[len(read.data.stations)]]), answer
assert "STATIONS" in json.dumps(functions_json())
""",
    tests=(
        "tests/boundaries/test_generated.py",
        "tests/worksheet",
        "tests/libreoffice/test_oxt.py",
        "tests/server/test_office.py",
    ),
)

EFFECT = Patch(
    "effect",
    2,
    new=(
        (
            "engine/case/effects/oil_film.py",
            '"""Squeezing of the oil between flanks: never simulated."""\n\n'
            "from engine.case.effect import Effect\n\n"
            "OIL_FILM = Effect(\n"
            '    "oil film",\n'
            '    "oil squeezed between flanks",\n'
            "    order=110,\n"
            '    number="Film thickness over roughness; never on",\n'
            '    bound="0",\n'
            ")\n",
        ),
        (
            "engine/plan/effects/oil_film.py",
            '"""Is the oil between flanks simulated?"""\n\n'
            "from engine.case.data import CaseData\n"
            "from engine.plan.decision import Finding\n"
            "from engine.plan.evidence import Evidence\n\n\n"
            "def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:\n"
            '    """It is not."""\n'
            '    return Finding(False, False, None, None, None, "Oil between flanks is not simulated.")\n',
        ),
    ),
    derived=(("addin/reference/schemas/case.schema.json", '"oil film"'),),
    check="""
import openpyxl
from addin.worksheet import functions
book = openpyxl.load_workbook("templates/blank_si.xlsx")
sheet = book["Case"]
cells = [cell.value for row in sheet[sheet.tables["EffectChoices"].ref] for cell in row]
assert "oil film" in cells, cells
from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from engine.run import run
results = run(read_workbook("templates/example_proposed.xlsx").case())
decision = results.plans[-1].decision("oil film")
assert not decision.on and "not simulated" in decision.why
""",
    tests=(
        "tests/boundaries/test_generated.py",
        "tests/engine/plan/test_plan.py",
        "tests/template/test_templates.py",
        "tests/worksheet/test_documented_formulas.py",
    ),
)

STUDY = Patch(
    "study",
    4,
    new=(
        (
            "addin/contract/studies/scaling.py",
            '''"""Frequencies of a train whose stiffnesses are all scaled, in workbook and JSON."""

from __future__ import annotations

from addin.contract.field import TableSpec, integer, number, table
from addin.contract.sheet import Sheet
from addin.contract.study_spec import StudySpec

_SOURCE = "docs/method.md, Natural frequencies"
_INPUTS: tuple[TableSpec, ...] = (
    table(
        "Scaling", sheet="Scaling", caption="Scaling", help="Factors on all stiffnesses.",
        rows=6, row_name=("Factor",),
        columns=(number("Factor", "ratio", "On every stiffness."),),
    ),
)  # fmt: skip
_RESULTS: tuple[TableSpec, ...] = (
    table(
        "ScaledFrequencies", sheet="Scaled frequencies", caption="Scaled frequencies",
        help="Frequencies with scaled stiffnesses.", row_name=("Factor", "Mode"),
        changes_shown=("Frequency",),
        columns=(
            number(
                "Factor", "ratio", "On every stiffness.", "As typed", _SOURCE,
                of_row=("Scaling.Factor",),
            ),
            integer("Mode", "Elastic mode.", "Counted from 1", _SOURCE),
            number(
                "Frequency", "frequency", "Natural frequency.", "f × √factor", _SOURCE,
                of_row=("NaturalFrequencies.Frequency", "Scaling.Factor"),
            ),
        ),
    ),
)  # fmt: skip
_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Scaling", "input", {"A": 1.5, "B": 12, "C:H": 12}, {"Scaling": "B5"},
        intro="Factors on all stiffnesses, for torsionbook scale FILE.",
    ),
    Sheet(
        "Scaled frequencies", "result", {"A": 1.5, "B:H": 14}, {"ScaledFrequencies": "B7"},
        intro="Frequencies with every stiffness scaled: torsionbook scale FILE.",
    ),
)  # fmt: skip

SCALING = StudySpec(
    key="scaling",
    order=6,
    command="scale",
    sheet="Scaled frequencies",
    inputs=_INPUTS,
    results=_RESULTS,
    sheets=_SHEETS,
)
''',
        ),
        (
            "addin/studies/scaling.py",
            '''"""Scaled stiffnesses as a study; see `engine.studies.scaling`."""

from __future__ import annotations

from collections.abc import Sequence

from addin.contract.studies.scaling import SCALING as SCALING_SPEC
from addin.studies.study import Study, StudyResult, StudyTask
from engine.case.case import Case
from engine.case.study_inputs import StudyInputs, study_digest
from engine.errors import Problem
from engine.studies.scaling.scaling import factor_problems, scaled_rows


def _check(case: Case, inputs: StudyInputs) -> Sequence[Problem]:
    return factor_problems(inputs.rows("Scaling"))


def _calculate(task: StudyTask) -> StudyResult:
    rows = task.inputs.rows("Scaling")
    table = scaled_rows(task.case, [row.factor for row in rows])
    return StudyResult(
        result=table,
        tables={"ScaledFrequencies": table},
        sentence=f"{len(rows)} factors on all stiffnesses were tried.",
        digest=study_digest(*rows),
    )


SCALING = Study(spec=SCALING_SPEC, check=_check, calculate=_calculate)
''',
        ),
        (
            "engine/studies/scaling/__init__.py",
            '''"""All stiffnesses scaled by one factor.

=========  =======================================================================================
module     responsibility
=========  =======================================================================================
`scaling`  frequencies with every stiffness scaled
=========  =======================================================================================
"""
''',
        ),
        (
            "engine/studies/scaling/scaling.py",
            '''"""Frequencies with every stiffness scaled."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from engine.case.case import Case
from engine.errors import Problem
from engine.run import at_speed


def factor_problems(rows: Sequence[Any]) -> list[Problem]:
    """Factors that are none."""
    return [
        Problem("Scaling", number, "Factor", row.factor, "a number above 0", "it must be above 0.")
        for number, row in enumerate(rows, start=1)
        if row.factor is None or row.factor <= 0.0
    ]


def scaled_rows(case: Case, factors: Sequence[float]) -> list[dict[str, Any]]:
    """One row a factor and elastic mode: frequencies go with the root of the factor. [Hz]"""
    frequencies = at_speed(case).modes.elastic_frequency.tolist()
    return [
        {"factor": factor, "mode": mode, "frequency": frequency * math.sqrt(factor)}
        for factor in factors
        for mode, frequency in enumerate(frequencies, start=1)
    ]
''',
        ),
    ),
    derived=(
        (
            "docs/results-studies.md",
            "## ScaledFrequencies",
        ),
        ("addin/reference/schemas/scaling.schema.json", '"scaled_frequencies"'),
    ),
    check="""
import json, math, pathlib, subprocess, sys
import jsonschema
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook
from addin.server.studies import read_study, study_of
def run(*words):
    return subprocess.run([sys.executable, "-m", "addin.cli", *words], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
folder = pathlib.Path("build/proof")
folder.mkdir(parents=True, exist_ok=True)
assert " scale " in run("--help")
case = case_to_json(read_workbook("templates/example_proposed.xlsx").data)
case["scaling"] = [{"factor": 1}, {"factor": 4}]
source = folder / "case.json"
source.write_text(json.dumps(case))
print(run("scale", str(source), "--json", str(folder / "scaled.json")))
content = json.loads((folder / "scaled.json").read_text())
schema = json.loads(pathlib.Path("addin/reference/schemas/scaling.schema.json").read_text())
jsonschema.validate(content, schema)
rows = content["scaled_frequencies"]
half = len(rows) // 2
assert half and all(math.isclose(2 * a["frequency"], b["frequency"])
                    for a, b in zip(rows[:half], rows[half:]))
asked = read_study({"study": "scale", "case": case})
assert study_of(asked, print)["value"]["scaled_frequencies"] == rows
# on sheets as well: a workbook with the studies, its rows typed, calculated and compared
import openpyxl
book = folder / "studies.xlsx"
run("new", str(book), "--studies", "--example", "proposed", "--force")
typed = openpyxl.load_workbook(book)
sheet = typed["Scaling"]
first = sheet[sheet.tables["Scaling"].ref.split(":")[0]]
first.offset(1, 0).value = 4
typed.save(book)
run("scale", str(book), "--out", str(folder / "scaled"))
made = openpyxl.load_workbook(next((folder / "scaled").glob("*.xlsx")))
cells = [c.value for row in made["Scaled frequencies"].iter_rows() for c in row]
assert any(isinstance(c, float) for c in cells)
""",
    tests=(
        "tests/boundaries/test_generated.py",
        "tests/boundaries/test_imports.py",
        "tests/studies/test_study_pages.py",
        "tests/template/test_templates.py",
    ),
)

PATCHES = {patch.name: patch for patch in (COLUMN, FUNCTION, EFFECT, STUDY)}


def copy_tree(target: Path) -> None:
    """What the checkout holds, as it stands, without what was built."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    ).stdout  # fmt: skip
    for name in filter(None, listed.split("\0")):
        source = ROOT / name
        if source.is_file():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target / name)
    subprocess.run([sys.executable, "hatch_build.py"], cwd=target, check=True, capture_output=True)


def apply(patch: Patch, tree: Path) -> None:
    """Put a patch into a tree; an anchor that does not stand there once is told."""
    for edit in patch.edits:
        path = tree / edit.path
        text = path.read_text(encoding="utf-8")
        if text.count(edit.before) != 1:
            raise SystemExit(
                f"patch {patch.name}: these words stand {text.count(edit.before)} times in "
                f"{edit.path}, not once; choose others in scripts/prove_records.py:\n{edit.before}"
            )
        path.write_text(text.replace(edit.before, edit.words + edit.before), encoding="utf-8")
    for name, text in patch.new:
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        (tree / name).write_text(text, encoding="utf-8")


def contents(tree: Path) -> dict[str, bytes]:
    """The files of a tree by name, without what was built."""
    left_out = {"build", "__pycache__", ".pytest_cache", ".hypothesis"}
    return {
        path.relative_to(tree).as_posix(): path.read_bytes()
        for path in sorted(tree.rglob("*"))
        if path.is_file() and not left_out & set(path.relative_to(tree).parts)
    }


def _run(tree: Path, *words: str) -> None:
    """Python in a tree, which stands before the checkout on the path."""
    environment = os.environ | {"PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([sys.executable, *words], cwd=tree, env=environment)
    if done.returncode:
        raise SystemExit(f"failed in the patched tree: {' '.join(words[:3])[:200]}")


def prove(patch: Patch, tree: Path, with_tests: bool) -> Iterator[str]:
    """Apply one patch, prove it and take it back; what was found, in words."""
    before = contents(tree)
    try:
        apply(patch, tree)
        changed = [name for name, text in contents(tree).items() if before.get(name) != text]
        assert len(changed) == patch.files == len(patch.touched), (patch.name, changed)
        _run(tree, "scripts/generated.py")
        after = contents(tree)
        derived = [name for name, text in after.items() if before.get(name) != text]
        derived = [name for name in derived if name not in changed]
        strangers = [name for name in derived if not name.startswith(DERIVED)]
        assert not strangers, f"{patch.name} changes {strangers}, which is not said to be derived"
        for name, words in patch.derived:
            assert words in (tree / name).read_text(encoding="utf-8"), (patch.name, name, words)
        _run(tree, "-c", patch.check)
        if with_tests:
            _run(tree, "-m", "pytest", "-q", "-p", "no:cacheprovider", *patch.tests)
        yield f"{patch.name}: {len(changed)} files by hand, {len(derived)} derived"
        yield from (f"  {name}" for name in changed)
    finally:
        for name in contents(tree).keys() - before.keys():
            (tree / name).unlink()
        for name, text in before.items():
            if (tree / name).read_bytes() != text:
                (tree / name).write_bytes(text)
        shutil.rmtree(tree / "build", ignore_errors=True)


def main(words: Sequence[str] | None = None) -> None:
    """Prove some patches, or all."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("patches", nargs="*", choices=[[], *PATCHES], metavar="PATCH")
    parser.add_argument("--no-tests", action="store_true", help="leave out the tests of the rooms")
    asked = parser.parse_args(words)
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        copy_tree(tree)
        for name in asked.patches or PATCHES:
            for line in prove(PATCHES[name], tree, not asked.no_tests):
                print(line, flush=True)


if __name__ == "__main__":
    main()
