"""Reference pages of case keys, result variables and presets, from what the package declares.

``python -m tests.architecture.reference_pages`` writes all of them to ``docs/reference``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from toothspace.case import Case
from toothspace.case.presets import INTERFACES, MODELS, PRESETS
from toothspace.core import keys
from toothspace.core.units import format_si
from toothspace.results import variables

FOLDER = Path(__file__).parents[2] / "docs" / "reference"
COMMAND = "python -m tests.architecture.reference_pages"

_HEAD = f"""# Keys of the case file

A case is one TOML file. Every dimensional number is a text with its unit (`"2.75 mm"`,
`"200 bar"`, `"1500 rpm"`, `"50 degC"`), pressures are absolute, and file paths are relative to
the case file. Unknown keys are refused. Exactly one of `[operating_point]`, `[circuit]`,
`[bearing]` and `[film]` stands in a case; `[study]` may be added to one of the first two.

These pages and `toothspace schema` are generated from the same definitions, the pages by
`{COMMAND}`.

| key | allowed | default | meaning |
|---|---|---|---|
| `schema` | 1 | compulsory | Version of the case file's keys. |
| `title` | a text | compulsory | What this case is. |

| page | tables |
|---|---|
"""
_COLUMNS = "| key | allowed | default | meaning |\n|---|---|---|---|\n"
_PAGES = {
    "fluid_and_operating_point": (
        "Fluid, operating point and run",
        "fluid operating_point run heat",
    ),
    "circuit": ("Circuit", "circuit"),
    "bearing": ("Journal bearing on its own", "bearing"),
    "film": ("Film on its own", "film"),
    "study": ("Study", "study"),
}
"""Titles and tables of the pages beside those of machines."""

_STUDY_END = """
## What each study is for

[Studies](../../studies/index.md), a page for each.
"""


def case_pages() -> dict[str, str]:
    """Pages ``case_file.md`` and ``case_file/*.md``: all keys of a case, by machine and table."""
    named = {name: key for name, (key, _) in keys.keys_of(Case).items()}
    machines = named["machine"]
    assert isinstance(machines, keys.Variant)
    chapters: dict[str, tuple[str, str, str]] = {}
    for name in sorted(machines.variants, key="external_gear gerotor crescent".find):
        tables = f'`[machine]` with `type = "{name}"`'
        body = "".join(_tables("machine", machines.variants[name], tables))
        chapters[name] = (f"Machine: {name.replace('_', ' ')}", tables, body)
    for name, (title, listed) in _PAGES.items():
        body = "".join(text for one in listed.split() for text in _sections(one, named[one]))
        chapters[name] = (title, ", ".join(f"`[{one}]`" for one in listed.split()), body)
    title, tables, body = chapters["study"]
    chapters["study"] = (title, tables, body + _STUDY_END)
    index = _HEAD + "".join(
        f"| [{title}](case_file/{name}.md) | {tables} |\n"
        for name, (title, tables, _) in chapters.items()
    )
    index += "\n```{toctree}\n:hidden:\n\n"
    index += "".join(f"case_file/{name}\n" for name in chapters) + "```\n"
    texts = {f"case_file/{name}.md": f"# {t}\n{body}" for name, (t, _, body) in chapters.items()}
    return {"case_file.md": index, **texts}


def _sections(name: str, key: keys.Key) -> Iterator[str]:
    if isinstance(key, keys.Variant):
        yield from _variants(name, key)
    elif isinstance(key, keys.Table):
        yield from _tables(name, key.spec, f"`[{name}]`")


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


def result_page() -> str:
    """Page ``results.md``: all result variables."""
    lines = [
        "# Result variables",
        "",
        f"Generated from `src/toothspace/results/variables.py` by `{COMMAND}`.",
        "",
        "A result is one NetCDF file. All values are in SI units; pressures are absolute.",
        "`sample` stands for `shaft_angle` in a steady run and for `time` in a transient run;",
        "the other one of the two is kept as a coordinate along it.",
        "",
        "| name | dimensions | unit | meaning |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| `{v.name}` | {', '.join(v.dimensions) or '-'} | {v.units or '-'} | {v.long_name} |"
        for v in variables.VARIABLES.values()
    ]
    lines += ["", "## Labels", "", "| dimension | meaning | labels |", "|---|---|---|"]
    for dim, meaning in variables.LABEL_DIMENSIONS.items():
        labels = " ".join(f"`{name}`" for name in variables.LABELS.get(dim, ())) or "-"
        lines.append(f"| `{dim}` | {meaning} | {labels} |")
    return "\n".join(lines) + "\n"


def preset_page() -> str:
    """Page ``presets.md``: presets, interfaces and their models."""
    presets = tuple(PRESETS.values())
    lines = [
        "# Fidelity presets",
        "",
        f"Generated by `{COMMAND}`.",
        "",
        "A preset is a tested set of models, chosen by `run.fidelity`. An interface is where two",
        "surfaces run on each other. The first model of an entry is that of the preset; another",
        "one is chosen by `[run.interfaces]`, by `run.film_tables` (tables) or by",
        "`run.mesh` (compliant contacts). A machine without a rigid mesh has compliant contacts.",
        "",
        "| preset | content |",
        "|---|---|",
        *(f"| `{preset.name}` | {preset.content} |" for preset in presets),
        "",
        f"| interface | {' | '.join(f'`{preset.name}`' for preset in presets)} |",
        f"|---|{'---|' * len(presets)}",
    ]
    for name, meaning in INTERFACES.items():
        offered = [", ".join(preset.interfaces.get(name, ())) or "none" for preset in presets]
        lines.append(f"| `{name}`: {meaning} | {' | '.join(offered)} |")
    lines += ["", "| model | what it solves |", "|---|---|"]
    lines += [f"| {name} | {meaning} |" for name, meaning in MODELS.items()]
    lines += [
        "",
        "Gaps at tooth tips and flanks are closed forms in every preset: in a parallel or curved",
        "gap these are the exact solution. A film round a rotor that exchanges oil with the films",
        "on its faces is solved together with them.",
        "",
        "```toml",
        "[run]",
        'fidelity = "films"',
        "[run.interfaces]",
        'lateral = "closed_form"     # solved journals, closed-form faces',
        "```",
        "",
        "Every result says in its provenance which model each interface used, and the report shows",
        "it under Models.",
        "",
    ]
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """Every generated page by its place."""
    return {**case_pages(), "presets.md": preset_page(), "results.md": result_page()}


if __name__ == "__main__":
    (FOLDER / "case_file").mkdir(exist_ok=True)
    for name, page in pages().items():
        (FOLDER / name).write_text(page, encoding="utf-8")
