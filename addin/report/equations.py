"""The equations of a calculation, typeset, with their sources.

The names are those of `addin.calculation.audit.EQUATIONS`, which a test compares; tables refer to an equation
by its name and so by its number.
"""

from __future__ import annotations

from addin.contract.sources import (
    CURVES,
    INTEGRATORS,
    MIL_STANDARD,
    PAPER,
    RAINFLOW,
    REFERENCES,
    SINGULAR_VALUES,
    Source,
)
from addin.report.document import Equation
from addin.report.formula import fence, formula, frac, root


def _numbered(source: Source) -> str:
    """A source by its authors and its number in the list of references."""
    return f"{source.named} [{REFERENCES.index(source) + 1}]"


_PAPER = _numbered(PAPER)

#: In the order in which they are numbered.
EQUATIONS: tuple[Equation, ...] = (
    Equation(
        "Shaft stiffness",
        formula("k =", frac(formula("π G", fence("D^4 − d^4")), "32 L")),
        "G = shear modulus, D and d = outer diameter and bore, L = length. Used where "
        "Stiffness is blank.",
        "strength of materials",
    ),
    Equation(
        "Natural frequencies",
        formula("*K φ = ω^2 *J φ ,~~ *K = *B^T diag", fence("k"), "*B ,~~ ω = singular~values~of~",
                frac(formula(root("k"), "*B"), root("*J"))),
        "B = incidence matrix of the elements with speed ratios, k = stiffnesses, J = "
        "inertias. The stiffness matrix is not assembled, so stiff elements do not reduce "
        "accuracy.",
        _numbered(SINGULAR_VALUES),
    ),
    Equation(
        "Modal damping",
        formula("ζ_r = ζ_stated +", frac("1", "2"), "∑_e η_e s_er +", frac("1", "2"),
                frac("φ_r^T *C φ_r", "ω_r")),
        "ζ stated by DampingRatio or ModeDamping, η = loss factor and s = strain-energy "
        "share of an element, φ at unit modal mass. The amplification at resonance is 1 / 2ζ.",
        "modal analysis; docs/method.md",
    ),
    Equation(
        "Separation margin",
        formula("m = min_n", frac(formula(fence("f − f_exc", "||")), "f_exc")),
        "minimum over the speeds n of continuous operation, 0 where the excitation crosses "
        "the mode in that range; required: 20 % for calculated, 10 % for measured "
        "frequencies.",
        f"{_PAPER}, Steady state torsional analysis",
    ),
    Equation(
        "Forced response",
        formula(fence(formula("*K", fence("1 + i η"), "+ i ω *C − ω^2 *J"), "[]"), "θ = *T"),
        "solved directly in complex form; by default T is 1 % zero-to-peak of the "
        "transmitted torque at motor, gears and driven machines in turn, else as in table "
        "Excitations.",
        _PAPER,
    ),
    Equation(
        "Allowable vibratory stress",
        formula("τ_allowable =", frac("UTS", "25")),
        "Compared with stresses that include SCF.",
        f"{MIL_STANDARD.cited}, as cited by {_PAPER}",
    ),
    Equation(
        "Pulsation",
        formula("T", fence("t"), "= T_p", fence("ω"), "sin",
                fence(formula("2", fence("ω_line t − p θ"), "+ φ_0")), ",~~ f = 2 f_line",
                fence(formula("1 −", frac("n", "n_s")))),
        "p pole pairs, θ angle of the motor, n speed, nₛ synchronous speed: twice the slip "
        "frequency, falling from 2 × line frequency to zero. Pulsation1 of a one-way discharge path has "
        "half the angle and half the frequency.",
        _PAPER,
    ),
    Equation(
        "Start-up crossing",
        formula("%~speed = 100", fence(formula("1 −", frac("f", "2 f_line")))),
        "the speed at which the pulsation crosses a natural frequency f; that of Pulsation1 at 100 (1 − f / f_line).",
        f"{_PAPER}, Table 1",
    ),
    Equation(
        "Start, exponential",
        formula("q''_r + 2 ζ_r ω_r q'_r + ω_r^2 q_r = φ_r^T *T", fence("t , θ , ω")),
        "integrated by a step that is exact for a torque cubic in time.",
        _numbered(INTEGRATORS),
    ),
    Equation(
        "Start, Newmark",
        formula("θ_n+1 = θ_n + h θ'_n +", frac("h^2", "4"), fence("θ''_n + θ''_n+1")),
        "average acceleration (Newmark) of [1], where Method is newmark. In the printed eq. "
        "(4) the second C term repeats the velocity; here the equation is derived from eqs "
        "(1) to (3).",
        f"{_PAPER}, eqs (1) to (4)",
    ),
    Equation(
        "Shear stress",
        formula("τ =", frac("16 T D", formula("π", fence("D^4 − d^4"))), ",~~ τ_a =",
                frac(formula("K_f · Δ τ"), "2")),
        "τ = nominal stress, D and d = stress diameter and bore; the amplitude of a cycle is "
        "half its range Δτ times Kf, which is SCF unless a notch sensitivity is stated; mean stress is ignored "
        "unless Goodman is stated.",
        "strength of materials",
    ),
    Equation(
        "Damage",
        formula("q = ∑_i", frac("n_i", "N_i"), ",~~ allowable~starts =", frac("1", "q"), ",~~ N = N_1",
                ("script", fence(frac("S_1", "S")), None, formula("k"))),
        "n = cycles of one start at amplitude S; N = cycles to failure at S on the S-N line, "
        "straight in log-log between its points (S₁, N₁), exponent k. Bending data are "
        "halved for torsion.",
        f"{_PAPER}, Figure 3 and Stress criterion; Miner's rule",
    ),
)  # fmt: skip

#: What is done by a published procedure rather than by one formula.
METHODS: tuple[tuple[str, str], ...] = (
    (
        "Torque curves",
        "monotone cubic through the typed points, without overshoot; constant outside them "
        f"({_numbered(CURVES)}).",
    ),
    (
        "Cycle counting",
        f"rainflow according to {_numbered(RAINFLOW)}; the history begins at rest and is closed by a return to zero.",
    ),
)

_NUMBERS = {equation.name: number for number, equation in enumerate(EQUATIONS, start=1)}


def by(*names: str) -> str:
    """A reference to equations by their names."""
    shown = [f"({_NUMBERS[name]})" for name in names]
    if len(shown) == 1:
        return f"By equation {shown[0]}."
    return f"By equations {', '.join(shown[:-1])} and {shown[-1]}."
