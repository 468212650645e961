"""Compile one entry of the library.

An entry is compiled behind a function that takes one block of 64-bit words, as records are
passed; what reaches the library is LLVM code as ``inspect_llvm`` gives it.
"""

from __future__ import annotations

import pickle
import platform
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from native.signatures import ArrayType, Scalar, TupleType, Type, dtype_of, parsed

KEPT = Path(__file__).resolve().parents[1] / "build" / "native"
"""Folder of entries that were compiled before."""

TARGETS = {"x86_64": "x86-64-v2", "amd64": "x86-64-v2"}
"""Processor that code is made for, by the kind of machine; elsewhere LLVM's generic one."""

_WRAPPERS = ("_ZN7cpython", "cfunc.")


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
    options = {k: v for k, v in function.targetoptions.items() if k != "nopython"}
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
    """Text of what an entry gives: numbers, for arrays are filled where their caller has them."""
    from numba import types

    numbers = {types.float64: "f8", types.int64: "i8", types.boolean: "b1", types.none: "n"}
    if kind in numbers:
        return numbers[kind]
    if isinstance(kind, types.BaseTuple):
        return f"({','.join(map(_result_text, kind))})"
    raise TypeError(f"no entry gives {kind}")


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
    triple = llvm.get_process_triple().replace("windows-msvc", "windows-gnu")
    module.triple = triple
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=target(), features="", opt=3, reloc="pic", codemodel="default"
    )
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options())
    manager = llvm.create_new_module_pass_manager()
    manager.add_global_dead_code_eliminate_pass()
    manager.run(module, builder)
    return bytes(machine.emit_object(module))
