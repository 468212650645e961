"""Fidelity presets: named, tested sets of models, each declared once.

A preset names the models that it offers for each interface between two surfaces that run on each
other, the one that it uses first; ``[run.interfaces]`` of a case chooses another. Keys of ``[run]``
that one preset reads stand beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from types import MappingProxyType
from typing import final

from toothspace.core.keys import Integer, KeyTable, choice, file_path, integer, number, pair

INTERFACES: Mapping[str, str] = MappingProxyType(
    {
        "journal": "Journal bearings",
        "lateral": "Faces of gears and rotors, and the film round an outer rotor",
        "tip": "Tooth tips on the casing, tips on each other, gaps of the flanks",
        "contact": "Contacts of teeth, lobes and tips",
    }
)
"""Interfaces of a machine and what they are."""

MODELS: Mapping[str, str] = MappingProxyType(
    {
        "closed_form": "formula of a gap, a bearing or a contact",
        "table": "table of films that `toothspace reduce` solved",
        "reynolds": "Reynolds equation on a grid, rigid walls",
        "elastic": "Reynolds equation on a grid with deformation and asperity contact, in balance",
        "rigid": "kinematic contact, force from the balance of moments",
        "compliant": "force over the overlap of elastic teeth",
    }
)
"""Models of interfaces and what they solve."""

_CELLS = Integer(low=8, high=4000)


@dataclass(frozen=True, kw_only=True)
class IdealKeys(KeyTable):
    """Keys of ``[run]`` that ``ideal`` reads."""

    flank_sealing: str = choice(
        "Whether meshing chambers share one pressure (ideal preset).",
        "single",
        "dual",
        default="single",
    )


@dataclass(frozen=True, kw_only=True)
class LumpedKeys(KeyTable):
    """Keys of ``[run]`` that ``lumped`` reads."""

    film_tables: Path | None = file_path(
        "Tables of 'toothspace reduce' in place of the closed-form films (lumped preset).", ".nc"
    )


@dataclass(frozen=True, kw_only=True)
class ElasticKeys(KeyTable):
    """Keys of ``[run]`` that ``elastic`` reads, and studies and tables of its films."""

    deformation: str = choice(
        "Deformation of bearings and gears under the lateral films (elastic preset): a Winkler "
        "foundation, elastic bodies, or rigid. The former word 'columns' for 'winkler' is accepted "
        "with a note until the next version.",
        "winkler",
        "bodies",
        "none",
        default="winkler",
        former={"columns": "winkler"},
    )
    film_grid: tuple[int, int] = pair(
        _CELLS, "Cells of each lateral film, round and along the radius.", default=(126, 18)
    )
    film_oil_share: float = number(
        "Share of the friction heat of a lateral film that warms its oil: 1 adiabatic, 0 "
        "isothermal (elastic preset).",
        low=0,
        high=1,
        default=0.0,
    )
    film_angles_per_pitch: int = integer(
        "Shaft angles of a tooth pitch over which axial forces are averaged.",
        low=1,
        high=360,
        default=2,
    )
    film_steps_per_revolution: int = integer(
        "Steps of the lateral films over a revolution, at least three in a tooth pitch.",
        low=12,
        high=7200,
        default=112,
    )


@final
@dataclass(frozen=True, kw_only=True)
class Preset:
    """Which models a run uses."""

    name: str
    """Value of ``run.fidelity``."""
    content: str
    """The set in one sentence, for reports."""
    module: str
    """Module whose function ``simulate`` makes the run."""
    interfaces: Mapping[str, tuple[str, ...]]
    """Models that it offers for each interface, its own choice first; empty without films."""
    keys: type[IdealKeys | LumpedKeys | ElasticKeys] | None = None
    """Keys of ``[run]`` that it alone reads."""
    unused: tuple[str, ...] = ()
    """Optional parts of a machine that this set does not use; the machine type says in
    ``part_tables`` which of its tables and keys describe them.
    """
    over_time: bool = False
    """Whether it runs a machine in a circuit over time."""

    @property
    def has_losses(self) -> bool:
        """Whether leakage, friction and temperatures follow from it."""
        return bool(self.interfaces)

    def reads(self, key: str) -> bool:
        """Whether it reads a key of ``[run]``."""
        owners = [one for one in PRESETS.values() if key in one.own_keys]
        return not owners or self in owners

    @property
    def own_keys(self) -> tuple[str, ...]:
        """Names of the keys that it alone reads."""
        return () if self.keys is None else tuple(entry.name for entry in fields(self.keys))


_BALANCE = ("floating_part", "elastic_bodies", "startup")
_CONTACTS = {"tip": ("closed_form",), "contact": ("rigid", "compliant")}

IDEAL = Preset(
    name="ideal",
    content="Kinematic flow and torque, no leakage, rigid fluid.",
    module="toothspace.run.ideal",
    interfaces={},
    keys=IdealKeys,
    unused=("running_in", "free_bodies", *_BALANCE),
)
LUMPED = Preset(
    name="lumped",
    content="Chamber pressures with cavitation, all flow paths, body motion, contacts, "
    "closed-form films and friction.",
    module="toothspace.run.run",
    interfaces={
        "journal": ("closed_form", "reynolds", "table"),
        "lateral": ("closed_form", "reynolds", "table"),
        **_CONTACTS,
    },
    keys=LumpedKeys,
    unused=_BALANCE,
    over_time=True,
)
FILMS = Preset(
    name="films",
    content="Lumped, with journal and lateral films solved on grids.",
    module="toothspace.run.run",
    interfaces={
        "journal": ("reynolds", "closed_form"),
        "lateral": ("reynolds", "closed_form"),
        **_CONTACTS,
    },
    unused=_BALANCE,
)
ELASTIC = Preset(
    name="elastic",
    content="Films, with elastic surfaces, asperity contact and floating parts in balance; beside "
    "covers that rest, films solved on grids.",
    module="toothspace.run.elastic",
    interfaces={
        "journal": ("reynolds", "closed_form"),
        "lateral": ("elastic", "reynolds"),
        **_CONTACTS,
    },
    keys=ElasticKeys,
    unused=("startup",),
)

PRESETS: Mapping[str, Preset] = MappingProxyType(
    {preset.name: preset for preset in (IDEAL, LUMPED, FILMS, ELASTIC)}
)
"""Fidelity presets by name."""
