"""``[circuit]``: named elements and their connections, for transient runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, final

from toothspace.core.errors import CaseError
from toothspace.core.frozen import FrozenDict
from toothspace.core.keys import (
    KeyTable,
    Named,
    Number,
    QuantityKey,
    Row,
    Text,
    Variant,
    choice,
    declare,
    file_path,
    forbid,
    instead_of,
    integer,
    items,
    number,
    quantity,
    require,
    table,
)

_SPEED = QuantityKey(unit="rpm", low=-50000, high=50000)


def _over_time(value: Any, name: str) -> Any:
    item = Row(items=(QuantityKey(unit="s", low=0, high=1e6), value))
    doc = f"Pairs of time and {name}, joined by straight lines."
    return items(item, doc, low=1, default=None)


def _check_history(owner: Any, key: str) -> None:
    """A history stands in the case or in a file, and its times increase."""
    file, rows = getattr(owner, f"{key}_file"), getattr(owner, key)
    if file is not None:
        forbid(owner, f"because {key}_file is given", key)
        return
    require(owner, f"unless {key}_file is given", key)
    times = [row[0] for row in rows]
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise CaseError(key, f"times {times}", "times that increase")


@final
@dataclass(frozen=True, kw_only=True)
class EfficiencyLine(KeyTable):
    """Volumetric efficiency that falls linearly with the pressure difference."""

    offset: float = number("Value at zero pressure difference.", above=0, high=1)
    per_100_bar: float = number("Change per 100 bar.", low=-1, high=1, default=0.0)


@final
@dataclass(frozen=True, kw_only=True)
class RatedPoint(KeyTable):
    """Point of a pump's catalogue, to which its laminar slip is fitted."""

    shaft_speed: float = quantity("rpm", "Shaft speed.", above=0, high=50000)
    pressure_difference: float = quantity("bar", "Pressure rise.", above=0, high=2000)
    volumetric_efficiency: float = number("Volumetric efficiency there.", above=0, high=1)
    dynamic_viscosity: float = quantity(
        "Pa s", "Viscosity of the oil of the catalogue.", above=0, high=10
    )

    def slip_coefficient(self, without_slip: float) -> float:
        """Slip of Wilson, (without_slip - efficiency) viscosity speed / pressure rise. [-]."""
        slip = (
            (without_slip - self.volumetric_efficiency) * self.dynamic_viscosity * self.shaft_speed
        )
        return slip / self.pressure_difference


@dataclass(frozen=True, kw_only=True)
class SpeedHistory(KeyTable):
    """Speed over time, in the case or in a file."""

    speed: tuple[tuple[float, float], ...] | None = _over_time(_SPEED, "speed")
    speed_file: Path | None = file_path("Columns time [s] and speed [rpm].", ".csv", ".txt")

    def __post_init__(self) -> None:
        _check_history(self, "speed")


@final
@dataclass(frozen=True, kw_only=True)
class SpeedSource(SpeedHistory):
    """``kind = "speed_source"``: prescribes the shaft speed."""


