"""Facts of the run that stand in the workbook beside the tables: what live formulas need."""

from __future__ import annotations

#: Rows of table `RunFacts`, in this order: what live formulas need, written by the calculation. New ones stand
#: last: names of workbooks made before refer to the rows above.
RUN_FACTS: tuple[tuple[str, str], ...] = (
    ("run_Stamp", "Inputs of the results"),
    ("run_Software", "Software and version"),
    ("run_Date", "Date of the calculation, UTC"),
    ("run_SHA256", "SHA-256 of the inputs"),
    ("run_Outcome", "How the start ended"),
    ("run_OutcomeWord", "Outcome of the start, short"),
    ("run_StartTime", "Duration of the start [s]"),
    ("run_SynchronousSpeed", "Synchronous speed [rpm]"),
    ("run_LineFrequency", "Line frequency [Hz]"),
    ("run_StartsFactor", "Factor on starts"),
    ("run_HzPerFrequency", "Hz per unit of NaturalFrequencies[Frequency]"),
    ("run_HzPerExcitation", "Hz per unit of SeparationMargins[Excitation frequency]"),
    ("run_PaPerUTS", "Pa per unit of Materials[UTS]"),
    ("run_PaPerAllowable", "Pa per unit of SteadyState[Allowable]"),
    ("run_GoverningShaft", "Shaft that table StartCycles belongs to"),
    ("run_SNExponent", "S-N exponent k of that shaft at the endurance limit"),
    (
        "run_Endurance",
        "Endurance limit of that shaft in torsion, in the unit of StartCycles[Amplitude]",
    ),
    ("run_NmPerMinimum", "N m per unit of TorqueReversals[Minimum torque]"),
    ("run_NmPerTransmitted", "N m per unit of TorqueReversals[Transmitted torque]"),
    ("run_ContactLaw", "Damping law of teeth in contact"),
    ("run_AccuracySentence", "Computing time of the wanted accuracy"),
    ("run_AccuracyReference", "Reference of the errors on sheet Effects and accuracy"),
    ("run_AccuracyInputs", "Inputs of sheet Effects and accuracy"),
    ("run_Poles", "Number of poles"),
    ("run_ShaftSpeeds", "Speeds of the other shafts with the motor at synchronous speed"),
    ("run_TotalRatio", "Speed ratio that is farthest from 1"),
    ("run_InertiaConstant", "Inertia constant H of the train [s]"),
    ("run_MotorInertiaConstant", "Inertia constant H of the motor alone [s]"),
    ("run_LoadShare", "LoadTorque at full speed over rated torque [%]"),
    ("run_RatedPower", "Rated power [kW]"),
    ("run_RatedTorque", "Rated torque [N m]"),
    ("run_RunningLoadShare", "Sum of the running loads over rated torque [%]"),
    ("run_PrintedModes", "What of modes and margins is not printed"),
    ("run_PrintedResponse", "What of the steady-state response is not printed"),
)
