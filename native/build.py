"""Build the library of compiled code.

``python -m native.build`` compiles every entry of ``native/entries.txt`` for the processor that
all of its kind can stand in for, links the library and what calls it from Python, and puts both
into the package. Nothing is done where they fit the sources already.

An entry is compiled behind a function that takes one block of 64-bit words, as records are
passed; what reaches the library is LLVM code as ``inspect_llvm`` gives it.
"""

from __future__ import annotations

import json
import os
import pickle
import platform
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from native.signatures import (
    ArrayType,
    Scalar,
    TupleType,
    Type,
    dtype_of,
    parsed,
    read_entries,
)

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent
FOLDER = REPOSITORY / "src" / "toothspace" / "native"
STAMP = FOLDER / "built_from"
KEPT = REPOSITORY / "build" / "native"

TARGETS = {"x86_64": "x86-64-v2", "amd64": "x86-64-v2"}
"""Processor that code is made for, by the kind of machine; elsewhere LLVM's generic one."""

_WRAPPERS = ("_ZN7cpython", "cfunc.")
LIBRARY_FLAGS = {
    "linux": ["-shared", "-Wl,-z,defs", "-Wl,--gc-sections", "-s"],
    "darwin": ["-dynamiclib", "-Wl,-install_name,@rpath/libtoothspace.dylib"],
}


def symbol_of(name: str) -> str:
    """Symbol of an entry in the library."""
    return "toothspace_" + name.replace(".", "_")


class Compiled(NamedTuple):
    """Object code of one entry and what it gives."""

    name: str
    types: str
    results: str
    code: bytes


def target() -> str:
    """Name of the processor that code is made for."""
    return TARGETS.get(platform.machine().lower(), "generic")


def compiled_entry(name: str, types: str, digest: str) -> Compiled:
    """Code of one entry, compiled unless it is kept."""
    kept = KEPT / f"{name}-{digest}"
    if kept.is_file():
        return Compiled(*pickle.loads(kept.read_bytes()))
    try:
        found = compile_entry(name, types)
    except Exception as error:
        raise RuntimeError(f"{name} {types}: {error}") from error
    KEPT.mkdir(parents=True, exist_ok=True)
    for former in KEPT.glob(f"{name}-*"):
        former.unlink()
    kept.write_bytes(pickle.dumps(tuple(found)))
    return found


def compile_entry(name: str, types: str) -> Compiled:
    """Compile one entry behind a function of one block of words."""
    from toothspace.core.compilation.jit import compiled
    from toothspace.core.compilation.records import RecordAddress

    module, function_name = name.rsplit(".", 1)
    function = getattr(import_module(f"toothspace.{module}"), function_name)
    arguments = parsed(types)
    assert isinstance(arguments, TupleType)
    options = {**function.targetoptions, "nopython": True}
    names: dict[str, Any] = {"function": function, "__name__": "native.entries"}
    given = ", ".join(
        _expression(f"words.a{k}", one, names) for k, one in enumerate(arguments.members)
    )
    symbol = symbol_of(name)
    exec(f"def {symbol}(words):\n    return function({given})\n", names)
    kind = RecordAddress(
        "Words", tuple((f"a{k}", _numba_type(one)) for k, one in enumerate(arguments.members))
    )
    entry = compiled(names[symbol], options)
    entry.compile((kind,))
    (signature,) = entry.nopython_signatures
    results = _result_text(signature.return_type)
    return Compiled(name, types, results, _object_code(entry.inspect_llvm((kind,)), symbol))


def _expression(word: str, kind: Type, names: dict[str, Any]) -> str:
    """Expression of an argument, from the words of the block."""
    if not isinstance(kind, TupleType) or _by_address(kind):
        return word
    fields = _fields(kind)
    members = ", ".join(
        _expression(f"{word}.{field}", member, names)
        for field, member in zip(fields, kind.members, strict=True)
    )
    if not kind.class_name:
        return f"({members},)"
    class_name = kind.class_name.replace(".", "_")
    names[class_name] = kind.load()
    return f"{class_name}({members})"


def _fields(kind: TupleType) -> tuple[str, ...]:
    if kind.class_name:
        return tuple(kind.load()._fields)
    return tuple(f"f{k}" for k in range(len(kind.members)))


def _by_address(kind: TupleType) -> bool:
    from toothspace.core.compilation.records import by_address

    return bool(kind.class_name) and by_address(kind.load())


