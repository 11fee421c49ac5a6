"""The audit trail: which inputs, which program, which method, how accurate, by which equations."""

from __future__ import annotations

import datetime as dt
import math
import platform
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from typing import Any

from addin.contract.audit_items import DIGEST_ITEM, SETTING_ITEM, SOFTWARE_ITEM
from addin.contract.fixed_date import fixed_date
from addin.contract.sources import (
    CURVES,
    INTEGRATORS,
    MIL_STANDARD,
    RAINFLOW,
    SINGULAR_VALUES,
    STEADY,
)
from addin.contract.version import product_version
from engine.case.choices import MeanStress
from engine.case.result_words import NoNumber
from engine.case.steels import KSI, Steel
from engine.plan.decision import EffectDecision
from engine.results.results import Results
from engine.stepping.library import about

#: Libraries whose numbers or files enter the result.
LIBRARIES = ("numpy", "scipy", "pint", "lxml", "formualizer")

#: In words, how the modes were calculated.
MODES_BY = {
    "svd": "SVD",
    "jacobi": "one-sided Jacobi SVD",
    "chain": "bidiagonal values, twisted factorisation",
}

#: What was calculated by which equation, and where it comes from.
EQUATIONS: tuple[tuple[str, str], ...] = (
    ("Shaft stiffness", "k = G π (D⁴ − d⁴) / (32 L) (strength of materials)"),
    (
        "Natural frequencies",
        "singular values of √k·B/√J, B the incidence matrix with speed ratios; K = Bᵀ k B "
        f"({SINGULAR_VALUES.cited})",
    ),
    (
        "Modal damping",
        "ζ = stated + ½ Σ loss factor × strain-energy share + ½ φᵀCφ/ω at unit modal mass",
    ),
    ("Separation margin", "|f − f_exc| / f_exc, least over the operating speeds; 20 % calculated, "
     f"10 % measured ({STEADY})"),
    ("Forced response", "direct complex solution of (K(1+iη) + iωC − ω²J) θ = T; 1 % zero-to-peak "
     "of the transmitted torque at motor, gear and driven machine in turn (Szenasi & von Nimitz 1978)"),
    ("Allowable vibratory stress", f"UTS/25 ({MIL_STANDARD.cited}, as cited there)"),
    ("Pulsation", "T(ω) sin(2 (ω_line t − p θ) + phase); f = 2 f_line (1 − n/n_s) "
     "(Szenasi & von Nimitz 1978); Pulsation1: T₁(ω) sin(ω_line t − p θ + phase / 2), f = f_line (1 − n/n_s)"),
    ("Start-up crossing", "% speed = 100 (1 − f / 2 f_line) (Szenasi & von Nimitz 1978, Table 1); "
     "of Pulsation1 100 (1 − f / f_line)"),
    ("Start, exponential", "q̈ + 2ζω q̇ + ω² q = Φᵀ T(t, θ, ω), exact step for a force cubic in "
     f"time ({INTEGRATORS.cited})"),
    ("Start, Newmark", "average acceleration, eqs (1) to (3) of Szenasi & von Nimitz 1978; eq. (4) "
     "derived from these (its printed second C term repeats the velocity instead of the acceleration)"),
    ("Torque curves", f"monotone cubic through the points, no overshoot ({CURVES.authors} 1980)"),
    ("Shear stress", "τ = 16 T D / (π (D⁴ − d⁴)), nominal; SCF multiplies it for fatigue and UTS/25"),
    ("Cycle counting", f"rainflow, {RAINFLOW.cited}; history from rest, closed by a return to zero"),
    ("Damage", "q = Σ n_i/N_i, starts = 1/q, log-log S-N line, bending data halved for torsion "
     "(Szenasi & von Nimitz 1978, Figure 3 and Stress criterion); mean stress ignored"),
)  # fmt: skip


@dataclass(frozen=True)
class Stamp:
    """When and with what a calculation was made."""

    software: str  #: Name and version.
    date: dt.datetime  #: In UTC. [date]

    @classmethod
    def now(cls) -> Stamp:
        """The present; SOURCE_DATE_EPOCH sets another date for reproducible files."""
        date = fixed_date() or dt.datetime.now(dt.UTC).replace(microsecond=0)
        return cls(f"torsionbook {product_version()}", date)


def audit_rows(
    results: Results,
    stamp: Stamp,
    digest: str,
    warnings: Sequence[str],
    overrides: Mapping[str, object],
) -> list[dict[str, Any]]:
    """Rows of the Audit table.

    Parameters
    ----------
    results : Results
        The run. [SI]
    stamp : Stamp
        Version and date.
    digest : str
        Digest of the inputs as typed. [hex]
    warnings : sequence of str
        Everything a reader must know. [sentences]
    overrides : mapping
        Settings of the command line that differ from the workbook's.

    Returns
    -------
    list of dict
        Keys item and value. [text]
    """
    pairs = [
        (DIGEST_ITEM, digest),
        (SOFTWARE_ITEM, stamp.software),
        ("Date (UTC)", f"{stamp.date:%Y-%m-%d %H:%M:%S}"),
        ("Python", f"{platform.python_version()} on {platform.system()}"),
        ("Libraries", _libraries()),
        *((f"{SETTING_ITEM}{k}", str(v)) for k, v in overrides.items()),
        *_settings(results),
        *_plans(results),
        *_accuracy(results),
        *_time_spent(results.spent),
        *((f"Warning {i}", text) for i, text in enumerate(warnings, start=1)),
        *((f"Equation: {name}", text) for name, text in EQUATIONS),
    ]
    return [{"item": item, "value": value} for item, value in pairs]


