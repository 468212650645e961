"""``[circuit]``: named elements and their connections, for transient runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, final

from toothspace.core.keys import (
    Items,
    KeyRuleError,
    Quantity,
    Row,
    Text,
    Variant,
    choice,
    declare,
    file_path,
    forbid,
    number,
    quantity,
    require,
    table,
)

_SPEED_OVER_TIME = Items(
    item=Row(
        items=(
            Quantity(unit="s", low=0, high=1e6),
            Quantity(unit="rpm", low=-50000, high=50000),
        )
    ),
    low=1,
    doc="Pairs of time and speed, joined by straight lines.",
)


@final
@dataclass(frozen=True, kw_only=True)
class EfficiencyLine:
    """Volumetric efficiency that falls linearly with the pressure difference."""

    offset: float = number("Value at zero pressure difference.", above=0, high=1)
    per_100_bar: float = number("Change per 100 bar.", low=-1, high=1, default=0.0)


def _check_history(owner: Any) -> None:
    if owner.speed_file is None:
        require(owner, "unless speed_file is given", "speed")
        times = [row[0] for row in owner.speed]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise KeyRuleError("speed", f"times {times}", "times that increase")
    else:
        forbid(owner, "because speed_file is given", "speed")


@final
@dataclass(frozen=True, kw_only=True)
class SpeedSource:
    """``kind = "speed_source"``: prescribes the shaft speed."""

    speed: tuple[tuple[float, float], ...] | None = declare(_SPEED_OVER_TIME, None)
    speed_file: Path | None = file_path("Columns time and speed.", ".csv", ".txt")

    def __post_init__(self) -> None:
        _check_history(self)


@final
@dataclass(frozen=True, kw_only=True)
class PumpMap:
    """``kind = "pump_map"``: supply pump with a map of volumetric efficiency."""

    displacement: float = quantity("cm^3/rev", "Displacement.", above=0, high=10000)
    speed: tuple[tuple[float, float], ...] | None = declare(_SPEED_OVER_TIME, None)
    speed_file: Path | None = file_path("Columns time and speed.", ".csv", ".txt")
    volumetric_efficiency: EfficiencyLine = table(
        EfficiencyLine, "Efficiency over pressure.", default=EfficiencyLine(offset=1.0)
    )
    table: Path | None = file_path("Map of volumetric efficiency.", ".csv")

    def __post_init__(self) -> None:
        _check_history(self)


@final
@dataclass(frozen=True, kw_only=True)
class Hose:
    """``kind = "hose"``: line with fluid inertia, friction and wall compliance."""

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
    model: str = choice("One volume, or waves.", "lumped", "transmission_line", default="lumped")

    def __post_init__(self) -> None:
        names = ("wall_thickness", "wall_modulus")
        if self.effective_bulk_modulus is None:
            require(self, "unless effective_bulk_modulus is given", *names)
        else:
            forbid(self, "because effective_bulk_modulus is given", *names)


@final
@dataclass(frozen=True, kw_only=True)
class Volume:
    """``kind = "volume"``: rigid volume of fluid."""

    volume: float = quantity("cm^3", "Volume.", above=0, high=1e6)


@final
@dataclass(frozen=True, kw_only=True)
class Orifice:
    """``kind = "orifice"``: sharp-edged restriction."""

    diameter: float | None = quantity("mm", "Diameter.", above=0, high=200, default=None)
    area: float | None = quantity("mm^2", "Area.", above=0, high=1e5, default=None)
    discharge_coefficient: float = number("Discharge coefficient.", above=0, high=1, default=0.7)

    def __post_init__(self) -> None:
        if self.diameter is None:
            require(self, "unless diameter is given", "area")
        else:
            forbid(self, "because diameter is given", "area")


@final
@dataclass(frozen=True, kw_only=True)
class ReliefValve:
    """``kind = "relief_valve"``: opens above a pressure difference."""

    opening_pressure: float = quantity("bar", "Pressure difference.", above=0, high=1000)
    gradient: float = quantity(
        "bar s/L", "Pressure rise per flow once open.", above=0, high=1e4, default=1.2e9
    )


@final
@dataclass(frozen=True, kw_only=True)
class Fan:
    """``kind = "fan"``: load on the shaft, torque = linear speed + cubic speed^3."""

    linear: float = quantity("N m/rpm", "Torque per speed.", low=0, high=100, default=0.0)
    cubic: float = quantity("N m s^3/rad^3", "Torque per speed cubed.", low=0, high=1, default=0.0)
    inertia: float = quantity("kg m^2", "Moment of inertia.", low=0, high=1000, default=0.0)


@final
@dataclass(frozen=True, kw_only=True)
class Inertia:
    """``kind = "inertia"``: rotating mass on the shaft."""

    inertia: float = quantity("kg m^2", "Moment of inertia.", above=0, high=1000)


@final
@dataclass(frozen=True, kw_only=True)
class Tank:
    """``kind = "tank"``: constant pressure."""

    pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)


ELEMENTS: Mapping[str, type] = {
    "speed_source": SpeedSource,
    "pump_map": PumpMap,
    "hose": Hose,
    "volume": Volume,
    "orifice": Orifice,
    "relief_valve": ReliefValve,
    "fan": Fan,
    "inertia": Inertia,
    "tank": Tank,
}
"""Circuit elements by the value of their key ``kind``."""

ELEMENT_KEY = Variant(tag="kind", variants=ELEMENTS, doc="Circuit element.")
SHAFT_ELEMENTS = (SpeedSource, Fan, Inertia)
MACHINE_PORTS = ("machine.inlet", "machine.outlet", "machine.drain")


@final
@dataclass(frozen=True, kw_only=True)
class Circuit:
    """``[circuit]``: duration, start, elements by name and which are joined."""

    duration: float = quantity("s", "Simulated time.", above=0, high=1e5)
    initial_shaft_speed: float = quantity(
        "rpm", "Shaft speed at time zero.", low=-50000, high=50000, default=0.0
    )
    connections: tuple[tuple[str, str], ...] = declare(
        Items(
            item=Row(items=(Text(), Text())),
            doc="Pairs of element names or machine.inlet, machine.outlet, machine.drain.",
        )
    )
    elements: Mapping[str, Any] = field(default_factory=dict)

    def check_connections(self) -> None:
        """Refuse connections to unknown elements, and fluid elements that nothing joins.

        Raises
        ------
        KeyRuleError
            With the name concerned.
        """
        fluid = [n for n, e in self.elements.items() if not isinstance(e, SHAFT_ELEMENTS)]
        allowed = [*fluid, *MACHINE_PORTS]
        joined = [name for pair in self.connections for name in pair]
        for name in joined:
            if name not in allowed:
                raise KeyRuleError("connections", repr(name), f"one of {', '.join(allowed)}")
        for name in fluid:
            if name not in joined:
                raise KeyRuleError(name, "an element without connection", "an entry in connections")
