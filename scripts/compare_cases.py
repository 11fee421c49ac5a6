"""Case JSON files for `compare_trees.py`: published and random ones, the same on every call.

Nothing of the project is imported, so that one set of files serves two source trees. Every random
case follows from its kind and its number alone.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

__all__ = ["KINDS", "STUDY_COMMANDS", "published_cases", "random_case", "study_command"]

Case = dict[str, Any]

#: Kinds of random cases.
KINDS = ("plain", "meshes", "clearances", "bearings", "pull-in", "studies")
#: The studies, each case of kind `studies` is asked one of them.
STUDY_COMMANDS = ("tune", "tolerances", "sensitivities", "starts", "calibrate")
#: One random case in so many is damaged, so that its errors are recorded.
DAMAGED = 12

#: Speeds of the torque curves over synchronous speed.
SPEEDS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.96, 1.0)
#: S-N line of the judged shafts: cycles and stress amplitude. [1, Pa]
SN_POINTS = ((1e3, 3.0e8), (1e4, 2.3e8), (1e5, 1.8e8), (1e6, 1.4e8))
ENDURANCE = 1.4e8


def study_command(number: int) -> str:
    """The study that a case of kind `studies` is asked."""
    return STUDY_COMMANDS[number % len(STUDY_COMMANDS)]


def random_case(kind: str, number: int) -> Case:
    """A random case of a kind, numbered from 0; one in `DAMAGED` is wrong on purpose."""
    rng = random.Random(f"{kind} {number}")
    case = _BUILDERS[kind](rng)
    case["title"] = f"Random case {number}, {kind}"
    if kind == "studies":
        _add_study(case, study_command(number), rng)
    if number % DAMAGED == DAMAGED - 1:
        _damage(case, rng)
    return case


# --- trains ---------------------------------------------------------------------------------------


def _number(value: float) -> float:
    """Six digits, as an engineer would type them."""
    return float(f"{value:.6g}")


def _log(rng: random.Random, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _train(rng: random.Random, stations: int, gears: float, branches: float) -> Case:
    """Stations and elements; `gears` and `branches` are the shares of meshes and of side branches.

    The motor is the first station. Links between two stations are as stiff as puts their own
    frequency between 8 and 150 Hz, meshes are stiffer or rigid.
    """
    ratio = [1.0]
    parents: list[int] = []
    meshes: list[bool] = []
    for i in range(1, stations):
        parent = rng.randrange(i) if rng.random() < branches else i - 1
        mesh = rng.random() < gears
        parents.append(parent)
        meshes.append(mesh)
        ratio.append(_number(ratio[parent] * (rng.uniform(0.3, 4.0) if mesh else 1.0)))
    referred = [10.0 ** rng.uniform(-1.0, 2.0) for _ in range(stations)]
    referred[0] = sum(referred[1:]) * rng.uniform(0.4, 2.5)
    inertia = [_number(j / r**2) for j, r in zip(referred, ratio, strict=True)]
    names = ["Motor", *(f"Station {i}" for i in range(1, stations))]
    case: Case = {
        "format": 1,
        "line_frequency": rng.choice([50.0, 60.0]),
        "poles": rng.choice([2, 4, 6, 12]),
        "stations": [
            {"station": name, "inertia": j, "speed_ratio": r}
            for name, j, r in zip(names, inertia, ratio, strict=True)
        ],
        "elements": [],
        "meshes": [],
    }
    for i, (parent, mesh) in enumerate(zip(parents, meshes, strict=True), start=1):
        ends = (parent, i) if rng.random() < 0.8 else (i, parent)
        a, b = ends
        other = inertia[b] * (ratio[b] / ratio[a]) ** 2
        reduced = inertia[a] * other / (inertia[a] + other)
        frequency = _log(rng, 200.0, 1500.0) if mesh else _log(rng, 8.0, 150.0)
        element: Case = {
            "element": f"Link {i}",
            "kind": "gear mesh" if mesh else rng.choice(["shaft", "coupling"]),
            "from": names[a],
            "to": names[b],
        }
        if not mesh or rng.random() < 0.6:
            element["stiffness"] = _number(reduced * (2.0 * math.pi * frequency) ** 2)
        case["elements"].append(element)
    return case


def _speed_ratios(case: Case) -> dict[str, float]:
    return {row["station"]: row["speed_ratio"] for row in case["stations"]}


def _inertias(case: Case) -> dict[str, float]:
    return {row["station"]: row["inertia"] for row in case["stations"]}


def _synchronous_speed(case: Case) -> float:
    return 4.0 * math.pi * case["line_frequency"] / case["poles"]


def _add_start(case: Case, rng: random.Random) -> None:
    """Motor and load torques for a start of about half a second to a second and a half."""
    ratio, inertia = _speed_ratios(case), _inertias(case)
    total = sum(inertia[name] * ratio[name] ** 2 for name in ratio)
    rated = _number(total * _synchronous_speed(case) / rng.uniform(0.5, 1.5))
    case["rated_torque"] = rated
    typed = rng.random() < 0.2  # with units, as an engineer may type them
    case["motor_torque"] = []
    for speed in SPEEDS:
        average = 0.0 if speed == 1.0 else rng.uniform(0.6, 1.5)
        pulsating = rng.uniform(0.05, 0.6)
        row: Case = {"station": "Motor", "speed": speed}
        if typed:
            row |= {"speed": f"{100.0 * speed:g} %", "average": f"{100.0 * average:.4g} %"}
            row["pulsating"] = f"{pulsating:.4g} pu"
        else:
            row |= {"average": _number(rated * average), "pulsating": _number(rated * pulsating)}
        case["motor_torque"].append(row)
    driven = [name for name in ratio if name != "Motor"]
    places = rng.sample(driven, min(len(driven), rng.choice([1, 1, 2])))
    case["load_torque"] = [
        {"station": name, "speed": speed, "torque": _number(rated * share / ratio[name])}
        for name in places
        for speed, share in zip(
            SPEEDS, sorted(rng.uniform(0.0, 0.3 / len(places)) for _ in SPEEDS), strict=True
        )
    ]
    if rng.random() < 0.9:
        case["damping_ratio"] = _number(10.0 ** rng.uniform(-2.6, -1.5))
    case["pulsation_phase"] = _number(rng.uniform(-math.pi, math.pi))


def _add_judged_shafts(case: Case, rng: random.Random) -> None:
    """Diameters, a material and an S-N line for about two shafts in three."""
    ratio = _speed_ratios(case)
    judged = False
    for row in case["elements"]:
        if row["kind"] == "gear mesh" or rng.random() < 0.3:
            continue
        torque = case["rated_torque"] / ratio[row["from"]]
        stress = ENDURANCE * rng.uniform(0.5, 1.5) * 10.0 ** rng.uniform(-0.3, 0.4)
        diameter = (16.0 * torque / (math.pi * stress)) ** (1.0 / 3.0)
        row |= {"stress_diameter": _number(diameter), "material": "Steel", "scf": 1.2}
        if rng.random() < 0.2:
            row["stress_bore"] = _number(0.3 * diameter)
        judged = True
    if not judged:
        return
    material: Case = {"material": "Steel", "uts": 7e8, "yield": 5e8, "endurance": ENDURANCE}
    if rng.random() < 0.3:
        material["below_endurance"] = rng.choice(["none", "same slope", "2k-1"])
    if rng.random() < 0.3:
        material["basis"] = rng.choice(["torsion", "bending"])
    case["materials"] = [material]
    case["sn_points"] = [{"material": "Steel", "cycles": n, "stress": s} for n, s in SN_POINTS]


def _add_limits(case: Case, rng: random.Random) -> None:
    """The makers' limits of some elements."""
    ratio = _speed_ratios(case)
    for row in case["elements"]:
        torque = case["rated_torque"] / ratio[row["from"]]
        for key, factor in (
            ("rated_torque", 1.5),
            ("peak_torque_limit", 3.0),
            ("reversal_limit", 0.5),
            ("vibratory_limit", 0.3),
        ):
            if rng.random() < 0.15:
                row[key] = _number(torque * factor * rng.uniform(0.5, 1.5))


