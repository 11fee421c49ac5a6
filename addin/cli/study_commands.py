"""Commands of the studies and their lines of help; written by `make generated`."""

STUDY_COMMANDS = {
    "tune": "Calculate couplings and other quantities in every combination, and rank them with reasons.",
    "tolerances": "Calculate the scatter of frequencies, margins, peaks and allowable starts from that of the inputs.",
    "sensitivities": "Calculate sensitivities of frequencies, peak stress and allowable starts to each quantity.",
    "starts": "Calculate the start matrix and the damage ledger: starts at every voltage, and the life left under a duty.",
    "calibrate": "Calibrate: find the smallest change of uncertain inputs that explains what was measured.",
    "accuracy": "Measure error against computing time for this case.",
}
