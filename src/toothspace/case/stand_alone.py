"""``[bearing]`` and ``[film]``: lubricant films without a machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from toothspace.core.keys import (
    Integer,
    Items,
    KeyRuleError,
    Number,
    Quantity,
    Row,
    Table,
    choice,
    declare,
    forbid,
    number,
    quantity,
    require,
    table,
)

_CELLS = Integer(low=4, high=5000)
_RATIO = Number(low=-0.999, high=0.999)
_FORCE = Quantity(unit="N", low=-1e8, high=1e8)
_SPEED = Quantity(unit="m/s", low=-100, high=100)
_TILT = Quantity(unit="rad", low=-0.1, high=0.1)
_GRID_DOC = "Number of cells in both directions."
_CAVITATION = ("jfo", "reynolds", "guembel")


@final
@dataclass(frozen=True, kw_only=True)
class FilmSurfaces:
    """``surfaces``: roughness and contact of the two walls of a film."""

    moving_roughness: float = quantity(
        "um", "Root mean square roughness of the moving wall.", low=0, high=100
    )
    resting_roughness: float = quantity(
        "um", "Root mean square roughness of the resting wall.", low=0, high=100
    )
    moving_pattern: float = number(
        "Correlation length of the moving wall along over across the motion.",
        above=0,
        high=20,
        default=1.0,
    )
    resting_pattern: float = number("The same of the resting wall.", above=0, high=20, default=1.0)
    correlation_length: float = quantity(
        "um", "Half-height correlation length, combined.", above=0, high=1000, default=15e-6
    )
    effective_modulus: float = quantity(
        "GPa", "2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2].", above=0, high=2000, default=1.55e11
    )
    hardness: float = quantity(
        "MPa", "Hardness of the softer wall.", above=0, high=100000, default=1e9
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities.", low=0, high=2, default=0.1
    )
    contact_law: str = choice(
        "Law of the asperity pressure.",
        "elastic_plastic",
        "greenwood_tripp",
        "kogut_etsion",
        "none",
        default="elastic_plastic",
    )

    def __post_init__(self) -> None:
        if self.moving_roughness + self.resting_roughness <= 0.0:
            raise KeyRuleError("moving_roughness", "two smooth walls", "one rough wall or more")


_SURFACES_DOC = "Roughness and contact; smooth walls without it."
_BARUS_DOC = "Coefficient alpha of the viscosity mu exp(alpha p)."
_DENSITY_DOC = "Density constant, or over the pressure after Dowson and Higginson."
_DENSITIES = ("constant", "dowson_higginson")


@final
@dataclass(frozen=True, kw_only=True)
class BearingGroove:
    """One of ``[[bearing.grooves]]``: patch of constant pressure."""

    angle: float = quantity("deg", "Centre, from x towards y.", low=-360, high=360)
    width: float = quantity("deg", "Extent along the circumference.", above=0, high=360)
    length: float = quantity("mm", "Axial extent, centred.", above=0, high=1000)
    pressure: float = quantity("bar", "Absolute pressure.", low=0, high=1000)


@final
@dataclass(frozen=True, kw_only=True)
class JournalBearingCase:
    """``[bearing]``: either eccentricity or load is given."""

    diameter: float = quantity("mm", "Journal diameter.", above=0, high=2000)
    length: float = quantity("mm", "Bearing length.", above=0, high=2000)
    radial_clearance: float = quantity(
        "um", "Bush radius minus journal radius.", above=0, high=5000
    )
    shaft_speed: float = quantity("rpm", "Speed of the journal.", low=-100000, high=100000)
    dynamic_viscosity: float | None = quantity(
        "Pa s", "Viscosity; or give a fluid.", above=0, high=100, default=None
    )
    eccentricity: tuple[float, float] | None = declare(
        Row(items=(_RATIO, _RATIO), doc="Displacement x, y over clearance."), None
    )
    load: tuple[float, float] | None = declare(
        Row(items=(_FORCE, _FORCE), doc="Force on the shaft; the equilibrium is found."), None
    )
    velocity: tuple[float, float] = declare(
        Row(items=(_SPEED, _SPEED), doc="Velocity of the shaft centre."), (0.0, 0.0)
    )
    tilt: tuple[float, float] = declare(
        Row(items=(_TILT, _TILT), doc="Rotation of the shaft about x and y."), (0.0, 0.0)
    )
    end_pressure: float = quantity(
        "bar", "Absolute pressure at both ends.", low=0, high=1000, default=1e5
    )
    cavitation_pressure: float = quantity(
        "bar", "Absolute pressure in the cavity.", low=0, high=1000, default=1e5
    )
    cavitation: str = choice("Cavitation model.", *_CAVITATION, default="jfo")
    grid: tuple[int, int] = declare(Row(items=(_CELLS, _CELLS), doc=_GRID_DOC), (200, 53))
    grooves: tuple[BearingGroove, ...] = declare(
        Items(item=Table(spec=BearingGroove), doc="Supply grooves.", low=0, high=100), ()
    )
    surfaces: FilmSurfaces | None = table(FilmSurfaces, _SURFACES_DOC, default=None)

    def __post_init__(self) -> None:
        if self.load is None:
            require(self, "unless load is given", "eccentricity")
        else:
            forbid(self, "because load is given", "eccentricity")
        if self.eccentricity is not None and sum(e * e for e in self.eccentricity) >= 1.0:
            raise KeyRuleError("eccentricity", str(list(self.eccentricity)), "length below 1")


@final
@dataclass(frozen=True, kw_only=True)
class PadPocket:
    """``pocket``: rectangular recess of a pad."""

    depth: float = quantity("um", "Depth.", low=0, high=10000)
    x: float = quantity("mm", "Start along the motion.", low=0, high=2000)
    length: float = quantity("mm", "Extent along the motion.", above=0, high=2000)
    width: float = quantity("mm", "Extent across, centred.", above=0, high=2000)


@final
@dataclass(frozen=True, kw_only=True)
class FilmCase:
    """``[film]`` with ``kind = "pad"``: plane slider with linear height."""

    length: float = quantity("mm", "Extent along the motion.", above=0, high=2000)
    width: float = quantity("mm", "Extent across the motion.", above=0, high=2000)
    speed: float = quantity("m/s", "Speed of the sliding wall.", low=-1000, high=1000)
    inlet_height: float = quantity("um", "Height where the wall enters.", above=0, high=10000)
    outlet_height: float = quantity("um", "Height where the wall leaves.", above=0, high=10000)
    pocket: PadPocket | None = table(PadPocket, "Recess.", default=None)
    dynamic_viscosity: float | None = quantity(
        "Pa s", "Viscosity; or give a fluid.", above=0, high=100, default=None
    )
    ambient_pressure: float = quantity(
        "bar", "Absolute pressure at all edges.", low=0, high=1000, default=1e5
    )
    cavitation_pressure: float = quantity(
        "bar", "Absolute pressure in the cavity.", low=0, high=1000, default=0.0
    )
    cavitation: str = choice("Cavitation model.", *_CAVITATION, default="jfo")
    grid: tuple[int, int] = declare(Row(items=(_CELLS, _CELLS), doc=_GRID_DOC), (256, 128))
    pressure_viscosity: float = quantity("1/GPa", _BARUS_DOC, low=0, high=100, default=0.0)
    density: str = choice(_DENSITY_DOC, *_DENSITIES, default="constant")
    surfaces: FilmSurfaces | None = table(FilmSurfaces, _SURFACES_DOC, default=None)


@final
@dataclass(frozen=True, kw_only=True)
class LateralFilmCase:
    """``[film]`` with ``kind = "lateral"``: film of a machine's bushing face at one angle."""

    side_gap: float = quantity("um", "Film height at the reference point.", above=0, high=1000)
    tilt: tuple[float, float] = declare(
        Row(items=(_TILT, _TILT), doc="Rotation of the bushing about x and y."), (0.0, 0.0)
    )
    shaft_angle: float = quantity(
        "deg", "Angle of the drive gear.", low=-360, high=360, default=0.0
    )
    shaft_speed: float = quantity("rpm", "Shaft speed.", low=0, high=50000)
    inlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    outlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    dynamic_viscosity: float | None = quantity(
        "Pa s", "Viscosity; or give a fluid.", above=0, high=100, default=None
    )
    cavitation_pressure: float = quantity(
        "bar", "Absolute pressure in the cavity.", low=0, high=1000, default=0.0
    )
    cavitation: str = choice("Cavitation model.", *_CAVITATION, default="jfo")
    grid: tuple[int, int] = declare(Row(items=(_CELLS, _CELLS), doc=_GRID_DOC), (256, 64))
    pressure_viscosity: float = quantity("1/GPa", _BARUS_DOC, low=0, high=100, default=0.0)
    density: str = choice(_DENSITY_DOC, *_DENSITIES, default="constant")
    surfaces: FilmSurfaces | None = table(FilmSurfaces, _SURFACES_DOC, default=None)


FILMS: Mapping[str, type] = {"pad": FilmCase, "lateral": LateralFilmCase}
"""Stand-alone films by the value of their key ``kind``."""