def _add_own_inertia(case: Case, rng: random.Random) -> None:
    """Some shafts by their geometry, with inertia along them, in place of a stiffness."""
    for row in case["elements"]:
        if row["kind"] == "shaft" and rng.random() < 0.25:
            length = rng.uniform(0.2, 1.0)
            outer = (32.0 * row.pop("stiffness") * length / (math.pi * 8e10)) ** 0.25
            row |= {"od": _number(outer), "length": _number(length), "shear_modulus": 8e10}
            if rng.random() < 0.3:
                row["id"] = _number(0.4 * outer)
            if rng.random() < 0.7:
                row["density"] = 7850.0


def _reduced_inertia(case: Case, element: Case) -> float:
    """Of the two ends of an element, at the speed of its From side. [kg m²]"""
    ratio, inertia = _speed_ratios(case), _inertias(case)
    a, b = element["from"], element["to"]
    other = inertia[b] * (ratio[b] / ratio[a]) ** 2
    return inertia[a] * other / (inertia[a] + other)


def _add_dampers(case: Case, rng: random.Random) -> None:
    """Dampers across some elements and to ground, hysteresis in others."""
    for row in case["elements"]:
        if "stiffness" in row and rng.random() < 0.4:
            ratio = _log(rng, 0.005, 0.05)
            critical = 2.0 * math.sqrt(row["stiffness"] * _reduced_inertia(case, row))
            row["damping"] = _number(ratio * critical)
        elif "stiffness" in row and rng.random() < 0.2:
            row["loss_factor"] = _number(rng.uniform(0.005, 0.05))
    for row in case["stations"]:
        if rng.random() < 0.2:
            row["damping"] = _number(row["inertia"] * rng.uniform(0.0, 0.02))


