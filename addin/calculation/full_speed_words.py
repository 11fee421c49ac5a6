"""The train at full speed in words, by which a reader sees a wrong unit before anything else."""

from __future__ import annotations

import math

from engine.operation.full_speed import FullSpeed

_RPM = math.pi / 30.0
_HORSEPOWER = 550.0 * 0.3048 * 4.4482216152605
_LBF_FT = 0.3048 * 4.4482216152605


def shaft_speeds(facts: FullSpeed) -> str:
    """Every other speed than the motor's, by its first station."""
    return ", ".join(f"{s.station} {_rpm(s.speed)}" for s in facts.shafts[1:])


def full_speed_words(facts: FullSpeed) -> str:
    """All of it that is known in one line."""
    words = []
    if facts.poles and facts.line_frequency:
        words.append(f"{facts.poles} poles at {facts.line_frequency:.4g} Hz")
    if facts.shafts:
        words.append(", ".join(f"{s.station} {_rpm(s.speed)}" for s in facts.shafts))
    words.append(f"total ratio {facts.total_ratio:.6g}")
    if facts.rated_power and facts.rated_torque:
        power, torque = facts.rated_power, facts.rated_torque
        words.append(
            f"rated {power / 1e3:,.5g} kW ({power / _HORSEPOWER:,.5g} hp), {torque:,.5g} N m "
            f"({torque / _LBF_FT:,.5g} lbf ft)"
        )
    shares = (("LoadTorque", facts.load), ("Running load", facts.running_load))
    words += [f"{name} {100.0 * x:.3g} % of rated" for name, x in shares if x is not None]
    if facts.inertia_constant is not None:
        words.append(f"inertia constant H {facts.inertia_constant:.3g} s{_of_motor(facts)}")
    return "; ".join(words)


def _of_motor(facts: FullSpeed) -> str:
    own = facts.motor_inertia_constant
    return "" if own is None else f" (motor {own:.3g} s)"


def _rpm(speed: float) -> str:
    rpm = speed / _RPM
    return f"{rpm:,.0f} rpm" if rpm >= 100.0 else f"{rpm:.4g} rpm"
