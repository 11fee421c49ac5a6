"""What `benchmarks.goals_beside` measures in both checkouts: a piece of code a row, as a user of the engine writes it.

The old program has other module paths, so a row may have two pieces of code. Each leaves `call`; `told` says in a few
words what the last call found. Workbooks of the examples stand in the folder TORSIONBOOK_EXAMPLES, the same inputs for both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

__all__ = ["ROWS", "Row"]


@dataclass(frozen=True)
class Row:
    """One goal that is a time of both programs.

    Parameters
    ----------
    what : str
        Line of the table. [text]
    goal : float
        New over old at most: the two columns of the goal. [1]
    new, old : str
        Code of either checkout. [Python]
    times : float
        So many of what is measured are what the goal counts. [1]
    budget : float
        Laps are repeated so long in every turn. [s]
    rounds : int or None
        Turns; None as many as asked for. [count]
    warm : bool
        Whether a first lap is left out. [flag]
    memory : float or None
        Goal for the largest resident memory, new over old. [1]
    note : str
        How it was measured. [text]
    also : callable
        What else must hold of the words that the new program tells. [function]
    alone : str, optional
        Code that makes `call` a piece of the work in one process, to see how much of it the loops take. [Python]
    full : tuple of str, optional
        Text of the sample in the code, and that of all starts. [Python]
    """

    what: str
    goal: float
    new: str
    old: str
    times: float = 1.0
    budget: float = 0.3
    rounds: int | None = None
    warm: bool = True
    memory: float | None = None
    note: str = ""
    also: Callable[[str], bool] = lambda told: True
    alone: str = ""
    full: tuple[str, str] | None = None

    def in_full(self) -> Row:
        """The row with every start calculated."""
        if self.full is None:
            return self
        new, old = (code.replace(*self.full) for code in (self.new, self.old))
        return replace(self, new=new, old=old, times=1.0, rounds=1, warm=False, note="all starts")


# --- starts ---------------------------------------------------------------------------------------

START = """
from benchmarks.ours import prepare_start
from benchmarks.problems import long_start
"""
NEW_START = (
    START
    + """
from engine.model.modal_train import ModalTrain
from engine.start.start import run_start
s = prepare_start(long_start())
call = lambda: run_start(s.case, ModalTrain(s.train, s.modes, s.damping))
"""
)
OLD_START = (
    START
    + """
from engine.startup import run_start
s = prepare_start(long_start())
call = lambda: run_start(s.case, s.train, s.modes, s.damping)
"""
)
READ = """
import os
from pathlib import Path
from {module} import read_checked
case = read_checked(Path(os.environ["TORSIONBOOK_EXAMPLES"]) / "example_backlash.xlsx").case()
"""
NEW_READ = READ.format(module="addin.reading.one_file")
OLD_READ = READ.format(module="addin.recalc")
NEW_EVENTS = (
    NEW_READ
    + """
from engine.run import planned_start
from engine.start.pieces import analysis_for_start
analysis = analysis_for_start(case)
call = lambda: planned_start(case, analysis)
"""
)
OLD_EVENTS = (
    OLD_READ
    + """
from engine.run import analyse, planned_start
analysis = analyse(case)
call = lambda: planned_start(case, analysis)
"""
)
FIVE = """
from dataclasses import replace
from benchmarks.backlash_speed import start_with_teeth
{imports}
from engine.run import calculate_start
case, mesh = start_with_teeth(bearings=False)
chosen = ("LS coupling", "HS coupling", "Gear shaft", "Pinion shaft")
case = replace(
    case,
    elements=tuple(replace(e, kind="coupling") if e.element in chosen else e for e in case.elements),
    meshes=(*case.meshes, *(MeshRow(e, angular_backlash=1e-3) for e in chosen)),
)
model = analyse(case).reported
linear = calculate_start(case, model, StartEffects(), None)
effects = StartEffects(clearances=(mesh, *chosen))
found = []
def call():
    found[:] = [calculate_start(case, model, effects, linear)]
def told():
    s = found[0]
    word = "sensitive" if getattr(s, "is_sensitive", False) else "met" if s.met_tolerance else "not met"
    return f"{word}, estimated error {s.estimated_error:.1e}, {s.trajectory.n_steps} steps"
"""
NEW_FIVE = FIVE.replace(
    "{imports}",
    "from engine.case.data import MeshRow\nfrom engine.case.effect import StartEffects\n"
    "from engine.model.modal_analysis import analyse",
)
OLD_FIVE = FIVE.replace(
    "{imports}",
    "from engine.case import MeshRow\nfrom engine.effects import StartEffects\nfrom engine.run import analyse",
)

# --- workbooks ------------------------------------------------------------------------------------

WARM = """
import os, shutil, tempfile
from pathlib import Path
from {recalc} import recalculate
place = Path(tempfile.mkdtemp(prefix="torsionbook-goals-"))
source = Path(shutil.copy(Path(os.environ["TORSIONBOOK_EXAMPLES"]) / "example_{example}.xlsx", place))
if {again}:
    recalculate(source, destination=place / "once.xlsx")
    source = place / "once.xlsx"
