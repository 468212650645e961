"""JSON Schema (draft 2020-12) of the case file, from the declared keys."""

from __future__ import annotations

from toothspace.case.case import Case
from toothspace.case.document import BASE
from toothspace.case.overrides import CONDITIONS
from toothspace.core.keys import Schema, Table

_BASE = {
    "description": "Case file that this one is based on: its keys count where this file has none.",
    "anyOf": [
        {"type": "string"},
        {
            "type": "object",
            "properties": {
                "file": {"type": "string", "description": "Case file, relative to this one."},
                "without": {
                    "type": "array",
                    "items": {"type": "string"},
                    "description": "Key paths of that file to be left out.",
                },
            },
            "required": ["file"],
            "additionalProperties": False,
        },
    ],
}


def case_schema() -> Schema:
    """Return the schema of a whole case file.

    A file with a ``base`` needs to be whole together with its base only, so what a case must
    have is asked of a file without one.
    """
    keys = Table(spec=Case).schema()
    whole = {
        "required": ["schema", "title"],
        "oneOf": [{"required": [name]} for name in CONDITIONS],
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "toothspace case file",
        **keys,
        "properties": {BASE: _BASE, **keys["properties"]},
        "required": [],
        "anyOf": [{"required": [BASE]}, whole],
    }
