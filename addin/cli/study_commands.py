"""Commands of the studies and their lines of help; written by `make generated`."""

STUDY_COMMANDS = {
    "tune": "Try couplings and other quantities in every combination, and rank them with the reasons.",
    "tolerances": "Show what the scatter of the inputs makes of frequencies, margins, peaks and starts.",
    "sensitivities": "Show what a small change of each quantity does to frequencies, peak stress and starts.",
    "starts": "Start matrix and damage ledger: starts at every voltage, and what a duty of them leaves.",
    "calibrate": "Calibrate: the least change of uncertain stiffnesses that explains measured frequencies.",
    "accuracy": "Show what accuracy costs in time: error against wall time of this very case.",
}
