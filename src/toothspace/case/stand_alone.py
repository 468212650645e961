"""``[bearing]`` and ``[film]``: lubricant films without a machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    Integer,
    KeyTable,
    Number,
    QuantityKey,
    Table,
    choice,
    flag,
    forbid,
    items,
    number,
    pair,
    quantity,
    require,
    table,
)
from toothspace.films.definitions import Groove, Lobes, RoughSurfaces

_CELLS = Integer(low=4, high=5000)
_RATIO = Number(low=-0.999, high=0.999)
_FORCE = QuantityKey(unit="N", low=-1e8, high=1e8)
_SPEED = QuantityKey(unit="m/s", low=-100, high=100)
_MOMENT = QuantityKey(unit="N m", low=-1e6, high=1e6)
_MOST_STEPS = 100_000
_TILT = QuantityKey(unit="rad", low=-0.1, high=0.1)
_GRID_DOC = "Number of cells in both directions."


@final
@dataclass(frozen=True, kw_only=True)
class FilmHeat(KeyTable):
    """``heat``: viscosity at the mean temperature that dissipated power gives the oil."""

    oil_share: float = number(
        "Part of the dissipated power that the oil carries away: 1 adiabatic, 0 isothermal.",
        low=0,
        high=1,
        default=1.0,
    )


@final
@dataclass(frozen=True, kw_only=True)
class ShaftOrbit(KeyTable):
    """``orbit``: motion of a rigid shaft in time, from its place in the case."""

    mass: float = quantity("kg", "Mass of the shaft per bearing.", above=0, high=1e6)
    duration: float = quantity("s", "Simulated time.", above=0, high=1000)
    time_step: float = quantity("s", "Time step.", above=0, high=10)
    unbalance: float = quantity(
        "kg m", "Mass times its distance from the axis.", low=0, high=1e3, default=0.0
    )
    film_memory: bool = flag("Whether the liquid in the cavity is followed in time.", default=False)

    def __post_init__(self) -> None:
        if self.time_step > self.duration:
            found = f"{self.time_step:g} s"
            raise CaseError("time_step", found, f"at most the duration, {self.duration:g} s")
        if self.duration > _MOST_STEPS * self.time_step:
            found = f"{self.duration / self.time_step:.0f} steps"
            raise CaseError("time_step", found, f"at most {_MOST_STEPS} steps")


@dataclass(frozen=True, kw_only=True)
class FilmKeys(KeyTable):
    """Keys that films of all kinds share."""

    dynamic_viscosity: float | None = quantity(
        "Pa s", "Viscosity; or give a fluid.", above=0, high=100, default=None
    )
    cavitation_pressure: float = quantity(
        "bar", "Absolute pressure in the cavity.", low=0, high=1000, default=0.0
    )
    cavitation: str = choice("Cavitation model.", "jfo", "reynolds", "guembel", default="jfo")
    pressure_viscosity: float = quantity(
        "1/GPa", "Coefficient alpha of the viscosity mu exp(alpha p).", low=0, high=100, default=0.0
    )
    density: str = choice(
        "Density constant, or over the pressure after Dowson and Higginson.",
        "constant",
        "dowson_higginson",
        default="constant",
    )
    surfaces: RoughSurfaces | None = table(
        RoughSurfaces, "Roughness and contact; smooth walls without it.", default=None
    )
    heat: FilmHeat | None = table(
        FilmHeat,
        "Heat balance, from the temperature of the fluid; isothermal without.",
        default=None,
    )


@final
@dataclass(frozen=True, kw_only=True)
class JournalBearingCase(FilmKeys):
    """``[bearing]``: either eccentricity or load is given."""

    diameter: float = quantity("mm", "Journal diameter.", above=0, high=2000)
    length: float = quantity("mm", "Bearing length.", above=0, high=2000)
    radial_clearance: float = quantity(
        "um", "Bush radius minus journal radius.", above=0, high=5000
    )
    shaft_speed: float = quantity("rpm", "Speed of the journal.", low=-100000, high=100000)
    eccentricity: tuple[float, float] | None = pair(
        _RATIO, "Displacement x, y over clearance.", default=None
    )
    load: tuple[float, float] | None = pair(
        _FORCE, "Force on the shaft; the equilibrium is found.", default=None
    )
    velocity: tuple[float, float] = pair(
        _SPEED, "Velocity of the shaft centre.", default=(0.0, 0.0)
    )
    tilt: tuple[float, float] = pair(
        _TILT, "Rotation of the shaft about x and y.", default=(0.0, 0.0)
    )
    end_pressure: float = quantity(
        "bar", "Absolute pressure at both ends.", low=0, high=1000, default=1e5
    )
    cavitation_pressure: float = quantity(
        "bar", "Absolute pressure in the cavity.", low=0, high=1000, default=1e5
    )
    grid: tuple[int, int] = pair(_CELLS, _GRID_DOC, default=(200, 53))
    grooves: tuple[Groove, ...] = items(
        Table(spec=Groove), "Supply grooves.", low=0, high=100, default=()
    )
    lobes: Lobes | None = table(Lobes, "Lobes; a cylinder without.", default=None)
    bush_speed: float = quantity(
        "rpm", "Speed of the bush; grooves rest.", low=-100000, high=100000, default=0.0
    )
    moment: tuple[float, float] | None = pair(
        _MOMENT, "Moment x, y on the shaft, which is then free to tilt.", default=None
    )
    end_condition: str = choice("Ends of the film.", "pressure", "no_flow", default="pressure")
    supply: str = choice(
        "Supply line on the widest gap; 'auto' where oil could not enter otherwise.",
        "auto",
        "none",
        "widest_gap",
        default="auto",
    )
    orbit: ShaftOrbit | None = table(ShaftOrbit, "Motion in time; steady without.", default=None)

    def __post_init__(self) -> None:
        if self.load is None:
            require(self, "unless load is given", "eccentricity")
            forbid(self, "without a load", "moment")
        else:
            forbid(self, "because load is given", "eccentricity")
        if self.moment is not None and self.orbit is not None:
            raise CaseError("moment", "a moment with an orbit", "one of both")
        if self.eccentricity is not None and sum(e * e for e in self.eccentricity) >= 1.0:
            raise CaseError("eccentricity", str(list(self.eccentricity)), "length below 1")


@final
@dataclass(frozen=True, kw_only=True)
class PadPocket(KeyTable):
    """``pocket``: rectangular recess of a pad."""

    depth: float = quantity("um", "Depth.", low=0, high=10000)
    x: float = quantity("mm", "Start along the motion.", low=0, high=2000)
    length: float = quantity("mm", "Extent along the motion.", above=0, high=2000)
    width: float = quantity("mm", "Extent across, centred.", above=0, high=2000)


@final
@dataclass(frozen=True, kw_only=True)
class FilmCase(FilmKeys):
    """``[film]`` with ``kind = "pad"``: plane slider with linear height."""

    length: float = quantity("mm", "Extent along the motion.", above=0, high=2000)
    width: float = quantity("mm", "Extent across the motion.", above=0, high=2000)
    speed: float = quantity("m/s", "Speed of the sliding wall.", low=-1000, high=1000)
    inlet_height: float = quantity("um", "Height where the wall enters.", above=0, high=10000)
    outlet_height: float = quantity("um", "Height where the wall leaves.", above=0, high=10000)
    pocket: PadPocket | None = table(PadPocket, "Recess.", default=None)
    ambient_pressure: float = quantity(
        "bar", "Absolute pressure at all edges.", low=0, high=1000, default=1e5
    )
    side_condition: str = choice(
        "Edges along the motion; walls make an endless pad.",
        "pressure",
        "no_flow",
        default="pressure",
    )
    squeeze_velocity: float = quantity(
        "m/s", "Velocity of the pad away from the wall.", low=-100, high=100, default=0.0
    )
    grid: tuple[int, int] = pair(_CELLS, _GRID_DOC, default=(256, 128))


@final
@dataclass(frozen=True, kw_only=True)
class LateralFilmCase(FilmKeys):
    """``[film]`` with ``kind = "lateral"``: film of a machine's bushing face at one angle."""

    side_gap: float = quantity("um", "Film height at the reference point.", above=0, high=1000)
    tilt: tuple[float, float] = pair(
        _TILT, "Rotation of the bushing about x and y.", default=(0.0, 0.0)
    )
    shaft_angle: float = quantity(
        "deg", "Angle of the drive gear.", low=-360, high=360, default=0.0
    )
    shaft_speed: float = quantity("rpm", "Shaft speed.", low=0, high=50000)
    inlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    outlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    grid: tuple[int, int] = pair(_CELLS, _GRID_DOC, default=(256, 64))


