"""What a key allows, in words, for messages and documentation."""

from __future__ import annotations

from functools import singledispatch

from toothspace.core import keys
from toothspace.core.units import dimension_name


def _range(key: keys.Quantity | keys.Number, unit: str) -> str:
    parts = []
    if key.above is not None:
        parts.append(f"above {key.above:g}{unit}")
    if key.low is not None:
        parts.append(f"from {key.low:g}{unit}")
    if key.high is not None:
        parts.append(f"{'to' if key.low is not None else 'at most'} {key.high:g}{unit}")
    joined = " ".join(parts) if key.low is not None else ", ".join(parts)
    return f", {joined}" if joined else ""


@singledispatch
def allowed_text(key: keys.Key) -> str:
    """Return what may stand behind a key, with its range."""
    return "any value"


@allowed_text.register
def _(key: keys.Quantity) -> str:
    limits = _range(key, f" {key.unit}")
    return f"{dimension_name(key.unit)} with its unit in quotes, such as '1 {key.unit}'{limits}"


@allowed_text.register
def _(key: keys.Number) -> str:
    return f"a number without unit{_range(key, '')}"


@allowed_text.register
def _(key: keys.Integer) -> str:
    return f"a whole number, from {key.low} to {key.high}"


@allowed_text.register
def _(key: keys.Choice) -> str:
    return " or ".join(f"'{option}'" for option in key.options)


@allowed_text.register
def _(_: keys.Text) -> str:
    return "a text that is not empty"


@allowed_text.register
def _(_: keys.Flag) -> str:
    return "true or false"


@allowed_text.register
def _(key: keys.FilePath) -> str:
    return f"a file that exists ({', '.join(key.suffixes)}), relative to the case file"


@allowed_text.register
def _(key: keys.Items) -> str:
    return f"a list of {key.low} to {key.high} items, each {allowed_text(key.item)}"


@allowed_text.register
def _(key: keys.Row) -> str:
    items = "; ".join(allowed_text(item) for item in key.items)
    return f"a list of {len(key.items)} items: {items}"


@allowed_text.register
def _(key: keys.Grid) -> str:
    return f"a list or {{from, to, count}} of: {allowed_text(key.item)}"


@allowed_text.register
def _(key: keys.Table) -> str:
    return f"a table with the keys {', '.join(keys.keys_of(key.spec))}"


@allowed_text.register
def _(key: keys.Variant) -> str:
    options = ", ".join(key.variants)
    return f"a table with {key.tag} = one of {options}"


@allowed_text.register
def _(_: keys.Named) -> str:
    return "a table"
