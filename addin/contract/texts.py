"""Words on the shipped workbooks: captions, one sentence a sheet, and the sheet `Notes`."""

from __future__ import annotations

from collections.abc import Mapping

from engine.case.defaults import NOTABLE_REVERSAL
from engine.case.practice_limits import PRACTICE_LIMITS

__all__ = [
    "CAPTIONS",
    "CONTACT_LAW",
    "EFFECT_NOTES",
    "NOTES",
    "REVERSAL_NOTES",
    "SHEET_INTROS",
    "SHORT_CAPTIONS",
]

#: Caption above each table.
CAPTIONS: Mapping[str, str] = {
    "Stations": "Stations",
    "Elements": "Elements",
    "Meshes": "Meshes",
    "ModeDamping": "Mode damping",
    "MotorTorque": "Motor torque",
    "LoadTorque": "Load torque",
    "TorqueTime": "Torque against time (optional)",
    "Materials": "Materials",
    "SNPoints": "S-N points (zero-to-peak)",
    "Excitations": "Excitations",
    "EffectChoices": "Effect choices",
    "Verdicts": "Verdicts",
    "NaturalFrequencies": "Natural frequencies",
    "ModeShapes": "Mode shapes",
    "SeparationMargins": "Separation margins",
    "SteadyState": "Steady-state response",
    "StartupPeaks": "Peaks of the start",
    "StartupCrossings": "Crossings of 2 × slip frequency",
    "AllowableStarts": "Allowable starts",
    "StartCycles": "Cycles of one start",
    "TorqueReversals": "Torque reversals",
    "BearingForces": "Bearing forces",
    "EnergyShares": "Sensitivities",
    "Effects": "Effects",
    "Plans": "Plans",
    "AccuracyCost": "Accuracy and its cost",
    "Audit": "Audit",
}

#: Tables with another table close to their right: the caption stands alone.
SHORT_CAPTIONS = frozenset({"MotorTorque", "LoadTorque", "TorqueTime", "Materials", "SNPoints"})

#: One sentence below the strip of each sheet.
SHEET_INTROS: Mapping[str, str] = {
    "Live": "Modes, margins and shaft stiffness of what is typed now, without a start. In cells of "
    "your own: functions of LiveModel, such as TV_STARTS.",
    "Case": "What the case is and how it is calculated. Blue on yellow is typed; the unit stands "
    "in the cell right of the number.",
    "Train": "The mass-elastic table. Units stand above the headers; a blank cell means what its "
    "prompt says. Insert table rows where a table is full.",
    "Torque": "Torque against speed of the motor and of each driven machine; every curve begins "
    "with the row of its lowest speed.",
    "Fatigue": "Strength and S-N lines of the shaft materials. Amplitudes are zero-to-peak; "
    "nominal stress times SCF is compared with them.",
    "Excitation": "What shakes the train in continuous operation. Leave the table blank for the "
    "usual: 1× and 2× of every shaft speed, 1× and 2× line frequency.",
    "Frequencies": "Undamped torsional natural frequencies and mode shapes; rigid-body modes come "
    "first with frequency 0.",
    "Margins": "Margin = |f − f_exc| / f_exc, the least over the speeds of continuous operation; "
    "0 where a line crosses the mode inside them.",
    "Steady state": "Response to continuous excitation, by default 1 % zero-to-peak of the "
    "transmitted torque. Stresses include SCF and are compared with UTS/25.",
    "Start-up": "The start from rest to EndSpeed, or to the end of pull-in or coast-down. Torques "
    "are at each element's own speed; a mesh's on its From side. Stresses here are nominal, without "
    "SCF.",
    "Histories": "Torque, stress or tooth load against time from rest to EndSpeed (the paper's "
    "Figures 1, 7 and 8). Each point drawn is calculated; the extremes are kept.",
    "Starts": "Fatigue damage of one start by rainflow count and Miner's rule; allowable starts "
    "are 1 / damage. Amplitude = half range times SCF; mean stress is ignored.",
    "Reversals": "Where teeth are unloaded or part in the start: a reversal is one passage of the "
    "transmitted torque below zero. Torques are those of the From side, at its own speed.",
    "Effects": "Which effects this case calls for, and the number that decided each. Force one on or "
    "off in table EffectChoices on sheet Case.",
    "Accuracy": "What accuracy costs in time, for this very case on this machine.",
    "Audit": "What was calculated, from which inputs, by which version, method and equations.",
    "Notes": "How to use this workbook, what it calculates and what its colours mean.",
    "Trace": "What each number on a result sheet is, by which equation and after which source, and "
    "what it comes from. Of one cell, with places and values: torsionbook verify FILE --trace 'Sheet!H9'",
}

#: The damping law of this workbook: formula, and what it shows while ContactLaw is blank.
CONTACT_LAW: tuple[str, str] = (
    '="In this workbook: "&IF(run_ContactLaw="",IF(ContactLaw="","limited",ContactLaw),'
    "run_ContactLaw)",
    "In this workbook: limited",
)