def _numba_type(kind: Type) -> Any:
    """Type of Numba; every tuple is a record in the block."""
    from numba import types
    from numba.np.numpy_support import from_dtype

    from toothspace.core.compilation.records import RecordAddress

    if isinstance(kind, Scalar):
        return from_dtype(dtype_of(kind.dtype))
    if isinstance(kind, ArrayType):
        return types.Array(
            from_dtype(dtype_of(kind.dtype)), kind.dimensions, kind.layout, kind.readonly
        )
    members = tuple(map(_numba_type, kind.members))
    name = kind.class_name.rpartition(".")[2] or "Members"
    return RecordAddress(name, tuple(zip(_fields(kind), members, strict=True)))


def _result_text(kind: Any) -> str:
    """Text of what an entry gives."""
    from numba import types

    numbers = {types.float64: "f8", types.int64: "i8", types.boolean: "b1", types.none: "n"}
    if kind in numbers:
        return numbers[kind]
    if isinstance(kind, types.Array) and kind.layout == "C":
        return f"{_dtype(kind)}[{kind.ndim}C]"
    if isinstance(kind, types.BaseNamedTuple):
        made = kind.instance_class
        name = f"{made.__module__}.{made.__qualname__}".removeprefix("toothspace.")
        return f"{name}({','.join(map(_result_text, kind))})"
    if isinstance(kind, types.BaseTuple):
        return f"({','.join(map(_result_text, kind))})"
    raise TypeError(f"no entry gives {kind}")


def _dtype(kind: Any) -> str:
    from numba.np.numpy_support import as_dtype

    return str(as_dtype(kind.dtype).str[1:])


def _object_code(text: str, symbol: str) -> bytes:
    """Translate the LLVM code of an entry; only its own symbol is seen from outside."""
    import llvmlite.binding as llvm

    module = llvm.parse_assembly(text)
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = llvm.Linkage.internal
    for function in module.functions:
        if function.is_declaration:
            continue
        function.linkage = llvm.Linkage.internal
        if symbol in function.name and not function.name.startswith(_WRAPPERS):
            function.name, function.linkage = symbol, llvm.Linkage.external
            function.visibility = llvm.Visibility.hidden
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        cpu=target(), features="", opt=3, reloc="pic", codemodel="default"
    )
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options())
    manager = llvm.create_new_module_pass_manager()
    manager.add_global_dead_code_eliminate_pass()
    manager.run(module, builder)
    return bytes(machine.emit_object(module))


def build() -> None:
    """Compile all entries, link the library and put it into the package."""
    from toothspace.core.compilation.sources import digest_of_texts, with_imports

    entries = read_entries()
    texts = with_imports(module_of(name) for name in entries)
    own = (HERE / "build.py").read_text(encoding="utf-8")
    digests = {
        name: digest_of_texts(
            {**with_imports({module_of(name)}), "types": types, "build": own, "target": target()}
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
    with tempfile.TemporaryDirectory() as folder:
        _link(compiled, _table(compiled, texts), Path(folder))


def module_of(name: str) -> str:
    """Module of an entry."""
    return name.rpartition(".")[0]


def _link(compiled: list[Compiled], source: str, folder: Path) -> None:
    from toothspace.core.compilation.library import CALLER, LIBRARY

    objects = []
    for k, one in enumerate(compiled):
        objects.append(folder / f"{k}.o")
        objects[-1].write_bytes(one.code)
    table = folder / "table.c"
    table.write_text(source, encoding="utf-8")
    sources = [table, *(HERE / "c" / name for name in ("memory.c",))]
    flags = LIBRARY_FLAGS.get(sys.platform, LIBRARY_FLAGS["linux"])
    common = [*_compiler(), "-O2", "-fPIC", "-fvisibility=hidden"]
    _run([*common, *flags, "-o", folder / LIBRARY, *sources, *objects, "-lm"])
    include = sysconfig.get_path("include")
    shared = (
        ["-bundle", "-undefined", "dynamic_lookup"] if sys.platform == "darwin" else ["-shared"]
    )
    _run([*common, *shared, f"-I{include}", "-o", folder / CALLER, HERE / "c" / "caller.c"])
    for name in (LIBRARY, CALLER):
        # moved, so that a process that uses the former one keeps it
        shutil.copyfile(folder / name, FOLDER / f".{name}")
        (FOLDER / f".{name}").replace(FOLDER / name)


def _compiler() -> list[str]:
    return shlex.split(os.environ.get("CC") or "cc")


def _run(command: list[Any]) -> None:
    subprocess.run([str(part) for part in command], check=True)


def _table(compiled: list[Compiled], texts: dict[str, str]) -> str:
    """Source of the table of entries, which the loader reads."""
    from toothspace.core.compilation.sources import digest_of_texts

    table = {
        "target": target(),
        "digest": digest_of_texts(texts),
        "modules": sorted(texts),
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
