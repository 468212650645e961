"""What holds fluid at a node: rigid volumes, accumulators and tanks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from toothspace.circuit.network import CircuitNode, FluidPart
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.errors import CaseError
from toothspace.core.keys import number, quantity


@dataclass(frozen=True, kw_only=True)
class Store(FluidPart):
    """Keys of an element with one end."""

    @property
    def ends(self) -> int:
        """One."""
        return 1


@final
@dataclass(frozen=True, kw_only=True)
class Volume(Store):
    """``kind = "volume"``: rigid volume of fluid."""

    volume: float = quantity("cm^3", "Volume.", above=0, high=1e6)

    def fill(self, node: CircuitNode, fluid: FluidLaw) -> CircuitNode:
        """Add the volume."""
        return node.grown(self.volume)


@final
@dataclass(frozen=True, kw_only=True)
class Accumulator(Store):
    """``kind = "accumulator"``: gas charge behind a bladder."""

    gas_volume: float = quantity("cm^3", "Volume of the charge.", above=0, high=1e6)
    precharge: float = quantity("bar", "Absolute pressure without fluid.", above=0, high=1000)
    gas_exponent: float = number("Polytropic exponent.", above=1, high=2, default=1.3)
    fluid_volume: float = quantity(
        "cm^3", "Fluid volume when empty.", above=0, high=1e6, default=10e-6
    )

    def fill(self, node: CircuitNode, fluid: FluidLaw) -> CircuitNode:
        """Add fluid and charge."""
        if node.gas_volume > 0.0:
            raise CaseError("circuit.connections", "two accumulators joined", "one")
        return replace(
            node.grown(self.fluid_volume),
            gas_volume=self.gas_volume,
            precharge=self.precharge,
            gas_exponent=self.gas_exponent,
        )


@final
@dataclass(frozen=True, kw_only=True)
class Tank(Store):
    """``kind = "tank"``: constant pressure."""

    pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
