"""The one model of a case: checked, frozen, and everything else is computed from it."""

from __future__ import annotations

import hashlib
import reprlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, final

from toothspace.case.case_tables import (
    MACHINE_KEY,
    SCHEMA_VERSION,
    STUDY_KEY,
    CaseTables,
    broken_rules,
    missing_tables,
)
from toothspace.case.document import (
    BASE,
    CONDITIONS,
    Document,
    document_text,
    parse_document,
    read_document,
    require_ordinary,
    split_override,
    with_values,
)
from toothspace.case.fingerprint import cached_by_hash, has_files
from toothspace.case.shipped import shipped_case
from toothspace.core.errors import CaseError, Problem
from toothspace.core.files import named_beside, path_of
from toothspace.core.keys import (
    FileText,
    Problems,
    Schema,
    Source,
    Table,
    shown,
)
from toothspace.core.registry import view
from toothspace.core.units import as_text
from toothspace.library import shipped_folder

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_KEPT_MACHINES = 16
_machines: dict[str, Any] = {}
_BASE = {
    "description": "Case file that this one is based on: its keys count where this file has none.",
    "anyOf": [
        {"type": "string"},
        {
            "type": "object",
            "properties": {
                "file": {"type": "string", "description": "Case file, relative to this one."},
                "without": {
                    "type": "array",
                    "items": {"type": "string"},
                    "description": "Key paths of that file to be left out.",
                },
            },
            "required": ["file"],
            "additionalProperties": False,
        },
    ],
}


