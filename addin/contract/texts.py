"""Words on the shipped workbooks: captions, one sentence a sheet, and the sheet `Notes`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.sources import CONTACT, IMPACT, MIL_STANDARD, PAPER, PAPER_TITLE, RAINFLOW
from engine.case.defaults import NOTABLE_REVERSAL
from engine.case.practice_limits import PRACTICE_LIMITS

#: Words on sheet Effects and accuracy until the study has been run.
NO_STUDY = (
    "Errors are estimates of this calculation; computing times are measured. Error "
    "against time by the exponential and by the paper's method, for this case: "
    "torsionbook accuracy FILE"
)
#: The damping law of this workbook: formula, and what it shows while ContactLaw is blank.
CONTACT_LAW: tuple[str, str] = (
    '="In this workbook: "&IF(run_ContactLaw="",IF(ContactLaw="","limited",ContactLaw),'
    "run_ContactLaw)",
    "In this workbook: limited",
)

#: Above the trace on sheet Notes.
TRACE_INTRO = (
    "Meaning, equation, source and inputs of each number on the result sheets. For one cell, with the cells and "
    "values it comes from: torsionbook verify FILE --trace 'Results!AW9'"
)

#: Notes on torque reversals: term, and text or formula.
_REVERSAL_NOTES: tuple[tuple[str, str], ...] = (
    (
        "Reversal",
        f"One passage of the torque below zero that is deeper than {NOTABLE_REVERSAL:.1%} of "
        "the element's largest torque. It begins at the last zero crossing before that depth "
        "and ends where the torque next rises above zero, so that oscillation about zero "
        "counts once.",
    ),
    (
        "Model",
        "linear: the teeth stay in contact in the calculation; a torque below zero means "
        "that real teeth would separate. clearance: the teeth separate, cross the gap and "
        "re-engage; time unloaded is then the time without contact, tooth force and "
        "recontact speed are normal to the flank.",
    ),
    (
        "Contact law",
        "Damping of teeth in contact. limited: the contact force never pulls and damping never "
        f"exceeds the spring force ({CONTACT}; {IMPACT.named} 1975). no adhesion: the contact "
        "force never pulls (ElastoBacklash2). Set ContactLaw on sheet Case.",
    ),
    ("", CONTACT_LAW[0]),
    (
        "Limit",
        "The maker's Reversal limit of table Elements, compared with the depth below zero; "
        "blank = a reversal is not judged. Limits in the literature:",
    ),
    *(
        (f"{limit.applies_to}, {limit.service}", f"{limit.says} ({limit.source})")
        for limit in PRACTICE_LIMITS
    ),
)

#: Notes of sheet `Effects`, below its table.
EFFECT_NOTES: tuple[str, ...] = (
    "The plan follows from modes, damping, rigid-body run-up and the linear start.",
    "Bound: largest change of a result if the effect is left out; 0 = none;",
    "blank = effect on, or bound unknown (no input, forced off).",
    "Time: computing time in this run; of an effect that is off, an estimate;",
    "backlash, pull-in and trip share one run; each shows the total time of that run.",
)

#: Blocks of sheet `Notes`: heading, then term and text.
NOTES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "How to use": (
        (
            "Fill in",
            "Type the inputs on sheets Case, Train, Torque and motor, and Fatigue. Units may be "
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
            "What torsionbook rewrites",
            "Only the result tables, the hidden sheets ChartData, Lists (RunFacts) and Inputs "
            "calculated, and chart titles that lost their link to ChartData. Everything else may be moved, restyled "
            "and extended: tables are found by their names, columns by their headers, scalars by "
            "their defined names.",
        ),
        (
            "Results and inputs",
            "Results belong to the inputs whose SHA-256 is shown on Summary and Audit. When an input, its "
            "unit or the number of rows of a table differs from the copy on the hidden sheet Inputs "
            "calculated, each banner says INPUTS CHANGED SINCE CALCULATION until the next recalculation, "
            "or until the input is as it was. The title block and descriptions change no result.",
        ),
    ),
    "Conventions": (
        (
            "Own speed",
            "Inertias, stiffnesses, torques and stresses are those of the shaft itself, at its "
            "own speed. Values referred to the motor are labelled so.",
        ),
        (
            "Amplitudes",
            "A torque or stress is zero-to-peak unless it is called peak-to-peak.",
        ),
        (
            "Sign",
            "Positive torque acts in the running direction. A negative mesh torque unloads the "
            "teeth.",
        ),
        (
            "Margins",
            f"20 % for calculated, 10 % for measured frequencies ({PAPER.cited}, "
            "Steady State Torsional Analysis).",
        ),
        (
            "Verdicts",
            "pass; pass within its error: by less than the error of the result; accepted by forced "
            "response: the margin is not kept, but the elements that carry the mode are within their limits "
            "at the resonance; incomplete: not judged, or only in part; fail. An undamped mode at resonance "
            "has an unbounded response: fail.",
        ),
    ),
    "Equations": (
        ("Natural frequencies", "K φ = ω² J φ, free-free, with gear ratios as exact constraints."),
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
        ("Shear stress", "τ = 16 T D / (π (D⁴ − d⁴)), nominal; times SCF where stated."),
        (
            "Steady-state limit",
            f"UTS / 25 ({MIL_STANDARD.cited}, as cited by Szenasi & von Nimitz), compared with the "
            "stress chosen in StressBasis on sheet Case; stresses include SCF.",
        ),
        (
            "Fatigue",
            "q = Σ nᵢ / Nᵢ over the cycles of one start, allowable starts 1 / q (paper, Figure 3). "
            f"Cycles by rainflow counting ({RAINFLOW.cited}); the paper's cycle-by-cycle count is "
            "shown beside it. Bending data are halved for torsion. N between S-N points is interpolated log-log.",
        ),
        ("Yield", "Nominal peak stress is judged against Yield / 2 (maximum shear theory)."),
    ),
    "Torque reversals": _REVERSAL_NOTES,
    "Limits of this version": (
        (
            "Contact",
            "Teeth are massless springs with a clearance; stress waves in the tooth, friction "
            "and the oil squeeze film are not modelled.",
        ),
        (
            "Bearings",
            "Bearings have the same stiffness and damping in all radial directions, independent "
            "of speed and load.",
        ),
        (
            "Drawn histories",
            "Charts show the minimum and maximum of 500 equal time intervals of the start, so "
            "that no peak is lost. Results never use chart data; KeepHistory writes the full "
            "history to a file.",
        ),
        (
            "Reference",
            f"{PAPER_TITLE}, 1978.",
        ),
    ),
}
