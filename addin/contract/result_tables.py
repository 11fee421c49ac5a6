"""Result tables of a calculation: each column with its unit, its source, and how workbook, verify, diff and report treat it.

A new column is the field of the engine's record, the key in `engine.results.tables`, and its line here;
``make generated`` rewrites what is derived.
"""

from __future__ import annotations

from dataclasses import replace

from addin.contract import live_formulas as live
from addin.contract import number_formats as shown
from addin.contract.field import (
    UNLIMITED,
    Field,
    Pane,
    ReportedError,
    TableSpec,
    flag,
    integer,
    mixed,
    number,
    sentence,
    switch,
    table,
    text,
    verdict,
)
from addin.contract.sources import (
    AIR_GAP,
    ASTM,
    CLEARANCE,
    CLEARANCES,
    CRITERION,
    CURVES,
    CURVES_FROM_DATA,
    DAMPING,
    EQUATION_OF_MOTION,
    EVENT,
    EVENT_METHOD,
    EVENT_RESPONSE,
    EXCITATION,
    EXPONENTIAL,
    FATIGUE,
    FIGURE_3,
    LABEL,
    LINE,
    MAKERS,
    MEASURED_TIMES,
    MIL,
    MODAL,
    MODAL_ELECTRICAL,
    MOTOR_DATA,
    NOTCH,
    NOTCHES,
    OF_SECTION,
    ONE_WAY,
    PAPER,
    PEAK,
    PHILOSOPHY,
    RAINFLOW,
    REVERSALS,
    SAFETY,
    SECTION,
    SHIGLEY,
    SLIP,
    SPEEDS,
    START,
    STEADY,
    STEPPED_SHAFTS,
    STRENGTH,
    STRENGTH_FACTORS,
    STRESS,
    SUPPLY,
    SVD,
    TRANSIENT,
    named,
)
from engine.case.effects import EFFECTS

#: Modes whose energy shares sheet `Frequencies` shows; sheet `Frequency sensitivities` has more.
SHARE_MODES = 5
#: What an element is judged by in one check or another.
LIMITS = (
    "Elements.Stress diameter", "Elements.Material", "Elements.Peak torque limit", "Elements.Reversal limit",
    "Elements.Vibratory limit", "Materials.UTS", "Materials.Yield", "SNPoints.Stress", "StartsRequired",
)  # fmt: skip
#: Rows kept free for the crossings of the start; what stands below them begins there.
CROSSING_ROWS = 8
_RATIO = ("Elements.From", "Elements.To", "Stations.Speed ratio")
_SCAN_METHOD = "docs/method.md, Events of a motor"


def _worst_instant(largest: str, suffix: str = "") -> tuple[Field, ...]:
    """Of an event whose phase, angle or clearing time is ``worst``, where it was found."""
    return tuple(
        number(
            f"{name}{suffix}", dimension, f"{column} with the largest {largest} of this row, where {column} is worst.",
            f"largest of all {column} of the scan, then of those beside it, ever nearer", _SCAN_METHOD,
            of_case=of_case, pane=Pane.MINOR, error=ReportedError.ESTIMATE,
        )
        for name, dimension, column, of_case in (
            ("Worst phase", "angle", "Phase", ("MotorEvents.Phase",)),
            ("Worst angle", "angle", "Angle", ("MotorEvents.Angle",)),
            (
                "Worst clearing time", "time", "Clears after",
                ("MotorEvents.Clears after", "MotorEvents.Earliest clearing", "MotorEvents.Latest clearing"),
            ),
            ("Worst pulsation phase", "angle", "PulsationPhase", ("PulsationPhase", "MotorEvents.Begins")),
        )
    )  # fmt: skip


#: A number that is judged is in the unit of its own dimension.
_JUDGED_IN = text(
    "dimension", "Dimension of result and limit, which are in the SI unit of that dimension."
)


def _checks(name: str) -> tuple[Field, ...]:
    """The columns of a table whose rows are checks."""
    return (
        text("Check", "What is judged.", "Name of the check", "docs/method.md"),
        mixed(
            "Result", "Result of the check.",
            "The governing number: least margin, largest stress / its allowable, least torque / its "
            "limit, fewest starts (rounded down to whole starts)",
            "docs/method.md; the source of the result table it is taken from",
            of_case=(
                "SeparationMargins.Margin", "SteadyState.Peak-to-peak stress",
                "SteadyState.Zero-to-peak stress", "StartupPeaks.Maximum torque",
                "TorqueReversals.Minimum torque", "AllowableStarts.Allowable starts",
                "StartsFactor",
            ),
            error=ReportedError.WORDS,
        ),
        mixed(
            "Limit", "Limit of the check.",
            "Required margin; UTS/25; limits of the maker; StartsRequired",
            f"{STEADY}; {MIL}; table Elements",
            of_case=(
                "SeparationMargins.Required", "SteadyState.Allowable",
                "Elements.Peak torque limit", "Elements.Reversal limit", "Materials.Yield",
                "StartsRequired",
            ),
        ),
        verdict(
            "Verdict", "fail, incomplete, pass within its error, accepted by forced response, or pass.",
            "pass where the result meets the limit; pass within its error where by less than its error; "
            "accepted by forced response as in SeparationMargins; incomplete where a part is not judged; fail; "
            "not judged without a limit. Overall = the worst",
            f"{STEADY} (a forced vibration analysis where the margin cannot be attained)",
            of_row=(f"{name}.Result", f"{name}.Limit"),
        ),
        sentence(
            "Where", "Mode, element or speed that governs.",
            "Mode, element or speed of the governing number", "docs/method.md",
            of_row=(f"{name}.Result",), width=32.0,
        ),
        sentence(
            "Coverage", "How much of the train is judged.",
            "Elements with a limit for this check, of all that the check is for; modes and excitations of a "
            "margin; crossings of a start",
            "docs/method.md", of_case=("Elements.Kind", *LIMITS), width=14.0,
        ),
        sentence(
            "Not judged", "What is not judged, and the peak torque of each element over the rated torque.",
            "Elements without a limit for this check; the input that is missing",
            "docs/method.md", of_case=("Elements.Kind", *LIMITS), width=20.0,
        ),
        number(
            "Safety factor", "count",  # no unit, which would take a row of sheet Summary
            "Limit over result, of allowable starts result over limit; blank: not judged, no reversal, or a margin.",
            "Limit / result; allowable starts / StartsRequired", SAFETY,
            of_row=(f"{name}.Result", f"{name}.Limit"), format=shown.TWO_DECIMALS, error=ReportedError.WORDS,
        ),
    )  # fmt: skip


_CONDITIONS = "docs/start-matrix.md, Several cases"
#: What a condition changes of the case.
_CHANGED = tuple(
    f"StartConditions.{column}"
    for column in (
        "Kind",
        "Voltage",
        "Damping ratio",
        "Stiffness factor",
        "Load",
        "Trip speed",
        "Event",
    )
)


def _on_one_line(field: Field) -> Field:
    """A column whose words do not wrap: rows of other parts of the sheet stay as low as they are."""
    return replace(field, width=0.0) if field.kind == "sentence" else field


def _of_checks(name: str, help: str) -> Field:
    """The worst verdict of some checks of a condition."""
    return verdict(
        name, help, "The worst of the checks", _CONDITIONS, of_row=("CaseVerdicts.Verdict",),
    )  # fmt: skip