@final
@dataclass(frozen=True, kw_only=True)
class Case(CaseTables):
    """Input of one reproducible run.

    The keys are what is solved; every construction, :func:`dataclasses.replace` included, checks
    them. Geometry is built and files are read on first use; :meth:`check` does both. Exactly one
    of ``operating_point``, ``circuit``, ``bearing`` and ``film`` is not None.
    Cases are equal if their keys are.

    Parameters
    ----------
    title : str
        Free text.
    machine : object or None
        Keys of ``[machine]`` in SI units, of the machine type's ``PARAMETERS`` class.
    fluid : FluidChoice or None
        Fluid and its temperature.
    operating_point : OperatingPoint or None
        Steady condition.
    circuit : Circuit or None
        Transient condition.
    bearing : JournalBearingCase or None
        Stand-alone journal bearing.
    film : FilmCase or None
        Stand-alone pad or lateral film.
    study : object or None
        Keys of one of the modules in :mod:`toothspace.studies`.
    heat : HeatSettings
        Temperatures of oil, bodies and films.
    run : RunSettings
        Fidelity and numerical settings.
    source : Path or None
        File that it was read from.
    overrides : tuple of str
        ``key=value`` that were laid over the file, in order.

    Raises
    ------
    CaseError
        If a value, or several together, ask for the impossible.
    """

    source: Path | None = field(default=None, compare=False)
    overrides: tuple[str, ...] = field(default=(), compare=False)

    _read_from: ClassVar[Document] = Document("", {})
    """Places of the keys in the file that the case was read from."""

    def __post_init__(self) -> None:
        stand_alone = [n for n in ("bearing", "film") if getattr(self, n) is not None]
        if stand_alone and not self.title:
            object.__setattr__(self, "title", stand_alone[0])
        broken = tuple(broken_rules(self))
        if broken:
            raise CaseError.of(broken)

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any], folder: str | Path = ".") -> Case:
        """Make a case from tables, nested as in a case file.

        Parameters
        ----------
        tables : mapping
            Keys and values: texts with units or :class:`toothspace.Quantity`, plain numbers
            where no unit belongs, arrays for lists, and objects of another case.
        folder : str or Path
            Folder that file paths are relative to.

        Raises
        ------
        CaseError
            A line for every key, with what was found and what is allowed.
        """
        _require_table("case", tables)
        return _made(Document("case", dict(tables)), path_of(folder, "folder", "a folder"))

    @classmethod
    def from_toml(cls, text: str, folder: str | Path = ".", label: str = "case") -> Case:
        """Make a case from TOML text, such as the one kept in a result.

        Parameters
        ----------
        text : str
            TOML.
        folder : str or Path
            Folder that file paths are relative to.
        label : str
            Name of the text in messages.

        Raises
        ------
        CaseError
            A line for every key, with what was found, what is allowed and where it stands.
        """
        if not isinstance(text, str):
            raise CaseError(label, f"{text!r}", "the text of a case file")
        place = path_of(folder, "folder", "a folder")
        document = parse_document(text, label, place)
        return _made(document, place, source=place / f"{label}.toml")

    def replace(self, values: Mapping[str, Any]) -> Case:
        """Return a case with other values, checked again, with a hash of its own.

        Parameters
        ----------
        values : mapping of key path to value
            Such as ``{"machine.gears.module": "3 mm"}``: texts with units,
            :class:`toothspace.Quantity`, whole tables or objects; None takes a key out. A key
            takes the place of the one that it excludes, ``run.revolutions`` that of
            ``run.until``. File paths are relative to the file of the case.

        Raises
        ------
        CaseError
            A line for every key, with what was found and what is allowed.
        """
        _require_table("values", values)
        changed = tuple(
            f"{path}={value if isinstance(value, str) else shown(as_text(value))}"
            for path, value in values.items()
        )
        return self._changed(values, overrides=self.overrides + changed)

    def at_point(self, values: Mapping[str, Any]) -> Case:
        """Return one point of a study: the case without its study, with other values.

        Parameters
        ----------
        values : mapping of key path to value
            As for :meth:`replace`, but no key of the study.

        Raises
        ------
        CaseError
            As for :meth:`replace`.
        """
        for path in values:
            if path.partition(".")[0] in {"study", "schema"}:
                allowed = "a key of the machine, the fluid, the condition or the run"
                raise CaseError("study", f"{path!r}", allowed).in_file(self.label)
        return replace(self, study=None)._changed(values, overrides=())

    def _changed(self, values: Mapping[str, Any], overrides: tuple[str, ...]) -> Case:
        document = Document(self.label, self.to_dict())
        folder = Path() if self.source is None else self.source.parent
        return _made(document, folder, values, source=self.source, overrides=overrides)

    def value(self, path: str) -> Any:
        """Return what stands at a key path, in SI units; None if nothing does."""
        found: Any = self
        for name in path.split("."):
            inner = getattr(found, "elements", found) if not hasattr(found, name) else found
            found = inner.get(name) if isinstance(inner, Mapping) else getattr(inner, name, None)
        return found

    def to_dict(self) -> dict[str, Any]:
        """Return the keys that are compulsory or differ from their default, as tables.

        Values carry their unit; file paths are absolute. ``Case.from_dict`` gives an equal case.
        """
        return self._written(lambda file: file.as_posix())

    def to_toml(self, folder: str | Path | None = None) -> str:
        """Return the case as TOML; reading it again gives an equal case.

        Parameters
        ----------
        folder : str or Path, optional
            Folder that file paths are relative to; absolute without.
        """
        if folder is None:
            return document_text(self.to_dict())
        return document_text(self._written(lambda file: named_beside(file, Path(folder))))

    def _written(self, file_text: FileText) -> dict[str, Any]:
        return {"schema": self.schema, **Table(spec=Case).written(self, file_text)}

    def check(self) -> Case:
        """Build the parts of the machine, so that an impossible one is refused now.

        Returns
        -------
        Case
            The case itself.

        Raises
        ------
        CaseError
            If a file, a material or the geometry of a part is impossible.
        """
        _ = self.machine_spec
        return self

    @cached_property
    def hash(self) -> str:
        """SHA-256 over all keys, with the content of files in place of their names."""
        return self._hashed()

    def _hashed(self) -> str:
        try:
            written = self._written(lambda file: hashlib.sha256(file.read_bytes()).hexdigest())
        except OSError as error:
            raise self._unreadable(error) from error
        return hashlib.sha256(document_text(written).encode()).hexdigest()

    @property
    def machine_type(self) -> str:
        """Name of the machine type, empty without a machine."""
        return MACHINE_KEY.name_of(self.machine)

    @property
    def study_kind(self) -> str:
        """Name of the study, empty without one."""
        return STUDY_KEY.name_of(self.study)

    @cached_property
    def machine_spec(self) -> Any:
        """What the machine type is built from: profiles, contours and materials, loaded.

        None without a machine. Computed from ``machine`` once for the same content.

        Raises
        ------
        CaseError
            If a part is impossible, or a file has changed since the case was hashed.
        """
        if self.machine is None:
            return None
        was_hashed = "hash" in vars(self)
        try:
            make = self.machine.assemble
            spec = cached_by_hash(_machines, _KEPT_MACHINES, make, self.machine)
        except CaseError as error:
            raise self._read_from.refuse(error.under("machine")) from error
        except OSError as error:
            raise self._unreadable(error) from error
        if was_hashed and self._hashed() != self.hash:
            found = "files that have changed since the case was hashed"
            raise CaseError("machine", found, "a case read anew").in_file(self.label)
        # files that change from now on change neither the machine nor the hash
        if has_files([getattr(self, key.name) for key in fields(self) if key.compare]):
            _ = self.hash
        return spec

    def _unreadable(self, error: OSError) -> CaseError:
        found = f"{error.filename}, {error.strerror}"
        return CaseError(f"{self.label}: files", found, "files that can be read")

    @property
    def name(self) -> str:
        """Stem of the file that it was read from, or ``case``."""
        return self.source.stem if self.source is not None else "case"

    @property
    def label(self) -> str:
        """File that it was read from, name of a shipped case, or ``case``, for messages."""
        shipped = self.source is None or self.source.parent == shipped_folder("cases")
        return self.name if shipped else str(self.source)

    @property
    def plot(self) -> MachineFigures:
        """Figures of the machine before any run, such as ``case.plot.section()``."""
        if self.machine is None:
            raise CaseError("machine", "none", "a case with a [machine] table")
        return MachineFigures(self)

    def _repr_html_(self) -> str:
        card: str = view("case_card")(self)
        return card

    def __repr__(self) -> str:
        condition = next(name for name in CONDITIONS if getattr(self, name) is not None)
        machine = f"{self.machine_type} {self.machine.mode}, " if self.machine else ""
        return f"<Case {self.title!r}: {machine}{condition}, {self.run.fidelity}>"


