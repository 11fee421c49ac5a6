"""Docstrings of the engine and of the Python interface against the code: names agree, and each quantity carries its unit.

Read from the sources, so that compiled functions are seen as they are written. Checked of every
public function, method and class in a public module of `engine` and `torsionbook`:

- it has a docstring that opens with one line;
- a public function that takes or gives a float, a complex or an array has a section Parameters with
  the names of its parameters in the same order (methods: where the section is there); elsewhere one
  plain line is enough;
- an entry whose type is such a quantity carries a unit in [brackets], [1] for a plain number; the
  same for Returns and Yields;
- each field of a dataclass that is such a quantity is described where it is defined, in a comment
  `#:` behind it or above it, with its unit.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

QUANTITY = re.compile(r"\b(float|complex|ndarray|array_like|array|NDArray|Floats)\b")
NOT_A_QUANTITY = re.compile(
    r"of (int|bool|str)\b|dtype (int|bool)|\b(Int|Bool)\w*\b|\bu?int\d*\b|\bcallable\b"
)
UNIT = re.compile(r"\[[^\[\]]+\]")


@dataclass(frozen=True)
class Entry:
    """One line `name : type` of a section, with the indented text under it."""

    names: tuple[str, ...]
    type: str
    text: str

    def lacks_unit(self) -> bool:
        is_quantity = QUANTITY.search(self.type) and not NOT_A_QUANTITY.search(self.type)
        return bool(is_quantity) and not UNIT.search(f"{self.type} {self.text}")


def sections(docstring: str) -> dict[str, list[Entry]]:
    """The numpydoc sections of a docstring that hold entries."""
    lines = docstring.splitlines()
    starts = [
        i
        for i in range(len(lines) - 1)
        if lines[i].strip() and re.fullmatch(r"\s*-{3,}\s*", lines[i + 1])
    ]
    found = {}
    for start, end in pairwise([*starts, len(lines)]):
        found[lines[start].strip()] = list(entries(lines[start + 2 : end]))
    return found


def entries(lines: list[str]) -> Iterator[Entry]:
    head = ""
    body: list[str] = []
    for line in [*lines, "end"]:
        if line.strip() and not line.startswith(" "):
            if head:
                names, _, kind = head.partition(" : ")
                yield Entry(
                    tuple(name.strip().lstrip("*") for name in names.split(",")),
                    kind or names,
                    " ".join(body),
                )
            head, body = line.strip(), []
        else:
            body.append(line.strip())


def is_public(name: str) -> bool:
    return not name.startswith("_")


Function = ast.FunctionDef | ast.AsyncFunctionDef


def decorators(node: Function | ast.ClassDef) -> set[str]:
    calls = (d.func if isinstance(d, ast.Call) else d for d in node.decorator_list)
    return {ast.unparse(d).split(".")[-1] for d in calls}


def parameters(function: Function, *, method: bool) -> list[str]:
    a = function.args
    names = [arg.arg for arg in [*a.posonlyargs, *a.args]]
    if method and "staticmethod" not in decorators(function):
        names = names[1:]
    names += [a.vararg.arg] if a.vararg else []
    names += [arg.arg for arg in a.kwonlyargs]
    return names + ([a.kwarg.arg] if a.kwarg else [])


def fields(node: ast.ClassDef) -> list[str]:
    return [
        s.target.id
        for s in node.body
        if isinstance(s, ast.AnnAssign)
        and isinstance(s.target, ast.Name)
        and is_public(s.target.id)
        and "ClassVar" not in ast.unparse(s.annotation)
    ]


def is_quantity(annotation: ast.expr | None) -> bool:
    text = ast.unparse(annotation) if annotation else ""
    return bool(QUANTITY.search(text)) and not NOT_A_QUANTITY.search(text)


def carries_quantities(function: Function) -> bool:
    words = function.args
    given = [a.annotation for a in [*words.posonlyargs, *words.args, *words.kwonlyargs]]
    return any(is_quantity(one) for one in [*given, function.returns])


def field_complaints(node: ast.ClassDef, lines: list[str]) -> Iterator[str]:
    """Fields that are quantities and have no unit in the comment behind or above them."""
    for field in node.body:
        if not (isinstance(field, ast.AnnAssign) and is_quantity(field.annotation)):
            continue
        comment = lines[(field.end_lineno or field.lineno) - 1].partition("#:")[2]
        above = field.lineno - 2
        while lines[above].strip().startswith("#:"):
            comment = lines[above].strip() + comment
            above -= 1
        if is_public(ast.unparse(field.target)) and not UNIT.search(comment):
            yield f"{ast.unparse(field.target)} has no unit in [brackets] behind or above it"


def unit_complaints(found: dict[str, list[Entry]]) -> Iterator[str]:
    for section in ("Parameters", "Attributes", "Returns", "Yields"):
        for entry in found.get(section, []):
            if entry.lacks_unit():
                yield f"{section}: {', '.join(entry.names)} has no unit in [brackets]"


def listed(found: dict[str, list[Entry]], *names: str) -> list[str]:
    return [n for section in names for entry in found.get(section, []) for n in entry.names]


def function_complaints(function: Function, *, method: bool) -> Iterator[str]:
    docstring = ast.get_docstring(function)
    if not docstring:
        yield "has no docstring"
        return
    found = sections(docstring)
    wanted = parameters(function, method=method)
    if "property" in decorators(function):
        returns = ast.unparse(function.returns) if function.returns else ""
        quantity = QUANTITY.search(returns) and not NOT_A_QUANTITY.search(returns)
        if quantity and not UNIT.search(docstring):
            yield "has no unit in [brackets]"
    elif "Parameters" in found or (wanted and not method and carries_quantities(function)):
        told = listed(found, "Parameters")
        if told != wanted:
            yield f"Parameters lists {told}, the signature has {wanted}"
    yield from unit_complaints(found)


def class_complaints(node: ast.ClassDef, lines: list[str]) -> Iterator[str]:
    docstring = ast.get_docstring(node)
    if not docstring:
        yield "has no docstring"
        return
    found = sections(docstring)
    if "dataclass" in decorators(node) and fields(node):
        if listed(found, "Attributes", "Parameters") != fields(node):
            yield from field_complaints(node, lines)
    elif "Parameters" in found:
        for member in node.body:
            if isinstance(member, Function) and member.name == "__init__":
                told, wanted = listed(found, "Parameters"), parameters(member, method=True)
                if told != wanted:
                    yield f"Parameters lists {told}, __init__ has {wanted}"
    yield from unit_complaints(found)


def complaints(source: str) -> Iterator[tuple[int, str, str]]:
    """Line, name and sentence of each complaint about the public names of a module."""
    tree = ast.parse(source)
    if not ast.get_docstring(tree):
        yield 1, "the module", "has no docstring"
    for node in tree.body:
        if isinstance(node, Function) and is_public(node.name):
            for sentence in function_complaints(node, method=False):
                yield node.lineno, node.name, sentence
        elif isinstance(node, ast.ClassDef) and is_public(node.name):
            for sentence in class_complaints(node, source.splitlines()):
                yield node.lineno, node.name, sentence
            for member in node.body:
                if isinstance(member, Function) and is_public(member.name):
                    for sentence in function_complaints(member, method=True):
                        yield member.lineno, f"{node.name}.{member.name}", sentence


def modules() -> list[Path]:
    return sorted(
        path
        for package in ("engine", "torsionbook")
        for path in (ROOT / package).rglob("*.py")
        if is_public(path.stem) or path.stem == "__init__"
    )


def test_there_is_something_to_check():
    assert len(modules()) > 5


@pytest.mark.parametrize("path", modules(), ids=lambda p: p.relative_to(ROOT).as_posix())
def test_docstrings(path):
    found = [
        f"{path.relative_to(ROOT).as_posix()}:{line}: {name} {sentence}"
        for line, name, sentence in complaints(path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n" + "\n".join(found)


GOOD = '''
"""A module."""

def stiffness(diameter, *, length, kind="shaft"):
    """Torsional stiffness of a solid shaft.

    Parameters
    ----------
    diameter, length : float
        Both larger than zero. [m]
    kind : str
        What it is called.

    Returns
    -------
    float
        Stiffness. [N m/rad]
    """
'''


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("", "", None),
        (" [m]", "", "Parameters: diameter, length has no unit in [brackets]"),
        (" [N m/rad]", "", "Returns: float has no unit in [brackets]"),
        ("diameter, length :", "length, diameter :", "Parameters lists"),
        ("*, length", "*, span", "Parameters lists"),
        ('"""A module."""', "", "has no docstring"),
    ],
)
def test_the_reading_of_docstrings(old, new, sentence):
    found = [s for _, _, s in complaints(GOOD.replace(old, new))]
    if sentence is None:
        assert found == []
    else:
        assert len(found) == 1
        assert found[0].startswith(sentence)


def test_the_reading_of_dataclasses():
    source = '''
"""A module."""

@dataclass(frozen=True)
class Shaft:
    """A shaft."""

    length: float  #: Length. [m]
    name: str
    #: Inner diameter,
    #: 0 for a solid shaft. [m]
    bore: float = 0.0
    speed: float = 0.0  #: Speed.
    stiffness: float | None = None
'''
    assert [s for _, _, s in complaints(source)] == [
        "speed has no unit in [brackets] behind or above it",
        "stiffness has no unit in [brackets] behind or above it",
    ]
