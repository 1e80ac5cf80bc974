"""Formulas drawn when the pages are made: no script, no network and no font is needed to read."""

from __future__ import annotations

import html
import re
from functools import cache
from typing import Any

import ziamath
from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.errors import SphinxError

INLINE_SIZE, BLOCK_SIZE = 17, 17
"""Sizes beside the text of the theme and by itself [px]."""

_ESCAPED = re.compile(r"\\[{}]")


class FormulaError(ValueError):
    """A formula that cannot be drawn."""


@cache
def draw(formula: str, *, as_block: bool) -> str:
    """Return a formula in TeX as an SVG picture in the colour of the text around it.

    Raises
    ------
    FormulaError
        If it holds a command that is not known or is not complete.
    """
    try:
        unknown = "\\" in convert(formula)
        size = BLOCK_SIZE if as_block else INLINE_SIZE
        drawn = ziamath.Latex(formula, size=size, inline=not as_block, color="currentColor")
    except Exception as error:  # the packages raise errors of many kinds for what they cannot read
        raise FormulaError(f"{error or type(error).__name__} in the formula {formula}") from error
    if unknown:
        raise FormulaError(f"a command that is not known in the formula {formula}")
    braces = _ESCAPED.sub("", formula)
    if braces.count("{") != braces.count("}"):
        raise FormulaError(f"a brace that is not closed in the formula {formula}")
    shift = "" if as_block else f' style="vertical-align:{drawn.getyofst():.2f}px"'
    picture = drawn.svg().replace("<svg ", f'<svg aria-hidden="true"{shift} ', 1)
    kind, text = "formula" if as_block else "symbol", html.escape(formula)
    return f'<span class="{kind}" role="img" aria-label="{text}">{picture}</span>'


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(_picture(node, as_block=False))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    writer.body.append(f"{_picture(node, as_block=True)}\n")
    raise nodes.SkipNode


def _picture(node: nodes.Element, *, as_block: bool) -> str:
    try:
        return draw(node.astext().strip(), as_block=as_block)
    except FormulaError as error:
        raise SphinxError(f"{node.source}: {error}") from error


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer."""
    app.add_html_math_renderer(
        "drawn", inline_renderers=(_inline, None), block_renderers=(_block, None)
    )
    return {"parallel_read_safe": True, "parallel_write_safe": True}
