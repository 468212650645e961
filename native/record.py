"""Find the entries of compiled code and their types by running cases.

``python -m native.record`` runs cases that reach all that Python calls and writes
``native/entries.txt``: one entry a line with the types of its arguments. An entry whose types
change is recorded anew.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from native.signatures import ENTRIES, read_entries, text_of

HEADER = "# Entries of the library and the types of their arguments, by python -m native.record\n"
REPOSITORY = Path(__file__).resolve().parents[1]


def record(run: Callable[[], None]) -> dict[str, str]:
    """Types of all entries that Python calls while something runs."""
    from toothspace.core.compilation.parts import Kernel

    found: dict[str, str] = {}
    call = Kernel.__call__

    def noted(kernel: Any, *arguments: Any) -> Any:
        function = kernel.py_func
        if "<locals>" not in function.__qualname__:
            name = f"{function.__module__.removeprefix('toothspace.')}.{function.__qualname__}"
            types = text_of(tuple(arguments))
            if found.setdefault(name, types) != types:
                sys.stderr.write(f"{name}: {types}\n  beside {found[name]}\n")
        return call(kernel, *arguments)

    Kernel.__call__ = noted
    try:
        run()
    finally:
        Kernel.__call__ = call
    return found


def reach_all() -> None:
    """Run what reaches every entry, as short as it can be."""
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
    for name, run in runs.items():
        sys.stderr.write(f"{name}\n")
        run()


if __name__ == "__main__":
    os.environ["TOOTHSPACE_COMPILATION"] = "jit"
    known = read_entries() | record(reach_all)
    lines = [f"{name} {types}\n" for name, types in sorted(known.items())]
    ENTRIES.write_text(HEADER + "".join(lines), encoding="utf-8")