def _time_spent(spent: Iterable[tuple[str, float]]) -> Iterator[tuple[str, str]]:
    """Time of each analysis; one that was made in several steps is listed once."""
    total: dict[str, float] = {}
    for name, seconds in spent:
        total[name] = total.get(name, 0.0) + seconds
    for name, seconds in total.items():
        yield f"Time spent: {name}", f"{1e3 * seconds:.1f} ms"


def _percent(share: float) -> str:
    """A share in per cent with two digits, never in powers of ten."""
    shown = 100.0 * share
    if not math.isfinite(shown):
        return "unknown"
    if shown == 0.0:
        return "0 %"
    if abs(shown) < 1e-6:
        return "less than 0.000001 %"
    digits = max(0, 1 - math.floor(math.log10(abs(shown))))
    return f"{shown:.{digits}f} %"


def library_words(steel: Steel) -> str:
    """The strengths that a steel of the library has, and where they come from."""
    return (
        f"UTS {steel.uts / 1e6:.4g} MPa ({steel.uts / KSI:.4g} ksi), yield {steel.yield_ / 1e6:.4g} MPa "
        f"({steel.yield_ / KSI:.4g} ksi), of the library: {steel.source}"
    )


@cache
def _libraries() -> str:
    """Their versions; they are looked up on the disk, once in a process."""
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in LIBRARIES)
    return f"{versions}; compiled loops: {about()}"


def _settings(results: Results) -> Iterator[tuple[str, str]]:
    case, start = results.case, results.start
    margins = results.margins
    low_high = margins.speed_range
    yield (
        "Required margin",
        f"{margins.required:.0%} ({case.standard or 'Szenasi'}, {case.margin_basis or 'calculated'})",
    )
    if low_high:
        rpm = [s * 9.549296585513721 for s in low_high]
        yield "Operating speed range", f"{rpm[0]:.6g} to {rpm[1]:.6g} rpm"
    yield "UTS/25 compared with", f"{results.steady.stress_basis} stress, SCF included"
    if start is not None:
        yield "Method of the start", start.method
        yield "Outcome of the start", start.outcome.sentence
    yield "Rainflow residue", case.rainflow_residue or f"half cycles ({RAINFLOW.cited})"
    for row in case.materials:
        if row.library_steel is not None:
            yield f"Strength of {row.material}", library_words(row.library_steel)
    if case.mean_stress == MeanStress.GOODMAN:
        yield "Mean stress", "Goodman with 0.67 UTS; amplitude = half range"
    else:
        yield "Mean stress", "ignored; amplitude = half range"
    yield (
        "Element torque in a start",
        "elastic torque, stiffness × twist; a rigid mesh by equilibrium",
    )


def _plans(results: Results) -> Iterator[tuple[str, str]]:
    """What was simulated and why; sheet `Effects` has each number."""
    for plan in results.plans:
        yield f"Plan {plan.number}", plan.reason
    reported = results.plans[-1]
    on = [d.effect for d in reported.decisions if d.on]
    yield "Effects simulated", ", ".join(on) or "none"
    left_out = [_left_out(d) for d in reported.decisions if not d.on]
    yield "Effects left out, with bounds", "; ".join(left_out) or "none"
    if reported.effects.clearances:
        yield "Clearances modelled", ", ".join(reported.effects.clearances)
        yield "Contact law", reported.effects.contact_law
    sensitivity = None if results.start is None else results.start.repeatability
    if sensitivity is not None:
        spread = (
            "a relative change of the input of 1e-9 may change a peak by "
            f"{_percent(sensitivity.spread)}, by {sensitivity.runs} runs"
        )
        yield "Sensitive", f"{'yes' if sensitivity.sensitive else 'no'}: {spread}"


def _left_out(decision: EffectDecision) -> str:
    if decision.bound is None:
        return f"{decision.effect}: bound unknown"
    bound = (
        "exact"
        if decision.bound == 0.0
        else f"changes a result by at most {_percent(decision.bound)}"
    )
    return f"{decision.effect}: {bound}"


def _accuracy(results: Results) -> Iterator[tuple[str, str]]:
    case, start = results.case, results.start
    yield "Modes by", MODES_BY[results.modes.algorithm]
    if results.segments:
        text = ", ".join(f"{name}: {n}" for name, n in results.segments)
        yield (
            "Shaft segments",
            f"{text}; estimated frequency error {_percent(results.frequency_error)}",
        )
        yield "Accurate up to", f"{results.accurate_up_to:.4g} Hz; modes above are not judged"
    if results.damping.neglected > 0.0:
        yield (
            "Largest neglected damping term",
            f"{results.damping.neglected:.3g} 1/s; it couples at most "
            f"{_percent(results.damping.coupling)} of one mode into another",
        )
    if start is None:
        return
    yield "Wanted error of peak torques", _percent(case.tolerance_peak or 1e-3)
    yield (
        "Estimated error of peak torques",
        f"{_percent(start.estimated_error)} (change from step h to h/2)",
    )
    left_out = f"{_percent(start.truncation_error)}; {start.kept_modes} modes kept"
    yield "of which modes left out", left_out
    yield (
        "Largest step",
        f"{1e3 * start.step:.4g} ms, {start.trajectory.n_steps:,} steps; step halved "
        f"{start.halvings} time{'' if start.halvings == 1 else 's'} to reach the wanted error",
    )
    for name, error in results.starts_error:
        shown = NoNumber.UNLIMITED if error is None else _percent(error)
        yield f"Estimated error of starts, {name}", shown