#: Result tables of workbook and JSON.
RESULT_TABLES: tuple[TableSpec, ...] = (
    table(
        "Verdicts", sheet="Summary", caption="Verdicts",
        help="Each check with its limit and verdict.",
        row_name=("Check",), rank=0, room=12, json_only=(_JUDGED_IN,), columns=_checks("Verdicts"),
    ),
    table(
        "CaseMatrix", sheet="Summary", caption="Other conditions",
        help="The worst verdict of each kind of check under every condition of table StartConditions.",
        row_name=("Condition",), changes_shown=("Verdict",), rank=0, later=True,
        columns=(
            text(
                "Condition", "The condition.", "Name, as typed", _CONDITIONS, of_row=("StartConditions.Condition",),
                width=24.0,
            ),
            _of_checks("Margin", "Separation margin."),
            _of_checks("Response", "Forced response in continuous operation."),
            _of_checks("Verdict", "All its checks."),
            sentence(
                "Where", "Checks that decide.", "Checks with the worst verdict",
                _CONDITIONS, of_row=("CaseVerdicts.Check",), width=32.0,
            ),
            _of_checks(
                "Start", "Outcome, torques, torque reversal and allowable starts of the start or the event.",
            ),
            sentence(
                "Changed", "What differs from the case.", "The row of the condition, in words", _CONDITIONS,
                of_row=_CHANGED, width=20.0,
            ),
        ),
    ),
    table(
        "CaseVerdicts", sheet="Case", caption="Verdicts of each condition",
        help="Every check of the case under every condition of table StartConditions.",
        row_name=("Condition", "Check"), rank=0, later=True, json_only=(_JUDGED_IN,),
        columns=(
            text(
                "Condition", "The condition.", "Name, as typed", _CONDITIONS, of_row=("StartConditions.Condition",),
                of_case=_CHANGED, width=24.0,
            ),
            *map(_on_one_line, _checks("CaseVerdicts")),
        ),
    ),
    table(
        "StandardRequirements", sheet="Effects and accuracy", caption="What the standard asks for",
        help="Margins and analyses that scalar Standard asks for, each with its source and the checks that show it.",
        row_name=("Requirement",), rank=9, room=8, later=True,
        columns=(
            text(
                "Requirement", "Margin or analysis that is asked for.", "Profile of Standard; no rows where that is blank",
                "docs/method.md, Standards", of_case=("Standard",), width=24.0,
            ),
            sentence(
                "Demand", "What is asked.", "Profile of Standard", "docs/method.md, Standards",
                of_case=("Standard",), width=40.0,
            ),
            sentence(
                "Source", "Who asks for it.", "Profile of Standard", "docs/method.md, Standards",
                of_case=("Standard",), width=34.0,
            ),
            flag(
                "Text read", "Whether the text of the source itself was read; no = as others quote it.",
                "yes for the paper; no for standards whose text was not at hand", "docs/method.md, Standards",
                of_case=("Standard",),
            ),
            sentence(
                "Shown by", "Checks of table Verdicts that show it.", "Checks of its kind",
                "docs/method.md, Standards", of_row=("Verdicts.Check",), width=26.0,
            ),
            verdict(
                "Verdict", "The worst verdict of these checks; not judged where there is none.",
                "The worst verdict of the checks that show it; not judged without any", "docs/method.md, Standards",
                of_row=("Verdicts.Verdict",),
            ),
            sentence(
                "Missing", "What is asked for and not calculated.",
                "Start or short circuit that the inputs do not have", "docs/method.md, Standards",
                of_case=("MotorEvents.Kind", "EventTorque.Event"), width=36.0,
            ),
        ),
    ),
    table(
        "NaturalFrequencies", sheet="Results", caption="Natural frequencies",
        help="Undamped natural frequencies; rigid-body modes first, with frequency 0.",
        row_name=("Mode",), changes_shown=("Frequency", "Largest strain energy"), rank=1,
        columns=(
            integer(
                "Mode", "Elastic modes are counted from 1; rigid-body modes have 0.",
                "Numbered by rising frequency; rigid-body modes, whose count follows from the "
                "topology, have 0",
                SVD, of_case=MODAL,
            ),
            number(
                "Frequency", "frequency", "Natural frequency.",
                "f = ω/2π, ω the singular values of √k · B / √J; B the incidence matrix with speed ratios, "
                "k = G π (D⁴ − d⁴) / 32 L where it is blank",
                f"{STEADY} (eigenvalue solution); {SVD}; {STRENGTH}", of_case=MODAL,
                error=ReportedError.FREQUENCIES,
            ),
            number(
                "CPM", "cycles per minute", "Natural frequency in cycles per minute.", "60 f",
                LABEL, of_row=("NaturalFrequencies.Frequency",), error=ReportedError.FREQUENCIES,
                printed="Frequency", pane=Pane.MINOR,
            ),
            number(
                "Percent speed", "fraction", "Speed of the start-up crossing, as a share of synchronous speed.",
                "100 (1 − f / 2 f_line)", f"{SLIP}; Table 1",
                of_row=("NaturalFrequencies.Frequency",), of_case=LINE, format=shown.TWO_DECIMALS,
                printed="Speed",
            ),
            number(
                "Damping ratio", "fraction", "Fraction of critical damping in the start.",
                "ζ = DampingRatio or ModeDamping + ½ Σ loss factor × strain-energy share + ½ φᵀCφ/ω at unit "
                "modal mass",
                "docs/method.md, Damping", of_row=("ModeDamping.Damping ratio",),
                of_case=(*DAMPING, *MODAL),
            ),
            text(
                "Largest strain energy", "Element with the largest share of the strain energy.",
                "The element with the largest k (Bφ)² of the mode",
                "docs/nomenclature.md, strain-energy share", kind="element", of_case=MODAL,
                printed="Largest strain energy in",
            ),
            number(
                "Share", "fraction", "Share of the mode's strain energy in that element.",
                "k (Bφ)² of that element / sum of all elements",
                "docs/nomenclature.md, strain-energy share", of_case=MODAL, format=shown.ONE_DECIMAL, pane=Pane.MINOR,
            ),
            flag(
                "Accurate", "no for a mode above the frequency up to which the pieces of shafts are fine enough.",
                "yes where the estimated error from the pieces of shafts with Density or sections is within 0.1 %, for this mode "
                "and all below",
                "docs/method.md, Distributed shafts", of_case=MODAL, pane=Pane.WORKBOOK,
            ),
        ),
        extra_columns=(
            number(
                "Percent speed check", "fraction", "Live formula: 1 - f / (2 f_line).",
                "100 (1 − f / 2 f_line), calculated by the spreadsheet", f"{SLIP}; Table 1",
                of_row=("NaturalFrequencies.Frequency",), of_case=LINE, formula=live.PERCENT_SPEED_CHECK,
                format=shown.TWO_DECIMALS,
            ),
        ),
    ),
    table(
        "ModeShapes", sheet="Results", caption="Mode shapes",
        help="Twist of each station, largest = 1; no twist for a mode in which gears only move "
        "laterally.",
        row_name=("Station",), rank=1,
        columns=(text("Station", "Station.", kind="station", trace=named("Stations.Station")),),
        repeated=number(
            "Mode", "ratio", "Twist of the station in this mode.",
            "φ of the station in its running direction, divided by the largest of the mode", SVD,
            of_case=MODAL,
        ),
    ),
    table(
        "SeparationMargins", sheet="Results", caption="Separation margins",
        help="Every mode against every continuous excitation.",
        row_name=("Mode", "Excitation"), changes_shown=("Margin",), rank=2, filtered=True,
        json_only=(
            number("frequency", "frequency", "Natural frequency."),
        ),
        columns=(
            integer(
                "Mode", "Elastic mode.", "As in NaturalFrequencies", SVD,
                of_row=("NaturalFrequencies.Mode",),
            ),
            text(
                "Excitation", "Name of the excitation.",
                "Rows of Excitations; blank = 1× and 2× of every shaft speed, 1× and 2× line frequency",
                f"{STEADY} (operating speeds, line frequency and their multiples)",
                of_row=("Excitations.Name",), of_case=("Stations.Speed ratio", *LINE),
            ),
            number(
                "Speed", "speed", "Motor speed at which the margin is least.",
                "The motor speed between MinimumSpeed and MaximumSpeed at which the margin is least",
                STEADY, of_row=EXCITATION, of_case=SPEEDS, pane=Pane.MINOR,
            ),
            number(
                "Excitation frequency", "frequency", "Frequency of the excitation at that motor speed.",
                "order × speed of its station / 2π, or the frequency stated", STEADY,
                of_row=(*EXCITATION, "SeparationMargins.Speed"), of_case=("Stations.Speed ratio",), pane=Pane.MINOR,
            ),
            number(
                "Margin", "fraction", "|f - f_exc| / f_exc.",
                "|f − f_exc| / f_exc, the least over the operating speeds; 0 where an excitation crosses the mode",
                f"{STEADY} (20 percent margin)",
                of_row=("NaturalFrequencies.Frequency", "SeparationMargins.Excitation frequency"),
                of_case=SPEEDS, format=shown.TWO_DECIMALS,
            ),
            number(
                "Required", "fraction", "Required margin.",
                "MarginRequired; else of Standard: Szenasi or blank 20 % for calculated, 10 % for measured frequencies, API "
                "617 and API 541/546 10 %", STEADY,
                of_case=("Standard", "MarginBasis", "MarginRequired"), format=shown.ONE_DECIMAL, pane=Pane.MINOR,
            ),
            verdict(
                "Verdict", "pass, pass within its error, accepted by forced response, not judged, or fail.",
                "pass where margin ≥ required; else accepted by forced response where these are within their "
                "limits at that resonance: elements with 90 % of the strain energy, the largest holder, and all with "
                "at least half of the largest modal torque over rated torque; not judged where one of them has no "
                "limit; else fail",
                f"{STEADY}; {MIL}",
                of_row=(
                    "SeparationMargins.Margin", "SeparationMargins.Required", "SteadyState.Verdict",
                    "SteadyState.Error",
                ),
            ),
            sentence(
                "Not judged", "Elements without a limit that keep the margin from being accepted.",
                "Elements of the mode that must be judged and have no limit, with their shares of strain energy and "
                "modal torque",
                f"{STEADY}; {MIL}", of_row=("SteadyState.Verdict", "SteadyState.Error"), of_case=MODAL, width=26.0,
            ),
        ),
        extra_columns=(
            number(
                "Margin check", "fraction", "Live formula: |f - f_exc| / f_exc.",
                "100 |f − f_exc| / f_exc, calculated by the spreadsheet", STEADY,
                of_row=("NaturalFrequencies.Frequency", "SeparationMargins.Excitation frequency"),
                formula=live.MARGIN_CHECK, format=shown.TWO_DECIMALS,
            ),
        ),
    ),
    table(
        "SteadyState", sheet="Results", caption="Steady-state response",
        help="Forced response; stresses include SCF.",
        row_name=("Element", "Excitation", "Mode", "Applied at"),
        changes_shown=("Peak-to-peak stress",), rank=3, filtered=True,
        json_only=(
            number("torque_limit", "torque", "Vibratory limit of the element."),
        ),
        columns=(
            text("Element", "Element.", kind="element", trace=named("Elements.Element")),
            text(
                "Excitation", "Name of the excitation.", "As in SeparationMargins", STEADY,
                of_row=("SeparationMargins.Excitation",),
            ),
            integer(
                "Mode", "Mode excited.",
                "Mode at resonance, if its margin is not kept; blank for a response at operating "
                "speed",
                STEADY, of_row=("SeparationMargins.Verdict",), pane=Pane.MINOR,
            ),
            number(
                "Frequency", "frequency", "Frequency of the worst response.",
                "The natural frequency where a margin is not kept (forcing at the resonance), else the "
                "frequency of the largest response over the operating speeds",
                f"{STEADY} (a conservative forcing function at the resonant frequency)",
                of_row=("NaturalFrequencies.Frequency", *EXCITATION), of_case=SPEEDS,
                error=ReportedError.FREQUENCIES, pane=Pane.MINOR,
            ),
            text(
                "Applied at", "Station of the applied torque.",
                "Motor, gears and driven machines in turn; the place with the largest response",
                STEADY, kind="station", of_row=("Excitations.Station",),
                of_case=("Stations.Running load", "Elements.Kind"), pane=Pane.MINOR,
            ),
            number(
                "Applied torque", "torque", "Applied torque, zero-to-peak.",
                "1 % zero-to-peak: of RatedTorque at the motor, of the transmitted torque at a gear, "
                "of Running load at a driven machine; or Torque of table Excitations",
                f"{STEADY} (approximately 1 percent zero-peak of the transmitted torque)",
                us="lbf*ft", of_row=("Excitations.Torque",),
                of_case=("RatedTorque", "RatedPower", "SynchronousSpeed", "Stations.Running load"), pane=Pane.MINOR,
            ),
            number(
                "Torque", "torque", "Response torque, zero-to-peak, at own speed.",
                "(K(1 + iη) + iωC − ω²J) θ = T solved directly, all modes; magnitude of the element's torque "
                "k(1 + iη)·twist + iωc·twist",
                f"{STEADY} (matrix method); docs/method.md, Separation margins and forced response",
                us="lbf*ft", of_row=("SteadyState.Frequency", "SteadyState.Applied torque"),
                of_case=(*MODAL, *DAMPING), pane=Pane.MINOR,
            ),
            number(
                "Zero-to-peak stress", "pressure", "Shear stress amplitude with SCF.",
                f"SCF · {STRESS}, T zero-to-peak", f"{STEADY}; {STRENGTH}",
                of_row=("SteadyState.Torque", *SECTION, *NOTCH), printed="Stress, 0‑pk", pane=Pane.MINOR,
            ),
            number(
                "Peak-to-peak stress", "pressure", "Shear stress range with SCF.",
                "2 × zero-to-peak stress", f"{STEADY} (the peak-to-peak stresses are calculated)",
                of_row=("SteadyState.Zero-to-peak stress",), printed="Stress, pk‑pk",
            ),
            number(
                "Allowable", "pressure", "UTS/25.", "UTS / 25", MIL,
                of_row=("Elements.Material", "Materials.UTS"),
            ),
            verdict(
                "Verdict", "pass, fail, unbounded (undamped mode at resonance) or not judged.",
                "pass where the stress of StressBasis is at most UTS/25, and the torque of a coupling or mesh "
                "at most its Vibratory limit; unbounded where an undamped mode is at resonance",
                MIL,
                of_row=(
                    "SteadyState.Peak-to-peak stress", "SteadyState.Zero-to-peak stress",
                    "SteadyState.Allowable", "Elements.Vibratory limit",
                ),
                of_case=("StressBasis",),
            ),
            number(
                "Error", "fraction", "Estimated relative error of torque and stress.",
                "What the last refinement of a sweep added, the change from half as many pieces of shafts with Density or sections, and "
                "the rise at the low end of DampingRange",
                "docs/method.md, Distributed shafts", of_case=("DampingRange", *MODAL), format=shown.ERROR, pane=Pane.MINOR,
                error=ReportedError.ESTIMATE,
            ),
            number(
                "Safety factor", "ratio", "Limit over stress or torque, the least.",
                "UTS/25 over the stress of StressBasis; Vibratory limit over the torque; the lower one", SAFETY,
                of_row=(
                    "SteadyState.Allowable", "SteadyState.Peak-to-peak stress", "SteadyState.Torque",
                    "Elements.Vibratory limit",
                ),
                of_case=("StressBasis",), format=shown.TWO_DECIMALS, pane=Pane.MINOR,
            ),
        ),
        extra_columns=(
            number(
                "UTS/25 check", "pressure", "Live formula: UTS / 25.",
                "UTS / 25, calculated by the spreadsheet", MIL,
                of_row=("Elements.Material", "Materials.UTS"), formula=live.UTS_CHECK,
            ),
        ),
    ),
    table(
        "StartupPeaks", sheet="Start", caption="Peaks of the start",
        help="Extremes from rest to the end of the run, torques at own speed, stress nominal without SCF.",
        row_name=("Element",), changes_shown=("Maximum torque", "Peak-to-peak stress"),
        of_the_start=True, rank=4,
        columns=(
            text("Element", "Element.", kind="element", trace=named("Elements.Element")),
            number(
                "Maximum torque", "torque", "Largest torque.", f"{EQUATION_OF_MOTION}; {PEAK}",
                EXPONENTIAL, us="lbf*ft", of_case=START, format=shown.SIGNED, error=ReportedError.PEAKS,
                share_of="Peak-to-peak torque",
            ),
            number(
                "Minimum torque", "torque", "Smallest torque.", f"{EQUATION_OF_MOTION}; {PEAK}",
                EXPONENTIAL, us="lbf*ft", of_case=START, format=shown.SIGNED, error=ReportedError.PEAKS,
                share_of="Peak-to-peak torque",
            ),
            number(
                "Peak-to-peak torque", "torque", "Maximum minus minimum.",
                "maximum − minimum, from rest to the end of the run", LABEL, us="lbf*ft",
                of_row=("StartupPeaks.Maximum torque", "StartupPeaks.Minimum torque"),
                error=ReportedError.PEAKS, printed="Torque, pk‑pk",
            ),
            number(
                "Peak-to-peak stress", "pressure", "Nominal shear stress range, without SCF.",
                f"{STRESS} of the peak-to-peak torque; nominal, without SCF",
                f"{TRANSIENT}; {STRENGTH}", of_row=("StartupPeaks.Peak-to-peak torque", *SECTION),
                error=ReportedError.PEAKS, printed="Stress, pk‑pk",
            ),
            number(
                "Time", "time", "Time of the largest torque.", "Instant of the maximum torque",
                EXPONENTIAL, of_row=("StartupPeaks.Maximum torque",), of_case=START, pane=Pane.MINOR,
            ),
            number(
                "Percent speed", "fraction", "Speed at that time, as a share of synchronous speed.",
                "100 × mean speed / synchronous speed at that instant", LABEL,
                of_row=("StartupPeaks.Time",), of_case=(*START,), format=shown.TWO_DECIMALS,
                printed="Speed", pane=Pane.MINOR,
            ),
            number(
                "Error", "fraction", "Estimated error of maximum and minimum, relative to the larger, and of the peak-to-peak torque.",
                "Change of both extremes from step h to h/2, with a bound on the modes left out and the error from "
                "the pieces of distributed shafts, divided by the larger extreme; where runs part after impacts, up to "
                "the ends of the 99 % intervals of maximum, minimum and peak-to-peak torque",
                "docs/method.md, The start; docs/method.md, Distributed shafts", of_case=("TolerancePeak", "Method"), format=shown.ERROR,
                error=ReportedError.ESTIMATE, printed="Estimated error", pane=Pane.MINOR,
            ),
            number(
                "Left out", "fraction", "Bound on the relative change by effects that are off, with an estimate of what "
                "motors without data damp; blank: no bound is known.",
                "Sum of the bounds of the effects left out; where teeth separate, the change of the peaks by one start "
                "with all of them on; and the change by motor curves read at the other speed",
                "docs/method.md, Errors of a start", of_case=("EffectChoices.Choice", "TorqueFollows"), format=shown.ERROR,
                error=ReportedError.ESTIMATE, pane=Pane.MINOR,
            ),
            number(
                "Peak low", "torque", "Least magnitude of the peak within error and effects left out.",
                "Larger extreme − error − left out; where runs part after impacts, the lower end of a 99 % interval "
                "from several runs",
                "docs/method.md, Errors of a start", us="lbf*ft", of_row=("StartupPeaks.Error", "StartupPeaks.Left out"),
                error=ReportedError.PEAKS, pane=Pane.MINOR,
            ),
            number(
                "Peak high", "torque", "Largest magnitude of the peak, likewise; verdicts use it.",
                "Larger extreme + error + left out; where runs part after impacts, the upper end of a 99 % interval "
                "from several runs",
                "docs/method.md, Errors of a start", us="lbf*ft", of_row=("StartupPeaks.Error", "StartupPeaks.Left out"),
                error=ReportedError.PEAKS, pane=Pane.MINOR,
            ),
            number(
                "Minimum low", "torque", "Lowest minimum torque, likewise; Torque reversal uses it.",
                "Minimum torque − error − left out; where runs part after impacts, the lower end of a 99 % interval "
                "of the minimum",
                "docs/method.md, Errors of a start", us="lbf*ft", of_row=("StartupPeaks.Error", "StartupPeaks.Left out"),
                format=shown.SIGNED, error=ReportedError.PEAKS, share_of="Peak-to-peak torque", pane=Pane.MINOR,
            ),
            number(
                "Minimum high", "torque", "Highest minimum torque, likewise.",
                "Minimum torque + error + left out; where runs part after impacts, the upper end of a 99 % interval "
                "of the minimum",
                "docs/method.md, Errors of a start", us="lbf*ft", of_row=("StartupPeaks.Error", "StartupPeaks.Left out"),
                format=shown.SIGNED, error=ReportedError.PEAKS, share_of="Peak-to-peak torque", pane=Pane.MINOR,
            ),
            number(
                "Worst phase", "angle", "Phase of the pulsation at which the larger of maximum and minimum is the largest; blank unless PulsationPhase is worst.",
                "PulsationPhase of the start with the largest magnitude",
                "docs/method.md, The worst phase", of_case=("PulsationPhase",), format=shown.ONE_DECIMAL,
                pane=Pane.MINOR,
            ),
            number(
                "Safety factor", "ratio", "Limit over the larger extreme, the least; blank: not judged.",
                "Peak torque limit over it; Yield / 2 over its nominal stress (maximum shear theory); the lower one", SAFETY,
                of_row=(
                    "StartupPeaks.Maximum torque", "StartupPeaks.Minimum torque", "Elements.Peak torque limit",
                    "Elements.Material", *SECTION,
                ),
                of_case=("Materials.Yield",), format=shown.TWO_DECIMALS, error=ReportedError.PEAKS, pane=Pane.MINOR,
            ),
        ),
    ),
    table(
        "SectionResults", sheet="Train", caption="Stiffness and inertia of the sections",
        help="Each section, and each element as a whole.",
        row_name=("Element", "Section"), later=True,
        columns=(
            text("Element", "The element.", kind="element", trace=named("Sections.Element")),
            text("Section", "The section; whole: all of the element.", trace=named("Sections.Section")),
            number(
                "Effective length", "length", "Length of a plain cylinder of its OD and ID that twists as much.",
                "Penetration × length (of a taper J ∫ dx/J) + Σ λ ((D/d)⁴ − 1) of the steps to thinner sections, over the share of the "
                "stiffness that a keyway leaves",
                STEPPED_SHAFTS, of_row=OF_SECTION, format="0.0000",
            ),
            number(
                "Stiffness", "torsional stiffness", "Torsional stiffness; of a whole element as it is calculated.",
                "G π (D⁴ − d⁴) / 32 effective length; of all: 1 / Σ 1/k, or the Stiffness typed in Elements",
                f"{STRENGTH}; {STEPPED_SHAFTS}",
                of_row=("SectionResults.Effective length", "Sections.OD", "Sections.ID", "Elements.Stiffness"),
                of_case=("SectionMaterials.Shear modulus",),
            ),
            number(
                "Inertia", "inertia", "Polar inertia, distributed along the element.",
                "ρ π (D⁴ − d⁴) L / 32, of a taper integrated; of all: the sum", f"{STRENGTH}; {STEPPED_SHAFTS}",
                of_row=("Sections.Length", "Sections.OD", "Sections.ID"), of_case=("SectionMaterials.Density",),
            ),
        ),
    ),
    table(
        "MotorCurves", sheet="Torque and motor", caption="Calculated torque curves",
        help="Torques and current of each motor of table MotorData while it slips, rated voltage behind its row of table Supply.",
        row_name=("Station", "Slip"), later=True,
        columns=(
            text(
                "Station", "Where the motor acts.", kind="station", trace=named("MotorData.Station"),
            ),
            number("Slip", "ratio", "1 at rest, 0 at synchronous speed.", "1 − speed / synchronous speed",
                   SLIP, of_row=("MotorData.Station",), format="0.00"),
            number(
                "Speed", "speed", "Speed of the station.", "(1 − slip) × synchronous speed of the station",
                SLIP, of_row=("MotorCurves.Slip", "Stations.Speed ratio"), of_case=LINE,
            ),
            number(
                "Average", "torque", "Mean torque.", "Im(Ψ₋ I₋* − Ψ₊ I₊*) × S / ω_s", CURVES_FROM_DATA,
                us="lbf*ft", of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE),
                format=shown.SIGNED,
            ),
            number(
                "Pulsating", "torque", "Torque at twice slip frequency, zero-to-peak.",
                "|Ψ₊ I₋ − Ψ₋ I₊| × S / ω_s", CURVES_FROM_DATA,
                us="lbf*ft", of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE),
                format=shown.SIGNED,
            ),
            number(
                "Phase", "angle",
                "Phase of the pulsation, of cos(2 s ω t) with the voltage along the axis of the poles at t = 0.",
                "arg j (Ψ₊ I₋ − Ψ₋ I₊)", CURVES_FROM_DATA,
                of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE), format="0.0",
            ),
            number(
                "Current", "ratio", "Current over rated current, rms of all frequencies.", "√(|I₊|² + |I₋|²)",
                CURVES_FROM_DATA,
                of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE), format="0.000",
            ),
            number(
                "Power factor", "ratio", "Of the part at line frequency; below 0 it feeds power back.",
                "Re U I₊* / |U I₊|, U the voltage at the terminals", CURVES_FROM_DATA,
                of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE), format="0.000",
            ),
            number(
                "Terminal voltage", "fraction", "Voltage at the terminals, of line frequency, over that of the line; 100 % without table Supply.",
                "|V − (R + j X) I₊|, V, R and X of the line and the starter", CURVES_FROM_DATA,
                of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE), format=shown.TWO_DECIMALS,
            ),
            number(
                "Pulsation1", "torque", "Torque at the slip frequency itself, zero-to-peak; 0 unless the discharge path is one-way.",
                "First harmonic of the torque over a period of the slip", ONE_WAY,
                us="lbf*ft", of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE), format=shown.SIGNED,
            ),
            number(
                "Phase1", "angle",
                "Phase of Pulsation1, of cos(s ω t) with the voltage along the axis of the poles at t = 0.",
                "Argument of that harmonic", ONE_WAY,
                of_row=("MotorCurves.Slip",), of_case=(*MOTOR_DATA, *SUPPLY, *LINE), format="0.0",
            ),
        ),
    ),
    table(
        "MotorTimeConstants", sheet="Torque and motor", caption="Time constants",
        help="Of field and damper in the axis of the poles, of the circuit that the start uses: as the relations of one winding after "
        "the other give them, and as tests show them.",
        row_name=("Station", "Time constant"), short_caption=True, later=True,
        columns=(
            text(
                "Station", "Where the motor acts.", kind="station", trace=named("MotorData.Station"),
            ),
            text(
                "Time constant", "As the columns of MotorData.", "Td0, the stator open; Td, short-circuited", MEASURED_TIMES,
                of_case=("MotorData.Time constants",),
            ),
            number(
                "Classical", "time", "By the relations of one winding after the other.", "(X_w + X) / (ω₀ R_w), X what it has in parallel",
                MEASURED_TIMES, of_row=("MotorTimeConstants.Time constant",), of_case=(*MOTOR_DATA, *LINE), format="0.0000",
            ),
            number(
                "Measured", "time", "As tests show it.", "Root of the whole circuit",
                MEASURED_TIMES, of_row=("MotorTimeConstants.Time constant",), of_case=(*MOTOR_DATA, *LINE), format="0.0000",
            ),
            number(
                "Difference", "fraction", "Measured over classical, less 1.", "Measured / Classical − 1", MEASURED_TIMES,
                of_row=("MotorTimeConstants.Classical", "MotorTimeConstants.Measured"), format=shown.TWO_DECIMALS,
            ),
        ),
    ),
    table(
        "ElectricalDamping", sheet="Torque and motor", caption="Electrical damping",
        help="What each motor makes of each mode that the start crosses, at that speed, and in operation at rated "
        "load with a leading power factor. Blank where the motor has no data sheet.",
        row_name=("Station", "Mode", "Percent speed"), later=True,
        columns=(
            text(
                "Station", "Where the motor acts.", kind="station", trace=named("MotorTorque.Station"),
            ),
            integer(
                "Mode", "Elastic mode.", "As in NaturalFrequencies", SVD, of_row=("NaturalFrequencies.Mode",),
            ),
            number(
                "Percent speed", "fraction", "Speed of the crossing; 100 % in operation.", "100 (1 − f / 2 f_line)",
                f"{SLIP}; Table 1", of_row=("NaturalFrequencies.Frequency",), of_case=LINE,
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Slope of the curve", "torsional damping",
                "Slope of the average torque of the start against speed; positive drives.",
                "dT/dω of the curve at that speed", MODAL_ELECTRICAL, of_row=("MotorTorque.Average",),
                of_case=(*MOTOR_DATA, *LINE), format=shown.SIGNED,
            ),
            number(
                "Share of the slope", "fraction", "Damping ratio that the slope makes of it: with TorqueFollows = own "
                "speed a start has it, else it has not.",
                "−½ slope φ²/ω, φ at unit modal mass", MODAL_ELECTRICAL,
                of_row=("ElectricalDamping.Slope of the curve",), of_case=MODAL, format="0.000",
            ),
            number(
                "Re K", "torsional damping",
                "Torque in phase with a small oscillation of the speed, over it; positive drives.",
                "K = Σ± [Δψd iq* + ψd* Δiq − Δψq id* − ψq* Δid] of the oscillation, × T_base / ω_s", MODAL_ELECTRICAL, of_row=("NaturalFrequencies.Frequency",),
                of_case=(*MOTOR_DATA, *LINE), format=shown.SIGNED,
            ),
            number(
                "Im K", "torsional damping",
                "Torque a quarter of a period ahead of that oscillation, over it; positive raises the frequency.",
                "K = Σ± [Δψd iq* + ψd* Δiq − Δψq id* − ψq* Δid] of the oscillation, × T_base / ω_s", MODAL_ELECTRICAL, of_row=("NaturalFrequencies.Frequency",),
                of_case=(*MOTOR_DATA, *LINE), format=shown.SIGNED,
            ),
            number(
                "Share of damping ratio", "fraction", "Damping ratio that the motor adds.",
                "ζe = −½ Re K φ²/ω, φ at unit modal mass", MODAL_ELECTRICAL,
                of_row=("ElectricalDamping.Re K",), of_case=MODAL, format="0.000",
            ),
            number(
                "Shift of frequency", "frequency", "Natural frequency that the motor adds.",
                "½ Im K φ² / 2π, φ at unit modal mass", MODAL_ELECTRICAL,
                of_row=("ElectricalDamping.Im K",), of_case=MODAL, format="0.0000",
            ),
            number(
                "Damping ratio", "fraction", "Damping ratio of the mode without motors.",
                "As in NaturalFrequencies", "docs/method.md, Damping",
                of_row=("NaturalFrequencies.Damping ratio",), format="0.000",
            ),
            number(
                "With motors", "fraction", "Damping ratio with all motors at that speed.",
                "ζ + Σ ζe", MODAL_ELECTRICAL,
                of_row=("ElectricalDamping.Damping ratio", "ElectricalDamping.Share of damping ratio"),
                format="0.000",
            ),
        ),
    ),
    table(
        "StartupCrossings", sheet="Start", caption="Crossings of 2 × slip frequency",
        help="Where 2 × slip frequency crosses each mode, and 1 × slip where a motor has Pulsation1, typed or from its one-way discharge path.",
        row_name=("Mode",), changes_shown=("Peak-to-peak torque", "Mesh minimum torque"),
        room=CROSSING_ROWS, of_the_start=True, rank=4,
        columns=(
            integer(
                "Mode", "Elastic mode.", "Every elastic mode up to 1.1 × (2 × line frequency)", SLIP,
                of_row=("NaturalFrequencies.Mode",), of_case=LINE,
            ),
            number(
                "Frequency", "frequency", "Natural frequency.", "As in NaturalFrequencies", SVD,
                of_row=("NaturalFrequencies.Frequency",), error=ReportedError.FREQUENCIES,
            ),
            number(
                "Percent speed", "fraction", "Speed of the crossing, as a share of synchronous speed.",
                "100 (1 − f / k f_line), k = 2 or 1, the multiple of slip", f"{SLIP}; Table 1",
                of_row=("StartupCrossings.Frequency", "StartupCrossings.Multiple of slip"),
                of_case=LINE, format=shown.TWO_DECIMALS,
                printed="Speed",
            ),
            number(
                "Time", "time", "Time of the crossing.", "When the mean speed passes that speed",
                f"{TRANSIENT}, Figure 6", of_row=("StartupCrossings.Percent speed",), of_case=START,
            ),
            number(
                "Average torque", "torque", "Average motor torque there.",
                "Monotone cubic through Average at that speed, × Voltage²",
                f"{PHILOSOPHY}; curves: {CURVES.paged}",
                us="lbf*ft", of_row=("StartupCrossings.Percent speed",),
                of_case=("MotorTorque.Speed", "MotorTorque.Average", "Voltage"), format=shown.SIGNED,
            ),
            number(
                "Pulsating torque", "torque", "Pulsating torque there, zero-to-peak.",
                "Monotone cubic through Pulsating, or of 1 × slip through Pulsation1, at that speed, × Voltage²",
                f"{PHILOSOPHY}; curves: {CURVES.paged}",
                us="lbf*ft", of_row=("StartupCrossings.Percent speed", "StartupCrossings.Multiple of slip"),
                of_case=(
                    "MotorTorque.Speed", "MotorTorque.Pulsating", "MotorTorque.Pulsation1", "Voltage",
                ),
            ),
            number(
                "Load torque", "torque", "Load torque there, referred to motor speed.",
                "Σ load torque at that speed × speed ratio: referred to the motor",
                f"{TRANSIENT}; docs/nomenclature.md", us="lbf*ft",
                of_row=("StartupCrossings.Percent speed",),
                of_case=("LoadTorque.Speed", "LoadTorque.Torque", "Stations.Speed ratio"),
                format=shown.SIGNED,
            ),
            number(
                "Acceleration", "angular acceleration", "Acceleration of the motor there.",
                "(average − load torque) / Σ J r², the rigid train", f"{PHILOSOPHY}, Figure 6",
                of_row=("StartupCrossings.Average torque", "StartupCrossings.Load torque"),
                of_case=("Stations.Inertia", "Stations.Speed ratio"),
            ),
            number(
                "Sweep rate", "sweep rate", "How fast 2 × slip frequency falls, or 1 × slip.",
                "k f_line × acceleration / synchronous speed, k = 2 or 1, the multiple of slip", SLIP,
                of_row=("StartupCrossings.Acceleration",), of_case=LINE,
            ),
            text(
                "Governing element", "Element with the largest stress or torque.",
                "The element with the largest nominal stress range in the window of the crossing; without "
                "stress diameters the largest torque range",
                "docs/method.md, Crossings", kind="element", width=12.0, of_case=(*START, *SECTION),
            ),
            number(
                "Peak-to-peak torque", "torque", "Its torque range at the crossing.",
                "Torque range of that element in the crossing window: from 1.1 f (or the geometric mean with the "
                "next higher mode, if lower) down to the geometric mean with the next lower mode",
                f"docs/method.md, Crossings; {EXPONENTIAL}", us="lbf*ft", of_case=START,
                error=ReportedError.PEAKS, printed="Torque, pk‑pk",
            ),
            number(
                "Peak-to-peak stress", "pressure", "Its nominal stress range at the crossing.",
                f"{STRESS} of that range; nominal, without SCF",
                f"{PAPER.cited}, Sample case (stress when the first mode is excited)",
                of_row=("StartupCrossings.Peak-to-peak torque",), of_case=SECTION,
                error=ReportedError.PEAKS, printed="Stress, pk‑pk",
            ),
            number(
                "Mesh minimum torque", "torque", "Least mesh torque at the crossing.",
                "Least torque of a gear mesh in the same window", f"{REVERSALS}, Figure 7",
                us="lbf*ft", of_case=START, format=shown.SIGNED, error=ReportedError.PEAKS,
            ),
            number(
                "Amplification", "ratio", "Largest amplitude of the mode over the static one of the pulsating torque.",
                "max |ω² q|, demodulated with the phase of 2 × slip over two cycles, / φ T_pulsating at that "
                "instant; with clearances half the torque range of the governing element over its static torque",
                f"docs/method.md, Crossings; {PHILOSOPHY}",
                of_row=("StartupCrossings.Pulsating torque",), of_case=START, format=shown.ONE_DECIMAL,
                error=ReportedError.PEAKS,
            ),
            integer(
                "Multiple of slip", "2, or 1 of the torque of a one-way discharge path.",
                "2 for each mode; 1 for those below 1.1 × line frequency where a motor has Pulsation1",
                "docs/method.md, Crossings", of_case=("MotorTorque.Pulsation1",),
            ),
            sentence(
                "Note", "Assessment of the crossing.",
                "Amplifications of dwelling at the resonance, 1/2ζ, and of a sweep without damping, 3.68 √(f²/ḟ); what "
                "limits that of this start; reversal",
                f"{PHILOSOPHY}; Lewis, Trans. ASME 54 (1932) 253",
                of_row=(
                    "StartupCrossings.Sweep rate", "NaturalFrequencies.Damping ratio",
                    "StartupCrossings.Amplification", "StartupCrossings.Average torque",
                ),
                width=38.0,
            ),
        ),
    ),
    table(
        "AllowableStarts", sheet="Fatigue", caption="Allowable starts",
        help="Fatigue damage of one start and allowable starts.",
        row_name=("Element",), changes_shown=("Allowable starts",), of_the_start=True, rank=6,
        json_only=(
            UNLIMITED,
        ),
        columns=(
            text("Element", "Element.", kind="element", trace=named("Elements.Element")),
            number(
                "Damage", "count", "Miner sum of one start.",
                f"q = Σ nᵢ/Nᵢ over the rainflow cycles of Kf · {STRESS}; amplitude = half range, mean ignored or by Goodman; "
                "N on the log-log S-N line, lowered by the factors of FatigueLimits; bending data halved for torsion",
                f"{FIGURE_3}; {ASTM}", of_row=FATIGUE, of_case=(*START, "RainflowResidue", "MeanStress"),
                format=shown.DAMAGE, error=ReportedError.STARTS,
            ),
            number(
                "Allowable starts", "count",
                "1 / damage; unlimited without damage, not judged when the start was not completed.",
                "1/q; unlimited where q = 0", FIGURE_3, of_row=("AllowableStarts.Damage",),
                format=shown.STARTS, unlimited=True, error=ReportedError.STARTS,
            ),
            number(
                "Paper count", "count",
                "Allowable starts by the cycle-by-cycle count of Szenasi & von Nimitz.",
                "1/Σ nᵢ/Nᵢ, every range from one turning point of the stress to the next counted as half a cycle",
                FIGURE_3, of_row=FATIGUE, of_case=START, format=shown.STARTS, unlimited=True,
                error=ReportedError.STARTS,
            ),
            number(
                "Error", "fraction", "Estimated relative error of the allowable starts.",
                "Change of 1/q from step h to h/2, and with the error from the pieces of distributed shafts",
                "docs/method.md, Allowable starts; docs/method.md, Distributed shafts",
                of_case=("ToleranceStarts", "TolerancePeak"), format=shown.ERROR,
                error=ReportedError.ESTIMATE, printed="Estimated error", pane=Pane.MINOR,
            ),
            flag(
                "Governing", "yes for the element that allows the fewest starts.",
                "yes for the element that allows the fewest starts", FIGURE_3,
                of_row=("AllowableStarts.Damage",), pane=Pane.MINOR,
            ),
            number(
                "Left out", "fraction", "Bound on the relative change by effects that are off, with an estimate of what "
                "motors without data damp; blank: no bound is known.",
                "Change of 1/q where every torque is larger by what is left out, or by motor curves read at the other speed",
                "docs/method.md, Errors of a start", of_case=("EffectChoices.Choice", "TorqueFollows"), format=shown.ERROR,
                error=ReportedError.ESTIMATE, pane=Pane.MINOR,
            ),
            number(
                "Starts low", "count", "Fewest allowable starts within error and effects left out; verdicts use it.",
                "1/q with the error of every torque, of 1/q and what is left out; where runs part after impacts, the "
                "lower end of a 99 % interval from several runs",
                "docs/method.md, Errors of a start", of_row=("AllowableStarts.Error", "AllowableStarts.Left out"),
                format=shown.STARTS, error=ReportedError.STARTS, pane=Pane.MINOR,
            ),
            number(
                "Starts high", "count", "Most allowable starts, likewise; blank: unlimited, or no bound is known.",
                "As Starts low, at the other end",
                "docs/method.md, Errors of a start", of_row=("AllowableStarts.Error", "AllowableStarts.Left out"),
                format=shown.STARTS, error=ReportedError.STARTS, pane=Pane.MINOR,
            ),
            number(
                "Worst phase", "angle", "Phase of the pulsation with the largest damage; blank unless PulsationPhase is worst.",
                "PulsationPhase of the start with the largest damage",
                "docs/method.md, The worst phase", of_case=("PulsationPhase",), format=shown.ONE_DECIMAL,
                pane=Pane.MINOR,
            ),
        ),
        extra_columns=(
            number(
                "Starts check", "count", "Live formula: 1 / damage.",
                "1 / damage, calculated by the spreadsheet", FIGURE_3,
                of_row=("AllowableStarts.Damage",), formula=live.STARTS_CHECK, format=shown.STARTS,
            ),
            number(
                "Starts to judge", "count",
                "Live formula: 1 / damage / StartsFactor, rounded down to whole starts.",
                "1 / damage / StartsFactor, rounded down, calculated by the spreadsheet", FIGURE_3,
                of_row=("AllowableStarts.Damage",), of_case=("StartsFactor",),
                formula=live.STARTS_TO_JUDGE, format=shown.WHOLE,
            ),
        ),
    ),
    table(
        "FatigueLimits", sheet="Fatigue", caption="Endurance limit, factors and safety",
        help="Largest stress amplitude of one start beside the endurance limit of each judged shaft, and the factors on both.",
        row_name=("Element",), changes_shown=("Safety factor",), of_the_start=True, rank=6, later=True,
        columns=(
            text("Element", "Element.", kind="element", trace=named("Elements.Element")),
            number(
                "Stress amplitude", "pressure", "Half of maximum minus minimum stress of the start, with Kf; reversed with a mean "
                "stress.",
                f"½ (maximum − minimum) of Kf · {STRESS}; with Goodman over 1 − mean / 0.67 UTS",
                f"{FIGURE_3}; {SHIGLEY}, page 347", of_row=FATIGUE, of_case=(*START, "MeanStress", "Materials.UTS"),
                error=ReportedError.PEAKS,
            ),
            number(
                "Endurance limit", "pressure", "In torsion, with the factors.", "Endurance of data × surface × size × reliability",
                STRENGTH_FACTORS, of_row=(
                    "FatigueLimits.Endurance of data", "FatigueLimits.Surface", "FatigueLimits.Size", "FatigueLimits.Reliability",
                ),
            ),
            number(
                "Safety factor", "ratio", "Endurance limit over stress amplitude; below 1 the starts are limited.",
                "Endurance limit / stress amplitude", SAFETY,
                of_row=("FatigueLimits.Stress amplitude", "FatigueLimits.Endurance limit"), format=shown.TWO_DECIMALS,
                error=ReportedError.PEAKS,
            ),
            number(
                "Kt", "ratio", "Stress concentration.", "SCF; or of the fillet or keyway of FatigueFactors", NOTCHES,
                of_row=(*NOTCH, "Elements.Stress diameter"), of_case=("Sections.OD", "Sections.Fillet"), format="0.000",
            ),
            number(
                "Notch sensitivity", "ratio", "q; 1 where nothing is typed.",
                "Typed; or 1/(1 + √a/√r) by Neuber, 1/(1 + a/r) by Peterson, a of UTS",
                f"{SHIGLEY}, Eqs. 6-34, 6-35b; Dowling, Mechanical Behavior of Materials",
                of_row=("FatigueFactors.Notch sensitivity", "FatigueFactors.Notch radius", "Elements.Material"),
                of_case=("Materials.UTS", "Sections.Fillet"), format="0.000",
            ),
            number(
                "Kf", "ratio", "What multiplies the nominal stress in fatigue.", "1 + q (Kt − 1)", f"{SHIGLEY}, Eq. 6-32",
                of_row=("FatigueLimits.Kt", "FatigueLimits.Notch sensitivity"), format="0.000",
            ),
            number(
                "Surface", "ratio", "Surface factor; 1 where nothing is typed.", "Typed; or a UTS^b of the finish",
                f"{SHIGLEY}, Eq. 6-19, Table 6-2", of_row=("FatigueFactors.Surface", "Elements.Material"),
                of_case=("Materials.UTS",), format="0.000",
            ),
            number(
                "Size", "ratio", "Size factor; 1 where nothing is typed.", "Typed; or of the Stress diameter",
                f"{SHIGLEY}, Eq. 6-20", of_row=("FatigueFactors.Size", "Elements.Stress diameter"), format="0.000",
            ),
            number(
                "Reliability", "ratio", "Reliability factor; 1 where nothing is typed.", "1 − 0.08 z of the share that endures",
                f"{SHIGLEY}, Table 6-5", of_row=("FatigueFactors.Reliability",), format="0.000",
            ),
            number(
                "Endurance of data", "pressure", "Endurance limit in torsion of the S-N data.",
                "Endurance; blank = the last S-N stress; bending data halved", CRITERION, of_row=(
                    "Elements.Material", "Materials.Endurance", "Materials.Basis", "SNPoints.Stress",
                ),
            ),
            sentence(
                "Sources", "Where each of them comes from.", "As typed, or the formula used", STRENGTH_FACTORS,
                of_row=FATIGUE, width=60.0, pane=Pane.MINOR,
            ),
        ),
    ),
    table(
        "TorqueReversals", sheet="Start", caption="Torque reversals",
        help="Torque reversals in the start, on the From side: each gear mesh, geared coupling, and other element with a Reversal limit.",
        row_name=("Element",),
        changes_shown=("Minimum torque", "Reversals", "Impacts", "Tooth force"), room=8,
        of_the_start=True, rank=5,
        columns=(
            text(
                "Element", "Gear mesh, geared coupling, or element with a Reversal limit.", kind="element",
                trace=named("Elements.Element"),
            ),
            number(
                "Minimum torque", "torque", "Least torque in the start.",
                f"{EQUATION_OF_MOTION}; {PEAK}", f"{REVERSALS}; {EXPONENTIAL}", us="lbf*ft",
                of_row=("StartupPeaks.Minimum torque",), of_case=START, format=shown.SIGNED,
                error=ReportedError.PEAKS,
            ),
            integer(
                "Reversals", "Number of torque reversals, counted with a hysteresis.",
                "Passages of the torque below zero that are deeper than 0.1 % of the element's largest torque",
                f"{REVERSALS}; docs/method.md, Torque reversals", of_case=START,
            ),
            number(
                "Time unloaded", "time",
                "Total time of reversed torque; with a clearance, total time without contact.",
                "Sum of the times below zero of the counted reversals; with a clearance the time without contact",
                f"{REVERSALS}; docs/method.md, Torque reversals", of_case=START,
            ),
            integer(
                "Impacts", "Number of re-engagements of the teeth; blank where no clearance is modelled.",
                "Re-engagements of either flank after a separation", CLEARANCE,
                of_row=("Meshes.Backlash", "Meshes.Angular backlash"), of_case=START, pane=Pane.MINOR,
            ),
            number(
                "Recontact speed", "approach speed", "Largest approach speed of the flanks.",
                "v = δ̇_c r_b cos β_b, the largest at a recontact, normal to the flank", CLEARANCE,
                of_row=("Meshes.Pitch radius drive", "Meshes.Pressure angle", "Meshes.Helix angle"),
                of_case=START, format=shown.APPROACH, error=ReportedError.PEAKS, pane=Pane.MINOR,
            ),
            number(
                "Tooth force", "force", "Largest normal tooth force.",
                "F = T / (r_b cos β_b), the largest; r_b = pitch radius × cos α_t, tan α_t = tan α_n / cos β",
                f"{CLEARANCE}; ISO 21771, base circle",
                of_row=("Meshes.Pitch radius drive", "Meshes.Pressure angle", "Meshes.Helix angle"),
                of_case=START, error=ReportedError.PEAKS, pane=Pane.MINOR,
            ),
            number(
                "Longest reversal", "time", "Longest single reversal.",
                "The longest of the passages counted", "docs/method.md, Torque reversals",
                of_case=START, pane=Pane.WORKBOOK,
            ),
            number(
                "First time", "time", "When the torque first falls below zero.",
                "Start of the first reversal, where the torque crosses zero",
                "docs/method.md, Torque reversals", of_case=START, pane=Pane.WORKBOOK,
            ),
            number(
                "2 × slip frequency", "frequency",
                "Frequency of the pulsation, twice the slip frequency, at the least torque; to "
                "compare with the modes.",
                "2 f_line (1 − n/n_s) at the instant of the least torque", SLIP,
                key="slip_frequency", of_case=(*LINE, *START), pane=Pane.WORKBOOK,
            ),
            number(
                "Transmitted torque", "torque", "Torque in continuous operation.",
                "Sum of the running loads beyond the element, at its own speed",
                "docs/nomenclature.md", us="lbf*ft",
                of_case=(
                    "Stations.Running load", "Stations.Speed ratio", "Elements.From", "Elements.To",
                ), pane=Pane.MINOR,
            ),
            number(
                "Margin", "fraction", "Least torque divided by the transmitted torque; below 0 the torque reverses.",
                "least torque / transmitted torque", "docs/nomenclature.md, reversal margin",
                of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Transmitted torque"),
                format=shown.TWO_DECIMALS, error=ReportedError.PEAKS, pane=Pane.WORKBOOK,
            ),
            number(
                "Limit", "torque", "The maker's Reversal limit of table Elements.",
                "The maker's Reversal limit", f"{REVERSALS} (gear makers set limits)", us="lbf*ft",
                of_row=("Elements.Reversal limit",), pane=Pane.MINOR,
            ),
            verdict(
                "Verdict", "pass, fail or not judged.",
                "fail where −minimum torque > limit; without a limit pass where the torque does not reverse, else not judged", REVERSALS,
                of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Limit"),
            ),
            number(
                "Recontact speed angular", "angular approach speed",
                "Recontact speed as relative angular speed, referred to the From side.",
                "The recontact speed / (r_b cos β_b), at the From side", CLEARANCE,
                of_row=("TorqueReversals.Recontact speed",), of_case=START, format=shown.APPROACH,
                error=ReportedError.PEAKS, pane=Pane.WORKBOOK,
            ),
            number(
                "Recontact error", "fraction", "Relative error of the recontact speeds.",
                "Change of the three fastest recontacts from twice the step; where runs part the 99 % interval of an ensemble",
                "docs/method.md, Errors of a start",
                of_row=("TorqueReversals.Recontact speed",), of_case=("TolerancePeak", *START), format=shown.ERROR,
                pane=Pane.WORKBOOK,
            ),
            text(
                "Model", "linear; clearance where the teeth can separate.",
                "clearance where the plan models it, else linear", "docs/method.md, The plan",
                of_row=("Effects.On",), of_case=("EffectChoices.Choice", *CLEARANCES), pane=Pane.WORKBOOK,
            ),
            sentence(
                "Note", "Summary of the result.", "Summary of the row", REVERSALS,
                of_row=("TorqueReversals.Reversals", "TorqueReversals.Limit"), width=20.0, pane=Pane.WORKBOOK,
            ),
            number(
                "Safety factor", "ratio", "Limit over the reversing torque; blank: no limit, or no reversal.",
                "Limit / −minimum torque", SAFETY,
                of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Limit"), format=shown.TWO_DECIMALS,
                error=ReportedError.PEAKS, pane=Pane.WORKBOOK,
            ),
        ),
        extra_columns=(
            number(
                "Margin check", "fraction", "Live formula: minimum / transmitted torque.",
                "100 × minimum / transmitted torque, calculated by the spreadsheet",
                "docs/nomenclature.md, reversal margin",
                of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Transmitted torque"),
                formula=live.REVERSAL_MARGIN_CHECK, format=shown.TWO_DECIMALS,
            ),
        ),
    ),
    table(
        "MakerSheet", sheet="Start", caption="Sheet to the makers",
        help="Torques, reversals and ratings of each element, at its own speed, of a mesh at the From side.",
        row_name=("Element",), changes_shown=("Peak torque", "Vibratory torque", "Reversing torque"),
        of_the_start=True, rank=5, later=True,
        columns=(
            text("Element", "Element.", kind="element", trace=named("Elements.Element")),
            number(
                "Speed", "speed", "Highest speed in continuous operation; of a mesh that of the From side.",
                "MaximumSpeed, blank = synchronous, × speed ratio", LABEL, of_row=_RATIO, of_case=SPEEDS,
            ),
            number(
                "Speed driven", "speed", "The same of the To side of a gear mesh.",
                "MaximumSpeed, blank = synchronous, × speed ratio", LABEL, of_row=_RATIO, of_case=SPEEDS,
                pane=Pane.MINOR,
            ),
            number(
                "Continuous torque", "torque", "Torque in continuous operation, its magnitude.",
                "|Σ running loads beyond the element| at its own speed", "docs/nomenclature.md", us="lbf*ft",
                of_case=("Stations.Running load", "LoadTorque.Torque", "RatedTorque", "RatedPower"),
                printed="Continuous",
            ),
            number(
                "Service factor", "ratio", "As typed; blank = 1.", "As typed; blank = 1", MAKERS,
                of_row=("Elements.Service factor",), format=shown.TWO_DECIMALS,
            ),
            number(
                "Required rating", "torque", "Continuous torque times service factor.",
                "continuous torque × service factor", MAKERS, us="lbf*ft",
                of_row=("MakerSheet.Continuous torque", "MakerSheet.Service factor"),
            ),
            number(
                "Offered rating", "torque", "Rated torque of table Elements.", "As typed", MAKERS, us="lbf*ft",
                of_row=("Elements.Rated torque",),
            ),
            number(
                "Offered factor", "ratio", "Service factor that the offered rating has.",
                "offered rating / continuous torque", MAKERS,
                of_row=("MakerSheet.Offered rating", "MakerSheet.Continuous torque"), format=shown.TWO_DECIMALS,
            ),
            number(
                "Vibratory torque", "torque",
                "Largest response torque in continuous operation, zero-to-peak; blank where it is unbounded.",
                "Largest torque of the rows of SteadyState", STEADY, us="lbf*ft", of_row=("SteadyState.Torque",),
                printed="Vibratory, 0‑pk",
            ),
            number(
                "Vibratory limit", "torque", "As typed in table Elements.", "As typed", MAKERS, us="lbf*ft",
                of_row=("Elements.Vibratory limit",), pane=Pane.MINOR,
            ),
            number(
                "Peak torque", "torque", "Largest magnitude in the start and in all events.",
                "Larger extreme of StartupPeaks and EventPeaks", f"{TRANSIENT}; {EVENT_METHOD}", us="lbf*ft",
                of_row=(
                    "StartupPeaks.Maximum torque", "StartupPeaks.Minimum torque", "EventPeaks.Maximum",
                    "EventPeaks.Minimum",
                ),
                error=ReportedError.PEAKS, printed="Peak",
            ),
            number(
                "Peak torque limit", "torque", "As typed in table Elements.", "As typed", MAKERS, us="lbf*ft",
                of_row=("Elements.Peak torque limit",), pane=Pane.MINOR,
            ),
            number(
                "Reversing torque", "torque", "How far the torque falls below zero in the start or an event; 0: it does not.",
                "−(smaller extreme of StartupPeaks and EventPeaks), 0 where that is positive", REVERSALS, us="lbf*ft",
                of_row=("StartupPeaks.Minimum torque", "EventPeaks.Minimum"), error=ReportedError.PEAKS,
                share_of="Peak torque", printed="Reversing",
            ),
            number(
                "Reversal limit", "torque", "As typed in table Elements.", "As typed", MAKERS, us="lbf*ft",
                of_row=("Elements.Reversal limit",), pane=Pane.MINOR,
            ),
            integer(
                "Reversals", "Number of torque reversals in the start, of every element.",
                "Passages of the torque below zero that are deeper than 0.1 % of the element's largest torque",
                f"{REVERSALS}; docs/method.md, Torque reversals", of_case=START,
            ),
            number(
                "Longest reversal", "time", "Longest single reversal.", "The longest of the passages counted",
                "docs/method.md, Torque reversals", of_case=START,
            ),
            integer(
                "Cycles above rated",
                "Passages of the torque in the start beyond the offered rating, either way; where that is blank, beyond the required one.",
                "Level crossings of the rating, counted as reversals are at zero",
                f"{RAINFLOW.cited}-85, 5.1; docs/method.md, Torque reversals",
                of_row=("MakerSheet.Offered rating", "MakerSheet.Required rating"), of_case=START,
            ),
            sentence(
                "Note", "What the numbers alone do not say.", "Summary of the row", MAKERS,
                of_row=("MakerSheet.Peak torque", "MakerSheet.Vibratory torque"), width=20.0, pane=Pane.MINOR,
            ),
            number(
                "Tooth force", "force", "Force normal to the flanks at the peak torque, of a mesh with pitch radius.",
                "F = T / (r_b cos β_b) of the peak torque; r_b = pitch radius × cos α_t, tan α_t = tan α_n / cos β",
                "ISO 21771, base circle", of_row=(
                    "MakerSheet.Peak torque", "Meshes.Pitch radius drive", "Meshes.Pressure angle", "Meshes.Helix angle",
                ),
                error=ReportedError.PEAKS,
            ),
            number(
                "Heat", "power", "Not calculated yet: blank.", "Not calculated yet", MAKERS, si="kW", us="kW",
                of_row=("SteadyState.Torque", "Elements.Loss factor", "Elements.Damping"), pane=Pane.WORKBOOK,
            ),
            number(
                "Safety factor", "ratio",
                "Least of the limits typed over their torque, and of offered over required rating; blank: no limit, or one "
                "that nothing is calculated for.",
                "min(offered / required rating, vibratory limit / vibratory torque, peak limit / peak, reversal limit / "
                "reversing torque)", SAFETY,
                of_row=(
                    "MakerSheet.Offered rating", "MakerSheet.Required rating", "MakerSheet.Vibratory limit",
                    "MakerSheet.Vibratory torque", "MakerSheet.Peak torque limit", "MakerSheet.Peak torque",
                    "MakerSheet.Reversal limit", "MakerSheet.Reversing torque",
                ),
                format=shown.TWO_DECIMALS, error=ReportedError.PEAKS,
            ),
        ),
    ),
    table(
        "EventPeaks", sheet="Torque and motor", caption="Peaks of events",
        help="Extremes from the event on, the torques of operation or start included, at own speed; stress nominal without "
        "SCF.",
        row_name=("Event", "Element"), changes_shown=("Maximum", "Minimum"), of_the_start=True, rank=7,
        later=True,
        columns=(
            text("Event", "Name of the event.", trace=named("EventTorque.Event")),
            text("Element", "Element.", kind="element", trace=named("Elements.Element")),
            number(
                "Maximum", "torque", "Largest torque.", f"{EVENT_RESPONSE}; {PEAK}", EVENT_METHOD,
                us="lbf*ft", of_case=EVENT, format=shown.SIGNED, error=ReportedError.EVENTS,
            ),
            number(
                "Minimum", "torque", "Smallest torque.", f"{EVENT_RESPONSE}; {PEAK}", EVENT_METHOD,
                us="lbf*ft", of_case=EVENT, format=shown.SIGNED, error=ReportedError.EVENTS,
            ),
            number(
                "Time", "time", "When the larger of the two magnitudes occurs, from the event on.",
                "Instant of the larger extreme", EVENT_METHOD,
                of_row=("EventPeaks.Maximum", "EventPeaks.Minimum"), of_case=EVENT, pane=Pane.MINOR,
            ),
            number(
                "Times rated", "ratio", "Larger magnitude over RatedTorque, both at motor speed.",
                "larger extreme × speed ratio / RatedTorque", LABEL,
                of_row=("EventPeaks.Maximum", "EventPeaks.Minimum"),
                of_case=("RatedTorque", "RatedPower", "Stations.Speed ratio"), format=shown.TWO_DECIMALS,
                error=ReportedError.EVENTS,
            ),
            number(
                "Peak stress", "pressure", "Nominal shear stress of the larger magnitude, without SCF.",
                f"{STRESS} of the larger extreme; nominal, without SCF", STRENGTH,
                of_row=("EventPeaks.Maximum", "EventPeaks.Minimum", *SECTION), error=ReportedError.EVENTS,
            ),
            number(
                "Damage", "count", "Miner sum of one such event, the worst one where something is worst; of one in a start, from it to the end of "
                "the start.",
                f"Σ nᵢ/Nᵢ over the rainflow cycles of Kf · {STRESS}; amplitude = half range, mean as in AllowableStarts",
                FIGURE_3, of_case=(*EVENT, *FATIGUE, "MeanStress"), format=shown.DAMAGE, error=ReportedError.EVENT_DAMAGE,
            ),
            number(
                "Damage per life", "count", "The same times Per life; blank where that is blank.",
                "damage × Per life", FIGURE_3, of_row=("EventPeaks.Damage",),
                of_case=("EventTorque.Per life", "MotorEvents.Per life"), format=shown.DAMAGE,
                error=ReportedError.EVENT_DAMAGE,
            ),
            number(
                "Damage error", "fraction", "Estimated relative error of the damage.",
                "As the error of the allowable starts", "docs/method.md, Errors of a start",
                of_row=("EventPeaks.Damage",), of_case=("TolerancePeak",), format=shown.ERROR,
                error=ReportedError.ESTIMATE, pane=Pane.WORKBOOK,
            ),
            number(
                "Limit", "torque", "Least of Peak torque limit and the torque of shear yield.",
                "Peak torque limit; the torque whose nominal stress is Yield / 2 (maximum shear theory); the lower one",
                STRENGTH, us="lbf*ft",
                of_row=("Elements.Peak torque limit", "Elements.Material", *SECTION), of_case=("Materials.Yield",),
            ),
            verdict(
                "Verdict", "pass, pass within its error, incomplete, fail, or not judged.",
                "pass where the larger extreme with its error is within the limit; incomplete where something without a "
                "bound is left out; not judged without a limit, or where the event was not calculated",
                EVENT_METHOD, of_row=("EventPeaks.Maximum", "EventPeaks.Minimum", "EventPeaks.Limit"),
            ),
            number(
                "Error", "fraction", "Estimated error of maximum and minimum, relative to the larger.",
                "Change of both extremes from spacing h to h/2 (the samples are exact), with what comes after the end, a "
                "bound on fast modes, the error from the pieces of distributed shafts and, of a worst instant, what "
                "halving the spacing of its scan changes",
                EVENT_METHOD, of_case=("TolerancePeak",), format=shown.ERROR,
                error=ReportedError.ESTIMATE, pane=Pane.MINOR,
            ),
            number(
                "Left out", "fraction", "Bound on the relative change by what is left out; blank: none is known.",
                "0; no bound where teeth would separate and backlash is forced off, or MaximumTime ends the event, or the start "
                "it begins in, early",
                EVENT_METHOD, of_case=("EffectChoices.Choice", "MaximumTime", *CLEARANCES),
                format=shown.ERROR, error=ReportedError.ESTIMATE, pane=Pane.MINOR,
            ),
            *_worst_instant("torque"),
            *_worst_instant("damage", " of damage"),
            number(
                "Safety factor", "ratio", "Limit over the larger extreme; blank: not judged.", "Limit / larger extreme",
                SAFETY, of_row=("EventPeaks.Maximum", "EventPeaks.Minimum", "EventPeaks.Limit"),
                format=shown.TWO_DECIMALS, error=ReportedError.EVENTS, pane=Pane.MINOR,
            ),
        ),
    ),
    table(
        "AirGapTorque", sheet="Torque and motor", caption="Air-gap torque of events of motors",
        help="Torque of the motor at its own speed in each event of table MotorEvents, and in a start in time; negative "
        "brakes.",
        row_name=("Event",), changes_shown=("Largest",), of_the_start=True, rank=7, later=True,
        columns=(
            text(
                "Event", "Name of the event; start: from the closing of the breaker on.",
                trace=named("MotorEvents.Event"),
            ),
            number(
                "Largest", "torque", "Largest torque in magnitude.", f"{AIR_GAP} × S / ω_s; extreme, also between samples",
                EVENT_METHOD, us="lbf*ft", of_case=EVENT, format=shown.SIGNED, error=ReportedError.EVENTS,
            ),
            number(
                "Time", "time", "When, from the event on.", "Instant of the largest torque", EVENT_METHOD,
                of_row=("AirGapTorque.Largest",), of_case=EVENT, pane=Pane.MINOR,
            ),
            number(
                "Closed form", "torque",
                "Largest magnitude in the first cycle with constant flux linkages: no resistance, one speed. A check, no "
                "bound.",
                "T = ψd (ψq − ψ''q) / Xq'' − ψq (ψd − ψ''d) / Xd'' with fluxes of the rotor that stay",
                EVENT_METHOD, us="lbf*ft", of_case=EVENT, format=shown.SIGNED,
            ),
            number(
                "Ratio", "ratio", "Largest torque over the closed form.", "|largest| / closed form", EVENT_METHOD,
                of_row=("AirGapTorque.Largest", "AirGapTorque.Closed form"), format=shown.TWO_DECIMALS,
            ),
            number(
                "Error", "fraction", "Estimated error of the largest torque.",
                "Change of the largest torque from spacing h to h/2; of a worst instant with what halving its spacing changes",
                EVENT_METHOD, of_case=("TolerancePeak",),
                format=shown.ERROR, error=ReportedError.ESTIMATE, pane=Pane.MINOR,
            ),
            *_worst_instant("torque"),
            number(
                "Slip", "fraction", "Slip of the motor in operation, before the event; 0 of a motor in step; blank in a start.",
                "The slip at which the average torque is that which balances the running loads", EVENT_METHOD,
                of_case=EVENT, format=shown.TELLING_SHARE, pane=Pane.MINOR,
            ),
        ),
    ),
    table(
        "Effects", sheet="Effects and accuracy", caption="Effects",
        help="Effects simulated and left out, each with its deciding number.",
        rows=len(EFFECTS), row_name=("Effect",), changes_shown=("On",), room=len(EFFECTS),
        worded=True, rank=7,
        columns=(
            text("Effect", "Name of the effect.", "Effect that a start may require", "docs/effects.md"),
            text(
                "Choice", "What was chosen in EffectChoices: auto, on or off.",
                "As chosen; blank = auto", "docs/effects.md", of_row=("EffectChoices.Choice",),
            ),
            switch(
                "On", "Whether the effect was simulated.",
                "Forced by the choice, else on where the deciding number is beyond the limit",
                "docs/effects.md; docs/method.md, The plan",
                of_row=("Effects.Deciding number", "Effects.Limit", "Effects.Choice"),
            ),
            number(
                "Deciding number", "deciding number", "Number that decided whether the effect is simulated.",
                "A quick estimate for each effect, from modes, damping, rigid-body run-up and the "
                "linear start",
                "docs/effects.md, The effects", of_case=START,
            ),
            number(
                "Limit", "deciding number", "Limit of the deciding number.",
                "Tolerance divided by the gain of the effect (gains and other limits: "
                "docs/effects.md)",
                "docs/method.md, The plan", of_case=("TolerancePeak", "ToleranceStarts"),
            ),
            number(
                "Bound", "fraction", "Largest change of a result if the effect is left out; 0 = none.",
                "Deciding number × gain; 0 where leaving it out is exact; of electrical damping without MotorData an "
                "estimate: the change of a peak with motor curves read at the other speed",
                "docs/method.md, The plan", of_row=("Effects.Deciding number",),
                error=ReportedError.ESTIMATE,
            ),
            number(
                "Time", "calculation time",
                "Computing time: measured where the effect has its own run (backlash, pull-in and "
                "aborted start share one), else estimated from the linear start.",
                "Wall time, measured where the effect has a run of its own, else estimated from the linear start",
                "docs/effects.md", wall_time=True,
            ),
            sentence(
                "Why", "The decision in words.", "The decision in words", "docs/effects.md",
                of_row=("Effects.Deciding number", "Effects.Limit"), width=96.0,
            ),
        ),
    ),
    table(
        "AccuracyCost", sheet="Effects and accuracy", caption="Accuracy and its cost",
        help="Error against computing time of this case on this machine.",
        row_name=("Method", "Setting"), of_the_start=True, worded=True, rank=7,
        columns=(
            text(
                "Method", "Method of the time integration, or the analysis.",
                "Method of the time integration, or the analysis",
                "docs/method.md, What accuracy costs", of_case=("Method",),
            ),
            text(
                "Setting", "Wanted tolerance or step.", "Wanted tolerance or step",
                "docs/method.md, What accuracy costs", of_case=("TolerancePeak",),
            ),
            number(
                "Error peak", "fraction", "Error of the peak torques.",
                "Largest error of a peak / larger extreme of its element: estimated from h "
                "and h/2; of an alternative, the change of the start as calculated by it; in a study, found by "
                "comparison with a reference 256 times more accurate "
                "(with events: with a start calculated to a tolerance 100 times finer, where the "
                "step allows)",
                "docs/method.md, What accuracy costs", of_case=START, format=shown.STUDIED,
                error=ReportedError.ESTIMATE, printed="Error of peaks",
            ),
            number(
                "Error starts", "fraction", "Error of the allowable starts.",
                "As in column Error peak, but for the allowable starts", "docs/method.md, What accuracy costs",
                of_case=(*START, *FATIGUE), format=shown.STUDIED, error=ReportedError.ESTIMATE,
                printed="Error of starts",
            ),
            number(
                "Time", "calculation time", "Wall time; in a study processor time, the median of repeats.",
                "Wall time of each analysis; in a study processor time, the median of repeats",
                "docs/method.md, What accuracy costs", wall_time=True,
            ),
        ),
    ),
    table(
        "Audit", sheet="Audit", caption="Audit",
        help="What was calculated, from which inputs, by which version and method.",
        row_name=("Item",), worded=True, rank=7,
        columns=(
            text("Item", "Name of the item.", "Name of the item", "docs/audit.md"),
            mixed(
                "Value", "Its value.",
                "Value of the item. The digest is SHA-256 of the SI values of all inputs except "
                "title block and descriptions, rounded to 12 significant digits",
                "docs/audit.md; FIPS 180-4", width=110.0,
            ),
        ),
    ),
)  # fmt: skip


