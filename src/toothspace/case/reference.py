"""Reference page of all keys of the case file, in Markdown."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from toothspace.case.case import Case
from toothspace.core import keys
from toothspace.core.units import format_si

_HEAD = """# Keys of the case file

A case is one TOML file. Every dimensional number is a text with its unit (`"2.75 mm"`,
`"200 bar"`, `"1500 rpm"`, `"50 degC"`), pressures are absolute, and file paths are relative to
the case file. Unknown keys are refused. Exactly one of `[operating_point]`, `[circuit]`,
`[bearing]` and `[film]` stands in a case; `[study]` may be added to one of the first two.

This page and `toothspace schema` are generated from the same definitions, the page by
`python -m toothspace.case.reference docs/reference/case_file.md`.

{columns}| `schema` | 1 | compulsory | Version of the case file's keys. |
| `title` | a text | compulsory | What this case is. |
"""
_COLUMNS = "| key | allowed | default | meaning |\n|---|---|---|---|\n"


def reference_page() -> str:
    """Return the whole page."""
    page = _HEAD.replace("{columns}", _COLUMNS)
    for name, (key, _) in keys.keys_of(Case).items():
        if isinstance(key, keys.Variant):
            page += "".join(_variants(name, key))
        elif isinstance(key, keys.Table):
            page += "".join(_tables(name, key.spec, f"`[{name}]`"))
    return page


def _variants(path: str, key: keys.Variant) -> Iterator[str]:
    for name, spec in key.variants.items():
        yield from _tables(path, spec, f'`[{path}]` with `{key.tag} = "{name}"`')


def _tables(path: str, spec: type, title: str) -> Iterator[str]:
    yield f"\n## {title}\n\n{_table(spec)}"
    for name, (key, _) in keys.keys_of(spec).items():
        if isinstance(key, keys.Named) and isinstance(key.item, keys.Variant):
            yield from _variants(f"{path}.NAME", key.item)
        nested = key.item if isinstance(key, keys.Items) else key
        if isinstance(nested, keys.Table):
            yield from _tables(f"{path}.{name}", nested.spec, f"`[{path}.{name}]`")


def _table(spec: type) -> str:
    doc = (spec.__doc__ or "").strip().splitlines()[0].partition(": ")[2]
    head = f"{doc[:1].upper()}{doc[1:]}\n\n" if doc else ""
    rows = [
        f"| `{name}` | {_cell(_allowed(key))} | {_default(key, field.default)} | {_cell(key.doc)} |"
        for name, (key, field) in keys.keys_of(spec).items()
        if not (isinstance(key, keys.Named) and key.beside)
    ]
    if not rows:
        return head + "No keys.\n"
    return head + _COLUMNS + "\n".join(rows) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


def _allowed(key: keys.Key) -> str:
    if isinstance(key, keys.Table):
        return "a table, see below"
    if isinstance(key, keys.Items) and isinstance(key.item, keys.Table):
        return "a list of tables, see below"
    return key.allowed()


def _default(key: keys.Key, default: Any) -> str:
    if default is MISSING:
        return "compulsory"
    if default is None or default == ():
        return "-"
    if isinstance(key, keys.QuantityKey):
        return format_si(default, key.unit)
    if isinstance(key, keys.Table):
        given = [f for f in fields(default) if getattr(default, f.name) != f.default]
        texts = [f"{f.name} = {getattr(default, f.name)}" for f in given]
        return ", ".join(texts) or "its defaults"
    if isinstance(key, keys.Row):
        return f"[{', '.join(f'{value:g}' for value in default)}] SI"
    return f"{default:g}" if isinstance(default, float) else f"{default}"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(reference_page(), encoding="utf-8")
