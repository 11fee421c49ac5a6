"""Findings of a run as sections: what is printed, and what docs/benchmarks.md says."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks import report
from benchmarks.goals import TARGETS
from benchmarks.goals_beside import goals_section, kept_lines
from benchmarks.modes import OURS as OURS_MODES
from benchmarks.modes import OURS_ALL
from benchmarks.peers import Absent, Worker
from benchmarks.plots import draw_error_against_time, draw_modes
from benchmarks.report import Section
from benchmarks.response import OURS_ALIKE, OURS_FUNCTION, points_of
from benchmarks.start import EXPONENTIAL, start_points
from benchmarks.study_pages import draw_effects, effect_goals, effect_sections

__all__ = ["publish"]

MODES_PICTURE, RESPONSE_PICTURE, START_PICTURE = (
    "bench_modes.png",
    "bench_response.png",
    "bench_start.png",
)
#: Calls drawn in the picture of the modes.
DRAWN = (
    OURS_ALL,
    OURS_MODES,
    "openTorsion undamped_modal_analysis",
    "openTorsion modal_analysis",
    "openTorsion eigenmodes",
    "ROSS run_modal, sparse (its default)",
    "ROSS run_modal, dense",
)


def publish(
    found: dict[str, Any],
    workers: Sequence[Worker],
    absent: Sequence[Absent],
    *,
    page: Path | None,
    images: Path,
) -> None:
    """Print everything; with a page, also write it and draw its pictures."""
    responses, starts = points_of(found["responses"]), start_points(found["starts"])
    sections = _sections(found, responses, starts, workers, absent)
    report.show(sections)
    if page is None:
        return
    images.mkdir(parents=True, exist_ok=True)
    draw_modes(images / MODES_PICTURE, found["modes"], DRAWN)
    draw_error_against_time(
        images / RESPONSE_PICTURE,
        "15 s under a prescribed torque, 10 stations",
        {label: points for label, points in responses.items() if len(points) > 1},
    )
    draw_error_against_time(
        images / START_PICTURE, "A start of 15 s, 10 stations, speed-dependent torque", starts
    )
    draw_effects(images, found)
    report.write_markdown(page, "Benchmarks", sections)


def _sections(
    found: dict[str, Any],
    responses: Any,
    starts: Any,
    workers: Sequence[Worker],
    absent: Sequence[Absent],
) -> list[Section]:
    machine = report.machine_line(found["machine"], found["busy"])
    kept = kept_lines()
    return [
        *([goals_section(kept)] if kept else []),
        Section(
            "How it was measured",
            "All below is made by `python -m benchmarks --write-docs`; printed by `make bench`. Times are "
            "processor times (one thread each, so wall times of an idle machine), medians of calls that take turns in one run, after a warm-up; they are shown, never "
            "tested. Compare ratios, not milliseconds: another machine has others.\n\n"
            f"{machine}\n\n{_peers_line(workers, absent)}",
            (report.goals_table(effect_goals(found)),),
        ),
        Section(
            "Natural frequencies",
            "Stations in a line. Errors are relative to Sturm counts bisected in 50-digit "
            "arithmetic: of the first frequency a program presents, and the largest of all it "
            "presents, compared rank by rank (openTorsion's smallest value stands for the "
            "rigid-body mode and is left out; ROSS leaves it out itself). ROSS finds by default "
            "the lowest few modes only. Our time includes mode shapes and element torques; shares "
            "of energy are calculated when they are asked for.",
            report.modes_tables(found["modes"]),
            ((MODES_PICTURE, "Time and error of natural frequencies"),),
        ),
        Section(
            "Fifteen seconds under a prescribed torque",
            "Ten stations, dampers of 1e-4 s times the stiffness, at the motor the net torque "
            "that reaches 1800 rpm in 15 s and a pulsation of half the rated torque falling from "
            "120 Hz to 0. The reference is the matrix exponential in twists and speeds with "
            f"8-point Gauss quadrature each 0.1 ms ({report.error(found['response_consistency'])} "
            "from itself at half the step with 12 points). Every program starts from its "
            "assembled model; ours includes the modes. **Alike**: every program gets the same samples of the torque, made "
            "beforehand; ours and ROSS join them by straight lines; openTorsion holds each over the step, half a step late, "
            "so it is given the means of neighbouring samples (in a line of its own the samples as they are). "
            "**As a function**: ours gets the torque as a function of time and evaluates it where it needs to; no peer "
            "can, so this is what a user of this program saves, and no comparison of programs. "
            "Errors are taken everywhere on a grid of "
            "0.1 ms, between samples by our own dense output and for the peers by a cubic spline, which is their "
            "best case. ROSS's Newmark compares residuals of absolute angles with 1e-6 N·m by default, which "
            "rounding exceeds once the train turns: where it fails, a looser tolerance helps.",
            (
                report.at_equal_error(responses, OURS_ALIKE, TARGETS, OURS_FUNCTION),
                report.response_table(found["responses"]),
            ),
            ((RESPONSE_PICTURE, "Error against time, prescribed torque"),),
        ),
        Section(
            "A start of fifteen seconds",
            "The shipped example `proposed` with ten stations at 77 % voltage: average and "
            "pulsating torque follow the speed, the pulsation's phase follows the rotor, two "
            "compressors load it. No peer has such a start as a call of its own, so the "
            "exponential step is compared with the method of the paper, both compiled, all modes "
            f"kept. {_start_reference(found['start_agreement'])}",
            (
                report.at_equal_error(starts, EXPONENTIAL, TARGETS),
                report.start_table(found["starts"]),
                report.whole_start_table(found["whole_start"]),
            ),
            ((START_PICTURE, "Error against time, start"),),
        ),
        Section(
            "How the start grows",
            "More stations (the last compressor split into discs), then more seconds.",
            (report.growth_table(found["growth"]),),
        ),
        *effect_sections(found),
        Section(
            "A whole workbook",
            "The shipped example `proposed`, read, calculated and written. *Threads as found*: "
            "numpy and scipy use the threads they choose; *one thread*: limited to one. A *calculated* "
            "workbook is the result of the one *as shipped*: the everyday case.",
            (
                report.stage_table(found["stages"]),
                report.warm_table(found["warm"]),
                report.program_table(found["programs"]),
            ),
        ),
    ]


def _start_reference(agreement: float | None) -> str:
    if agreement is None:
        return "The reference of this short run is the exponential step itself at 1/64 ms."
    return (
        "The reference is Dormand-Prince 8(5,3) at 1e-12 in twists and speeds; the exponential "
        f"step at 1/64 ms is {report.error(agreement)} from it."
    )


def _peers_line(workers: Sequence[Worker], absent: Sequence[Absent]) -> str:
    said = []
    for w in workers:
        versions = ", ".join(f"{name} {v}" for name, v in w.hello["versions"].items())
        said.append(f"{w.name}: {versions} (import {w.hello['import_seconds']:.1f} s, not counted)")
    said += [f"{a.name}: absent, {a.reason}" for a in absent]
    return "Peers, each in an environment and a process of its own. " + "; ".join(said) + "."
