"""The page docs/validation.md: published cases, their numbers and ours.

Inputs and published numbers are those of `tests/validation/cases`, the calculations those of the tests there; this file says
what is compared. `make generated` writes the page, and a test says where it is stale.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "validation")]

import test_clearance_cases as clearance  # noqa: E402  (found through the lines above)
import test_forced_response as forced  # noqa: E402
import test_machine_in_time as machines  # noqa: E402
import test_natural_frequencies as lumped  # noqa: E402
import test_prescribed_torque as prescribed  # noqa: E402
import test_rainflow_published as rainflow  # noqa: E402
import test_sample_start as sample  # noqa: E402
import test_sn_and_miner_published as miner  # noqa: E402
from cases import case_path, load_case  # noqa: E402

from engine.backlash.event_start import clearances_of  # noqa: E402
from engine.case.data import ElementRow, MeshRow, StationRow  # noqa: E402
from engine.fatigue.cycle_counting import count_cycles  # noqa: E402
from engine.fatigue.damage import miner_damage  # noqa: E402
from engine.fatigue.stress import shear_stress  # noqa: E402
from engine.model.modes import damped_eigenvalues, modes_of  # noqa: E402
from engine.model.subdivision import natural_modes  # noqa: E402
from engine.motor.circuit import (  # noqa: E402
    Step,
    line_omega,
    rotor_windings,
    stator_resistance,
)
from engine.run import run  # noqa: E402

MPA, PSI = 1e6, 6894.757293168361

#: A difference below this is rounding of the arithmetic: its digits depend on the processor. [1]
ROUNDING = 1e-9

HEAD = """# Published cases

Made from `tests/validation` by `make generated`; do not edit.

Each published case: what it is, where its numbers come from, what is printed there and what torsionbook calculates. *Difference* is the largest, relative
to the published number (of a history: to its largest value). The last digit printed limits it: 16.2269 can tell 3e-6 apart. Tests hold every
row, most of them to more digits than are printed, since each case was recomputed independently (40-digit arithmetic, closed forms, or scipy's
integrators) before it was put there.

