"""Build the library of compiled code.

``python -m native.build`` compiles every entry of ``native/entries.txt`` for the processor that
all of its kind can stand in for, links the library and what calls it from Python, and puts both
into the package. Nothing is done where they fit the sources already.
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from native.compile import Compiled, compiled_entry, symbol_of, target
from native.signatures import read_entries

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent
FOLDER = REPOSITORY / "src" / "toothspace" / "native"
STAMP = FOLDER / "built_from"

WHOLE_MACHINE = "solver.compiled_model._run"
"""Entry that is the whole lumped model."""

LIBRARY_FLAGS = {
    "linux": ["-shared", "-fPIC", "-Wl,-z,defs", "-Wl,--gc-sections", "-s", "-lm"],
    "darwin": ["-dynamiclib", "-Wl,-install_name,@rpath/libtoothspace.dylib"],
    "win32": ["-shared", "-static-libgcc", "-s"],
}
CALLER_FLAGS = {
    "linux": ["-shared", "-fPIC", "-s"],
    "darwin": ["-bundle", "-undefined", "dynamic_lookup"],
    "win32": ["-shared", "-static-libgcc", "-s", f"-L{sys.base_prefix}/libs", "-lpython3"],
}
"""What the C compiler is told on each system; the one on Windows is that of MinGW."""


def build() -> None:
    """Compile all entries, link the library and put it into the package."""
    from toothspace.core.compilation.sources import digest_of_texts, with_imports

    entries = read_entries()
    texts = with_imports(module_of(name) for name in entries)
    own = (HERE / "compile.py").read_text(encoding="utf-8")
    digests = {
        name: digest_of_texts(
            {**with_imports({module_of(name)}), "types": types, "compile": own, "target": target()}
        )
        for name, types in entries.items()
    }
    os.environ.update(TOOTHSPACE_COMPILATION="jit", NUMBA_CPU_NAME=target(), NUMBA_CPU_FEATURES="")
    # the whole machine takes as long as all others together, so it comes first
    first = sorted(entries, key=lambda name: not name.startswith("solver."))
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as workers:
        tasks = [workers.submit(compiled_entry, n, entries[n], digests[n]) for n in first]
        compiled = [task.result() for task in tasks]
    FOLDER.mkdir(exist_ok=True)
    digest = digest_of_texts(texts)
    with tempfile.TemporaryDirectory() as folder:
        _link(compiled, _table(compiled, sorted(texts), digest), digest, Path(folder))


def module_of(name: str) -> str:
    """Module of an entry."""
    return name.rpartition(".")[0]


def _link(compiled: list[Compiled], source: str, digest: str, folder: Path) -> None:
    from toothspace.core.compilation.library import CALLER, LIBRARY, MODEL, UNIT, UNIT_SOURCES

    objects = []
    for k, one in enumerate(compiled):
        objects.append(folder / f"{k}.o")
        objects[-1].write_bytes(one.code)
    table = folder / "table.c"
    table.write_text(source, encoding="utf-8")
    sources = [table, *(HERE / "c" / name for name in ("machine.c", "reshape.c"))]
    common = [*_compiler(), "-O2", "-fvisibility=hidden"]
    _run([*common, "-o", folder / LIBRARY, *sources, *objects, *LIBRARY_FLAGS[sys.platform]])
    # the whole machine alone, for units that go to other programs
    model = folder / MODEL
    model.write_bytes(next(one.code for one in compiled if one.name == WHOLE_MACHINE))
    (folder / "digest.c").write_text(f'const char *toothspace_table = "{digest}";\n', "utf-8")
    for name in UNIT_SOURCES:
        if not (folder / name).exists():
            shutil.copyfile(HERE / "c" / name, folder / name)
    sources = [folder / name for name in UNIT_SOURCES if name.endswith(".c")]
    # a unit shows the functions of FMI only: others of its kind may be in the same program
    hidden = [*common, "-DTOOTHSPACE_STATIC"]
    _run([*hidden, "-o", folder / UNIT, *sources, model, *LIBRARY_FLAGS[sys.platform]])
    caller = [f"-I{sysconfig.get_path('include')}", HERE / "c" / "caller.c"]
    _run([*common, "-o", folder / CALLER, *caller, *CALLER_FLAGS[sys.platform]])
    for name in (LIBRARY, CALLER, UNIT, MODEL, *UNIT_SOURCES):
        # moved, so that a process that uses the former one keeps it
        shutil.copyfile(folder / name, FOLDER / f".{name}")
        (FOLDER / f".{name}").replace(FOLDER / name)


def _compiler() -> list[str]:
    return shlex.split(os.environ.get("CC") or ("gcc" if sys.platform == "win32" else "cc"))


def _run(command: list[Any]) -> None:
    subprocess.run([str(part) for part in command], check=True)


def _table(compiled: list[Compiled], modules: list[str], digest: str) -> str:
    """Source of the table of entries, which the loader reads."""
    table = {
        "target": target(),
        "digest": digest,
        "modules": modules,
        "entries": [
            {"name": one.name, "types": one.types, "results": one.results} for one in compiled
        ],
    }
    symbols = [symbol_of(one.name) for one in compiled]
    text = json.dumps(json.dumps(table, separators=(",", ":")))
    return "\n".join(
        (
            "#include <stdint.h>",
            "#if defined(_WIN32)",
            "#define EXPORTED __declspec(dllexport)",
            "#else",
            '#define EXPORTED __attribute__((visibility("default")))',
            "#endif",
            *(f"extern int32_t {one}(void *, void **, const void *);" for one in symbols),
            f"EXPORTED const char *toothspace_table = {text};",
            "EXPORTED void *toothspace_functions[] = {",
            *(f"    (void *){one}," for one in symbols),
            "};",
            "",
        )
    )


def _stamp() -> str:
    """Digest of all that the library is made of."""
    from toothspace.core.compilation.sources import digest_of_texts, with_imports

    own = [path for path in HERE.rglob("*") if path.suffix in {".py", ".c", ".h", ".txt"}]
    texts = {str(path.relative_to(HERE)): path.read_text("utf-8") for path in own}
    texts |= with_imports(map(module_of, read_entries()))
    return digest_of_texts(texts)


if __name__ == "__main__":
    stamp = _stamp()
    if not STAMP.is_file() or STAMP.read_text(encoding="utf-8") != stamp:
        build()
        STAMP.write_text(stamp, encoding="utf-8")