def _add_settings(case: Case, rng: random.Random) -> None:
    """Scalars and small tables that a case may have, each now and then."""
    speed = _synchronous_speed(case)

    def now_and_then(share: float) -> bool:
        return rng.random() < share

    if now_and_then(0.3):
        case["tolerance_peak"] = rng.choice([0.01, 0.01, "0.5 %", 3e-4])
    if now_and_then(0.05):
        case |= {"method": "newmark", "tolerance_peak": 0.01}
    if now_and_then(0.1):
        case["trip_speed"] = _number(speed * rng.uniform(0.4, 0.95))
    if now_and_then(0.15):
        case["shock_amplitude"] = _number(case["rated_torque"] * rng.uniform(0.3, 2.0))
        case["shock_time_constant"] = _number(10.0 ** rng.uniform(-2.0, -0.5))
    if now_and_then(0.1):
        case["voltage"] = rng.choice([0.8, "85 %", 1.1])
    if now_and_then(0.15):
        case["mode_damping"] = [{"mode": 1, "damping_ratio": _number(rng.uniform(0.002, 0.05))}]
    if now_and_then(0.5):
        case["starts_required"] = float(rng.choice([500, 2000, 10000]))
    if now_and_then(0.15):
        case["starts_factor"] = 2.0
    if now_and_then(0.15):
        case |= {"minimum_speed": "95 %", "maximum_speed": "105 %"}
    if now_and_then(0.15):
        case["margin_basis"] = rng.choice(["calculated", "measured"])
    if now_and_then(0.1):
        case["margin_required"] = 0.15
    if now_and_then(0.2):
        case["stress_basis"] = rng.choice(["peak-to-peak", "zero-to-peak"])
    if now_and_then(0.15):
        case["rainflow_residue"] = "repeated"
    if now_and_then(0.05):
        case["keep_history"] = "npz"
    if now_and_then(0.2):
        effect = rng.choice(["resonance sweep", "fast modes", "coupled damping"])
        case["effect_choices"] = [{"effect": effect, "choice": rng.choice(["on", "off"])}]
    if now_and_then(0.25):
        case["excitations"] = [{"name": "1 × motor", "order": 1.0}]
        shares = now_and_then(0.5)  # one kind of unit a column, as a workbook has it
        if now_and_then(0.5):
            row = {"name": "vanes", "order": 5.0, "of_station": case["stations"][-1]["station"]}
            torque = "2 %" if shares else _number(0.02 * case["rated_torque"])
            case["excitations"].append(row | {"torque": torque})
        if now_and_then(0.5):
            row = {"name": "line", "frequency": 2.0 * case["line_frequency"], "station": "Motor"}
            torque = "1 %" if shares else _number(0.01 * case["rated_torque"])
            case["excitations"].append(row | {"torque": torque})
    if now_and_then(0.15):
        case["stations"][-1]["running_load"] = _number(0.2 * case["rated_torque"])


def _add_radii(case: Case, rng: random.Random, share: float) -> None:
    """Rows of table Meshes with the sizes of the gears, for a share of the gear meshes."""
    ratio = _speed_ratios(case)
    for element in case["elements"]:
        if element["kind"] != "gear mesh" or rng.random() > share:
            continue
        drive = rng.uniform(0.1, 0.4)
        row = {
            "element": element["element"],
            "pitch_radius_drive": _number(drive),
            "pitch_radius_driven": _number(drive * ratio[element["from"]] / ratio[element["to"]]),
            "pressure_angle": rng.choice(["20 deg", _number(rng.uniform(0.2, 0.5))]),
        }
        if rng.random() < 0.4:
            row["helix_angle"] = _number(rng.uniform(-0.5, 0.5))
        if rng.random() < 0.4:
            row["orientation"] = _number(rng.uniform(-3.0, 3.0))
        unequal = abs(ratio[element["from"]] / ratio[element["to"]] - 1.0) > 0.01
        if unequal and rng.random() < 0.15:
            row["gear_type"] = "internal"
        if "stiffness" in element and rng.random() < 0.2:
            row["mesh_stiffness"] = _number(element.pop("stiffness") / drive**2)
        case["meshes"].append(row)


