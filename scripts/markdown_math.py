"""Equations of the pages as MathML: `$x$` in a line, `$$` alone on the lines before and after a displayed one.

Browsers set MathML without a script, so that the pages stay readable offline. A forge that shows the Markdown
itself reads the same signs.
"""

from __future__ import annotations

import re

from latex2mathml.converter import convert
from markdown import Markdown
from markdown.extensions import Extension
from markdown.inlinepatterns import InlineProcessor
from markdown.preprocessors import Preprocessor

#: No blank inside next to the signs and no letter or digit outside: a sum in dollars is no equation.
IN_LINE = r"(?<![\\$\w])\$(?!\s)([^$\n]+?)(?<!\s)\$(?![\w$])"
DISPLAYED = re.compile(r"(?ms)^( *)\$\$\n(.*?)\n *\$\$$")


def _mathml(latex: str, display: str) -> str:
    """An equation; browsers leave no blank between `sin` and what it is of, as print does."""
    return convert(
        re.sub(r"(\\(?:sin|cos))\b(?!\s*(?:\\left|[({^]))", r"\1\\,", latex), display=display
    )


class Displayed(Preprocessor):
    """Equations on lines of their own, before Markdown looks for emphasis in them."""

    def run(self, lines: list[str]) -> list[str]:
        def stashed(match: re.Match[str]) -> str:
            mathml = _mathml(match[2], "block")
            return match[1] + self.md.htmlStash.store(f'<div class="equation">{mathml}</div>')

        return DISPLAYED.sub(stashed, "\n".join(lines)).split("\n")


class InLine(InlineProcessor):
    """An equation within a sentence."""

    def handleMatch(self, m, data):
        return self.md.htmlStash.store(_mathml(m[1], "inline")), m.start(0), m.end(0)


class MathExtension(Extension):
    def extendMarkdown(self, md: Markdown) -> None:
        md.preprocessors.register(Displayed(md), "displayed_math", 27)
        md.inlinePatterns.register(InLine(IN_LINE, md), "math", 185)


def makeExtension(**options: object) -> MathExtension:
    return MathExtension(**options)
