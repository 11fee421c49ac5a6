"""What no result table of a run holds: energy shares, nodes, plans, the outcome in full.

SI throughout, under the keys of the JSON.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from engine.arrays import Floats
from engine.model.frequency_derivatives import frequency_derivatives
from engine.operation.full_speed import full_speed
from engine.results.results import AtSpeed, Results
from engine.results.tables import Row


def start_summary(results: Results) -> Row | None:
    """Outcome of the start; None if nothing was started.

    Keys outcome, time [s], end_speed [rad/s] and sentence, pull_in and bearing_forces where they were
    simulated.
    """
    start = results.start
    if start is None:
        return None
    summary = asdict(start.outcome)
    if start.pull_in is not None:
        pull_in = asdict(start.pull_in)
        for key in ("in_step_time", "in_step_slip"):
            summary[key] = pull_in.pop(key)
        summary["pull_in"] = pull_in
    if start.bearing_forces:
        summary["bearing_forces"] = [asdict(force) for force in start.bearing_forces]
    return summary


def plan_details(results: Results) -> Row:
    """Plans and sensitivity of the run.

    Key ``plans``: number [count] and reason of each plan, the reported one last. Key ``sensitivity``,
    where it was tried: spread [1] and sensitive.
    """
    details: Row = {
        "plans": [{"number": plan.number, "reason": plan.reason} for plan in results.plans]
    }
    if results.start is not None and results.start.repeatability is not None:
        repeated = results.start.repeatability
        details["sensitivity"] = {
            "spread": repeated.spread,
            "sensitive": repeated.sensitive,
            "runs": repeated.runs,
        }
    return details


def full_speed_details(results: AtSpeed) -> Row:
    """The train with its motor at synchronous speed; what is not known is absent.

    Key ``full_speed``: line_frequency [Hz], poles [count], rated_power [W], rated_torque [N m], shafts with
    station and speed [rad/s], total_ratio [1], inertia_constant and motor_inertia_constant [s], load and
    running_load over rated torque [1].
    """
    facts = asdict(full_speed(results.case, results.train))
    facts["shafts"] = list(facts["shafts"])
    return {"full_speed": {key: value for key, value in facts.items() if value is not None}}


def energy_rows(results: AtSpeed, most_modes: int) -> list[Row]:
    """Energy shares of every stiffness and inertia, from which frequencies follow a small change.

    ∂ln f/∂ln k = ½ × share of the strain energy, ∂ln f/∂ln J = −½ × share of the kinetic energy
    (`engine.model.frequency_derivatives`, where modes as good as equal are treated as well). Keys
    quantity, of, share_1, share_2, … [1], as many as there are elastic modes, `most_modes` at the most:
    stiffnesses first, in the order of the case.
    """
    derivatives = frequency_derivatives(results.case, results.train, results.modes)
    return [
        {
            "quantity": row.quantity,
            "of": row.name,
            **{
                f"share_{k}": 2.0 * abs(value)
                for k, value in enumerate(row.value[:most_modes].tolist(), 1)
            },
        }
        for row in derivatives.rows
    ]


def modal_details(results: AtSpeed) -> Row:
    """What the sheets have no table for: energy shares, nodes, damped eigenvalues.

    Key ``modes``: per elastic mode its frequency [Hz], the share of strain energy of each element and of
    kinetic energy of each station [1], and its nodes as element and position from the From end [1]; of
    gears on bearings also ``bearing_strain_energy`` and ``sideways_kinetic_energy`` by station [1]. Key
    ``damped_eigenvalues``, where dampers couple the modes: real and imaginary parts [1/s].
    """
    train, modes = results.train, results.modes
    rows = []
    for r in range(modes.n_rigid, modes.n_modes):
        number = r - modes.n_rigid + 1
        rows.append(
            {
                "mode": number,
                "frequency": float(modes.frequency[r]),
                "strain_energy": _shares(train.elements, modes.strain_share[:, r]),
                "kinetic_energy": _shares(train.stations, modes.kinetic_share[:, r]),
                "nodes": [
                    {"element": n.element, "position": n.position}
                    for n in results.nodes
                    if n.mode == number
                ],
            }
            | _sideways(results, r)
        )
    details: Row = {"modes": rows}
    if results.eigenvalues is not None:
        details["damped_eigenvalues"] = [
            {"real": float(v.real), "imaginary": float(v.imag)} for v in results.eigenvalues
        ]
    return details


def _shares(names: Sequence[str], shares: Floats) -> dict[str, float]:
    return dict(zip(names, shares.tolist(), strict=True))


def _sideways(results: AtSpeed, mode: int) -> Row:
    """Energy shares of the gears on bearings; nothing where there are none."""
    bodies = [results.train.stations[b.station] for b in results.train.bodies]
    if not bodies:
        return {}
    modes = results.modes
    return {
        "bearing_strain_energy": _shares(bodies, modes.bearing_share[:, mode]),
        "sideways_kinetic_energy": _shares(bodies, modes.sideways_share[:, mode]),
    }
