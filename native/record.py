"""Find the entries of compiled code and their types by running cases.

``python -m native.record`` runs cases that reach all that Python calls and writes
``native/entries.txt``: one entry a line with the types of its arguments. What only elastic bodies
reach is kept as it stands; ``python -m native.record CASE run.fidelity=elastic`` runs one more
case, with overrides as ``KEY=VALUE`` behind it.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from native.signatures import ENTRIES, read_entries, text_of

HEADER = "# Entries of the library and the types of their arguments, by python -m native.record\n"
REPOSITORY = Path(__file__).resolve().parents[1]


def record(run: Callable[[], None]) -> dict[str, str]:
    """Types of all entries that Python calls while something runs."""
    from toothspace.core.compilation.parts import Kernel
    from toothspace.core.compilation.sources import name_of

    found: dict[str, str] = {}
    call = Kernel.__call__

    def noted(kernel: Any, *arguments: Any) -> Any:
        function = kernel.py_func
        if "<locals>" not in function.__qualname__:
            name = name_of(function)
            types = text_of(tuple(arguments))
            found[name] = widened(found.get(name, types), types)
        return call(kernel, *arguments)

    Kernel.__call__ = noted
    try:
        run()
    finally:
        Kernel.__call__ = call
    return found


_LAYOUT = re.compile(r"(?<=\[\d)[CFA](?=\])")


def widened(former: str, types: str) -> str:
    """Types for both: arrays that differ in layout alone may have any; else the later ones."""
    if _LAYOUT.sub("A", former) != _LAYOUT.sub("A", types):
        return types
    layouts = iter(_LAYOUT.findall(former))
    return _LAYOUT.sub(lambda own: own[0] if next(layouts) == own[0] else "A", types)


def is_there(name: str) -> bool:
    """Whether an entry still is a compiled function of its module."""
    module, function = name.rsplit(".", 1)
    try:
        return hasattr(getattr(import_module(f"toothspace.{module}"), function, None), "py_func")
    except ImportError:
        return False


def reach_all(more: list[str]) -> None:
    """Run what reaches every entry, as short as it can be, and one more case."""
    from toothspace import api

    folder = REPOSITORY / "src" / "toothspace" / "library" / "warmup"
    cases = REPOSITORY / "cases"
    machine = folder / "machine.toml"
    runs: dict[str, Callable[[], object]] = {
        "lumped": lambda: api.simulate(api.load_case(machine, ["run.fidelity=lumped"])),
        "films": lambda: api.simulate(api.load_case(machine, ["run.fidelity=films"])),
        "bearing": lambda: api.solve_bearing(api.load_case(folder / "bearing.toml")),
        "film": lambda: api.solve_film(api.load_case(folder / "film.toml")),
        "pump": lambda: api.simulate(api.load_case(cases / "egm12_pump.toml")),
        "gerotor": lambda: api.simulate(api.load_case(cases / "gerotor_trochoidal.toml")),
    }
    runs |= {
        name: lambda name=name: api.solve_film(api.load_case(cases / f"{name}.toml"))  # type: ignore[misc]
        for name in ("slider_pad", "thrust_ring", "adiabatic_pad", "egm12_lateral_film")
    }
    if more:
        runs[more[0]] = lambda: api.simulate(api.load_case(more[0], more[1:]))
    for name, run in runs.items():
        sys.stderr.write(f"{name}\n")
        run()


def main() -> None:
    """Record with an empty cache but for compiled code, so that nothing is taken from there."""
    from toothspace.core.compilation.sources import compiled_folder

    kept = compiled_folder()
    with tempfile.TemporaryDirectory() as folder:
        own = Path(folder) / "toothspace"
        own.mkdir()
        (own / "compiled").symlink_to(kept)
        os.environ |= {"TOOTHSPACE_CACHE": folder, "TOOTHSPACE_COMPILATION": "jit"}
        found = record(lambda: reach_all(sys.argv[1:]))
    known = {name: types for name, types in read_entries().items() if is_there(name)}
    for name, types in found.items():
        known[name] = widened(known.get(name, types), types)
    lines = [f"{name} {types}\n" for name, types in sorted(known.items())]
    ENTRIES.write_text(HEADER + "".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
