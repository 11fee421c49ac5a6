"""The start matrix and its damage ledger in workbook and JSON."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.charts import Axis, ChartSpec, Series
from addin.contract.field import (
    JUDGED,
    UNLIMITED,
    TableSpec,
    Trace,
    integer,
    number,
    sentence,
    table,
    text,
    verdict,
)
from addin.contract.json_shapes import FLAG, NUMBER, TEXT, Shape, cut_short, described
from addin.contract.sheet import ChartAt, Sheet
from addin.contract.study_spec import StudySpec

_NAME, _METHOD = "Name, as typed", "docs/start-matrix.md"
_MINER = "Szenasi & von Nimitz 1978, Stress criterion, Figure 3; Miner, J. Applied Mechanics 12 (1945) A-159"
_RUN = "The run of the case with this voltage, damping, load and trip speed; docs/start-matrix.md"
_ROW = (
    "StartConditions.Voltage",
    "StartConditions.Damping ratio",
    "StartConditions.Stiffness factor",
    "StartConditions.Load",
    "StartConditions.Trip speed",
)
_CASE = ("MotorTorque.Average", "MotorTorque.Pulsating", "LoadTorque.Torque", "Stations.Inertia",
         "Elements.Stiffness", "DampingRatio", "ModeDamping.Damping ratio")  # fmt: skip
_STRESS = (*_CASE, "Elements.Stress diameter", "Elements.Stress bore")
_FATIGUE = (*_STRESS, "Elements.SCF", "SNPoints.Cycles", "SNPoints.Stress", "Materials.Endurance")
_DUTY = ("StartConditions.So far", "StartConditions.Per year")
_PER_LIFE = ("EventTorque.Per life", "MotorEvents.Per life")


def _run(equation: str, of_case: tuple[str, ...] = _CASE) -> Trace:
    return Trace(equation, _RUN, _ROW, of_case)


def _asked(column: str, rule: str) -> Trace:
    return Trace(rule, _METHOD, (f"StartConditions.{column}",))


_STRESS_EQUATION = "τ = 16 ΔT D/(π(D⁴ − d⁴)), ΔT from rest to the end of this start"
_STARTS_EQUATION = "1/q; unlimited where q = 0, not judged where the start is not completed"

_RESULTS: tuple[TableSpec, ...] = (
    table(
        "StartsByVoltage", sheet="Start matrix", caption="By voltage",
        help="Stress and allowable starts by voltage, of starts that are not aborted and have the "
        "damping of the case; blank = none, unlimited or not judged.",
        short_caption=True, room=14,
        columns=(
            number(
                "Voltage", "fraction", "Voltage as a share of that of the torque curves.",
                trace=_asked("Voltage", "Voltage / voltage of the torque curves"),
            ),
            number(
                "Loaded stress", "pressure", "Nominal, peak to peak, of the governing shaft.",
                trace=_run(_STRESS_EQUATION, _STRESS),
            ),
            number(
                "Loaded starts", "count", "Allowable starts if only this condition occurs.",
                _STARTS_EQUATION,
                _MINER, of_row=_ROW, of_case=_FATIGUE, format=shown.STARTS,
            ),
            number(
                "Unloaded stress", "pressure", "The same stress without load torque.",
                trace=_run(_STRESS_EQUATION, _STRESS),
            ),
            number(
                "Unloaded starts", "count", "Allowable starts without load torque.", _STARTS_EQUATION,
                _MINER, of_row=_ROW, of_case=_FATIGUE, format=shown.STARTS,
            ),
        ),
    ),
    table(
        "StartMatrix", sheet="Start matrix", caption="Start matrix",
        help="Each start condition calculated separately, with its own plan of effects.",
        row_name=("Condition",), changes_shown=("Outcome", "Allowable starts"),
        json_only=(UNLIMITED, JUDGED),
        columns=(
            text(
                "Condition", "Start condition, of table StartConditions or of the standard matrix.",
                trace=_asked("Condition", _NAME),
            ),
            number(
                "Voltage", "fraction", "Voltage as a share of that of the torque curves.",
                trace=_asked("Voltage", "Motor torques × (voltage / voltage of the torque curves)²"),
            ),
            number(
                "Damping ratio", "fraction", "Of all elastic modes; blank = as in the case.",
                trace=_asked(
                    "Damping ratio", "In place of DampingRatio; ModeDamping in the same proportion",
                ),
            ),
            number(
                "Load", "fraction", "Share of LoadTorque that acts.",
                trace=_asked("Load", "LoadTorque × share"),
            ),
            number(
                "Trip speed", "speed", "Speed at which the start is aborted; blank = not aborted.",
                trace=_asked(
                    "Trip speed", "The motor is switched off there, and the train coasts down",
                ),
            ),
            text("Outcome", "Outcome of the start.", trace=_run("How the run ended")),
            number(
                "Time", "time", "Simulated time, including the coast-down of an aborted start.",
                trace=_run("Time of the run, with the coast-down of an aborted start"),
            ),
            number(
                "Percent speed", "speed fraction", "Speed at the end, as a share of synchronous speed.",
                trace=_run("100 n/n_synchronous at the end of the run"), format=shown.TWO_DECIMALS,
                printed="Speed",
            ),
            number(
                "Peak over rated", "ratio",
                "Largest torque, referred to the motor, divided by RatedTorque.",
                trace=_run(
                    "max |T| × speed ratio / RatedTorque over all elements",
                    (*_CASE, "RatedTorque"),
                ),
            ),
            text(
                "Peak element", "Element with that torque.", kind="element",
                trace=_run("Element with that torque"),
            ),
            text(
                "Governing", "Judged shaft with the largest damage.", kind="element",
                trace=_run("Shaft with the largest q, else the largest stress", _FATIGUE),
            ),
            number(
                "Peak-to-peak stress", "pressure",
                "Peak-to-peak stress of the governing shaft, nominal, without SCF.",
                trace=_run(_STRESS_EQUATION, _STRESS), printed="Stress, pk‑pk",
            ),
            number(
                "Mesh minimum torque", "torque", "Least torque of any gear mesh.", us="lbf*ft",
                trace=_run("min T over all meshes, on the From side"), format=shown.SIGNED,
            ),
            integer(
                "Impacts",
                "Number of re-engagements of the teeth; blank where no clearance is modelled.",
                trace=_run("Re-engagements, sum over all elements with a modelled clearance"),
            ),
            number(
                "Damage", "count", "Damage of one such start on the governing shaft.",
                "q = Σ n/N of one such start", _MINER, of_row=_ROW, of_case=_FATIGUE, format=shown.DAMAGE,
            ),
            number(
                "Allowable starts", "count", "1 / damage, if only this condition occurs.",
                _STARTS_EQUATION,
                _MINER, of_row=("StartMatrix.Damage", *_ROW), of_case=_FATIGUE, format=shown.STARTS,
                unlimited=True,
            ),
            sentence(
                "Note", "Notes.", trace=_run("Summary of the result"),
                width=56.0,
            ),
        ),
    ),
    table(
        "DamageLedger", sheet="Damage ledger", caption="Damage ledger",
        help="Life used and life left of each judged shaft, for the duty in table StartConditions.",
        row_name=("Element",), changes_shown=("Used", "Remaining years", "Verdict"), room=8,
        json_only=(
            number("used_low", "count", "Damage so far, at the lower end of its error."),
            number("used_high", "count", "Damage so far, at the upper end of its error."),
            number("yearly_low", "count", "Damage per year, at the lower end of its error."),
            number("yearly_high", "count", "Damage per year, at the upper end of its error."),
            number("events_low", "count", "Damage of events, at the lower end of its error."),
            number("events_high", "count", "Damage of events, at the upper end of its error."),
            UNLIMITED,
        ),
        columns=(
            text(
                "Element", "The shaft.", _NAME, _METHOD, kind="element",
                of_row=("Elements.Element",),
            ),
            text(
                "Governing", "Start condition that causes most of the damage.",
                "Largest per year × q, else largest so far × q", _METHOD, of_case=_DUTY,
            ),
            number(
                "Allowed", "count", "1 / StartsFactor.", "1/StartsFactor", _METHOD,
                of_case=("StartsFactor",), format=shown.FOUR_DECIMALS,
            ),
            number(
                "Used", "count", "Damage so far.", "Σ so far × q over all start conditions", _MINER,
                of_case=("StartConditions.So far", *_FATIGUE), format=shown.USED,
            ),
            number(
                "Yearly", "count", "Damage per year.", "Σ per year × q over all start conditions",
                _MINER, of_case=("StartConditions.Per year", *_FATIGUE), format=shown.USED,
            ),
            number(
                "Events", "count", "Damage of all events in a life.", "Σ Per life × q over the events that have it",
                _MINER, of_case=(*_PER_LIFE, *_FATIGUE), format=shown.USED,
            ),
            number(
                "Left", "count", "Allowed damage 1/StartsFactor minus damage so far and of events.",
                "1/StartsFactor − used − events", _METHOD,
                of_row=("DamageLedger.Used", "DamageLedger.Events", "DamageLedger.Allowed"),
                format=shown.FOUR_DECIMALS,
            ),
            number(
                "Remaining years", "count", "Left / yearly.",
                "(1/StartsFactor − used − events)/yearly; 0 where nothing is left", _METHOD,
                of_row=("DamageLedger.Left", "DamageLedger.Yearly"), format=shown.YEARS, unlimited=True,
            ),
            number(
                "Years low", "count", "Years left with all damages at the upper end of their error.",
                "The same with every damage at the upper end of its error", _METHOD, of_case=_DUTY,
                format=shown.YEARS,
            ),
            number(
                "Years high", "count",
                "Years left with all damages at the lower end of their error; blank = unlimited.",
                "The same with every damage at the lower end of its error", _METHOD, of_case=_DUTY,
                format=shown.YEARS,
            ),
            verdict(
                "Verdict", "pass while life is left; fail; or not judged.",
                "pass if used + events < 1/StartsFactor", _METHOD,
                of_row=("DamageLedger.Used", "DamageLedger.Events", "DamageLedger.Allowed"),
            ),
            sentence(
                "Reason", "Reason, with the numbers.", "The verdict in words", _METHOD, of_case=_DUTY,
                width=32.0,
            ),
        ),
    ),
    table(
        "RemainingStarts", sheet="Damage ledger", caption="Remaining starts",
        help="Each start condition on each judged shaft: damage of one start, and starts left if "
        "only this condition occurs.",
        row_name=("Element", "Condition"),
        json_only=(UNLIMITED, JUDGED),
        columns=(
            text(
                "Element", "The shaft.", _NAME, _METHOD, kind="element",
                of_row=("Elements.Element",),
            ),
            text("Condition", "Start condition.", trace=_asked("Condition", _NAME)),
            number(
                "So far", "count", "Starts so far under this condition.",
                trace=_asked("So far", "As typed; blank = 0"), format=shown.AS_TYPED,
            ),
            number(
                "Per year", "count", "Starts per year under this condition.",
                trace=_asked("Per year", "As typed; blank = 0"), format=shown.AS_TYPED,
            ),
            number(
                "Per life", "count", "Such events in the life of the train.", "As typed; blank = 0", _METHOD,
                of_case=_PER_LIFE, format=shown.AS_TYPED,
            ),
            number(
                "Share", "fraction", "Share of the damage per year.",
                "Per year × q over Σ per year × q",
                _METHOD, of_row=("StartConditions.Per year",), of_case=("DamageLedger.Yearly",),
                format=shown.ONE_DECIMAL,
            ),
            number(
                "Peak-to-peak stress", "pressure", "Nominal, without SCF, in one such start.",
                trace=_run(_STRESS_EQUATION, _STRESS), printed="Stress, pk‑pk",
            ),
            number(
                "Damage", "count", "Damage of one such start.", "q = Σ n/N of one such start", _MINER,
                of_row=_ROW, of_case=_FATIGUE, format=shown.DAMAGE,
            ),
            number(
                "Damage low", "count", "Damage at the lower end of its error.",
                "q with every stress amplitude minus its error, or q minus its change between two steps",
                "docs/method.md, Fatigue", of_row=_ROW, of_case=_FATIGUE, format=shown.DAMAGE,
            ),
            number(
                "Damage high", "count", "Damage at the upper end of its error.",
                "q with every stress amplitude plus its error, or q plus its change between two steps",
                "docs/method.md, Fatigue", of_row=_ROW, of_case=_FATIGUE, format=shown.DAMAGE,
            ),
            number(
                "Remaining starts", "count",
                "Allowed damage not yet used / damage of one start, if only this condition occurs.",
                "(1/StartsFactor − used − events)/q, of this start condition alone", _METHOD,
                of_row=("RemainingStarts.Damage",), of_case=("DamageLedger.Left",), format=shown.STARTS,
                unlimited=True,
            ),
            sentence(
                "Reason", "Reason why there is no number.", "Why there is no number", _METHOD,
                of_row=_ROW,
                width=32.0,
            ),
        ),
    ),
)  # fmt: skip

_BY_VOLTAGE, _MATRIX, _LEDGER, _REMAINING = _RESULTS

_CHART_ROWS = 17

_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Start matrix",
        "result",
        {"A": 1.5, "B": 30, "C:E": 9.5, "F": 10, "G": 26, "H:J": 9.5, "K:L": 18, "M:Q": 11.5,
         "R": 56},
        {"StartsByVoltage": "M7", "StartMatrix": f"B{8 + _CHART_ROWS}"},
        (
            ChartAt("starts-voltage", "C7", 460, 300),
            ChartAt("stress-voltage", "H7", 470, 300),
        ),
        breaks=("M",),
        repeated="B:B",
        intro="Each start condition, calculated separately: torsionbook starts FILE. A start that "
        "is not completed is not judged.",
    ),
    Sheet(
        "Damage ledger",
        "result",
        {"A": 1.5, "B": 20, "C": 26, "D:K": 10, "L": 10, "M": 32},
        {"DamageLedger": "B7", "RemainingStarts": f"B{_LEDGER.below(7)}"},
        intro="Life used of each judged shaft by the duty in table StartConditions: Palmgren-Miner, order of "
        "starts ignored; life ends at damage 1/StartsFactor.",
    ),
)  # fmt: skip

_VOLTAGE = Axis("Voltage [% of the voltage of the torque curves]", number="0", crossing="min")


def _by_voltage(quantity: str) -> tuple[Series, ...]:
    """Loaded and unloaded starts against voltage."""
    return tuple(
        Series("StartsByVoltage", "Voltage", f"{load} {quantity}", load, colour, 2.0, marker="circle", size=7)
        for load, colour in (("Loaded", "navy"), ("Unloaded", "teal"))
    )  # fmt: skip


_CHARTS: tuple[ChartSpec, ...] = (
    ChartSpec(
        "starts-voltage", "marked curves", "Allowable starts if only this condition occurs",
        _VOLTAGE, Axis("Allowable starts", log=True, number="#,##0", crossing="min"),
        _by_voltage("starts"), legend=True,
    ),
    ChartSpec(
        "stress-voltage", "marked curves", "Peak-to-peak stress of the governing shaft (nominal)",
        _VOLTAGE, Axis("Stress, in the unit of table By voltage", least=0, number="#,##0"),
        _by_voltage("stress"), legend=True,
    ),
)  # fmt: skip


#: What its JSON has beside its tables.
_DETAILS: Shape = {
    **cut_short(
        "Number of starts calculated; an aborted start of the standard matrix counts as "
        "eight (trip instants)."
    ),
    "standard": described("Whether the standard matrix is included.", FLAG),
    "starts_factor": NUMBER,
    "assumption": described("The rule behind the ledger.", TEXT),
    "verdict": described("Worst verdict of the ledger.", TEXT),
}

STARTS = StudySpec(
    key="starts",
    order=4,
    command="starts",
    sheet="Start matrix",
    inputs=(),
    results=_RESULTS,
    sheets=_SHEETS,
    details=_DETAILS,
    charts=_CHARTS,
    height=70.0,
)
