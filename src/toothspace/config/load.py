"""One case file to one frozen case."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

from toothspace.case import Case, Circuit, FluidChoice, JournalBearingCase, OperatingPoint
from toothspace.case.circuit import ELEMENT_KEY
from toothspace.case.conditions import RunSettings
from toothspace.case.stand_alone import FILMS
from toothspace.case.study import STUDIES
from toothspace.config.document import document_text, parse_document, read_document
from toothspace.config.overrides import apply_overrides, apply_values
from toothspace.config.reader import Reader, joined
from toothspace.config.rules import check_together
from toothspace.core.errors import CaseError
from toothspace.core.keys import Integer, Key, KeyRuleError, Table, Text, Variant, keys_of
from toothspace.core.registry import machine_modules

SCHEMA_VERSION = 1

TOP_LEVEL: dict[str, Key] = {
    "schema": Integer(
        low=SCHEMA_VERSION, high=SCHEMA_VERSION, doc="Version of the case file's keys."
    ),
    "title": Text(doc="What this case is."),
    "machine": Table(spec=object, doc="The machine; keys by its type."),
    "fluid": Table(spec=FluidChoice, doc="Fluid and temperature."),
    "operating_point": Table(spec=OperatingPoint, doc="Steady condition."),
    "circuit": Table(spec=Circuit, doc="Transient condition: elements and connections."),
    "bearing": Table(spec=JournalBearingCase, doc="Stand-alone journal bearing."),
    "film": Variant(tag="kind", variants=FILMS, doc="Stand-alone film."),
    "study": Variant(tag="kind", variants=STUDIES, doc="Study that drives the condition."),
    "run": Table(spec=RunSettings, doc="Fidelity and numerical settings."),
}
"""Keys at the top of a case file."""


def machine_key() -> Variant:
    """Return the key ``machine``: one variant per installed machine type."""
    variants = {
        name: import_module(f"{module}.parameters").PARAMETERS
        for name, module in machine_modules().items()
    }
    return Variant(tag="type", variants=variants, doc="The machine; keys by its type.")


def load_case(path: str | Path, overrides: Iterable[str] = ()) -> Case:
    """Read and check a case file.

    Parameters
    ----------
    path : str or Path
        TOML file.
    overrides : iterable of str
        ``key.path=value``, applied before anything is read.

    Returns
    -------
    Case
        Everything in SI units.

    Raises
    ------
    CaseError
        One line with file, key, what was found and what is allowed.
    """
    tables = read_document(Path(path), str(path))
    return _case(tables, tuple(overrides), Path(path), str(path))


def case_from_text(text: str, folder: str | Path = ".", label: str = "case") -> Case:
    """Read and check a case from TOML text, such as the one kept in a result.

    Parameters
    ----------
    text : str
        TOML.
    folder : str or Path
        Folder that file paths are relative to.
    label : str
        Name of the text in messages.

    Returns
    -------
    Case
        Everything in SI units.

    Raises
    ------
    CaseError
        One line with label, key, what was found and what is allowed.
    """
    return _case(parse_document(text, label), (), Path(folder) / f"{label}.toml", label)


def case_with(case: Case, values: Mapping[str, Any]) -> Case:
    """Return one point of a study: a case without ``[study]`` and with other values.

    Parameters
    ----------
    case : Case
        Case that was read from a file or text.
    values : mapping of key path to value
        Values as they would stand in the case file, such as ``"20 um"``.

    Returns
    -------
    Case
        Its hash depends on what is computed only, not on the study.

    Raises
    ------
    CaseError
        One line with file, key, what was found and what is allowed.
    """
    source = case.source if case.source is not None else Path("case.toml")
    tables = parse_document(case.text, str(source))
    tables.pop("study", None)
    for path in values:
        if path.partition(".")[0] in {"study", "schema"}:
            allowed = "a key of the machine, the fluid, the condition or the run"
            raise CaseError(f"{source}: study: found {path!r}, allowed {allowed}")
    return _case(apply_values(tables, values, str(source)), (), source, str(source))


def _case(tables: dict[str, Any], overrides: tuple[str, ...], source: Path, label: str) -> Case:
    tables = apply_overrides(tables, overrides, label)
    reader = Reader(label=label, folder=source.parent)
    values = _read_tables(reader, tables)
    text = document_text(tables)
    case = Case(
        **values, source=source, overrides=overrides, text=text, hash=_hash(text, reader.files)
    )
    check_together(case, reader)
    return case


def _read_tables(reader: Reader, tables: dict[str, Any]) -> dict[str, Any]:
    reader.refuse_unknown(tables, list(TOP_LEVEL), "")
    if "bearing" in tables or "film" in tables:
        tables = {"title": next(iter({"bearing", "film"} & tables.keys())), **tables}
    for name in ("schema", "title"):
        if name not in tables:
            example = f"{SCHEMA_VERSION}" if name == "schema" else "a text that is not empty"
            reader.fail(name, "nothing", example)
    special = {"machine": _read_machine, "circuit": _read_circuit}
    values: dict[str, Any] = {}
    for name, key in TOP_LEVEL.items():
        if name in special and name in tables:
            values |= special[name](reader, tables[name])
        elif name in tables:
            values[name] = reader.read(key, tables[name], name)
    return values


def _read_machine(reader: Reader, raw: Any) -> dict[str, Any]:
    machine = reader.read(machine_key(), raw, "machine")
    try:
        spec = machine.assemble()
    except KeyRuleError as error:
        reader.fail(joined("machine", error.key), error.found, error.allowed)
    except CaseError as error:
        raise type(error)(f"{reader.label}: machine.{error}") from error
    return {"machine_type": raw["type"], "machine": machine, "machine_spec": spec}


def _read_circuit(reader: Reader, raw: Any) -> dict[str, Any]:
    declared = list(keys_of(Circuit))
    if not isinstance(raw, dict):
        reader.table(Circuit, raw, "circuit")
    elements = {
        name: reader.read(ELEMENT_KEY, value, f"circuit.{name}")
        for name, value in raw.items()
        if name not in declared and isinstance(value, dict)
    }
    rest = {name: value for name, value in raw.items() if name not in elements}
    plain = reader.table(Circuit, rest, "circuit")
    circuit = replace(plain, elements=elements)
    try:
        circuit.check_connections()
    except KeyRuleError as error:
        reader.fail(joined("circuit", error.key), error.found, error.allowed)
    return {"circuit": circuit}


def _hash(text: str, files: list[Path]) -> str:
    digest = hashlib.sha256(text.encode())
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()