#: Tables of the workbook alone, beside the results of the contract; the JSON has none of them.
WORKBOOK_TABLES: tuple[TableSpec, ...] = (
    table(
        "StartCycles", sheet="Fatigue", caption="Cycles of one start",
        help="Largest damage first; a row without amplitude holds all other cycles.",
        row_name=("Amplitude",), of_the_start=True,
        columns=(
            number(
                "Amplitude", "pressure", "Stress amplitude of a cycle, with SCF or Kf.",
                f"Half range of a rainflow cycle of Kf · {STRESS}; with Goodman over 1 − mean / 0.67 UTS", ASTM,
                of_case=("AllowableStarts.Governing", "MeanStress", *FATIGUE, *START), error=ReportedError.PEAKS,
            ),
            number(
                "Cycles", "count", "n: cycles in one start; 0.5 is a half cycle.",
                "n: 1 for a closed cycle, 0.5 for a half cycle of the residue", ASTM,
                of_case=("RainflowResidue", *START), format=shown.STARTS,
            ),
            number(
                "Cycles to failure", "count", "N at this amplitude on the S-N line.",
                "N on the log-log S-N line at this amplitude; below endurance unlimited, or by the "
                "rule in Below endurance",
                FIGURE_3, of_row=("StartCycles.Amplitude",),
                of_case=(
                    "SNPoints.Cycles", "SNPoints.Stress", "Materials.Endurance", "Materials.Basis",
                    "Materials.Below endurance",
                ),
                format=shown.WHOLE, unlimited=True, error=ReportedError.ALL_STARTS,
            ),
            number(
                "Damage", "count", "n / N as calculated.", "n / N", FIGURE_3,
                of_row=("StartCycles.Cycles", "StartCycles.Cycles to failure"), format=shown.DAMAGE,
                error=ReportedError.ALL_STARTS,
            ),
        ),
        extra_columns=(
            number(
                "Damage check", "count", "Live formula: n / N.",
                "n / N, calculated by the spreadsheet", FIGURE_3,
                of_row=("StartCycles.Cycles", "StartCycles.Cycles to failure"),
                formula=live.CYCLE_DAMAGE_CHECK, format=shown.DAMAGE,
            ),
        ),
    ),
    table(
        "BearingForces", sheet="Start", caption="Bearing forces",
        help="Largest radial bearing force of each gear on elastic bearings, excluding weight.",
        row_name=("Station",), changes_shown=("Force",), of_the_start=True, rank=5,
        columns=(
            text("Station", "The gear.", kind="station", trace=named("Stations.Station")),
            number(
                "Force", "force", "Largest radial force, vibratory plus transmitted.",
                "The largest |k_b u + c_b u̇| over x and y, with the transmitted force, excluding "
                "weight",
                f"{PAPER.cited}, Figure 4c; docs/method.md, Clearances",
                of_row=(
                    "Meshes.Bearing stiffness drive", "Meshes.Bearing stiffness driven",
                    "Meshes.Bearing damping drive", "Meshes.Bearing damping driven",
                ),
                of_case=START, error=ReportedError.PEAKS,
            ),
            number(
                "Time", "time", "When.", "When", "docs/method.md, Clearances",
                of_row=("BearingForces.Force",), of_case=START,
            ),
        ),
    ),
    table(
        "EnergyShares", sheet="Results", caption="Sensitivities",
        help="Frequency shift for the change above: ± ½ × share × change × f, + for a stiffness, "
        "− for an inertia.",
        row_name=("Quantity", "Of"),
        columns=(
            text(
                "Quantity", "stiffness or inertia; bearing stiffness, lateral mass of gears.",
                "Stiffness or inertia", SVD, of_case=MODAL,
            ),
            text("Of", "Element or station.", "Element or station, as typed", SVD, of_case=MODAL),
            *(
                number(
                    f"Share {mode}", "count", f"Its share of the strain or kinetic energy of mode {mode}.",
                    "k (Bφ)² of the element or J φ² of the station / sum of all; nearly equal "
                    "modes are summed",
                    "docs/nomenclature.md, strain-energy share; Lancaster, Numer. Math. 6 (1964) 377",
                    of_case=MODAL, format=shown.FOUR_DECIMALS,
                )
                for mode in range(1, SHARE_MODES + 1)
            ),
        ),
        extra_columns=tuple(
            number(
                f"Shift {mode}", "frequency",
                f"Live formula: ± 1/2 × Share {mode} × change × frequency of mode {mode}, in Hz.",
                "± ½ × share × change × f, + for a stiffness, − for an inertia, calculated by the "
                "spreadsheet",
                "Rayleigh, Theory of Sound I, § 88; docs/tolerances.md",
                of_row=(f"EnergyShares.Share {mode}", "NaturalFrequencies.Frequency"),
                formula=live.energy_shift(mode), format=shown.SHIFT if mode <= 3 else "",
            )
            for mode in range(1, SHARE_MODES + 1)
        ),
    ),
    table(
        "Plans", sheet="Effects and accuracy", caption="Plans",
        help="Results shown are those of the last plan; a new plan is made when the run "
        "contradicts the previous plan.",
        row_name=("Plan",), worded=True, rank=7,
        columns=(
            integer(
                "Plan", "Number of the plan, from 1.", "Numbered from 1; the last one is reported",
                "docs/method.md, The plan",
            ),
            sentence(
                "Reason", "Reason for the plan.", "Why it was made", "docs/method.md, The plan",
                width=96.0,
            ),
        ),
    ),
)  # fmt: skip
