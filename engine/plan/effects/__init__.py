"""What the evidence says of each effect: one file an effect, of the name of its record's file.

Each has one function `finding(case, evidence, modelled)`; `modelled` names the elements whose
clearance the plan before this one modelled.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pkgutil import iter_modules

from engine.case.data import CaseData
from engine.case.effects import EFFECTS
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence


def _finding_of(module: str) -> Callable[[CaseData, Evidence, tuple[str, ...]], Finding]:
    finding = getattr(import_module(f"{__name__}.{module}"), "finding", None)
    if not callable(finding):
        raise ImportError(f"engine/plan/effects/{module}.py has no function `finding`")
    return finding  # type: ignore[no-any-return]


_FILES = {file.name for file in iter_modules(__path__)}
_RECORDS = {effect.module for effect in EFFECTS.values()}
for _name in sorted(_RECORDS - _FILES):
    raise ImportError(f"effect {_name} has no function finding: add engine/plan/effects/{_name}.py")
for _name in sorted(_FILES - _RECORDS):
    raise ImportError(f"effect {_name} has no record: add engine/case/effects/{_name}.py")

#: Name of an effect → its finding, in the order of `EFFECTS`.
FINDINGS = {name: _finding_of(effect.module) for name, effect in EFFECTS.items()}
