"""The formula that runs is documented, with equation, validity and source."""

from __future__ import annotations

import ast
import inspect
import re

from tests.architecture.sources import SOURCES, FunctionNode, for_every
from tests.architecture.test_docstrings import UNIT, described, section

CLOSURES = [
    (source.label, name, node)
    for source in SOURCES
    if source.label.startswith("closures/")
    for name, node in source.public_functions()
    if "." not in name
]

every_closure = for_every([(f"{label}:{name}", (node,)) for label, name, node in CLOSURES])


def missing_parts(node: FunctionNode) -> list[str]:
    """What the docstring of a formula lacks."""
    doc = inspect.cleandoc(ast.get_docstring(node) or "")
    notes = "\n".join(section(doc, "Notes"))
    sources = "\n".join(section(doc, "References"))
    missing = []
    if ".. math::" not in notes:
        missing.append("equation")
    if not re.search(r"\bValidity:", notes):
        missing.append("validity")
    if not re.search(r"\.\. \[1\] \S", sources):
        missing.append("source")
    for entry in ("Parameters", "Returns"):
        texts = described(section(doc, entry))
        missing += [f"unit of {key}" for key, text in texts.items() if not UNIT.search(text)]
        if not texts:
            missing.append(entry.lower())
    return missing


@every_closure
def test_formula_is_documented(node: FunctionNode) -> None:
    assert missing_parts(node) == []


def test_what_the_docstring_lacks_is_noticed() -> None:
    code = '''
def flow(height: float) -> float:
    r"""Flow.

    Parameters
    ----------
    height : float
        Height. [m]

    Returns
    -------
    float
        Flow. [m3/s]

    Notes
    -----
    .. math:: Q = h

    Validity: everywhere.

    References
    ----------
    .. [1] A textbook.
    """
'''

    def missing(text: str) -> list[str]:
        (node,) = ast.parse(text).body
        assert isinstance(node, ast.FunctionDef)
        return missing_parts(node)

    assert missing(code) == []
    assert missing(code.replace(".. math::", "")) == ["equation"]
    assert missing(code.replace("Validity", "Range")) == ["validity"]
    assert missing(code.replace(".. [1]", "")) == ["source"]
    assert missing(code.replace("[m]", "")) == ["unit of height"]
    assert missing(code.replace("[m3/s]", "")) == ["unit of float"]
