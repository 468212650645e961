"""Formulas as MathML in the page itself, so that a browser needs neither network nor script."""

from __future__ import annotations

import re

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

logger = logging.getLogger(__name__)


def formula(tex: str, display: str, node: nodes.Node) -> str:
    """Convert one formula; a command that is unknown to the converter is a warning."""
    try:
        mathml = convert(tex.strip(), display=display)
    except Exception as error:
        logger.warning("formula %r: %s", tex, error, location=node)
        return ""
    if found := re.search(r"<m[a-z]+[^>]*>\s*(\\[A-Za-z]+)", mathml):
        logger.warning("formula %r: %s is unknown", tex, found.group(1), location=node)
    return mathml


def inline(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    self.body.append(formula(node.astext(), "inline", node))
    raise nodes.SkipNode


def block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula of its own."""
    self.body.append(f'<div class="formula">{formula(node.astext(), "block", node)}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer under the name that ``html_math_renderer`` chooses."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