def _finished(case: Case, rng: random.Random) -> Case:
    _add_judged_shafts(case, rng)
    _add_limits(case, rng)
    _add_settings(case, rng)
    if not case["meshes"]:
        del case["meshes"]
    return case


def _plain(rng: random.Random) -> Case:
    case = _train(rng, rng.randint(2, 7), gears=0.0, branches=0.1)
    _add_start(case, rng)
    _add_dampers(case, rng)
    _add_own_inertia(case, rng)
    if rng.random() < 0.1:  # a prescribed torque in place of a motor
        del case["motor_torque"], case["load_torque"]
        torque = case["rated_torque"]
        case["torque_time"] = [
            {"station": "Motor", "time": t, "torque": _number(torque * y)}
            for t, y in ((0.0, 0.0), (0.05, 1.0), (0.2, 1.0), (0.25, 0.0), (0.6, 0.0))
        ]
    return _finished(case, rng)


def _meshes(rng: random.Random) -> Case:
    case = _train(rng, rng.randint(3, 8), gears=0.4, branches=0.35)
    _add_start(case, rng)
    _add_radii(case, rng, 0.6)
    _add_dampers(case, rng)
    if rng.random() < 0.3:
        _add_own_inertia(case, rng)
    return _finished(case, rng)


def _clearances(rng: random.Random) -> Case:
    """One or two elements with a clearance, in a start that is followed for a part of a second."""
    case = _train(rng, rng.randint(3, 5), gears=0.5, branches=0.2)
    _add_start(case, rng)
    for element in case["elements"]:
        if element["kind"] == "gear mesh" and "stiffness" not in element:
            frequency = _log(rng, 200.0, 800.0)
            reduced = _reduced_inertia(case, element)
            element["stiffness"] = _number(reduced * (2.0 * math.pi * frequency) ** 2)
    _add_radii(case, rng, 1.0)
    by_element = {row["element"]: row for row in case["meshes"]}
    chosen = rng.sample(case["elements"], min(len(case["elements"]), rng.choice([1, 1, 2])))
    for element in chosen:
        reduced = _reduced_inertia(case, element)
        gap = 10.0 ** rng.uniform(-4.0, -2.5)
        row = by_element.get(element["element"])
        if row is None:
            element["kind"] = "coupling"
            row = {"element": element["element"], "angular_backlash": _number(gap)}
            case["meshes"].append(row)
        else:
            row["backlash"] = _number(gap * row["pitch_radius_drive"])
        frequency = _log(rng, 100.0, 600.0)
        if "stiffness" in element:
            stiffest = reduced * (2.0 * math.pi * frequency) ** 2
            element["stiffness"] = _number(min(element["stiffness"], stiffest))
            ratio = rng.uniform(0.03, 0.2)
            critical = 2.0 * math.sqrt(element["stiffness"] * reduced)
            element["damping"] = _number(ratio * critical)
    if rng.random() < 0.8:
        case["maximum_time"] = _number(rng.uniform(0.2, 0.5))
    if rng.random() < 0.3:
        case["contact_law"] = rng.choice(["limited", "no adhesion"])
    return _finished(case, rng)


def _bearings(rng: random.Random) -> Case:
    """Every gear on bearings, in one case in six with a clearance besides."""
    case = _train(rng, rng.randint(3, 6), gears=0.5, branches=0.2)
    if all(element["kind"] != "gear mesh" for element in case["elements"]):
        case["elements"][-1]["kind"] = "gear mesh"
    _add_start(case, rng)
    ratio, inertia = _speed_ratios(case), _inertias(case)
    bodies: dict[str, tuple[float, float, float]] = {}
    for element in case["elements"]:
        if element["kind"] != "gear mesh":
            continue
        if "stiffness" not in element:
            frequency = _log(rng, 200.0, 800.0)
            reduced = _reduced_inertia(case, element)
            element["stiffness"] = _number(reduced * (2.0 * math.pi * frequency) ** 2)
        drive = rng.uniform(0.1, 0.4)
        driven = drive * ratio[element["from"]] / ratio[element["to"]]
        along = element["stiffness"] / drive**2
        row: Case = {
            "element": element["element"],
            "pitch_radius_drive": _number(drive),
            "pitch_radius_driven": _number(driven),
            "pressure_angle": "20 deg",
            "orientation": _number(rng.uniform(-3.0, 3.0)),
        }
        for side, name, radius in (
            ("drive", element["from"], drive),
            ("driven", element["to"], driven),
        ):
            if name not in bodies:
                mass = _number(2.0 * inertia[name] / radius**2)
                stiffness = _number(along * _log(rng, 0.2, 5.0))
                bodies[name] = (mass, stiffness, _number(0.05 * math.sqrt(mass * stiffness)))
            mass, stiffness, damping = bodies[name]
            row[f"mass_{side}"] = mass
            row[f"bearing_stiffness_{side}"] = stiffness
            row[f"bearing_damping_{side}"] = damping
        case["meshes"].append(row)
    if rng.random() < 1.0 / 6.0:
        row = rng.choice(case["meshes"])
        row["backlash"] = _number(row["pitch_radius_drive"] * 10.0 ** rng.uniform(-4.0, -3.0))
        case["maximum_time"] = 0.3
    return _finished(case, rng)


