"""JSON Schema (draft 2020-12) of the case file, from the declared keys."""

from __future__ import annotations

from dataclasses import MISSING, is_dataclass
from functools import singledispatch
from typing import Any

from toothspace.case.circuit import ELEMENT_KEY
from toothspace.config.allowed import allowed_text
from toothspace.config.load import TOP_LEVEL, machine_key
from toothspace.config.rules import CONDITIONS
from toothspace.core import keys
from toothspace.core.units import format_si

Schema = dict[str, Any]

_QUANTITY_PATTERN = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(\s*|\s+1/)[A-Za-zµμ°].*$"


def case_schema() -> Schema:
    """Return the schema of a whole case file."""
    properties = {name: _described(key) for name, key in TOP_LEVEL.items()}
    properties["machine"] = _described(machine_key())
    properties["circuit"]["additionalProperties"] = schema_of(ELEMENT_KEY)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "toothspace case file",
        "type": "object",
        "properties": properties,
        "required": ["schema", "title"],
        "oneOf": [{"required": [name]} for name in CONDITIONS],
        "additionalProperties": False,
    }


def table_schema(spec: type) -> Schema:
    """Return the schema of the table that is read to a dataclass."""
    declared = keys.keys_of(spec) if is_dataclass(spec) else {}
    properties = {}
    for name, (key, dataclass_field) in declared.items():
        properties[name] = _described(key) | _default(key, dataclass_field.default)
    required = [name for name, (_, f) in declared.items() if keys.is_required(f)]
    return {
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _described(key: keys.Key) -> Schema:
    nested = isinstance(key, (keys.Table, keys.Variant, keys.Free))
    allowed = "" if nested else f" Allowed: {allowed_text(key)}."
    return {"description": f"{key.doc}{allowed}".strip(), **schema_of(key)}


def _default(key: keys.Key, default: Any) -> Schema:
    if default is MISSING or default is None:
        return {}
    if isinstance(key, keys.Quantity):
        return {"default": format_si(default, key.unit)}
    if isinstance(key, (keys.Number, keys.Integer, keys.Choice, keys.Text, keys.Flag)):
        return {"default": default}
    return {}


@singledispatch
def schema_of(key: keys.Key) -> Schema:
    """Return the schema of one value."""
    return {}


@schema_of.register
def _(key: keys.Quantity) -> Schema:
    bounds = {"x-minimum": key.low, "x-exclusiveMinimum": key.above, "x-maximum": key.high}
    given = {name: bound for name, bound in bounds.items() if bound is not None}
    return {"type": "string", "pattern": _QUANTITY_PATTERN, "x-unit": key.unit, **given}


@schema_of.register
def _(key: keys.Number) -> Schema:
    bounds = {"minimum": key.low, "exclusiveMinimum": key.above, "maximum": key.high}
    return {"type": "number", **{name: b for name, b in bounds.items() if b is not None}}


@schema_of.register
def _(key: keys.Integer) -> Schema:
    return {"type": "integer", "minimum": key.low, "maximum": key.high}


@schema_of.register
def _(key: keys.Choice) -> Schema:
    return {"type": "string", "enum": [*key.options, *key.former]}


@schema_of.register
def _(_: keys.Text) -> Schema:
    return {"type": "string", "minLength": 1}


@schema_of.register
def _(_: keys.Flag) -> Schema:
    return {"type": "boolean"}


@schema_of.register
def _(key: keys.FilePath) -> Schema:
    names = [suffix.lstrip(".") for suffix in key.suffixes]
    endings = "|".join([*names, *(name.upper() for name in names)])
    return {"type": "string", "pattern": rf"\.({endings})$"}


@schema_of.register
def _(key: keys.Items) -> Schema:
    return {
        "type": "array",
        "items": schema_of(key.item),
        "minItems": key.low,
        "maxItems": key.high,
    }


@schema_of.register
def _(key: keys.Row) -> Schema:
    items = [schema_of(item) for item in key.items]
    return {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}


@schema_of.register
def _(key: keys.Grid) -> Schema:
    item = schema_of(key.item)
    span = {
        "type": "object",
        "properties": {"from": item, "to": item, "count": {"type": "integer", "minimum": 2}},
        "required": ["from", "to", "count"],
        "additionalProperties": False,
    }
    return {"anyOf": [{"type": "array", "items": item, "minItems": 1}, span]}


@schema_of.register
def _(key: keys.Table) -> Schema:
    return table_schema(key.spec)


@schema_of.register
def _(key: keys.Variant) -> Schema:
    return {"oneOf": [_variant(key.tag, name, spec) for name, spec in key.variants.items()]}


def _variant(tag: str, name: str, spec: type) -> Schema:
    schema = table_schema(spec)
    schema["properties"] = {tag: {"const": name}, **schema["properties"]}
    schema["required"] = [tag, *schema["required"]]
    return schema


@schema_of.register
def _(key: keys.Named) -> Schema:
    return {"type": "object", "additionalProperties": schema_of(key.item)}
