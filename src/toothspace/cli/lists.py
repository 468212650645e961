"""Commands that show and copy what comes with the package; heavy imports wait until needed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from toothspace.cli import output
from toothspace.cli.options import Force, Json


def init(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Shipped case, see 'cases'.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Where to.")] = Path(),
    force: Force = False,
) -> None:
    """Start from a shipped case: copy it with the files that it names."""
    import tomllib

    from toothspace.case.shipped import copy_case

    written = copy_case(name, folder, replace=force)
    for path in written:
        output.message(f"Written: {path}")
    tables = tomllib.loads(written[0].read_text(encoding="utf-8"))
    command = next((c for c in ("study", "bearing", "film") if c in tables), "run")
    output.message(f"Next: toothspace {command} {written[0]}")


def cases(as_json: Json = False) -> None:
    """List the shipped cases, which every command knows by name."""
    from toothspace.case import shipped

    output.write(shipped.cases(), as_json=as_json)


def fluids(as_json: Json = False) -> None:
    """List the fluids of the library."""
    from toothspace import library

    output.write(library.fluids(), as_json=as_json)


def warmup(as_json: Json = False) -> None:
    """Compile everything that runs need, once, so that the first run starts at once."""
    from toothspace.core.compilation.sources import compiled_folder
    from toothspace.warmup import warm_up

    output.write(warm_up(), as_json=as_json)
    output.message(f"Compiled code: {compiled_folder()}")


def schema() -> None:
    """Print the JSON Schema of the case file."""
    from toothspace.case.json_schema import case_schema

    output.line(json.dumps(case_schema(), indent=2, ensure_ascii=False))