def _pull_in(rng: random.Random) -> Case:
    case = _train(rng, rng.randint(2, 5), gears=0.2, branches=0.1)
    _add_start(case, rng)
    case["field_slip"] = rng.choice([0.03, "5 %", _number(rng.uniform(0.02, 0.1))])
    case["pull_out_torque"] = _number(case["rated_torque"] * rng.uniform(0.6, 2.5))
    if rng.random() < 0.5:
        case["field_time_constant"] = _number(rng.uniform(0.05, 0.8))
    if rng.random() < 0.3:
        case["field_angle"] = rng.choice(["90 deg", _number(rng.uniform(-3.0, 3.0))])
    if rng.random() < 0.4:
        share = rng.uniform(1.0, 10.0)
        case["pull_in_damping"] = _number(share * case["rated_torque"] / _synchronous_speed(case))
    case["maximum_time"] = 8.0
    return _finished(case, rng)


def _study_train(rng: random.Random) -> Case:
    case = _train(rng, rng.randint(2, 5), gears=0.25, branches=0.1)
    _add_start(case, rng)
    case = _finished(case, rng)
    case["tolerance_peak"] = 0.01
    case.pop("keep_history", None)
    return case


_BUILDERS: dict[str, Callable[[random.Random], Case]] = {
    "plain": _plain,
    "meshes": _meshes,
    "clearances": _clearances,
    "bearings": _bearings,
    "pull-in": _pull_in,
    "studies": _study_train,
}


# --- studies --------------------------------------------------------------------------------------


def _add_study(case: Case, command: str, rng: random.Random) -> None:
    """The tables that one study reads."""
    elastic = [row for row in case["elements"] if "stiffness" in row]
    first = (elastic or case["elements"])[0]
    if command == "tune":
        values = "; ".join(f"{rng.uniform(0.3, 2.0):.3g}" for _ in range(rng.randint(2, 4)))
        case["tuning"] = [{"element": first["element"], "quantity": "stiffness", "values": values}]
        if len(elastic) > 1 and rng.random() < 0.5:
            row: Case = {"element": elastic[1]["element"], "quantity": "stiffness", "unit": "%"}
            case["tuning"].append(row | {"from": 50.0, "to": 150.0, "steps": 2})
        couplings = [row for row in elastic if row["kind"] == "coupling" and row is not first]
        if couplings and rng.random() < 0.5:
            element, stiffness = couplings[-1]["element"], couplings[-1]["stiffness"]
            case["catalogue"] = [
                {"element": element, "name": "A", "fitted": "yes", "stiffness": stiffness},
                {"element": element, "name": "B", "stiffness": _number(0.6 * stiffness)},
            ]
    if command in ("tolerances", "sensitivities", "calibrate"):
        case["scatter"] = [
            {"quantity": "stiffness", "distribution": "normal", "spread": 0.05},
            {"quantity": "inertia", "distribution": "uniform", "spread": "3 %"},
        ]
        if command == "tolerances":
            case["scatter"] += [
                {"quantity": "pulsating torque", "distribution": "triangular", "spread": 0.1},
                {"quantity": "load torque", "spread": 0.05, "together": "together"},
            ]
    if command == "starts" and rng.random() < 0.8:
        case["start_conditions"] = [
            {"condition": "normal", "per_year": 24.0, "so_far": 60.0},
            {"condition": "weak", "voltage": "90 %", "per_year": 6.0},
            {"condition": "unloaded", "load": 0.0, "per_year": 12.0},
            {"condition": "trip", "trip_speed": "80 %", "per_year": 1.0},
        ]
    if command == "calibrate":
        case["measured_frequencies"] = [
            {"frequency": _number(_log(rng, 10.0, 120.0)), "uncertainty": 0.01}
            for _ in range(rng.randint(1, 2))
        ]
        if rng.random() < 0.4:
            case["measured_peaks"] = [
                {"element": first["element"], "maximum_torque": _number(2.0 * case["rated_torque"])}
            ]