@final
@dataclass(frozen=True, kw_only=True)
class PumpMap(SpeedHistory):
    """``kind = "pump_map"``: supply pump with a map of volumetric efficiency."""

    displacement: float = quantity("cm^3/rev", "Displacement.", above=0, high=10000)
    volumetric_efficiency: EfficiencyLine = table(
        EfficiencyLine, "Efficiency over pressure.", default=EfficiencyLine(offset=1.0)
    )
    rated_point: RatedPoint | None = table(
        RatedPoint,
        "Point of a catalogue that gives the slip: what the efficiency line leaves of its "
        "losses. Instead of slip_coefficient.",
        default=None,
    )
    table: Path | None = file_path(
        "Map instead of the line: columns speed [rpm], pressure_difference [bar] and "
        "volumetric_efficiency [1] of a full grid.",
        ".csv",
    )
    slip_coefficient: float = number(
        "Laminar slip of Wilson: leakage times viscosity over displacement per radian and "
        "pressure rise.",
        low=0,
        high=1e-3,
        default=0.0,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rated_point is None:
            return
        forbid(self, "because rated_point is given", "table")
        if self.slip_coefficient > 0.0:
            allowed = "leave this key out because rated_point is given"
            raise CaseError("slip_coefficient", f"{self.slip_coefficient:g}", allowed)
        if self.slip < 0.0:
            found = f"a volumetric efficiency of {self.rated_point.volumetric_efficiency:g}"
            raise CaseError("rated_point", found, "one that volumetric_efficiency leaves")

    @property
    def slip(self) -> float:
        """Slip of Wilson, given or from the rated point. [-]."""
        rated, line = self.rated_point, self.volumetric_efficiency
        if rated is None:
            return self.slip_coefficient
        return rated.slip_coefficient(
            line.offset + line.per_100_bar * rated.pressure_difference / 1e7
        )


@dataclass(frozen=True, kw_only=True)
class Line(KeyTable):
    """Length, bore and wall of a line; without ``effective_bulk_modulus`` or a wall it is rigid."""

    length: float = quantity("m", "Length.", above=0, high=1000)
    bore: float = quantity("mm", "Bore diameter.", above=0, high=500)
    effective_bulk_modulus: float | None = quantity(
        "GPa", "Bulk modulus of fluid and wall together.", above=0, high=5, default=None
    )
    wall_thickness: float | None = quantity(
        "mm", "Wall thickness.", above=0, high=100, default=None
    )
    wall_modulus: float | None = quantity(
        "GPa", "Elastic modulus of the wall.", above=0, high=300, default=None
    )
    cells: int = integer("Cells of a transmission line.", low=2, high=200, default=16)

    def __post_init__(self) -> None:
        wall = ("wall_thickness", "wall_modulus")
        if self.effective_bulk_modulus is not None:
            forbid(self, "because effective_bulk_modulus is given", *wall)
        elif self.has_wall:
            require(self, f"where one of {' and '.join(wall)} is given", *wall)

    @property
    def has_wall(self) -> bool:
        """Whether a tube is described."""
        return self.wall_thickness is not None or self.wall_modulus is not None


@final
@dataclass(frozen=True, kw_only=True)
class PortLine(Line):
    """``[operating_point.line]``: line with waves between working port and load or source."""


@final
@dataclass(frozen=True, kw_only=True)
class Hose(Line):
    """``kind = "hose"``: line with an elastic wall."""

    model: str = choice(
        "One volume, or waves with friction that depends on frequency.",
        "lumped",
        "transmission_line",
        default="lumped",
    )
    wall_stiffening: float = number(
        "Stiffness of the wall to fast changes over that at rest: rubber takes time to yield. In "
        "one volume only.",
        low=1,
        high=10,
        default=1.0,
    )
    wall_relaxation_time: float = quantity(
        "s", "Time that the wall takes to yield fully.", above=0, high=100, default=0.05
    )

    def __post_init__(self) -> None:
        if self.carries_waves and self.wall_stiffening > 1.0:
            raise CaseError("wall_stiffening", f"{self.wall_stiffening:g}", "1 with waves")
        if self.wall_stiffening > 1.0 and self.effective_bulk_modulus is None and not self.has_wall:
            raise CaseError("wall_stiffening", f"{self.wall_stiffening:g}", "1 of a rigid line")
        super().__post_init__()

    @property
    def carries_waves(self) -> bool:
        """Whether its two ends are places of their own."""
        return self.model == "transmission_line"


@final
@dataclass(frozen=True, kw_only=True)
class Volume(KeyTable):
    """``kind = "volume"``: rigid volume of fluid."""

    volume: float = quantity("cm^3", "Volume.", above=0, high=1e6)


@final
@dataclass(frozen=True, kw_only=True)
class Orifice(KeyTable):
    """``kind = "orifice"``: sharp-edged restriction."""

    diameter: float | None = quantity("mm", "Diameter.", above=0, high=200, default=None)
    area: float | None = quantity("mm^2", "Area.", above=0, high=1e5, default=None)
    discharge_coefficient: float = number("Discharge coefficient.", above=0, high=1, default=0.7)

    def __post_init__(self) -> None:
        instead_of(self, "diameter", "area")


@final
@dataclass(frozen=True, kw_only=True)
class ReliefValve(KeyTable):
    """``kind = "relief_valve"``: opens above a pressure difference."""

    opening_pressure: float = quantity("bar", "Pressure difference.", above=0, high=1000)
    gradient: float = quantity(
        "bar s/L", "Pressure rise per flow once open.", above=0, high=1e4, default=1.2e9
    )


@final
@dataclass(frozen=True, kw_only=True)
class CheckValve(KeyTable):
    """``kind = "check_valve"``: lets fluid pass in the order of its connections."""

    opening_pressure: float = quantity("bar", "Pressure difference.", low=0, high=1000, default=0.0)
    gradient: float = quantity(
        "bar s/L", "Pressure rise per flow once open.", above=0, high=1e4, default=1e8
    )


@final
@dataclass(frozen=True, kw_only=True)
class ProportionalValve(KeyTable):
    """``kind = "proportional_valve"``: orifice whose opening changes over time."""

    area: float = quantity("mm^2", "Area when fully open.", above=0, high=1e5)
    discharge_coefficient: float = number("Discharge coefficient.", above=0, high=1, default=0.7)
    opening: tuple[tuple[float, float], ...] | None = _over_time(
        Number(low=0, high=1), "opening from 0 to 1"
    )
    opening_file: Path | None = file_path("Columns time [s] and opening [1].", ".csv", ".txt")

    def __post_init__(self) -> None:
        _check_history(self, "opening")


@final
@dataclass(frozen=True, kw_only=True)
class Accumulator(KeyTable):
    """``kind = "accumulator"``: gas charge behind a bladder."""

    gas_volume: float = quantity("cm^3", "Volume of the charge.", above=0, high=1e6)
    precharge: float = quantity("bar", "Absolute pressure without fluid.", above=0, high=1000)
    gas_exponent: float = number("Polytropic exponent.", above=1, high=2, default=1.3)
    fluid_volume: float = quantity(
        "cm^3", "Fluid volume when empty.", above=0, high=1e6, default=10e-6
    )


@final
@dataclass(frozen=True, kw_only=True)
class Cooler(KeyTable):
    """``kind = "cooler"``: pressure drop with a laminar and a turbulent part."""

    pressure_drop: float = quantity("bar", "Drop at the rated flow.", above=0, high=100)
    flow_rate: float = quantity("L/min", "Rated flow.", above=0, high=10000)
    laminar_share: float = number("Laminar part of that drop.", above=0, high=1, default=0.5)


@final
@dataclass(frozen=True, kw_only=True)
class TorqueSource(KeyTable):
    """``kind = "torque_source"``: torque that the load takes from the shaft over time."""

    torque: tuple[tuple[float, float], ...] | None = _over_time(
        QuantityKey(unit="N m", low=-1e5, high=1e5), "torque"
    )
    torque_file: Path | None = file_path("Columns time [s] and torque [N m].", ".csv", ".txt")

    def __post_init__(self) -> None:
        _check_history(self, "torque")


@final
@dataclass(frozen=True, kw_only=True)
class Fan(KeyTable):
    """``kind = "fan"``: load, torque = linear speed + quadratic speed^2 + cubic speed^3."""

    linear: float = quantity("N m/rpm", "Torque per speed.", low=0, high=100, default=0.0)
    quadratic: float = quantity(
        "N m/rpm^2", "Torque per speed squared, the law of a fan.", low=0, high=1, default=0.0
    )
    cubic: float = quantity("N m s^3/rad^3", "Torque per speed cubed.", low=0, high=1, default=0.0)
    inertia: float = quantity("kg m^2", "Moment of inertia.", low=0, high=1000, default=0.0)


@final
@dataclass(frozen=True, kw_only=True)
class Inertia(KeyTable):
    """``kind = "inertia"``: rotating mass on the shaft."""

    inertia: float = quantity("kg m^2", "Moment of inertia.", above=0, high=1000)


@final
@dataclass(frozen=True, kw_only=True)
class Coupling(KeyTable):
    """``kind = "coupling"``: elastic coupling between the shaft and all fans and inertias."""

    stiffness: float = quantity("N m/rad", "Torque per twist.", above=0, high=1e8)
    damping: float = quantity("N m s/rad", "Torque per slip.", low=0, high=1e6, default=0.0)


@final
@dataclass(frozen=True, kw_only=True)
class Tank(KeyTable):
    """``kind = "tank"``: constant pressure."""

    pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)


