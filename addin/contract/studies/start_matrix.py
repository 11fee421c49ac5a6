"""Result tables of the start matrix and its ledger, and where each column comes from."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.charts import Axis, ChartSpec, Series
from addin.contract.field import TableSpec, integer, number, table, text
from addin.contract.result_tables import Trace

__all__ = ["STARTS_RESULT_TABLES", "STARTS_TRACES"]

_MATRIX, _LEDGER = "Start matrix", "Damage ledger"

STARTS_RESULT_TABLES: tuple[TableSpec, ...] = (
    table(
        "StartsByVoltage",
        _MATRIX,
        1,
        "Whole starts with the damping of the case, by voltage; blank = none, unlimited or not judged.",
        number("Voltage", "fraction", "Of the voltage of the torque curves."),
        number("Loaded stress", "pressure", "Nominal, peak to peak, of the governing shaft."),
        number("Loaded starts", "count", "Allowable starts of this kind alone."),
        number("Unloaded stress", "pressure", "The same without load torque."),
        number("Unloaded starts", "count", "The same without load torque."),
    ),
    table(
        "StartMatrix",
        _MATRIX,
        1,
        "Each kind of start as a run of its own, with effects planned anew.",
        text("Condition", "Kind of start, of table StartConditions or of the standard matrix."),
        number("Voltage", "fraction", "Of the voltage of the torque curves."),
        number("Damping ratio", "fraction", "Of all elastic modes; blank = as in the case."),
        number("Load", "fraction", "Share of LoadTorque that acts."),
        number("Trip speed", "speed", "Where it is aborted; blank = it is not."),
        text("Outcome", "How it ends."),
        number("Time", "time", "Simulated time; of an aborted start with the coast-down."),
        number("Percent speed", "speed fraction", "Speed at the end, of synchronous."),
        number(
            "Peak over rated", "ratio", "Largest torque, referred to the motor, over RatedTorque."
        ),
        text("Peak element", "Where that torque is.", kind="element"),
        text("Governing", "Judged shaft with the most damage.", kind="element"),
        number("Peak-to-peak stress", "pressure", "Nominal, without SCF, of the governing shaft."),
        number("Mesh minimum torque", "torque", "Least torque of any gear mesh.", us="lbf*ft"),
        integer("Impacts", "How often teeth meet again; blank where no clearance is modelled."),
        number("Damage", "count", "Of one such start, on the governing shaft."),
        number("Allowable starts", "count", "Of this kind alone, 1 / damage."),
        text("Note", "What a reader must know."),
        json_only=("unlimited", "judged"),
    ),
    table(
        "DamageLedger",
        _LEDGER,
        1,
        "What the duty of sheet Duty has used of each judged shaft, and leaves.",
        text("Element", "The shaft.", kind="element"),
        text("Governing", "Kind of start that takes most of it."),
        number("Allowed", "count", "1 / StartsFactor."),
        number("Used", "count", "Damage so far."),
        number("Yearly", "count", "Damage a year."),
        number("Left", "count", "Allowed less used."),
        number("Remaining years", "count", "Left / yearly."),
        number("Years low", "count", "The same at the worse end of the error of the damages."),
        number("Years high", "count", "At the better end; blank = unlimited."),
        text("Verdict", "pass while something is left, fail, or not judged."),
        text("Reason", "Why, with the numbers."),
        json_only=("used_low", "used_high", "yearly_low", "yearly_high", "unlimited"),
    ),
    table(
        "RemainingStarts",
        _LEDGER,
        1,
        "Each kind of start on each judged shaft: what one takes, and how many of it alone are left.",
        text("Element", "The shaft.", kind="element"),
        text("Condition", "Kind of start."),
        number("So far", "count", "Such starts the train has seen."),
        number("Per year", "count", "Such starts a year."),
        number("Share", "fraction", "Of the damage a year."),
        number("Peak-to-peak stress", "pressure", "Nominal, without SCF, in one such start."),
        number("Damage", "count", "Of one such start."),
        number("Damage low", "count", "At the lower end of its error."),
        number("Damage high", "count", "At the upper end of its error."),
        number("Remaining starts", "count", "Left / damage, of this kind alone."),
        text("Reason", "Why there is none."),
        json_only=("unlimited", "judged"),
    ),
)

_NAME, _METHOD = "Name, as typed", "docs/start-matrix.md"
_MINER = "Szenasi & von Nimitz 1978, Stress criterion, Figure 3; Miner, J. Applied Mechanics 12 (1945) A-159"
_RUN = "The run of the case with this voltage, damping, load and trip speed; docs/start-matrix.md"
_ROW = (
    "StartConditions.Voltage",
    "StartConditions.Damping ratio",
    "StartConditions.Load",
    "StartConditions.Trip speed",
)
_CASE = ("MotorTorque.Average", "MotorTorque.Pulsating", "LoadTorque.Torque", "Stations.Inertia",
         "Elements.Stiffness", "DampingRatio", "ModeDamping.Damping ratio")  # fmt: skip
_STRESS = (*_CASE, "Elements.Stress diameter", "Elements.Stress bore")
_FATIGUE = (*_STRESS, "Elements.SCF", "SNPoints.Cycles", "SNPoints.Stress", "Materials.Endurance")
_DUTY = ("StartConditions.So far", "StartConditions.Per year")


def _run(equation: str, of_case: tuple[str, ...] = _CASE) -> Trace:
    return Trace(equation, _RUN, _ROW, of_case)


def _asked(column: str, rule: str) -> Trace:
    return Trace(rule, _METHOD, (f"StartConditions.{column}",))


_STRESS_EQUATION = "τ = 16 ΔT D/(π(D⁴ − d⁴)), ΔT from rest to the end of this kind of start"
_STARTS_EQUATION = "1/q; unlimited where q = 0, not judged where the start does not come to its end"

STARTS_TRACES: Mapping[tuple[str, str], Trace] = {
    ("StartsByVoltage", "Voltage"): _asked("Voltage", "V/V of the torque curves"),
    ("StartsByVoltage", "Loaded stress"): _run(_STRESS_EQUATION, _STRESS),
    ("StartsByVoltage", "Loaded starts"): Trace(_STARTS_EQUATION, _MINER, _ROW, _FATIGUE),
    ("StartsByVoltage", "Unloaded stress"): _run(_STRESS_EQUATION, _STRESS),
    ("StartsByVoltage", "Unloaded starts"): Trace(_STARTS_EQUATION, _MINER, _ROW, _FATIGUE),
    ("StartMatrix", "Condition"): _asked("Condition", _NAME),
    ("StartMatrix", "Voltage"): _asked("Voltage", "Motor torques × (V/V of the torque curves)²"),
    ("StartMatrix", "Damping ratio"): _asked(
        "Damping ratio", "In place of DampingRatio; ModeDamping in the same proportion"
    ),
    ("StartMatrix", "Load"): _asked("Load", "LoadTorque × share"),
    ("StartMatrix", "Trip speed"): _asked(
        "Trip speed", "The motor is switched off there, and the train coasts down"
    ),
    ("StartMatrix", "Outcome"): _run("How the run ended"),
    ("StartMatrix", "Time"): _run("Time of the run, with the coast-down of an aborted start"),
    ("StartMatrix", "Percent speed"): _run("100 n/n_synchronous at the end of the run"),
    ("StartMatrix", "Peak over rated"): _run(
        "max |T| × speed ratio / RatedTorque over all elements", (*_CASE, "RatedTorque")
    ),
    ("StartMatrix", "Peak element"): _run("Where that is"),
    ("StartMatrix", "Governing"): _run("Shaft with the largest q, else the largest stress", _FATIGUE),
    ("StartMatrix", "Peak-to-peak stress"): _run(_STRESS_EQUATION, _STRESS),
    ("StartMatrix", "Mesh minimum torque"): _run("min T over all meshes, on the From side"),
    ("StartMatrix", "Impacts"): _run("Recontacts of all clearances that are modelled"),
    ("StartMatrix", "Damage"): Trace("q = Σ n/N of one such start", _MINER, _ROW, _FATIGUE),
    ("StartMatrix", "Allowable starts"): Trace(
        _STARTS_EQUATION, _MINER, ("StartMatrix.Damage", *_ROW), _FATIGUE
    ),
    ("StartMatrix", "Note"): _run("What was found, in words"),
    ("DamageLedger", "Element"): Trace(_NAME, _METHOD, ("Elements.Element",)),
    ("DamageLedger", "Governing"): Trace(
        "Largest per year × q, else largest so far × q", _METHOD, (), _DUTY
    ),
    ("DamageLedger", "Allowed"): Trace("1/StartsFactor", _METHOD, (), ("StartsFactor",)),
    ("DamageLedger", "Used"): Trace(
        "Σ so far × q over all kinds of starts", _MINER, (), ("StartConditions.So far", *_FATIGUE)
    ),
    ("DamageLedger", "Yearly"): Trace(
        "Σ per year × q over all kinds of starts", _MINER, (),
        ("StartConditions.Per year", *_FATIGUE),
    ),
    ("DamageLedger", "Left"): Trace(
        "1/StartsFactor − used", _METHOD, ("DamageLedger.Used", "DamageLedger.Allowed")
    ),
    ("DamageLedger", "Remaining years"): Trace(
        "(1/StartsFactor − used)/yearly; 0 where nothing is left", _METHOD,
        ("DamageLedger.Left", "DamageLedger.Yearly"),
    ),
    ("DamageLedger", "Years low"): Trace(
        "The same with every damage at the upper end of its error", _METHOD, (), _DUTY
    ),
    ("DamageLedger", "Years high"): Trace(
        "The same with every damage at the lower end of its error", _METHOD, (), _DUTY
    ),
    ("DamageLedger", "Verdict"): Trace(
        "pass if used < 1/StartsFactor", _METHOD, ("DamageLedger.Used", "DamageLedger.Allowed")
    ),
    ("DamageLedger", "Reason"): Trace("The verdict in words", _METHOD, (), _DUTY),
    ("RemainingStarts", "Element"): Trace(_NAME, _METHOD, ("Elements.Element",)),
    ("RemainingStarts", "Condition"): _asked("Condition", _NAME),
    ("RemainingStarts", "So far"): _asked("So far", "As typed; blank = 0"),
    ("RemainingStarts", "Per year"): _asked("Per year", "As typed; blank = 0"),
    ("RemainingStarts", "Share"): Trace(
        "Per year × q over Σ per year × q", _METHOD, ("StartConditions.Per year",),
        ("DamageLedger.Yearly",),
    ),
    ("RemainingStarts", "Peak-to-peak stress"): _run(_STRESS_EQUATION, _STRESS),
    ("RemainingStarts", "Damage"): Trace("q = Σ n/N of one such start", _MINER, _ROW, _FATIGUE),
    ("RemainingStarts", "Damage low"): Trace(
        "q with every stress amplitude less its error, or q less its change between two steps",
        "docs/method.md, Fatigue", _ROW, _FATIGUE,
    ),
    ("RemainingStarts", "Damage high"): Trace(
        "q with every stress amplitude plus its error, or q plus its change between two steps",
        "docs/method.md, Fatigue", _ROW, _FATIGUE,
    ),
    ("RemainingStarts", "Remaining starts"): Trace(
        "(1/StartsFactor − used)/q, of this kind alone", _METHOD, ("RemainingStarts.Damage",),
        ("DamageLedger.Left",),
    ),
    ("RemainingStarts", "Reason"): Trace("Why there is no number", _METHOD, _ROW),
}  # fmt: skip


_VOLTAGE = Axis("Voltage [% of that of the curves]", number="0", crossing="min")


def _by_voltage(quantity: str) -> tuple[Series, ...]:
    """Loaded and unloaded starts against voltage."""
    return tuple(
        Series("StartsByVoltage", "Voltage", f"{load} {quantity}", load, colour, 2.0, marker="circle", size=7)
        for load, colour in (("Loaded", "navy"), ("Unloaded", "teal"))
    )  # fmt: skip


CHARTS = (
    ChartSpec(
        "starts-voltage", "marked curves", "Allowable starts of each kind alone",
        _VOLTAGE, Axis("Allowable starts", log=True, number="#,##0", crossing="min"),
        _by_voltage("starts"), legend=True,
    ),
    ChartSpec(
        "stress-voltage", "marked curves", "Peak-to-peak stress of the governing shaft (nominal)",
        _VOLTAGE, Axis("Stress, in the unit of table By voltage", least=0, number="#,##0"),
        _by_voltage("stress"), legend=True,
    ),
)  # fmt: skip
