"""List every sentence that a user can meet: `python scripts/list_sentences.py`.

Read from the sources: texts of at least three words in engine and addin, docstrings, comments and names of
tests apart; what is put into a text stands as {…}. `make generated` writes scripts/sentences.txt, so that a
change of words is seen in review, and a test refuses words that were replaced (see `REPLACED`).
"""

from __future__ import annotations

import argparse
import ast
import html
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: A text is a sentence for people when it has so many words in a row.
_WORDS = re.compile(r"[A-Za-zÀ-ÿ’'-]{2,}(?:[ ,;:.()%–−]+(?:\{…\}|[A-Za-z0-9À-ÿ’'-]+)){2,}")
#: What no sentence says any more, and what it says instead.
REPLACED = {
    r"\bgiven up\b": "cancelled, stopped",
    r"\b(is|are) told\b|\btold (in|as)\b(?! Boolean)": "is shown, is reported",
    r"\bhangs? on\b": "depends on",
    r"\bas (it|they) stands?\b": "unchanged",
    r"\bsideways\b": "lateral",
    r"\bblows?\b": "impact",
    r"\bteeth part\b|\bruns that part\b|\btrain that parts\b": "separate, diverge",
    r"\bis not a start\b|(?<!there )\bis no start\b": "is an incomplete start",
    r"\bstands? in the way of\b|\bwants it no more\b|\bcounts nothing\b": "plain words",
}


def _text(node: ast.expr) -> str | None:
    """A text with {…} for what is put in; None for anything else."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    if isinstance(node, ast.JoinedStr):
        parts = [_text(part) if isinstance(part, ast.Constant) else "{…}" for part in node.values]
        return "".join(part or "" for part in parts)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        left, right = _text(node.left), _text(node.right)
        return None if left is None and right is None else f"{left or '{…}'}{right or '{…}'}"
    return None


class _Reader(ast.NodeVisitor):
    """Texts of a module that are no docstrings."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def visit_Expr(self, node: ast.Expr) -> None:
        if not (isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)):
            self.generic_visit(node)

    def generic_visit(self, node: ast.AST) -> None:
        text = _text(node) if isinstance(node, ast.expr) else None
        if text is None:
            super().generic_visit(node)
            return
        self.texts.append(text)
        if isinstance(node, ast.JoinedStr):
            for part in node.values:  # texts chosen inside the braces
                if isinstance(part, ast.FormattedValue):
                    self.visit(part.value)
        elif isinstance(node, ast.BinOp):
            for side in (node.left, node.right):
                if _text(side) is None:
                    self.visit(side)


def sentences(root: Path = ROOT) -> Iterator[tuple[str, str]]:
    """File and sentence, in the order of the files."""
    for package in ("engine", "addin", "torsionbook"):
        for path in sorted((root / package).rglob("*")):
            place = path.relative_to(root).as_posix()
            if path.suffix == ".py":
                reader = _Reader()
                reader.visit(ast.parse(path.read_text(encoding="utf-8")))
                texts = reader.texts
            elif path.suffix == ".js":
                source = re.sub(r"(?m)^\s*(//|/?\*).*$", "", path.read_text(encoding="utf-8"))
                quoted = re.findall(r'"((?:[^"\\\n]|\\.)*)"|`((?:[^`\\]|\\.)*)`', source)
                texts = [re.sub(r"\$\{.*?\}", "{…}", a or b) for a, b in quoted]
            elif path.suffix == ".html":
                texts = re.split(r"<[^>]*>", html.unescape(path.read_text(encoding="utf-8")))
            else:
                continue
            for text in texts:
                plain = " ".join(text.split())
                if _WORDS.search(plain):
                    yield place, plain


def listing(root: Path = ROOT) -> str:
    """The committed list: each file with its sentences."""
    lines: list[str] = []
    for place, sentence in dict.fromkeys(sentences(root)):
        if not lines or lines[-1].split("\t")[0] != place:
            lines.append("")
        lines.append(f"{place}\t{sentence}")
    return "\n".join(lines).lstrip("\n") + "\n"


def riddles(root: Path = ROOT) -> Iterator[tuple[str, str, str]]:
    """File, sentence, and what to say instead, of each sentence with words that were replaced."""
    for place, sentence in dict.fromkeys(sentences(root)):
        for pattern, instead in REPLACED.items():
            if re.search(pattern, sentence, re.IGNORECASE):
                yield place, sentence, instead


def main() -> int:
    """Print the list, or write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--riddles", action="store_true", help="only sentences with replaced words")
    options = parser.parse_args()
    if options.riddles:
        for place, sentence, instead in riddles():
            sys.stdout.write(f"{place}: {sentence}  → {instead}\n")
    else:
        sys.stdout.write(listing())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