# --- wrong on purpose -----------------------------------------------------------------------------


def _damage(case: Case, rng: random.Random) -> None:
    """One to three mistakes of an engineer."""
    for _ in range(rng.randint(1, 3)):
        rng.choice(_MISTAKES)(case, rng)


def _wrong_cell(table: str, key: str, *values: Any) -> Callable[[Case, random.Random], None]:
    def damage(case: Case, rng: random.Random) -> None:
        rows = case.get(table)
        if rows:
            row, value = rng.choice(rows), rng.choice(values)
            row.pop(key, None)
            if value is not None:
                row[key] = value

    return damage


def _wrong_scalar(key: str, *values: Any) -> Callable[[Case, random.Random], None]:
    def damage(case: Case, rng: random.Random) -> None:
        case[key] = rng.choice(values)

    return damage


_MISTAKES = (
    _wrong_cell("stations", "inertia", -1.0, 0.0, None, "12", "3 furlongs", "5 kg*m^2"),
    _wrong_cell("stations", "speed_ratio", -2.0, 0.0, "4 rpm", 7.5),
    _wrong_cell("stations", "station", None, "Motor", "ground", 7),
    _wrong_cell("elements", "stiffness", -1.0, 0.0, "stiff", "1e6 N*m", True),
    _wrong_cell("elements", "to", "Statoin 1", None, "ground"),
    _wrong_cell("elements", "kind", "shfat", None, "gear mesh"),
    _wrong_cell("elements", "material", "Stele", "Iron"),
    _wrong_cell("elements", "scf", 0.5, -1.0),
    _wrong_cell("elements", "stiffnes", 1.0),
    _wrong_cell("meshes", "pitch_radius_driven", 0.01, -1.0, None),
    _wrong_cell("meshes", "backlash", -1e-4, "1 rad"),
    _wrong_cell("meshes", "bearing_stiffness_drive", None, -1.0),
    _wrong_cell("motor_torque", "speed", 0.2, 50.0, None, "500 rpm"),
    _wrong_cell("motor_torque", "average", None, "12 %%"),
    _wrong_cell("load_torque", "torque", -5.0, None),
    _wrong_cell("sn_points", "stress", 9e9, None),
    _wrong_cell("materials", "endurance", 9e9, -1.0),
    _wrong_cell("tuning", "element", "nothing", None),
    _wrong_cell("tuning", "values", "1;x", ""),
    _wrong_cell("scatter", "spread", -1.0, 5.0, None),
    _wrong_cell("start_conditions", "voltage", 0.0, 30.0),
    _wrong_cell("measured_frequencies", "frequency", -3.0, None),
    _wrong_scalar("poles", 3, 4.5, 0, "four"),
    _wrong_scalar("line_frequency", -60.0, "60 m", 1e40),
    _wrong_scalar("damping_ratio", 1.5, "150 %", -0.1),
    _wrong_scalar("end_speed", "120 %", 0.0),
    _wrong_scalar("method", "euler", 3),
    _wrong_scalar("field_slip", 0.05, 5.0),
    _wrong_scalar("tolerance_peak", 0.0, 3.0),
    _wrong_scalar("trip_speed", "99.9 %", "200 %"),
    _wrong_scalar("effect_choices", [{"effect": "pull-in", "choice": "on"}], {"a": 1}),
)


# --- published cases ------------------------------------------------------------------------------


def published_cases(folder: Path) -> Iterator[tuple[str, Case]]:
    """Name and case of every published case that is a train.

    Lumped ones come twice: as published, and with a pulse of torque at their first station, so that
    their time response is recorded too.
    """
    for path in sorted(folder.glob("*.json")):
        data = json.loads(path.read_text(encoding="utf-8"))
        if path.stem.startswith("SAMPLE"):
            for design in data["elements"]:
                yield f"{path.stem} {design}", _sample(data, design)
        elif path.stem[:3] in _CLOSED_FORMS:
            made = _CLOSED_FORMS[path.stem[:3]](data.get("input") or data["model"])
            yield path.stem, {"format": 1, "title": data["title"]} | made
        elif "nodes" in data.get("model", {}) and data["model"].get("shafts") is not None:
            case = {"format": 1, "title": data["title"]} | _lumped(data["model"])
            yield path.stem, case | _excited(data.get("excitation") or {})
            yield f"{path.stem} pulse", case | _pulse(case["stations"][0]["station"], 100.0)


def _pulse(station: str, torque: float) -> Case:
    points = ((0.0, 0.0), (0.05, torque), (0.1, 0.0), (0.6, 0.0))
    rows = [{"station": station, "time": t, "torque": y} for t, y in points]
    return {"damping_ratio": 0.01, "torque_time": rows}