ELEMENTS: Mapping[str, type] = {
    "speed_source": SpeedSource,
    "pump_map": PumpMap,
    "hose": Hose,
    "volume": Volume,
    "orifice": Orifice,
    "relief_valve": ReliefValve,
    "check_valve": CheckValve,
    "proportional_valve": ProportionalValve,
    "accumulator": Accumulator,
    "cooler": Cooler,
    "fan": Fan,
    "inertia": Inertia,
    "coupling": Coupling,
    "torque_source": TorqueSource,
    "tank": Tank,
}
"""Circuit elements by the value of their key ``kind``."""

ELEMENT_KEY = Variant(tag="kind", variants=ELEMENTS, doc="Circuit element.")
SHAFT_ELEMENTS = (SpeedSource, Fan, Inertia, Coupling, TorqueSource)
MACHINE_PORTS = ("machine.inlet", "machine.outlet", "machine.drain")


@final
@dataclass(frozen=True, kw_only=True)
class Circuit(KeyTable):
    """``[circuit]``: duration, start, elements by name and which are joined."""

    duration: float = quantity("s", "Simulated time.", above=0, high=1e5)
    initial_shaft_speed: float = quantity(
        "rpm", "Shaft speed at time zero.", low=-50000, high=50000, default=0.0
    )
    initial_pressure: float | None = quantity(
        "bar",
        "Absolute pressure of all volumes at time zero; default that of the first tank.",
        above=0,
        high=1000,
        default=None,
    )
    initial_shaft_angle: float = quantity(
        "deg", "Shaft angle at time zero.", low=-360, high=360, default=0.0
    )
    connections: tuple[tuple[str, str], ...] = items(
        Row(items=(Text(), Text())),
        "Pairs of element names or machine.inlet, machine.outlet, machine.drain.",
    )
    elements: Mapping[str, Any] = declare(
        Named(item=ELEMENT_KEY, beside=True, doc="Elements by name."), FrozenDict()
    )

    def __post_init__(self) -> None:
        # connections to unknown elements, and fluid elements that nothing joins
        fluid = [n for n, e in self.elements.items() if not isinstance(e, SHAFT_ELEMENTS)]
        allowed = [*fluid, *MACHINE_PORTS]
        joined = [name for pair in self.connections for name in pair]
        for name in joined:
            if name not in allowed:
                raise CaseError("connections", repr(name), f"one of {', '.join(allowed)}")
        for name in fluid:
            if name not in joined:
                raise CaseError(name, "an element without connection", "an entry in connections")
