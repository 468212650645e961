"""Lines of a circuit: compliance of their walls, and their cells where waves run in them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import final

import numpy as np

from toothspace.case.circuit import Hose, Line, PortLine
from toothspace.closures.bulk_modulus import liquid_bulk_modulus
from toothspace.closures.density import mixture_density
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.line_friction import CRITICAL_REYNOLDS, memory_branches
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.errors import CaseError
from toothspace.model.circuit_description import CircuitElement, CircuitNetwork, CircuitNode
from toothspace.model.ledger import PORT_NODES

_WALL_REFERENCE = 20e5
_IN_WALL = 0.02


@final
@dataclass(frozen=True)
class LineCell:
    """Part of a line: fluid volume at zero pressure [m3], its growth per pressure [m3/Pa]."""

    volume: float
    wall_compliance: float


@final
@dataclass(frozen=True)
class LineParts:
    """Inner nodes of a line, and the columns of fluid between all its nodes."""

    nodes: tuple[CircuitNode, ...]
    columns: tuple[CircuitElement, ...]


def wall_flexibility(hose: Line, fluid: FluidLaw) -> float:
    """Relative growth of the bore area of a hose per pressure. [1/Pa].

    From wall modulus and thickness as a thin tube, d/(E t); or what the effective bulk modulus
    leaves beside that of the liquid; zero of a rigid line.
    """
    if hose.effective_bulk_modulus is not None:
        return 1.0 / hose.effective_bulk_modulus - 1.0 / liquid_modulus(fluid)
    if hose.wall_modulus is None or hose.wall_thickness is None:
        return 0.0
    return hose.bore / (hose.wall_modulus * hose.wall_thickness)


def liquid_modulus(fluid: FluidLaw) -> float:
    """Bulk modulus of the liquid in a line. [Pa]."""
    return float(liquid_bulk_modulus(_WALL_REFERENCE, fluid))


def check_wall(hose: Line, fluid: FluidLaw, path: str) -> None:
    """Refuse a line that is stiffer than the liquid in it.

    Parameters
    ----------
    path : str
        Table of the line in its case.

    Raises
    ------
    CaseError
        If the effective bulk modulus exceeds that of the liquid at its temperature.
    """
    liquid, given = liquid_modulus(fluid), hose.effective_bulk_modulus
    if given is not None and given > liquid:
        raise CaseError(
            f"{path}.effective_bulk_modulus",
            f"{given / 1e9:.4g} GPa",
            f"at most that of the liquid at its temperature, {liquid / 1e9:.4g} GPa; without the "
            "key the wall is rigid",
        )


def relaxed_wall(name: str, node: CircuitNode, hose: Hose, fluid: FluidLaw) -> LineParts:
    r"""Part of the wall of a hose that yields late, behind a resistance.

    Parameters
    ----------
    node : CircuitNode
        Node that the hose belongs to.
    hose : Hose
        Hose with ``wall_stiffening`` s and ``wall_relaxation_time``.

    Returns
    -------
    LineParts
        Node of the compliance :math:`C(1 - 1/s)` and the resistance that fills it in the
        relaxation time; the node of the hose keeps :math:`C/s`.

    Notes
    -----
    Standard linear solid. A fiftieth of the fluid stands in the wall's node.

    References
    ----------
    .. [1] D. N. Johnston, T. M. Way, K. M. Cone, "Measured dynamic properties of flexible hoses",
       J. Vibration and Acoustics 132, 2010, 021011: dynamic bulk moduli of hoses are
       significantly and consistently above static ones.
    """
    volume = 0.25 * np.pi * hose.bore**2 * hose.length
    late = volume * wall_flexibility(hose, fluid) * (1.0 - 1.0 / hose.wall_stiffening)
    wall = CircuitNode(f"{name}:wall", node.pressure, _IN_WALL * volume, late)
    resistance = hose.wall_relaxation_time / late
    column = CircuitElement("resistance", node.name, wall.name, (resistance, 0.0))
    return LineParts((wall,), (column,))


def end_cell(hose: Line, fluid: FluidLaw) -> LineCell:
    """Half a cell, which belongs to the node at either end."""
    volume = 0.125 * np.pi * hose.bore**2 * hose.length / hose.cells
    return LineCell(volume, volume * wall_flexibility(hose, fluid))


def line_parts(
    name: str, hose: Line, ends: tuple[str, str], pressure: float, fluid: FluidLaw
) -> LineParts:
    """Divide a line into cells joined by columns of fluid.

    Parameters
    ----------
    name, ends : str
        Name of the line, which its inner nodes carry, and the nodes at its ends.
    pressure : float
        Absolute pressure at the start, at which density and viscosity are taken. [Pa]
    """
    half = end_cell(hose, fluid)
    inner = tuple(
        CircuitNode(f"{name}:{k}", pressure, 2.0 * half.volume, 2.0 * half.wall_compliance)
        for k in range(1, hose.cells)
    )
    names = [ends[0], *(node.name for node in inner), ends[1]]
    columns = _columns(hose, names, pressure, fluid)
    return LineParts(inner, columns)


def line_at_port(
    line: PortLine, port: str, volume: float, pressure: float, far_end: str, fluid: FluidLaw
) -> CircuitNetwork:
    """Circuit of one line at a port of the machine.

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
    check_wall(line, fluid, "operating_point.line")
    ends = (far_end, port) if port == "inlet" else (port, far_end)
    parts, half = line_parts("line", line, ends, pressure, fluid), end_cell(line, fluid)
    held = far_end in PORT_NODES
    near = CircuitNode(port, pressure, volume + half.volume, half.wall_compliance)
    far = CircuitNode(far_end, pressure, *((0.0,) if held else (half.volume, half.wall_compliance)))
    return CircuitNetwork((near, far, *parts.nodes), parts.columns, supply_pressure=pressure)


def _columns(
    hose: Line, names: list[str], pressure: float, fluid: FluidLaw
) -> tuple[CircuitElement, ...]:
    gas = fluid.feed_gas_mass_fraction
    density = float(mixture_density(pressure, gas, fluid))
    diffusion = float(dynamic_viscosity(pressure, fluid)) / density
    radius, step = 0.5 * hose.bore, hose.length / hose.cells
    inertance = density * step / (np.pi * radius**2)
    renewal = diffusion / radius**2
    # angular frequency of the shortest wave that the cells can carry
    compliance = 1.0 / liquid_modulus(fluid) + wall_flexibility(hose, fluid)
    speed = 1.0 / np.sqrt(density * compliance)
    branches = memory_branches(float(2.0 * speed * hose.cells / hose.length) / renewal)
    law = (
        inertance,
        8.0 * renewal * inertance,
        0.5 * np.pi * radius * diffusion * CRITICAL_REYNOLDS,
    )
    memory = branches * [renewal, 4.0 * renewal * inertance]
    return tuple(
        CircuitElement("fluid_column", a, b, law, memory=memory) for a, b in pairwise(names)
    )


def characteristic_impedance(line: Line, pressure: float, fluid: FluidLaw) -> float:
    """Pressure over flow of a wave in a line without friction, rho c / A. [Pa s/m3]."""
    density = float(mixture_density(pressure, fluid.feed_gas_mass_fraction, fluid))
    compliance = 1.0 / float(liquid_bulk_modulus(pressure, fluid)) + wall_flexibility(line, fluid)
    return float(np.sqrt(density / compliance) / (0.25 * np.pi * line.bore**2))
