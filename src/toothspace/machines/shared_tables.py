"""Tables and keys of ``[machine]`` that several machine types have, and the machine type itself."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast, final

from toothspace.closures.gap_flow import equal_leakage_height
from toothspace.core.keys import (
    KeyTable,
    choice,
    forbid,
    instead_of,
    number,
    quantity,
    require,
    text,
)
from toothspace.model.description import MachineDescription

if TYPE_CHECKING:
    pass

DEFAULT_NODES = 720
"""About how many table nodes stand on one turn."""


DRAFT = """# Drafted from {files}.
# Numbers marked "assumed" are not in the files: put in your own.
schema = 1
title = {title}

[machine]
type = "{machine}"
mode = "pump"                    # or "motor"
{found}

[machine.lateral]
side_gap = "{side_gap}"               # assumed

[fluid]
name = "iso_vg_46"               # assumed: toothspace fluids lists others
temperature = "50 degC"

[operating_point]                # assumed
shaft_speed = "{shaft_speed}"
inlet_pressure = "1 bar"
outlet_pressure = "{outlet_pressure}"

[run]
fidelity = "lumped"
until = "cyclic"
"""
"""First case file round the keys found."""


PROPOSED_CONDITION = """[machine.inlet]
volume = "{port:.3g} cm^3"

[machine.outlet]
volume = "{port:.3g} cm^3"

[fluid]
name = "iso_vg_46"               # 'toothspace fluids' lists others
temperature = "50 degC"
free_air_fraction = 0.002
dissolved_air_fraction = 0.08

[operating_point]
shaft_speed = "{speed:g} rpm"
inlet_pressure = "1 bar"         # absolute
outlet_pressure = "{pressure:g} bar"
"""
FREE_RIPPLE = """outlet_load = "orifice"          # ripple is free behind the outlet volume
"""
PROPOSED_RUN = """
[run]
fidelity = "lumped"
until = "cyclic"
"""
"""Ports, fluid and operating point with which a first design ends, and how it is run."""


def draft_line(key: str, value: object, note: str = "") -> str:
    """Line of a first case file, with its note in a column of their own."""
    line = f"{key} = {json.dumps(value)}"
    return f"{line:<33}# {note}" if note else line


@final
@dataclass(frozen=True)
class CaseDraft:
    """First case file of a machine that was found in CAD files."""

    text: str
    """TOML with comments on what was found and what is assumed."""
    parts: int
    """How many parts of the files it uses."""


@final
@dataclass(frozen=True)
class MachineType:
    """A machine type as it is found by name."""

    name: str
    """Name in ``machine.type``."""
    describe: Callable[..., MachineDescription]
    """From the definition of a machine, and optionally about how many table nodes on a turn, to its
    description; ``GeometryError`` if it cannot be built.
    """


@dataclass(frozen=True, kw_only=True)
class MachineTables(KeyTable):
    """``[machine]``: what every pump and motor has."""

    mode: str = choice("What the machine is used as.", "pump", "motor")
    drain: str | None = choice(
        "Node that collects the drain; default the low-pressure port.",
        "inlet",
        "outlet",
        "external",
        default=None,
    )
    drain_pressure: float | None = quantity(
        "bar", "Absolute pressure of an external drain.", above=0, high=100, default=None
    )

    def __post_init__(self) -> None:
        if self.drain == "external":
            require(self, 'with drain = "external"', "drain_pressure")
        else:
            forbid(self, 'unless drain = "external"', "drain_pressure")

    @property
    def use(self) -> Literal["pump", "motor"]:
        """What the machine is used as."""
        return cast(Literal["pump", "motor"], self.mode)

    @property
    def drain_node(self) -> Literal["inlet", "outlet", "external"]:
        """Node that collects the drain."""
        low = "inlet" if self.mode == "pump" else "outlet"
        return cast(Literal["inlet", "outlet", "external"], self.drain or low)

    @property
    def missing_floating_part(self) -> str:
        """Message about what a floating part in balance would need; empty if there is one."""
        return "machine.type: found a type without floating parts, allowed one with them"

    @property
    def covers_rest(self) -> bool:
        """Whether nothing beside gears or rotors floats."""
        return True

    def assemble(self) -> Any:
        """Return the definition of the machine: these keys themselves."""
        return self


@dataclass(frozen=True, kw_only=True)
class ShaftBearingParameters(KeyTable):
    """``[machine.journal_bearings]``: two equal bearings of a shaft."""

    diameter: float = quantity("mm", "Journal diameter.", above=0, high=500)
    length: float = quantity("mm", "Length of each bearing.", above=0, high=500)
    radial_clearance: float = quantity("um", "Bush radius minus journal radius.", low=1, high=500)
    roughness_shaft: float = quantity(
        "um", "Root mean square roughness of the journal.", low=0, high=10, default=0.15e-6
    )
    roughness_bush: float = quantity(
        "um", "Root mean square roughness of the bush.", low=0, high=10, default=0.30e-6
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities.", low=0, high=1, default=0.05
    )


@dataclass(frozen=True, kw_only=True)
class LinedBearingParameters(ShaftBearingParameters):
    """``[machine.journal_bearings]``: two equal bearings on each shaft, with a running layer."""

    material: str = text("Running layer of the bush.", default="ptfe_lined_bush")


@final
@dataclass(frozen=True, kw_only=True)
class ShaftSealParameters(KeyTable):
    """``[machine.seals]``."""

    shaft_seal_torque: float = quantity("N m", "Friction of the shaft seal.", low=0, high=100)


@dataclass(frozen=True, kw_only=True)
class SideGapParameters(KeyTable):
    """``[machine.lateral]``: films beside the faces, of one height or each of its own."""

    each: ClassVar[tuple[str, str]]
    """Keys of both heights."""

    side_gap: float | None = quantity(
        "um", "Film height of both faces.", low=0.1, high=500, default=None
    )

    def __post_init__(self) -> None:
        instead_of(self, "side_gap", *self.each)

    @property
    def side_gaps(self) -> tuple[float, float]:
        """Film heights in the order of the keys. [m]."""
        if self.side_gap is not None:
            return self.side_gap, self.side_gap
        first, second = self.each
        return getattr(self, first), getattr(self, second)

    @property
    def leakage_height(self) -> float:
        """Height that lets the same leakage through as the gaps of both faces. [m]."""
        return float(equal_leakage_height(*self.side_gaps))

    @property
    def shear_height(self) -> float:
        """Height that shears like the gaps of both faces together. [m]."""
        first, second = self.side_gaps
        return 2.0 / (1.0 / first + 1.0 / second)


@dataclass(frozen=True, kw_only=True)
class PortParameters(KeyTable):
    """``[machine.inlet]`` and ``[machine.outlet]``."""

    volume: float = quantity(
        "cm^3", "Fluid volume between machine and line.", low=0.1, high=1e5, default=50e-6
    )
