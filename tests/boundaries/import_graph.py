"""Every import of the project's own modules, read from the sources: also those inside functions and type-only ones."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path


@dataclass(frozen=True)
class Import:
    """One imported name: where it stands, and the module or third-party name it comes from."""

    source: str
    path: str
    line: int
    target: str
    inside_function: bool


class _Reader(ast.NodeVisitor):
    def __init__(self, module: str, is_package: bool) -> None:
        parts = module.split(".")
        self.package = parts if is_package else parts[:-1]
        self.depth = 0
        self.names: list[tuple[int, str, bool]] = []

    def visit_FunctionDef(self, node: ast.AST) -> None:
        self.depth += 1
        self.generic_visit(node)
        self.depth -= 1

    visit_AsyncFunctionDef = visit_FunctionDef
    visit_Lambda = visit_FunctionDef

    def visit_Import(self, node: ast.Import) -> None:
        for alias in node.names:
            self.names.append((node.lineno, alias.name, self.depth > 0))

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        base = self.package[: len(self.package) - node.level + 1] if node.level else []
        base = base + (node.module.split(".") if node.module else [])
        for alias in node.names:
            self.names.append((node.lineno, ".".join([*base, alias.name]), self.depth > 0))


def modules_of(root: Path, *packages: str) -> dict[str, Path]:
    """Dotted name → file of every module of the packages."""
    named = {}
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            named[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return named


@functools.cache
def _names_in(path: Path, module: str) -> tuple[tuple[int, str, bool], ...]:
    """Line, name, and whether inside a function, of each import of a file; read once a run."""
    reader = _Reader(module, path.name == "__init__.py")
    reader.visit(ast.parse(path.read_text(encoding="utf-8"), str(path)))
    return tuple(reader.names)


def imports_of(root: Path, *packages: str) -> Iterator[Import]:
    """Every import; a target of the project's own is the longest part of the name that is a module."""
    modules = modules_of(root, *packages)
    for module, path in modules.items():
        for line, name, inside in _names_in(path, module):
            target = name
            if name.split(".")[0] in packages:
                while target not in modules and "." in target:
                    target = target.rpartition(".")[0]
            if target != module:
                yield Import(module, path.relative_to(root).as_posix(), line, target, inside)


def circle(arrows: dict[str, set[str]]) -> list[str]:
    """One circle of the arrows; empty if there is none."""
    try:
        TopologicalSorter(arrows).prepare()
    except CycleError as found:
        return list(found.args[1])
    return []
