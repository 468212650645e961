"""What flow paths are booked under: name, label, colour, and what they do in the network.

Ports, grooves, faces and the drain are the same in every machine and stand here; a machine type
adds categories of its own for what seals its chambers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

PathRole = Literal[
    "inlet_port",
    "outlet_port",
    "inlet_groove",
    "outlet_groove",
    "mesh",
    "along",
    "lateral",
    "drain",
    "gap",
    "load",
    "circuit",
]
"""What a path does: opens a chamber to a port or groove, joins chambers, seals."""

OPENINGS: tuple[PathRole, ...] = ("inlet_port", "outlet_port", "inlet_groove", "outlet_groove")
"""Roles of paths that open chambers to ports."""

LEAKAGES: tuple[PathRole, ...] = ("mesh", "lateral", "drain", "gap")
"""Roles of paths through which fluid leaks to the low-pressure side."""


@final
@dataclass(frozen=True)
class PathCategory:
    """Account of the flow paths of one kind."""

    name: str
    """Name along the dimension ``path`` of results, for example ``lateral``."""
    label: str
    """Readable name, for example ``lateral gaps``."""
    colour: str
    """Colour in figures, ``#rrggbb``."""
    role: PathRole
    """``inlet_port``, ``outlet_port``, ``inlet_groove``, ``outlet_groove``: opens chambers to a
    port; ``mesh``: joins chambers that mesh with one another; ``along``: joins slices of one tooth
    space; ``lateral``: beside the faces of bodies, from chamber to chamber; ``drain``: from
    chambers to the drain; ``gap``: any other gap that seals; ``load``, ``circuit``: beyond the
    machine.
    """

    @property
    def account(self) -> str:
        """Name of its loss in the energy ledger."""
        return f"throttle_{self.name}" if self.role in OPENINGS else self.name

    @property
    def account_label(self) -> str:
        """Readable name of its loss in the energy ledger."""
        kind = "throttling" if self.role in (*OPENINGS, "mesh", "along") else "leakage"
        return f"{kind}, {self.label}"


INLET_PORT = PathCategory("inlet_port", "inlet port", "#0072B2", "inlet_port")
OUTLET_PORT = PathCategory("outlet_port", "outlet port", "#D55E00", "outlet_port")
INLET_GROOVE = PathCategory("inlet_groove", "inlet groove", "#56B4E9", "inlet_groove")
OUTLET_GROOVE = PathCategory("outlet_groove", "outlet groove", "#E69F00", "outlet_groove")
LATERAL = PathCategory("lateral", "lateral gaps", "#009E73", "lateral")
DRAIN = PathCategory("drain", "drain", "#8C6D46", "drain")
RIM = PathCategory("radial", "outer journal", "#9467A8", "gap")
LOAD_ORIFICE = PathCategory("load_orifice", "load", "#8A949E", "load")
CIRCUIT_ORIFICE = PathCategory("circuit_orifice", "circuit", "#8A949E", "circuit")

LATERAL_PATHS = (LATERAL, DRAIN)
"""Categories of the closed-form paths beside the faces of bodies."""