def call():
    done = recalculate(source, destination=place / "results.xlsx")
    assert done.calculation is not None, done.problems
"""


def _warm(what: str, example: str, again: bool, goal: float) -> Row:
    words = {"example": example, "again": again}
    return Row(
        f"warm recalc, {what}",
        goal,
        WARM.format(recalc="addin.writing.recalculate", **words),
        WARM.format(recalc="addin.recalc", **words),
        budget=1.0,
    )


# --- studies --------------------------------------------------------------------------------------

STUDY = """
import os, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
{case}
{imports}
rows = (
    ScatterRow(quantity="stiffness", spread=0.05),
    ScatterRow(quantity="inertia", spread=0.02),
    ScatterRow(quantity="damping ratio", distribution="uniform", spread=0.3),
    ScatterRow(quantity="average torque", spread=0.05),
    ScatterRow(quantity="pulsating torque", distribution="triangular", spread=0.1),
    ScatterRow(quantity="load torque", spread=0.05, together="together"),
)
samples = {samples}
plan = plan_tolerances(case, rows, ToleranceSettings(max(samples, 30)))  # fewer are refused
# as many starts as samples; those of the sensitivities are left out
units = units_of(plan, {chunk})[: -(-samples // {chunk})]
evaluate(units_of(plan, 1)[0])  # what the first start compiles or loads
def call():
    began, used = time.perf_counter(), sum(os.times()[:4])
    with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
        list(pool.map(evaluate, units))
    return time.perf_counter() - began, sum(os.times()[:4]) - used
"""
NEW_SAMPLE = """
from engine.case.study_inputs import ScatterRow
from engine.studies.tolerances.sample import ToleranceSettings, evaluate, plan_tolerances, units_of
"""
OLD_SAMPLE = """
from engine.studies import ScatterRow
from engine.tolerance_sample import ToleranceSettings, evaluate, plan_tolerances, units_of
"""
PAPER = "from tests.sample_case import sample_case\ncase = sample_case('proposed')"


def _study(what: str, of: int, samples: int, goal: float, cases: tuple[str, str]) -> Row:
    words = {"samples": samples, "chunk": max(samples // 10, 1)}
    new, old = (
        STUDY.format(case=case, imports=imports, **words)
        for case, imports in zip(cases, (NEW_SAMPLE, OLD_SAMPLE), strict=True)
    )
    return Row(
        f"{of:,} {what} starts of a tolerance study", goal, new, old,
        times=of / samples, budget=0.0, rounds=1, warm=False,
        note=f"{samples} samples on two processes, scaled; the goal is wall time on two cores, of which processor time "
        "is twice as much",
        alone="call = lambda: evaluate(units[0])\n",
        full=(f"samples = {samples}\n", f"samples = {of}\n"),
    )  # fmt: skip


# --- modes, prescribed torque ---------------------------------------------------------------------

MODES = """
from benchmarks.ours import build_and_solve
from benchmarks.problems import random_chain
chain = random_chain(5000)
call = lambda: build_and_solve(chain)
"""
PRESCRIBED = """
from benchmarks.ours import response
from benchmarks.problems import MOTOR, RESPONSE, ten
{build}
train = build_train(ten().case())
call = lambda: response(train, RESPONSE, MOTOR, 6e-4, "linear")
"""

ROWS = (
    Row("15 s start with its error estimate, 10 stations, to 1e-3", 4 / 15, NEW_START, OLD_START),
    Row(
        "start with backlash, bearings, pull-in (example)", 45 / 143, NEW_EVENTS, OLD_EVENTS,
        budget=0.5, note="plan, linear start, start with events, and one more run that says what the curves' reading changes, which the "
        "old program does not make",
    ),
    _warm("template, linear", "proposed", False, 75 / 178),
    _warm("already calculated, linear", "proposed", True, 75 / 303),
    _warm("template, backlash", "backlash", False, 130 / 366),
    _warm("already calculated, backlash", "backlash", True, 130 / 578),
    _study("linear", 10_000, 500, 24 / 85, (PAPER, PAPER)),
    _study("backlash", 1_000, 20, 120 / 450, (NEW_READ, OLD_READ)),
    Row(
        "prescribed torque, 15 s, a sample each 0.6 ms", 9 / 50,
        PRESCRIBED.format(build="from engine.model.build_train import build_train"),
        PRESCRIBED.format(build="from engine.train import build_train"),
        note="trajectory error 1e-3",
    ),
    Row(
        "modes of 5,000 stations", 3 / 11, MODES, MODES, budget=0.0, rounds=1, warm=False, memory=1 / 3.2,
        note="all modes: frequencies, shapes and torques of elements; before also shares of energy, which are now "
        "calculated when they are asked for",
    ),
    Row(
        "five clearances in series", 0.26 / 2.6, NEW_FIVE, OLD_FIVE, budget=0.0, rounds=1,
        note="the start with events of the example with a mesh and four couplings that have clearance",
        also=lambda told: not told.startswith("not met"),
    ),
)  # fmt: skip
