r"""Hoses and lines: their keys, walls and cells, and the columns of fluid where waves run in them.

The volume flow q of a column of length l and area A between two nodes follows

.. math::

    L \dot q = p_a - p_b - R\,\phi(q)\,q - \sum_i g_i (q - z_i), \qquad
    \dot z_i = n_i (q - z_i), \qquad L = \rho l / A

with the laminar resistance R, its growth :math:`\phi` in turbulent flow and the branches
:math:`(n_i, g_i)` of :func:`toothspace.closures.line_friction.memory_branches`. The states of a
column are q, then all z; each branch acts like a spring of mass :math:`g_i/n_i`.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, final

import numpy as np

from toothspace.circuit.network import (
    FIRST_ROW,
    PORT_NODES,
    ROWS,
    CircuitElement,
    CircuitNetwork,
    CircuitNode,
    FluidPart,
    law_columns,
)
from toothspace.circuit.restrictions import Resistance
from toothspace.closures.density import liquid_bulk_modulus, mixture_density
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.line_friction import (
    CRITICAL_REYNOLDS,
    memory_branches,
    turbulent_growth,
)
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.compiled import kernel
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    choice,
    forbid,
    integer,
    number,
    quantity,
    require,
)
from toothspace.core.types import Array

_WALL_REFERENCE = 20e5
_IN_WALL = 0.02
SMALL_SHARE = 0.03


class FluidColumn(NamedTuple):
    """Inertia and friction of the fluid between two cells; its table are the branches of memory."""

    inertance: float
    """Pressure per change of flow. [kg/m4]"""
    resistance: float
    """Laminar pressure drop per flow. [Pa s/m3]"""
    critical_flow: float
    """Flow at a Reynolds number of 2300. [m3/s]"""


_INERTANCE, _RESISTANCE, _CRITICAL_FLOW = law_columns(FluidColumn)


@kernel
def column_drop(element: Array, flow: float) -> float:
    """Pressure drop of steady friction. [Pa]."""
    growth, _ = turbulent_growth(abs(flow) / element[_CRITICAL_FLOW])
    return element[_RESISTANCE] * growth * flow


@kernel
def fill_column(
    element: Array, tables: Array, drop: float, state: Array, place: int, rate: Array
) -> None:
    """Rates of flow and memory of a column whose states begin at a place."""
    first, count = int(element[FIRST_ROW]), int(element[ROWS])
    flow = state[place]
    drop -= column_drop(element, flow)
    for i in range(count):
        lag = flow - state[place + 1 + i]
        rate[place + 1 + i] = tables[first + i, 0] * lag
        drop -= tables[first + i, 1] * lag
    rate[place] = drop / element[_INERTANCE]


@kernel
def column_weight(element: Array, flow: float, tolerance: float) -> float:
    """Error allowed in flow and memory of a column. [m3/s]."""
    return tolerance * (abs(flow) + SMALL_SHARE * element[_CRITICAL_FLOW])


@kernel
def column_power(element: Array, tables: Array, drop: float, state: Array, place: int) -> float:
    """Rate at which the kinetic energy of a column grows: work less dissipation. [W]."""
    flow = state[place]
    power = flow * (drop - column_drop(element, flow))
    first = int(element[FIRST_ROW])
    for i in range(int(element[ROWS])):
        lag = flow - state[place + 1 + i]
        power -= tables[first + i, 1] * lag * lag
    return power


@kernel
def column_energy(element: Array, tables: Array, state: Array, place: int) -> float:
    """Kinetic energy of a column with its memory. [J]."""
    energy = 0.5 * element[_INERTANCE] * state[place] ** 2
    first = int(element[FIRST_ROW])
    for i in range(int(element[ROWS])):
        stiffness = tables[first + i, 1] / tables[first + i, 0]
        energy += 0.5 * stiffness * state[place + 1 + i] ** 2
    return energy


@kernel
def add_column(element: Array, tables: Array, state: Array, place: int, matrix: Array) -> float:
    """Add the derivatives of flow and memory by themselves; return that by the pressure drop."""
    growth, slope = turbulent_growth(abs(state[place]) / element[_CRITICAL_FLOW])
    slope *= abs(state[place]) / element[_CRITICAL_FLOW]
    inertance = element[_INERTANCE]
    matrix[place, place] -= element[_RESISTANCE] * (growth + slope) / inertance
    first = int(element[FIRST_ROW])
    for i in range(int(element[ROWS])):
        decay, resistance = tables[first + i, 0], tables[first + i, 1]
        memory = place + 1 + i
        matrix[place, place] -= resistance / inertance
        matrix[place, memory] += resistance / inertance
        matrix[memory, place] += decay
        matrix[memory, memory] -= decay
    return 1.0 / inertance


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

    @property
    def volume(self) -> float:
        """Fluid volume at zero pressure. [m3]."""
        return 0.25 * np.pi * self.bore**2 * self.length

    def wall_flexibility(self, fluid: FluidLaw) -> float:
        """Relative growth of the bore area per pressure. [1/Pa].

        From wall modulus and thickness as a thin tube, d/(E t); or what the effective bulk modulus
        leaves beside that of the liquid; zero of a rigid line.
        """
        if self.effective_bulk_modulus is not None:
            return 1.0 / self.effective_bulk_modulus - 1.0 / liquid_modulus(fluid)
        if self.wall_modulus is None or self.wall_thickness is None:
            return 0.0
        return self.bore / (self.wall_modulus * self.wall_thickness)

    def check_wall(self, fluid: FluidLaw, path: str) -> None:
        """Refuse a line that is stiffer than the liquid in it.

        Raises CaseError if the effective bulk modulus exceeds that of the liquid at its
        temperature.

        Parameters
        ----------
        path : str
            Table of the line in its case.
        """
        liquid, given = liquid_modulus(fluid), self.effective_bulk_modulus
        if given is not None and given > liquid:
            raise CaseError(
                f"{path}.effective_bulk_modulus",
                f"{given / 1e9:.4g} GPa",
                f"at most that of the liquid at its temperature, {liquid / 1e9:.4g} GPa; without "
                "the key the wall is rigid",
            )

    def end_cell(self, node: CircuitNode, fluid: FluidLaw) -> CircuitNode:
        """Node at an end, with its half of a cell."""
        volume = 0.5 * self.volume / self.cells
        return node.grown(volume, volume * self.wall_flexibility(fluid))

    def divided(
        self, name: str, ends: tuple[str, str], pressure: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        """Inner cells, joined by columns of fluid with the ends.

        Parameters
        ----------
        name, ends : str
            Name of the line, which its inner nodes carry, and the nodes at its ends.
        pressure : float
            Absolute pressure at the start, at which density and viscosity are taken. [Pa]
        """
        volume = self.volume / self.cells
        compliance = volume * self.wall_flexibility(fluid)
        inner = tuple(
            CircuitNode(f"{name}:{k}", pressure, volume, compliance) for k in range(1, self.cells)
        )
        names = [ends[0], *(node.name for node in inner), ends[1]]
        law, memory = self._column(pressure, fluid)
        columns = tuple(
            CircuitElement(law, a, b, table=memory, states=1 + len(memory))
            for a, b in pairwise(names)
        )
        return CircuitNetwork(inner, columns)

    def _column(self, pressure: float, fluid: FluidLaw) -> tuple[FluidColumn, Array]:
        """Law of one column and its memory: decay rate [1/s] and resistance [Pa s/m3]."""
        density = float(mixture_density(pressure, fluid.feed_gas_mass_fraction, fluid))
        diffusion = float(dynamic_viscosity(pressure, fluid)) / density
        radius, step = 0.5 * self.bore, self.length / self.cells
        inertance = density * step / (np.pi * radius**2)
        renewal = diffusion / radius**2
        # angular frequency of the shortest wave that the cells can carry
        compliance = 1.0 / liquid_modulus(fluid) + self.wall_flexibility(fluid)
        speed = 1.0 / np.sqrt(density * compliance)
        branches = memory_branches(float(2.0 * speed * self.cells / self.length) / renewal)
        law = FluidColumn(
            inertance,
            8.0 * renewal * inertance,
            0.5 * np.pi * radius * diffusion * CRITICAL_REYNOLDS,
        )
        return law, branches * [renewal, 4.0 * renewal * inertance]

    def characteristic_impedance(self, pressure: float, fluid: FluidLaw) -> float:
        """Pressure over flow of a wave in the line without friction, rho c / A. [Pa s/m3]."""
        density = float(mixture_density(pressure, fluid.feed_gas_mass_fraction, fluid))
        compliance = 1.0 / float(liquid_bulk_modulus(pressure, fluid)) + self.wall_flexibility(
            fluid
        )
        return float(np.sqrt(density / compliance) / (0.25 * np.pi * self.bore**2))


@final
@dataclass(frozen=True, kw_only=True)
class PortLine(Line):
    """``[operating_point.line]``: line with waves between working port and load or source."""

    def at_port(
        self, port: str, volume: float, pressure: float, far_end: str, fluid: FluidLaw
    ) -> CircuitNetwork:
        """Circuit of this line alone at a port of the machine.

        Parameters
        ----------
        port : str
            ``inlet`` of a motor or ``outlet`` of a pump.
        volume : float
            Fluid in that port. [m3]
        pressure : float
            Absolute pressure at the start, and of a far end that is held. [Pa]
        far_end : str
            ``supply`` or ``load``, which hold the pressure, or another name for a free end.
        """
        self.check_wall(fluid, "operating_point.line")
        ends = (far_end, port) if port == "inlet" else (port, far_end)
        parts = self.divided("line", ends, pressure, fluid)
        near = self.end_cell(CircuitNode(port, pressure, volume), fluid)
        far = CircuitNode(far_end, pressure)
        if far_end not in PORT_NODES:
            far = self.end_cell(far, fluid)
        return CircuitNetwork((near, far, *parts.nodes), parts.elements, supply_pressure=pressure)


@final
@dataclass(frozen=True, kw_only=True)
class Hose(Line, FluidPart):
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

    @property
    def ends(self) -> int:
        """Two places with waves, else one."""
        return 2 if self.carries_waves else 1

    def fill(self, node: CircuitNode, fluid: FluidLaw) -> CircuitNode:
        """Add the volume with the part of the wall that yields at once, or half a cell."""
        if self.carries_waves:
            return self.end_cell(node, fluid)
        wall = self.volume * self.wall_flexibility(fluid) / self.wall_stiffening
        return node.grown(self.volume, wall)

    def build(
        self, name: str, ends: tuple[str, str], start: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        r"""Cells and columns with waves, else the part of the wall that yields late.

        Notes
        -----
        Standard linear solid: the compliance :math:`C(1 - 1/s)` behind a resistance that fills it
        in the relaxation time, while the node of the hose keeps :math:`C/s`. A fiftieth of the
        fluid stands in the wall's node.

        References
        ----------
        .. [1] D. N. Johnston, T. M. Way, K. M. Cone, "Measured dynamic properties of flexible
           hoses", J. Vibration and Acoustics 132, 2010, 021011: dynamic bulk moduli of hoses are
           significantly and consistently above static ones.
        """
        self.check_wall(fluid, f"circuit.{name}")
        if self.carries_waves:
            return self.divided(name, ends, start, fluid)
        flexibility = self.wall_flexibility(fluid)
        late = self.volume * flexibility * (1.0 - 1.0 / self.wall_stiffening)
        if late <= 0.0:
            return CircuitNetwork()
        wall = CircuitNode(f"{name}:wall", start, _IN_WALL * self.volume, late)
        law = Resistance(self.wall_relaxation_time / late, 0.0)
        return CircuitNetwork((wall,), (CircuitElement(law, ends[0], wall.name),))


def liquid_modulus(fluid: FluidLaw) -> float:
    """Bulk modulus of the liquid in a line. [Pa]."""
    return float(liquid_bulk_modulus(_WALL_REFERENCE, fluid))