def _excited(excitation: Case) -> Case:
    """A published harmonic torque as an excitation of a fixed frequency."""
    if not excitation.get("amplitudes"):
        return {}
    return {
        "damping_ratio": 0.01,
        "excitations": [
            {
                "name": f"harmonic {order}",
                "frequency": order * excitation["omega"] / (2.0 * math.pi),
                "station": excitation["node"],
                "torque": amplitude,
            }
            for order, amplitude in zip(
                excitation["harmonics"], excitation["amplitudes"], strict=True
            )
        ],
    }


def _lumped(model: Case) -> Case:
    """Nodes, shafts and gears of a file; a gear turns its child `ratio` times its parent."""
    near: dict[str, list[tuple[str, float]]] = {node["id"]: [] for node in model["nodes"]}
    for shaft in model["shafts"]:
        near[shaft["i"]].append((shaft["j"], 1.0))
        near[shaft["j"]].append((shaft["i"], 1.0))
    for gear in model.get("gears", []):
        near[gear["parent"]].append((gear["child"], abs(gear["ratio"])))
        near[gear["child"]].append((gear["parent"], 1.0 / abs(gear["ratio"])))
    first = model["nodes"][0]["id"]
    ratio, waiting = {first: 1.0}, [first]
    while waiting:
        node = waiting.pop()
        for other, factor in near[node]:
            if other not in ratio:
                ratio[other] = ratio[node] * factor
                waiting.append(other)
    inertia = {node["id"]: node["J"] for node in model["nodes"]}
    for shaft in model["shafts"]:
        for end in (shaft["i"], shaft["j"]):  # its own inertia, half of it at each end
            inertia[end] += 0.5 * shaft.get("rhoJL", 0.0)
    stations, elements, meshes = [], [], []
    for node in model["nodes"]:
        name = node["id"]
        row = {"station": name, "inertia": inertia[name], "speed_ratio": ratio[name]}
        stations.append(row | ({"damping": node["c_ground"]} if node.get("c_ground") else {}))
    for shaft in model["shafts"]:
        row = {"element": f"{shaft['i']}-{shaft['j']}", "kind": "shaft"}
        row |= {"from": shaft["i"], "to": shaft["j"], "stiffness": shaft["k"]}
        elements.append(row | ({"damping": shaft["c"]} if shaft.get("c") else {}))
    for gear in model.get("gears", []):
        name = f"{gear['parent']}:{gear['child']}"
        row = {"element": name, "kind": "gear mesh", "from": gear["parent"], "to": gear["child"]}
        elements.append(row)
        meshes.append(
            {"element": name, "gear_type": "external" if gear["ratio"] < 0 else "internal"}
        )
    for node in model["nodes"]:
        if node.get("k_ground"):
            row = {"element": f"{node['id']} to ground", "kind": "spring to ground"}
            row |= {"from": node["id"], "to": "ground", "stiffness": node["k_ground"]}
            loss = node.get("eta_ground")
            elements.append(row | ({"loss_factor": loss} if loss else {}))
    case = {"stations": stations, "elements": elements}
    return case | ({"meshes": meshes} if meshes else {})


def _chain(inertias: list[float], stiffnesses: list[float], **more: Any) -> Case:
    return {
        "stations": [
            {"station": f"disk {i}", "inertia": j} for i, j in enumerate(inertias, start=1)
        ],
        "elements": [
            {
                "element": f"shaft {i}",
                "kind": "coupling",
                "from": f"disk {i}",
                "to": f"disk {i + 1}",
                "stiffness": k,
            }
            for i, k in enumerate(stiffnesses, start=1)
        ],
    } | more


def _shaft(geometry: Case, discs: list[float | None], ends: tuple[bool, bool]) -> Case:
    """A shaft in equal lengths between discs; a fixed end is ground."""
    names = [f"point {i}" for i in range(len(discs))]
    if ends[0]:
        names[0] = "ground"
    if ends[1]:
        names[-1] = "ground"
    stations: list[Case] = []
    for name, inertia in zip(names, discs, strict=True):
        if name != "ground":
            stations.append({"station": name} | ({} if inertia is None else {"inertia": inertia}))
    return {
        "stations": stations,
        "elements": [
            {
                "element": f"shaft {i}",
                "kind": "shaft",
                "from": a,
                "to": b,
                "od": geometry["d"],
                "length": geometry["L"] / (len(discs) - 1),
                "shear_modulus": geometry["G"],
                "density": geometry["rho"],
            }
            for i, (a, b) in enumerate(zip(names, names[1:], strict=False), start=1)
        ],
    }