*Seen* says how the published numbers were found: **text**, the source itself or the test file of its makers; **quoted**, a public program or
repository that gives them as those of the source; **output**, the published output of a public program. Closed forms, random trains against
other integrators and the accuracy of whole starts are on the pages [claims](claims.md), [accuracy study](accuracy-study.md) and [hard
cases](hard-cases.md).
"""

TABLE = """
| case | source | seen | published | torsionbook | difference |
|---|---|---|---|---|--:|
"""


@dataclass(frozen=True)
class Row:
    """One comparison.

    Parameters
    ----------
    what, source, seen : str
        The case, where its numbers are from, and how they were found.
    published, ours : str
        Numbers as they are shown, with their unit.
    difference : float or None
        The largest, relative; none where the source has words. [1]
    """

    what: str
    source: str
    seen: str
    published: str
    ours: str
    difference: float | None

    def line(self) -> str:
        if self.difference is None:
            difference = "–"
        elif self.difference == 0.0:
            difference = "none"
        else:
            small = self.difference < ROUNDING
            difference = f"< {ROUNDING:.0e}" if small else f"{self.difference:.1e}"
        cells = (self.what, self.source, self.seen, self.published, self.ours, difference)
        return "| " + " | ".join(cells) + " |\n"


def _listed(values: Iterable[float], digits: int) -> str:
    """Numbers with so many significant digits, without the noughts behind; long ones whole."""
    rounded = [float(f"{v:.{digits}g}") for v in values]
    return ", ".join(f"{v:,.0f}" if abs(v) >= 1e4 else f"{v:.{digits}g}" for v in rounded)


def _numbers(
    what: str, source: str, seen: str, published: Sequence[float], ours: Sequence[float],
    digits: int, unit: str = "",
) -> Row:  # fmt: skip
    """Printed numbers, ours with one digit more."""
    theirs, calculated = np.array(published, float), np.array(ours, float)
    difference = max(float(np.max(np.abs(calculated / theirs - 1.0))), 0.1 * ROUNDING)
    return Row(
        what, source, seen, f"{_listed(theirs, digits)}{unit}",
        f"{_listed(calculated, digits + 1)}{unit}", difference,
    )  # fmt: skip


def _history(
    what: str, source: str, seen: str, published: np.ndarray, ours: np.ndarray, name: str
) -> Row:
    """A series of samples: how many, its largest value and ours at that sample."""
    k = int(np.argmax(np.abs(published)))
    difference = float(np.max(np.abs(ours - published)) / abs(published[k]))
    return Row(
        what, source, seen, f"{published.size:,} samples of {name}, largest {published[k]:.6g}",
        f"{ours[k]:.6g} there", difference,
    )  # fmt: skip


# --- natural frequencies --------------------------------------------------------------------------

#: Case, what it is, source, seen, significant digits printed.
FREQUENCIES = (
    ("M01", "two discs", "openTorsion, `test_shaft`", "output", 4),
    ("M02", "four-disc train", "Friswell et al., Dynamics of Rotating Machines (2010), Example 9.7.1", "quoted", 5),
    ("M03", "direct-drive wind turbine", "Sopanen et al., IEEE Trans. Ind. Electron. 58 (2011), digitised from its figure", "quoted", 4),
    ("M04_ieee_ssr_first_benchmark", "turbine generator, six masses", "IEEE SSR First Benchmark (1977), as MATLAB-SSR prints it", "output", 6),
    ("M05", "555 MVA turbine generator", "Kundur, Power System Stability and Control (1994), Fig. 15.3, as MATLAB-SSR prints it", "output", 6),
    ("M07", "191 MVA gas turbine", "Kundur (1994), Fig. 15.5, as MATLAB-SSR prints it", "output", 6),
    ("M12", "eight masses between fixed ends", "VPCS SDLD02/89; Code_Aster V2.01.002", "text", 6),
    ("G01", "motor and two rotors through a gear", "Friswell et al. (2010), ch. 9", "quoted", 5),
)  # fmt: skip


#: Published with finite elements, whose own error is most of the difference.
DISTRIBUTED = {
    "F01": ("hollow shaft between two discs (50 finite elements there)", "Friswell et al. (2010), Example 9.9", "quoted"),
    "F03": ("cantilever shaft with a disc, first mode (6 finite elements there)", "Tiwari (2018), Exercise 7.8", "output"),
}  # fmt: skip


def frequencies() -> Iterator[Row]:
    for case_id, what, source, seen, digits in FREQUENCIES:
        data, _, modes = lumped.solved(case_id)
        printed = data["published"]["frequencies_Hz"]
        yield _numbers(what, source, seen, printed, modes.elastic_frequency, digits, " Hz")
    data, _, modes = lumped.solved("G04")
    yield _numbers(
        "two discs through a gear", "Tiwari, Rotor Systems (2018), Exercise 6.9", "output",
        data["published"]["frequencies_rad_per_s"], modes.omega[modes.n_rigid :], 6, " rad/s",
    )  # fmt: skip
    import test_distributed_shafts as distributed

    case, _ = distributed.reference("F05")
    r = natural_modes(case, 120.0, 1e-4)
    yield _numbers(
        "shaft with its own inertia and two discs", "ROSS, example 27 (geometry of Friswell 6.3.1.b)",
        "output", [103.45], r.modes.elastic_frequency[:1], 5, " Hz",
    )  # fmt: skip
    for name, file, key, unit in (
        ("F01", "F01_friswell_9_9_hollow_shaft_FE_50el", "frequencies_Hz", " Hz"),
        ("F03", "F03", "rad_per_s", " rad/s"),
    ):
        case, exact = distributed.reference(name)
        r = natural_modes(case, 1.01 * exact[-1] / (2.0 * math.pi), 1e-4)
        scale = 1.0 if unit == " Hz" else 2.0 * math.pi
        printed = load_case(file)["published"][key][: 4 if name == "F01" else 1]
        what, source, seen = DISTRIBUTED[name]
        ours = scale * r.modes.elastic_frequency[: len(printed)]
        yield _numbers(what, source, seen, printed, ours, 6, unit)
    data = load_case("T02")
    train = lumped.case_of(data["model"])
    built = natural_modes(train)
    found = damped_eigenvalues(built.train, built.modes)
    published = np.linalg.eigvals(np.array(data["published"]["A"]))
    oscillating = sorted(published[published.imag > 1.0], key=abs)
    nearest = [found[np.argmin(np.abs(found - z))] for z in oscillating]
    worst = max(abs(a / b - 1.0) for a, b in zip(nearest, oscillating, strict=True))
    yield Row(
        "damped geared train: eigenvalues of its state matrix", "openTorsion, `test_state_space`", "output",
        ", ".join(f"{z.real:.4f} ± {z.imag:.4f}j" for z in oscillating),
        ", ".join(f"{z.real:.5f} ± {abs(z.imag):.5f}j" for z in nearest), worst,
    )  # fmt: skip


# --- forced response, response in time ------------------------------------------------------------


def responses() -> Iterator[Row]:
    d = load_case("R03")
    omega = 2.0 * math.pi * np.array(d["published"]["frequency_Hz"])
    x = d["excitation"]
    train, response = forced.respond(d["model"], omega, x["node"], x["amplitude"])
    ours = np.abs(response.station_angle[train.stations.index("C")])
    printed = np.abs([complex(*z) for z in d["published"]["response_C"]])
    yield _numbers(
        "forced response with a loss factor, amplitude at eight frequencies",
        "Code_Aster SDLD313, V2.01.313 (Piranda 1990)", "text", printed, ours, 4, " m",
    )  # fmt: skip
    d = load_case("R04")
    omega = np.array([2.0 * math.pi * float(f) for f in d["published"]])
    x = d["excitation"]
    _, response = forced.respond(d["model"], omega, x["node"], x["amplitude"])
    printed = np.array([[row["X1"], row["X2"]] for row in d["published"].values()])
    yield _numbers(
        "two masses, three springs, amplitudes at 1.5, 4 and 6.5 Hz",
        "ANSYS VM90 (Thomson, Vibration Theory and Applications (1965), § 6.6)", "text",
        printed.ravel(), response.station_angle.real.T.ravel(), 5, " in",
    )  # fmt: skip
    d = load_case("R05")
    x = d["excitation"]
    amplitudes = []
    for h, amplitude in zip(x["harmonics"], x["amplitudes"], strict=True):
        _, response = forced.respond(d["model"], [h * x["omega"]], x["node"], amplitude)
        amplitudes.append(-response.element_torque[:, 0].real)
    theirs, calculated = [], []
    for i in range(4):
        t, curve = np.array(d["published"]["curves"][f"shaft{i + 1}"]).T
        turns = np.cos(np.outer(np.array(x["harmonics"]) * x["omega"], t))
        theirs.append(curve)
        calculated.append(np.array([a[i] for a in amplitudes]) @ turns)
    yield _history(
        "five discs, four harmonics: torque of four shafts",
        "openTorsion, tutorial *Steady-state forced response*", "output",
        np.concatenate(theirs), np.concatenate(calculated), "torque [N m]",
    )  # fmt: skip
    d = load_case("T05")
    train, modes, _ = prescribed.prepared(prescribed.train_of(d["model"]))
    pulse = prescribed.held(0, np.array([0.0, 1.8]), np.array([50.0, 0.0]))
    r = prescribed.time_response(train, modes, [pulse], np.array([0.0, 1.3, 2.4]))
    yield _numbers(
        "two masses, rectangular pulse", "ANSYS VM182 (Vierck, Vibration Analysis (1979), § 5-8)", "text",
        list(d["published"].values()),
        [r.station_angle[0, 1], r.station_angle[1, 1], r.station_angle[0, 2]], 4, " m",
    )  # fmt: skip
    d = load_case("T01")
    train, modes, _ = prescribed.prepared(prescribed.train_of(d["model"]))
    u = d["excitation"]
    t = u["dt"] * np.arange(u["n_samples"])
    impulse = prescribed.held(0, t, np.array(u["torque"]))
    r = prescribed.time_response(train, modes, [impulse], t)
    theirs, ours_at = [], []
    for i in range(4):
        for when, value in d["published"]["curves"][f"shaft{i + 1}"]:
            k = round(when / u["dt"])
            if abs(when - t[k]) < 1e-6:  # the drawing leaves samples out
                theirs.append(value)
                ours_at.append(-r.torque[i, k])
    yield _history(
        "five discs, triangular impulse: torque of four shafts", "openTorsion, tutorial *Transient response*",
        "output", np.array(theirs), np.array(ours_at), "torque [N m]",
    )  # fmt: skip
    d = load_case("T03")
    with case_path("msl_First", ".csv").open(encoding="utf-8") as file:
        table = np.array([[float(v) for v in row] for row in list(csv.reader(file))[1:]])
    table = table[np.concatenate([[True], np.diff(table[:, 0]) > 0.0])]
    train, modes, _ = prescribed.prepared(prescribed.train_of(d["model"]))
    torque = prescribed.torque_from_function(0, lambda x: 10.0 * np.sin(2.0 * np.pi * 5.0 * x))
    r = prescribed.time_response(train, modes, [torque], table[:, 0])
    yield _history(
        "geared drive with a damper to ground, sine torque",
        "Modelica Standard Library 4.0, Rotational.Examples.First, reference result", "text",
        table[:, 4], r.station_speed[2], "load speed [rad/s]",
    )  # fmt: skip


# --- clearances -----------------------------------------------------------------------------------


def clearances() -> Iterator[Row]:
    with case_path("msl_Backlash", ".csv").open(encoding="utf-8") as file:
        rows = np.array([[float(v) for v in row[:3]] for row in list(csv.reader(file))[1:]])
    times, first = np.unique(rows[:, 0], return_index=True)
    angle, _ = clearance.oscillator("limited", times)
    yield _history(
        "oscillator in a gap, damped contact",
        "Modelica Standard Library 4.0, Rotational.Examples.Backlash, reference result", "text",
        rows[first, 1], angle, "angle [rad]",
    )  # fmt: skip
    d = load_case("B02")
    m, printed = d["model"], d["published"]["code_aster"]
    case = clearance.CaseData(
        stations=(StationRow("mass", None, m["m"]),),
        elements=(
            ElementRow("spring", "spring to ground", "mass", "ground", m["k_ground"]),
            ElementRow("stop", "spring to ground", "mass", "ground", m["k_stop"]),
        ),
        meshes=(MeshRow("stop", angular_backlash=1e6),),
    )
    train = clearance.build_train(case)
    found = clearance.clearance_response(
        train, modes_of(train), clearances_of(train), np.linspace(0.0, 0.02, 21), step=1e-4,
        initial_speed=np.array([m["v0"]]),
    )  # fmt: skip
    _, value = clearance.torque_peaks(found, 1)
    yield _numbers(
        "oscillator against a one-sided stop, largest force (closed form 9950.37)",
        "Code_Aster SDND101, V5.01.101", "text", [printed["F_max"]], [float(value.max())], 7, " N",
    )  # fmt: skip


# --- motors ---------------------------------------------------------------------------------------


def motors() -> Iterator[Row]:
    sheet = load_case("SM06")["sets"][0]["inputs"]
    omega = line_omega(sheet["frequency"])
    field, damper = rotor_windings(
        sheet["xd"], sheet["xl"],
        [Step(sheet["xd_transient"], sheet["Td0_transient"]),
         Step(sheet["xd_subtransient"], sheet["Td0_subtransient"])],
        omega,
    )  # fmt: skip
    (across,) = rotor_windings(
        sheet["xq"], sheet["xl"], [Step(sheet["xq_subtransient"], sheet["Tq0_subtransient"])], omega
    )
    resistance = stator_resistance(
        sheet["xd_subtransient"], sheet["xq_subtransient"], sheet["Ta"], omega
    )
    yield _numbers(
        "circuit of a synchronous machine from its data sheet: Rf, Xlf, Rkd, Xlkd, Rkq, Xlkq, Rs",
        "Modelica Standard Library 4.0, SynchronousMachineData (EN 60034-4)", "text",
        [0.01875, 0.0384615, 0.04, 0.05, 0.04, 0.05, 0.03],
        [*field, *damper, *across, resistance], 6, " pu",
    )  # fmt: skip
    data = load_case("SM01")
    torque, times, theirs = machines.reluctance_start(data)
    yield _history(
        "motor without field winding, direct on line, to the step of load",
        "Modelica Standard Library 4.0, SMR_DOL, torque from the published currents", "text",
        theirs, torque, "torque [N m]",
    )  # fmt: skip


# --- fatigue --------------------------------------------------------------------------------------


def _counts(pairs: Iterable[tuple[float, float]]) -> str:
    return "; ".join(f"{size:g} × {count:g}" for size, count in sorted(pairs))


def fatigue() -> Iterator[Row]:
    for case_id, what, source, seen in (
        ("W01", "ranges × cycles", "ASTM E1049-85, 5.4.4, Figure 6", "quoted"),
        ("W02", "ranges × cycles, 23 points", "github.com/iamlikeme/rainflow, test data", "output"),
    ):
        case = load_case(case_id)
        theirs = dict(case["published"]["range_counts"])
        ours = rainflow.totals(count_cycles(case["input"]))
        difference = max(abs(ours.get(k, 0) - v) for k, v in theirs.items())
        yield Row(
            f"rainflow: {what}", source, seen, _counts(theirs.items()), _counts(ours.items()),
            difference,
        )  # fmt: skip
    case = load_case("W03")
    i = np.arange(1001)
    cycles = count_cycles(0.8 * np.sin(0.01 * math.pi * i) + 0.2 * np.sin(0.032 * math.pi * i))
    order = np.argsort(cycles.range)
    printed = [size for size, _ in case["published"]["range_counts"]]
    yield _numbers(
        "rainflow: ranges of the sum of two sines", "github.com/iamlikeme/rainflow, test data", "output",
        printed, cycles.range[order], 6,
    )  # fmt: skip
    for case_id, source in (("W04", "Code_Aster SZLZ102"), ("W05", "Code_Aster SZLZ103")):
        case = load_case(case_id)
        points = case["input"]
        if case_id == "W05":
            points = rainflow.without_small_oscillations(points, case["filter_range"])
        theirs = rainflow.Counter((hi, lo) for hi, lo in case["published"]["cycles_max_min"])
        ours = rainflow.as_pairs(count_cycles(points, "repeated"))
        yield Row(
            "rainflow, history repeated: maximum, minimum of each cycle", source, "text",
            "; ".join(f"{hi:g}, {lo:g}" for hi, lo in sorted(theirs.elements())),
            "; ".join(f"{hi:g}, {lo:g}" for hi, lo in sorted(ours.elements())),
            0.0 if ours == theirs else 1.0,
        )  # fmt: skip
    case = load_case("W07")
    curve = miner.curve_of([(500, 690 * MPA), (1000, 540 * MPA)], None, None)
    cycle = count_cycles([600 * MPA, -500 * MPA, 600 * MPA])
    yield _numbers(
        "damage of a cycle, S-N table", "Code_Aster SZLZ100", "text",
        [case["published"]["table_damage"]], [miner_damage(cycle.amplitude, cycle.count, curve)], 8,
    )  # fmt: skip
    case = load_case("W08")
    amplitude = np.array(case["input"]["amplitude_MPa"]) * MPA
    cycles = np.array(case["input"]["cycles"])
    curve = miner.curve_of(miner.power_law(2e6, 125 * MPA, 7, 350 * MPA), 125 * MPA, "same slope")
    life = cycles.sum() / miner_damage(amplitude, cycles, curve)
    yield _numbers(
        "life under a stepped collective, elementary Miner",
        "Haibach, Betriebsfestigkeit (2006), p. 271", "quoted",
        [case["published"]["life_cycles"]], [life], 6, " cycles",
    )  # fmt: skip
    case = load_case("W09")
    cycles = np.array(case["input"]["cycles"])
    curve = miner.curve_of(miner.power_law(1e6, 100 * MPA, 4, 800 * MPA), 100 * MPA, "2k-1")
    relative = np.array(case["input"]["relative_amplitude"])
    lives = case["published"]["life_cycles_by_peak"]
    ours = [
        cycles.sum() / miner_damage(relative * float(peak) * MPA, cycles, curve) for peak in lives
    ]
    yield _numbers(
        "life at seven peaks, modified Miner (slope 2k − 1)", "Haibach (2006), p. 292", "quoted",
        list(lives.values()), ours, 6, " cycles",
    )  # fmt: skip


# --- the paper ------------------------------------------------------------------------------------

PAPER = "Szenasi & von Nimitz (1978)"

PAPER_HEAD = """
## The paper's sample case

