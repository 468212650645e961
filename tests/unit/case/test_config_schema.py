"""JSON Schema and reference page come from the keys that are read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from toothspace.api import load_case
from toothspace.case.case import case_schema

REPOSITORY = Path(__file__).resolve().parents[3]
CASES = sorted((REPOSITORY / "cases").glob("*.toml"))
TYPES = {
    "string": str,
    "number": (int, float),
    "integer": int,
    "object": dict,
    "array": list,
    "boolean": bool,
}


def errors(schema: dict[str, Any], value: Any, path: str = "") -> list[str]:
    """Violations of the keywords that the schema uses."""
    found: list[str] = []
    if "oneOf" in schema and sum(not errors(s, value, path) for s in schema["oneOf"]) != 1:
        found.append(f"{path}: not exactly one alternative")
    if "anyOf" in schema and all(errors(s, value, path) for s in schema["anyOf"]):
        found.append(f"{path}: no alternative")
    if "const" in schema and value != schema["const"]:
        found.append(f"{path}: not {schema['const']}")
    if "type" in schema and not isinstance(value, TYPES[schema["type"]]):
        return [*found, f"{path}: not a {schema['type']}"]
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{path}: not in {schema['enum']}")
    if "pattern" in schema and not re.search(schema["pattern"], value):
        found.append(f"{path}: pattern")
    if "minimum" in schema and value < schema["minimum"]:
        found.append(f"{path}: below minimum")
    if "maximum" in schema and value > schema["maximum"]:
        found.append(f"{path}: above maximum")
    return found + _nested(schema, value, path)


def _nested(schema: dict[str, Any], value: Any, path: str) -> list[str]:
    found: list[str] = []
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        found += [f"{path}: no {name}" for name in schema.get("required", []) if name not in value]
        for name, item in value.items():
            other = schema.get("additionalProperties", {})
            if name in properties:
                found += errors(properties[name], item, f"{path}.{name}")
            elif other is False:
                found.append(f"{path}.{name}: unknown")
            else:
                found += errors(other, item, f"{path}.{name}")
    if isinstance(value, list):
        items = schema.get("prefixItems") or [schema.get("items", {})] * len(value)
        for k, (item, part) in enumerate(zip(items, value, strict=False)):
            found += errors(item, part, f"{path}[{k}]")
    return found


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    return case_schema()


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_cases_fulfil_the_schema(path: Path, schema: dict[str, Any]) -> None:
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    # what a base holds need not stand in the file
    assert errors(schema, load_case(path).to_dict() if "base" in tables else tables) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"2.75 mm"', "2.75"),
        ('"2.75 mm"', '"2.75"'),
        ("tooth_count = 12", "tooth_count = 0"),
        ("tooth_count = 12", "teeth = 12"),
        ('mode = "motor"', 'mode = "fan"'),
        ("schema = 1", "schema = 2"),
        ("[operating_point]", "[circuit]"),
    ],
)
def test_schema_refuses_what_the_reader_refuses(old: str, new: str, schema: dict[str, Any]) -> None:
    text = (REPOSITORY / "cases/egm12_motor.toml").read_text(encoding="utf-8")
    assert errors(schema, tomllib.loads(text.replace(old, new, 1)))


def test_every_key_has_a_meaning(schema: dict[str, Any]) -> None:
    def silent(part: dict[str, Any], path: str) -> list[str]:
        found = []
        for name, item in part.get("properties", {}).items():
            if "const" not in item and not item.get("description"):
                found.append(f"{path}.{name}")
            found += silent(item, f"{path}.{name}")
        for option in part.get("oneOf", []):
            found += silent(option, path)
        return found

    assert silent(schema, "") == []


def test_quantities_state_unit_and_range(schema: dict[str, Any]) -> None:
    machines = schema["properties"]["machine"]["oneOf"]
    gears = next(m["properties"]["gears"] for m in machines if "gears" in m["properties"])
    gears = gears["properties"]
    assert gears["module"]["x-unit"] == "mm"
    assert gears["module"]["x-minimum"] == 0.1
    assert "from 0.1 mm to 50 mm" in gears["module"]["description"]
    assert gears["roughness"]["default"] == "0.25 um"