@final
@dataclass(frozen=True, kw_only=True)
class RingFilmCase(FilmKeys):
    """``[film]`` with ``kind = "ring"``: plane ring or disc, its lower face turns."""

    inner_radius: float = quantity("mm", "Inner radius; zero for a disc.", low=0, high=2000)
    outer_radius: float = quantity("mm", "Outer radius.", above=0, high=2000)
    side_gap: float = quantity("um", "Film height on the axis.", above=0, high=10000)
    tilt: tuple[float, float] = pair(
        _TILT, "Rotation of the upper face about x and y.", default=(0.0, 0.0)
    )
    shaft_speed: float = quantity("rpm", "Speed of the lower face.", low=-100000, high=100000)
    squeeze_velocity: float = quantity(
        "m/s", "Velocity of the upper face away from the lower.", low=-100, high=100, default=0.0
    )
    inner_pressure: float | None = quantity(
        "bar", "Absolute pressure at the inner rim; a wall without.", low=0, high=5000, default=None
    )
    outer_pressure: float | None = quantity(
        "bar", "Absolute pressure at the outer rim; a wall without.", low=0, high=5000, default=None
    )
    grid: tuple[int, int] = pair(_CELLS, _GRID_DOC, default=(256, 64))

    def __post_init__(self) -> None:
        if self.inner_radius >= self.outer_radius:
            found = f"{1e3 * self.inner_radius:g} mm"
            raise CaseError("inner_radius", found, "below the outer radius")
        if self.inner_pressure is None and self.outer_pressure is None:
            require(self, "unless inner_pressure is given", "outer_pressure")


FILMS: Mapping[str, type] = {
    "pad": FilmCase,
    "lateral": LateralFilmCase,
    "ring": RingFilmCase,
    "journal": JournalBearingCase,
}
"""Stand-alone films by the value of their key ``kind``."""
