"""Named tuples that compiled code sees as the address of one block of memory.

Numba hands a named tuple on by value: each of its arrays becomes seven values in every call,
and a system of some fifty arrays becomes hundreds. A class marked with
``passed_by_address`` stays a named tuple in Python. When Python calls compiled code, scalars
and descriptions of arrays are written once into a block of 64-bit words; compiled code hands on
its address and loads what it uses.

Compiled code can read the fields by name, nothing else: it cannot unpack such a tuple, return it
to Python or make one. A block describes the arrays as they are when Python calls: an array must
not be resized meanwhile. The memory layout of each array is part of the type.
"""

from __future__ import annotations

import hashlib
import struct
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

_WORD = 8
_FORMATS: dict[types.Type, str] = {
    types.int64: "q",
    types.float64: "d",
    types.boolean: "q",
}


class RecordAddress(types.Type):
    """Type of a named tuple that is passed by its address.

    Parameters
    ----------
    class_name : str
        Name of the class.
    fields : tuple of (str, numba type)
        Names and types of the fields in their order.
    """

    def __init__(self, class_name: str, fields: tuple[tuple[str, types.Type], ...]) -> None:
        self.fields = dict(fields)
        self.places: dict[str, int] = {}
        self.format = ""
        for name, kind in fields:
            self.places[name] = struct.calcsize("=" + self.format)
            if isinstance(kind, RecordAddress):
                self.format += str(kind.format)
            elif isinstance(kind, types.Array):
                # size, data, shape and strides
                self.format += "q" * (2 + 2 * kind.ndim)
            elif kind in _FORMATS:
                self.format += _FORMATS[kind]
            else:
                raise TypeError(
                    f"{class_name}.{name}: found {kind}, allowed an array, an integer, a real "
                    "number or another class passed by address"
                )
        text = repr([(name, str(kind)) for name, kind in fields])
        # short names: they stand in the name of every compiled function
        super().__init__(f"{class_name}.{hashlib.sha256(text.encode()).hexdigest()[:12]}")


_BY_ADDRESS: set[type] = set()


def by_address(record: type) -> bool:
    """Whether instances of a named-tuple class are passed by their address."""
    return record in _BY_ADDRESS


def register_record(record: type) -> None:
    """Make the type of a named-tuple class known whose instances are passed by their address."""
    _BY_ADDRESS.add(record)

    @typeof_impl.register(record)
    def _typeof(value: Any, context: Any) -> RecordAddress:
        kinds = [typeof_impl(item, context) for item in value]
        return RecordAddress(record.__name__, tuple(zip(value._fields, kinds, strict=True)))


def pack(value: tuple[Any, ...], form: str) -> bytes:
    """Write a named tuple into a block of 64-bit words."""
    words: list[Any] = []
    _append_words(value, words)
    return struct.pack(form, *words)


def _append_words(value: tuple[Any, ...], words: list[Any]) -> None:
    for item in value:
        if isinstance(item, np.ndarray):
            words += (item.size, item.__array_interface__["data"][0], *item.shape, *item.strides)
        elif isinstance(item, tuple):
            _append_words(item, words)
        else:
            words.append(item)


@register_model(RecordAddress)
class _AddressModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: RecordAddress) -> None:
        super().__init__(manager, kind, ir.IntType(8).as_pointer())


@infer_getattr
class _FieldTypes(AttributeTemplate):  # type: ignore[misc]
    key = RecordAddress

    def generic_resolve(self, kind: RecordAddress, name: str) -> types.Type | None:
        return kind.fields.get(name)


@lower_getattr_generic(RecordAddress)
def _load_field(context: Any, builder: Any, kind: RecordAddress, address: Any, name: str) -> Any:
    field, place = kind.fields[name], kind.places[name]
    if isinstance(field, RecordAddress):
        return cgutils.pointer_add(builder, address, place)
    if field == types.boolean:
        word = _load_word(builder, address, place, context.get_value_type(types.int64))
        return builder.icmp_signed("!=", word, word.type(0))
    if not isinstance(field, types.Array):
        return _load_word(builder, address, place, context.get_value_type(field))
    return _load_array(context, builder, address, place, field)


def _load_array(context: Any, builder: Any, address: Any, place: int, kind: types.Array) -> Any:
    """Description of an array whose memory Python owns."""
    array = context.make_array(kind)(context, builder)
    word = context.get_value_type(types.intp)

    def load(number: int) -> Any:
        return _load_word(builder, address, place + _WORD * number, word)

    n = kind.ndim
    array.nitems = load(0)
    array.itemsize = word(context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    array.data = builder.inttoptr(load(1), array.data.type)
    array.shape = cgutils.pack_array(builder, [load(2 + k) for k in range(n)], word)
    array.strides = cgutils.pack_array(builder, [load(2 + n + k) for k in range(n)], word)
    array.meminfo = cgutils.get_null_value(array.meminfo.type)
    array.parent = cgutils.get_null_value(array.parent.type)
    return array._getvalue()


def _load_word(builder: Any, address: Any, place: int, kind: Any) -> Any:
    """Load a word that nothing writes while compiled code runs."""
    pointer = cgutils.pointer_add(builder, address, place, kind.as_pointer())
    value = builder.load(pointer)
    value.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value


@unbox(RecordAddress)
def _unbox(kind: RecordAddress, value: Any, context: Any) -> NativeValue:
    """Pack the tuple and keep the block as long as the call lasts."""
    api = context.pyapi
    function = api.unserialize(api.serialize_object(pack))
    form = api.unserialize(api.serialize_object("=" + kind.format))
    block = api.call_function_objargs(function, (value, form))
    api.decref(function)
    api.decref(form)
    failed = cgutils.is_null(context.builder, block)
    address = cgutils.alloca_once_value(
        context.builder, cgutils.get_null_value(ir.IntType(8).as_pointer())
    )
    with context.builder.if_then(context.builder.not_(failed)):
        context.builder.store(api.bytes_as_string(block), address)
    return NativeValue(
        context.builder.load(address), is_error=failed, cleanup=lambda: api.decref(block)
    )