The paper prints no mass-elastic data, torque curves, diameters or S-N data. Those of this case (`tests/sample_case.py`) were constructed so that
three of its results come out, as the first column says; the others are predictions. Motor curves are read at the rotor's own speed, as they were when the
data were chosen (`TorqueFollows`). The shipped examples have rounder numbers: Table 1 as printed, their other results on sheet Notes.
"""


def paper() -> Iterator[Row]:
    for design, printed in (("proposed", (30.0, 53.0, 86.0)), ("modified", (21.0, 39.0, 69.0))):
        case = sample.as_the_prototype(design)
        results = run(case)
        start = results.start
        assert start is not None
        ours = natural_modes(case).modes.elastic_frequency[:3]
        yield _numbers(
            f"{design}, natural frequencies (stiffnesses constructed to give them)",
            f"{PAPER}, Table 1", "text", printed, ours, 2, " Hz",
        )  # fmt: skip
        percent = sample.sample_data()["results"]["percent_speed"][design]
        crossed = [100.0 * (1.0 - f / 120.0) for f in ours]
        rounded = [math.floor(p + 0.5) for p in crossed]
        yield Row(
            f"{design}, % speed of the crossings", f"{PAPER}, Table 1", "text",
            ", ".join(str(p) for p in percent), ", ".join(str(p) for p in rounded),
            float(max(abs(a - b) for a, b in zip(rounded, percent, strict=True))),
        )  # fmt: skip
        hp = {p.element: p for p in start.peaks}["HP compressor shaft"]
        stress = shear_stress(hp.peak_to_peak, 0.07, 0.0) / PSI
        first = "diameter constructed to give it" if design == "proposed" else "prediction"
        yield _numbers(
            f"{design}, peak-to-peak stress of the HP compressor shaft ({first})", PAPER, "text",
            [30_000.0 if design == "proposed" else 19_000.0], [stress], 4, " psi",
        )  # fmt: skip
        mesh = {p.element: p for p in start.peaks}["Mesh"]
        rated = sample.sample_data()["rated_torque_nm"]
        if design == "modified":
            assert results.starts is not None
            assert results.starts.starts is not None
            yield Row(
                "modified, allowable starts (prediction; S-N data constructed)", PAPER, "text",
                "more than 2,000", f"{math.floor(results.starts.starts):,}", None,
            )  # fmt: skip
        says = "reverses" if design == "proposed" else "a small amount of backlash for a few cycles"
        yield Row(
            f"{design}, torque of the gear over rated (prediction)", PAPER, "text", says,
            f"{mesh.minimum / rated:.2f} to {mesh.maximum / rated:.2f}", None,
        )  # fmt: skip


SECTIONS: tuple[tuple[str, Any], ...] = (
    ("\n## Natural frequencies and damping\n", frequencies),
    ("\n## Forced response and response in time\n", responses),
    ("\n## Clearances\n", clearances),
    ("\n## Motors\n", motors),
    ("\n## Cycle counting and fatigue\n", fatigue),
    (PAPER_HEAD, paper),
)


def validation_page() -> str:
    """The page."""
    return HEAD + "".join(
        head + TABLE + "".join(row.line() for row in rows()) for head, rows in SECTIONS
    )


if __name__ == "__main__":
    print(validation_page())