@final
@dataclass(frozen=True, eq=False)
class MachineFigures:
    """Figures of the machine of a case; each is an object of Matplotlib."""

    case: Case

    def section(self, shaft_angle: float = 0.0) -> Figure:
        """Section with ports, grooves and bearings at a shaft angle [rad]."""
        return self._drawn("section", shaft_angle=shaft_angle)

    def volumes(self) -> Figure:
        """Volume of a chamber and its slope over the chamber's own angle."""
        return self._drawn("volumes")

    def openings(self) -> Figure:
        """Open areas of a chamber to ports and grooves over its own angle."""
        return self._drawn("openings")

    def _drawn(self, name: str, **options: float) -> Figure:
        figure: Figure = view("machine_figure")(view("describe")(self.case), name, **options)
        return figure


def _require_table(name: str, given: object) -> None:
    if not isinstance(given, Mapping):
        raise CaseError(name, reprlib.repr(given), "a table of keys and values")


def load_case(source: Case | str | Path | Mapping[str, Any], overrides: Iterable[str] = ()) -> Case:
    """Read and check a case.

    Parameters
    ----------
    source : str, Path, mapping or Case
        TOML file, name of a shipped case such as ``egm12_pump``, or tables as for
        :meth:`Case.from_dict`; a case is returned as it is.
    overrides : iterable of str
        ``key.path=value``, laid over the file before its values are read.

    Returns
    -------
    Case
        Everything in SI units.

    Raises
    ------
    CaseError
        A line for every key, with file, what was found, what is allowed and where it stands.
    """
    if not isinstance(overrides, Iterable):
        raise CaseError("--set", f"{overrides!r}", "a list of key.path=value")
    given = (overrides,) if isinstance(overrides, str) else tuple(overrides)
    if isinstance(source, Case) and not given:
        return source
    if isinstance(source, Mapping):
        document, path = Document("case", dict(source)), None
    else:
        path = path_of(source, "case", "a file, the name of a shipped case, or tables")
        label = str(path)
        if not path.suffix and path.name == label and not path.exists():
            path = shipped_case(path.name)
        document = read_document(path, label)
    try:
        values = [split_override(override) for override in given]
    except CaseError as error:
        raise document.refuse(error) from error
    folder = Path() if path is None else path.parent
    for key, value in values:
        require_ordinary({"--set": value}, document.label)
        document = _overlaid(document, {key: value})
    return _made(document, folder, source=path, overrides=given)


def _overlaid(document: Document, values: Mapping[str, Any]) -> Document:
    try:
        tables = with_values(document.tables, values)
    except CaseError as error:
        raise document.refuse(error) from error
    # a value from elsewhere stands in no line
    nowhere = dict.fromkeys(values, (document.label, 0))
    return Document(document.label, tables, {**document.places, **nowhere})


def _made(
    document: Document,
    folder: Path,
    values: Mapping[str, Any] | None = None,
    *,
    source: Path | None = None,
    overrides: tuple[str, ...] = (),
) -> Case:
    document = _overlaid(document, values) if values else document
    require_ordinary(document.tables, document.label)
    tables, problems = document.tables, Problems()
    if source is not None and "schema" not in tables:
        # without it nobody knows what the other keys mean
        raise document.refuse(CaseError("schema", "nothing", str(SCHEMA_VERSION)))
    if not {"title", "bearing", "film"} & set(tables):
        problems.append(Problem("title", "nothing", "a text that is not empty"))
    read = problems.of("", Table(spec=Case).values, tables, Source(folder))
    if problems:
        # what rules on whole cases would ask for next
        problems += missing_tables(tables)
    try:
        problems.settle()
        case = Case(**read, source=source, overrides=overrides)
    except CaseError as error:
        raise document.refuse(error) from error
    object.__setattr__(case, "_read_from", Document(document.label, {}, document.places))
    return case


def case_schema() -> Schema:
    """Return the schema of a whole case file.

    A file with a ``base`` needs to be whole together with its base only, so what a case must
    have is asked of a file without one.
    """
    keys = Table(spec=Case).schema()
    whole = {
        "required": ["schema", "title"],
        "oneOf": [{"required": [name]} for name in CONDITIONS],
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "toothspace case file",
        **keys,
        "properties": {BASE: _BASE, **keys["properties"]},
        "required": [],
        "anyOf": [{"required": [BASE]}, whole],
    }
