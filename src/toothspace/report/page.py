"""Templates of reports, and the style that all pages share."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

from toothspace.results.variables import unit_of, words_of

TEMPLATES = Path(__file__).parent / "templates"
_TYPOGRAPHY = (("degC", "°C"), ("deg", "°"), ("um", "µm"), ("m2", "m²"), ("m3", "m³"))
"""Units as plain text, and for a reader."""


def render(template: str, **values: Any) -> str:
    """Fill a template of this package; ``style`` stands for the shared style sheet."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    style = (TEMPLATES / "report.css").read_text(encoding="utf-8")
    return environment.get_template(template).render(style=style, **values)


class LabelledNumber(NamedTuple):
    """A number for a reader: label, value as text, unit."""

    label: str
    value: str
    unit: str


def quantity(name: str, value: object) -> LabelledNumber:
    """Split a name such as ``mean_flow_L_per_min`` into label and unit, and format its value."""
    text, unit = words_of(name), unit_of(name)
    label = text[:1].upper() + text[1:]
    if unit == "1":
        if not name.endswith("_efficiency") or not isinstance(value, float):
            return LabelledNumber(label, format_value(value), "")
        value, unit = 100.0 * value, "%"
    return LabelledNumber(label, format_value(value), shown_unit(unit))


def shown_unit(unit: str) -> str:
    """Return a unit as it is printed."""
    for plain, shown in _TYPOGRAPHY:
        unit = unit.replace(plain, shown)
    return unit


def format_value(value: object) -> str:
    """Four significant digits for numbers, yes or no for truth values."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, int | float):
        return str(value)
    if math.isnan(value):
        return "–"
    if value != 0.0 and (abs(value) < 1e-3 or abs(value) >= 1e6):
        return f"{value:.2e}"
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"