#: Notes of sheet `Reversals`: term, and text or formula.
REVERSAL_NOTES: tuple[tuple[str, str], ...] = (
    (
        "Reversal",
        f"One passage of the torque below zero that is deeper than {NOTABLE_REVERSAL:.1%} of the "
        "element's largest torque. It begins where the torque last crossed zero and ends where it "
        "next rises above zero, so that torque trembling about zero is not counted twice.",
    ),
    (
        "Model",
        "linear: the teeth are taken to stay in contact, the torque below zero says that they would "
        "not. clearance: the teeth part, cross the gap and meet again; time unloaded is then the "
        "time without contact, tooth force and recontact speed are along the normal of the flank.",
    ),
    (
        "Contact law",
        "Damping of teeth in contact. limited: never pulls and never exceeds the spring force "
        "(Modelica Standard Library 4.0, ElastoBacklash; Hunt and Crossley 1975). no adhesion: never "
        "pulls (ElastoBacklash2). Scalar ContactLaw on sheet Case.",
    ),
    ("", CONTACT_LAW[0]),
    (
        "Limit",
        "The maker's Reversal limit of table Elements, compared with the depth below zero; blank = "
        "not judged. What the literature says:",
    ),
    *(
        (f"{limit.applies_to}, {limit.service}", f"{limit.says} ({limit.source})")
        for limit in PRACTICE_LIMITS
    ),
)

#: Notes of sheet `Effects`, below its table.
EFFECT_NOTES: tuple[str, ...] = (
    "The plan is made from modes, damping, rigid run-up and the linear start.",
    "Bound: the most that leaving an effect out changes an answer; 0 = exact;",
    "blank = it is on, or nothing is known of it (no input, forced off).",
    "Time: what it cost in this run, or is estimated to cost when on;",
    "backlash, pull-in and trip share one run and each show the whole of it.",
)

#: Blocks of sheet `Notes`: heading, then term and text.
NOTES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "How to use": (
        (
            "Fill in",
            "Type the inputs on sheets Case, Train, Torque, Fatigue and Excitation. Units may be "
            "changed in the cell above a column or right of a number; numbers are read in the unit "
            "shown, never converted.",
        ),
        (
            "Check",
            "torsionbook check FILE reads everything and names each cell that needs attention, "
            "without calculating.",
        ),
        (
            "Recalculate",
            "torsionbook recalc FILE writes a new workbook with all results; --in-place replaces "
            "this one and keeps a .bak. Close the workbook first.",
        ),
        (
            "What is rewritten",
            "Only the result tables, the hidden sheets ChartData and Lists (RunFacts), and titles "
            "of charts that a spreadsheet program cut off from ChartData. "
            "Everything else may be moved, restyled and extended: tables are found by their "
            "names, columns by their headers, scalars by their defined names.",
        ),
        (
            "Results and inputs",
            "Results belong to the inputs whose SHA-256 stands on Summary and Audit. After any "
            "change of an input they are old until the next recalculation.",
        ),
    ),
    "Conventions": (
        (
            "Own speed",
            "Inertias, stiffnesses, torques and stresses are those of the shaft itself, at its own "
            "speed. What is referred to the motor says so.",
        ),
        (
            "Amplitudes",
            "A torque or stress is zero-to-peak unless it is called peak-to-peak.",
        ),
        (
            "Sign",
            "Positive torque drives in the running direction. A negative torque of a mesh unloads "
            "its teeth.",
        ),
        (
            "Margins",
            "20 % for calculated, 10 % for measured frequencies (Szenasi & von Nimitz 1978, "
            "Steady State Torsional Analysis).",
        ),
        (
            "Verdicts",
            "pass; accepted by forced response: the margin fails and every judged stress stays "
            "within UTS/25; fail. No damping at a resonance is unbounded, a fail.",
        ),
    ),
    "Equations": (
        ("Natural frequencies", "K φ = ω² J φ, free-free, all gears referred exactly."),
        (
            "Start-up excitation",
            "f = 2 f_line (1 − n / n_sync): twice the slip frequency falls from 2 × line frequency "
            "to 0. A mode f is crossed at 100 (1 − f / 2 f_line) % speed (paper, Table 1).",
        ),
        (
            "Equation of motion",
            "J θ'' + C θ' + K θ = T(t, θ'), paper eq. 1; integrated exactly between steps "
            "(exponential), or by average acceleration, paper eqs 2 to 4 (Newmark).",
        ),
        ("Shear stress", "τ = 16 T D / (π (D⁴ − d⁴)), nominal; times SCF where it says so."),
        (
            "Steady-state limit",
            "UTS / 25 (Mil-Std-167 as the paper reads it), compared as Stress basis on sheet "
            "Case says; stresses with SCF.",
        ),
        (
            "Fatigue",
            "q = Σ nᵢ / Nᵢ over the cycles of one start, allowable starts 1 / q (paper, Figure 3). "
            "Cycles by rainflow counting (ASTM E1049); the paper's cycle-by-cycle count stands "
            "beside. Bending data are halved for torsion. N between S-N points is log-log.",
        ),
        ("Yield", "Nominal peak stress is judged against Yield / 2 (maximum shear theory)."),
    ),
    "Limits of this version": (
        (
            "Contact",
            "Teeth are massless springs with a clearance: the wave inside a tooth, friction and "
            "the oil squeezed between flanks are not calculated.",
        ),
        (
            "Bearings",
            "A bearing is the same in all radial directions and does not change with speed or load.",
        ),
        (
            "Drawn histories",
            "Charts show the least and the largest calculated value of 500 equal intervals of "
            "the start, so that no peak is lost. Results never come from them; KeepHistory "
            "writes the full history to a file.",
        ),
        (
            "Reference",
            "F. R. Szenasi and W. W. von Nimitz, Transient Analyses of Synchronous Motor Trains, "
            "1978.",
        ),
    ),
}
