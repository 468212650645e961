"""What is on the shaft: prescribed speed, or loads, inertias and a coupling."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.circuit.electric_drive import ElectricDrive
from toothspace.circuit.history import (
    NO_HISTORY,
    SpeedHistory,
    check_history,
    history,
    no_history,
    over_time,
)
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, QuantityKey, file_path, quantity
from toothspace.core.types import Array


@final
@dataclass(frozen=True, kw_only=True)
class SpeedSource(SpeedHistory):
    """``kind = "speed_source"``: prescribes the shaft speed."""


@final
@dataclass(frozen=True, kw_only=True)
class TorqueSource(KeyTable):
    """``kind = "torque_source"``: torque that the load takes from the shaft over time."""

    torque: tuple[tuple[float, float], ...] | None = over_time(
        QuantityKey(unit="N m", low=-1e5, high=1e5), "torque"
    )
    torque_file: Path | None = file_path("Columns time [s] and torque [N m].", ".csv", ".txt")

    def __post_init__(self) -> None:
        check_history(self, "torque")


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
class FreeShaft:
    """A shaft that turns as the torques on it let it, with all loads of a circuit."""

    inertia: float
    """Moment of inertia of load and shaft without the machine's bodies. [kg m2]"""
    linear: float = 0.0
    square: float = 0.0
    cubic: float = 0.0
    """Torque of the load: linear w + square w|w| + cubic w^3. [N m s], [N m s2], [N m s3]"""
    load_history: Array = field(default_factory=no_history)
    """Time [s] and further torque of the load [N m], joined by straight lines. Shape (knots, 2)."""
    coupling: Coupling | None = None
    """Elastic coupling between the machine and its load; None joins them rigidly."""


def shaft_of(parts: Iterable[Any]) -> FreeShaft | None:
    """The free shaft with its loads; None where a source prescribes its speed.

    Raises CaseError if more than one torque source or coupling is given, or a coupling that turns
    nothing.
    """
    parts = tuple(parts)
    if speed_of(parts) is not None:
        return None
    fans = [part for part in parts if isinstance(part, Fan)]
    source = _only(parts, TorqueSource, "torque sources")
    coupling = _only(parts, Coupling, "couplings")
    drive = _only(parts, ElectricDrive, "electric drives")
    if drive is not None and (source is not None or coupling is not None):
        other = "a torque source" if source is not None else "a coupling"
        raise CaseError("circuit", f"{other} and an electric drive", "one of them")
    turning = (Fan, Inertia, ElectricDrive)
    inertia = sum(part.inertia for part in parts if isinstance(part, turning))
    if coupling is not None and inertia <= 0.0:
        raise CaseError(
            "circuit",
            "a coupling without inertia beyond it",
            "one with a fan or an inertia above 0 kg m^2",
        )
    # a drive starts where its controller leads it
    load = NO_HISTORY if drive is None else np.zeros((1, 2))
    return FreeShaft(
        inertia=inertia,
        linear=sum(fan.linear for fan in fans),
        square=sum(fan.quadratic for fan in fans),
        cubic=sum(fan.cubic for fan in fans),
        load_history=load if source is None else history(source, "torque", "N m"),
        coupling=coupling,
    )


def speed_of(parts: Iterable[Any]) -> Array | None:
    """Prescribed shaft speed over time, None where the shaft is free. [s], [rad/s]."""
    parts = tuple(parts)
    source = _only(parts, SpeedSource, "speed sources")
    for kind, name in ((Coupling, "a coupling"), (ElectricDrive, "an electric drive")):
        if source is not None and any(isinstance(part, kind) for part in parts):
            raise CaseError("circuit", f"{name} and a speed source", "one of them")
    return None if source is None else source.speed_over_time


def _only(parts: Iterable[Any], kind: type, name: str) -> Any:
    """The only element of a kind, None where there is none."""
    found = [part for part in parts if isinstance(part, kind)]
    if len(found) > 1:
        raise CaseError("circuit", f"two {name}", "one")
    return found[0] if found else None