def _geared(v: Case) -> Case:
    ratio = v["speed_ratio_load_over_motor"]
    return {
        "stations": [
            {"station": "motor", "inertia": v["J_motor"]},
            {"station": "pinion", "inertia": v["J_pinion"]},
            {"station": "gear", "inertia": v["J_gear"], "speed_ratio": ratio},
            {"station": "load", "inertia": v["J_load"], "speed_ratio": ratio},
        ],
        "elements": [
            {"element": "motor shaft", "kind": "shaft", "from": "motor", "to": "pinion",
             "stiffness": v["k_motor_shaft"]},
            {"element": "mesh", "kind": "gear mesh", "from": "pinion", "to": "gear"},
            {"element": "load shaft", "kind": "shaft", "from": "gear", "to": "load",
             "stiffness": v["k_load_shaft"]},
        ],
    } | _pulse("motor", 100.0)  # fmt: skip


def _with_gap(inertias: list[float], stiffness: float, gap: float, torque: float) -> Case:
    case = _chain(inertias, [stiffness]) | _pulse("disk 1", torque)
    return case | {"meshes": [{"element": "shaft 1", "angular_backlash": gap}]}


_CLOSED_FORMS: dict[str, Callable[[Case], Case]] = {
    "A01": lambda v: _shaft(v, [None, None, None], (False, False)),
    "A02": lambda v: _chain([v["J"]] * v["N"], [v["k"]] * (v["N"] - 1)),
    "A03": lambda v: _chain(v["J"], v["k"]),
    "A04": _geared,
    "A07": lambda v: (
        _chain([v["J1"], v["J2"]], [v["k"]]) | _pulse("disk 1", v["T0"])
        | {"damping_ratio": v["zeta"]}
    ),
    "A08": lambda v: _chain(v["J"], [v["k"]] * 4) | _pulse("disk 1", 1000.0),
    "A09": lambda v: _with_gap([v["J1"], v["J2"]], v["k"], v["total_backlash"], v["T_step"]),
    "B01": lambda v: _with_gap([v["J"], v["J"]], v["k"], v["total_backlash_rad"], 500.0),
    "F03": lambda v: _shaft(v["geometry"], [None, v["geometry"]["Ip_end"]], (True, False)),
    "F04": lambda v: _shaft(v["geometry"], [None, v["geometry"]["Ip_mid"], None], (True, True)),
    "F05": lambda v: _shaft(
        v["geometry"],
        [None, None, *v["geometry"]["disc_nodes"].values(), None, None],
        (False, False),
    ),
}  # fmt: skip


def _sample(data: Case, design: str) -> Case:
    """The paper's sample train."""
    rated, curve, sn = data["rated_torque_nm"], data["torque_speed"], data["sn"]
    psi = 6894.757293168361
    ratio = {s["name"]: s["speed_ratio"] for s in data["stations"]}
    elements = []
    for e in data["elements"][design]:
        stiffness = e.get("stiffness", e.get("stiffness_referred_to_motor_speed"))
        row = {"element": e["name"], "kind": e["kind"], "from": e["from"], "to": e["to"]}
        if stiffness is not None:
            row["stiffness"] = stiffness
        if "stress_diameter_m" in e:
            row |= {
                "stress_diameter": e["stress_diameter_m"],
                "scf": sn["scf"],
                "material": "steel",
            }
        elements.append(row)
    return {
        "format": 1,
        "title": f"Sample train, {design}",
        "line_frequency": float(data["line_frequency_hz"]),
        "poles": data["poles"],
        "rated_torque": rated,
        "damping_ratio": data["modal_damping_ratio"],
        "stations": [
            {"station": s["name"], "inertia": s["inertia"], "speed_ratio": s["speed_ratio"]}
            for s in data["stations"]
        ],
        "elements": elements,
        "motor_torque": [
            {"station": "Motor", "speed": x, "average": a * rated, "pulsating": p * rated}
            for x, a, p in zip(
                curve["speed_fraction"],
                curve["motor_average_pu"],
                curve["motor_pulsating_0pk_pu"],
                strict=True,
            )
        ],
        "load_torque": [
            {"station": name, "speed": x, "torque": y * rated * share / ratio[name]}
            for name, share in curve["load_share"].items()
            for x, y in zip(curve["speed_fraction"], curve["load_pu_at_motor"], strict=True)
        ],
        "materials": [
            {"material": "steel", "uts": 110_000 * psi, "endurance": sn["endurance_psi"] * psi}
        ],
        "sn_points": [
            {"material": "steel", "cycles": n, "stress": s * psi}
            for s, n in sn["points_psi_cycles"]
        ],
    }
