"""From names with unit suffixes to text for a reader."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

_SUFFIXES: Mapping[str, str] = {
    "_cm3_per_rev": "cm³/rev",
    "_L_per_min": "L/min",
    "_W_per_mm2": "W/mm²",
    "_um_bar": "µm bar",
    "_N_m": "N m",
    "_percent": "%",
    "_bar": "bar",
    "_degC": "°C",
    "_rpm": "rpm",
    "_mm3": "mm³",
    "_mm2": "mm²",
    "_mrad": "mrad",
    "_deg": "°",
    "_mm": "mm",
    "_um": "µm",
    "_W": "W",
    "_kN": "kN",
    "_MPa": "MPa",
    "_N": "N",
    "_J": "J",
    "_K": "K",
    "_s": "s",
}
"""Unit suffixes of summary numbers, longest first where one ends another."""


class LabelledNumber(NamedTuple):
    """A number for a reader: label, value as text, unit."""

    label: str
    value: str
    unit: str


def quantity(name: str, value: object) -> LabelledNumber:
    """Split a name such as ``mean_flow_L_per_min`` into label and unit, and format its value."""
    for suffix, unit in _SUFFIXES.items():
        if name.endswith(suffix):
            return LabelledNumber(_label(name.removesuffix(suffix)), format_value(value), unit)
    if name.endswith("_efficiency") and isinstance(value, float):
        return LabelledNumber(_label(name), format_value(100.0 * value), "%")
    return LabelledNumber(_label(name), format_value(value), "")


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


def _label(name: str) -> str:
    text = name.replace("_", " ")
    return text[:1].upper() + text[1:]
