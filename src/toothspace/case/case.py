"""The whole of one case file, read, checked and frozen."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, final

from toothspace.case.circuit import Circuit
from toothspace.case.conditions import FluidChoice, OperatingPoint, RunSettings
from toothspace.case.stand_alone import FilmTable, JournalBearingCase


@final
@dataclass(frozen=True, kw_only=True)
class Case:
    """Input of one reproducible run.

    Exactly one of ``operating_point``, ``circuit``, ``bearing`` and ``film`` is not None.

    Parameters
    ----------
    title : str
        Free text.
    machine_type : str
        Name of the machine type, empty for a stand-alone film.
    machine : object or None
        Keys of ``[machine]`` in SI units, of the machine type's ``PARAMETERS`` class.
    machine_spec : object or None
        What ``machine.assemble()`` built: profiles, contours and materials loaded.
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
        One of the classes in :mod:`toothspace.case.study`.
    run : RunSettings
        Fidelity and numerical settings.
    source : Path or None
        File that it was read from.
    overrides : tuple of str
        ``key=value`` as given on the command line, in order.
    text : str
        Normalised case as TOML, overrides included.
    hash : str
        SHA-256 over the text and the contents of all files that it names.
    """

    title: str
    machine_type: str = ""
    machine: Any = None
    machine_spec: Any = None
    fluid: FluidChoice | None = None
    operating_point: OperatingPoint | None = None
    circuit: Circuit | None = None
    bearing: JournalBearingCase | None = None
    film: FilmTable | None = None
    study: Any = None
    run: RunSettings = field(default_factory=RunSettings)
    schema: int = 1
    source: Path | None = None
    overrides: tuple[str, ...] = ()
    text: str = ""
    hash: str = ""

    def to_toml(self) -> str:
        """Return the normalised case as TOML; reading it again gives an equal case."""
        return self.text

    @property
    def name(self) -> str:
        """Stem of the file that it was read from, or ``case``."""
        return self.source.stem if self.source is not None else "case"
