r"""The ledger: masses and energies over the evaluation window, and the table that closes.

Signs: ``shaft`` is work done by the shaft on the machine (positive in a pump, negative in
a motor), ``radial_load`` work of an external load on it; ``port_inlet`` is carried into the
machine, ``port_outlet`` and ``port_drain`` out of it, each as
:math:`\int \dot m\,h(p)\,\mathrm{d}t` with :math:`h = \int \mathrm{d}p/\rho` from one common
reference; a loss is positive when it dissipates, a change when the machine stores.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, final

MASS_ENTRIES: Mapping[str, str] = {
    "inlet": "into the machine through the inlet, or out of tanks into its circuit",
    "outlet": "out of the machine through the outlet, or out of its circuit into tanks",
    "drain": "out of the machine through an external drain",
    "stored_change": "increase of the mass inside",
}
"""Mass accounts. [kg]"""

BOUNDARY_ENTRIES: Mapping[str, str] = {
    "shaft": "shaft",
    "port_inlet": "inlet port",
    "port_outlet": "outlet port",
    "port_drain": "drain port",
    "radial_load": "external radial load on the shaft",
    "supply": "supply pumps of the circuit",
}
"""Energies that cross the boundary of the machine. [J]"""

LOSS_ENTRIES: Mapping[str, str] = {
    "journal_viscous": "journal bearings, viscous",
    "journal_asperity": "journal bearings, asperities",
    "lateral_viscous": "lateral films, viscous",
    "lateral_asperity": "lateral films, asperities",
    "tip_shear": "sealing gaps, shear",
    "mesh_friction": "mesh friction",
    "contact_friction": "contact friction",
    "contact_damping": "contact and structure damping",
    "shaft_seal": "shaft seal",
    "startup": "start-up friction",
    "gas_relaxation": "gas relaxation",
    "circuit": "valves, orifices and lines of the circuit",
    "coupling": "elastic coupling",
}
"""Energies dissipated besides those in the flow paths, which each machine names. [J]"""

CHANGE_ENTRIES: Mapping[str, str] = {
    "stored_change": "increase of stored energy",
    "kinetic_change": "increase of kinetic energy",
    "elastic_change": "increase of elastic energy",
}
"""Energies kept in the machine over the window. [J]"""

NOTE_ENTRIES: Mapping[str, str] = {
    "load_orifice": "dissipated in line and load, beyond the port",
    "trapped_volume": "trapping: groove and mesh throttling while a chamber is sealed",
}
"""Reported beside the balance, not further entries of it. [J]"""

ENERGY_ENTRIES: Mapping[str, str] = {
    **BOUNDARY_ENTRIES,
    **LOSS_ENTRIES,
    **CHANGE_ENTRIES,
    **NOTE_ENTRIES,
}
"""All energy accounts with a readable name. [J]"""

TRAPPED = "trapped_"
"""Before the account of a flow path: the part of its loss while a chamber is sealed. [J]"""

FRICTION_CAUSES: Mapping[str, tuple[str, ...]] = {
    "journal bearings": ("journal_viscous", "journal_asperity"),
    "faces of gears and bearings": ("lateral_viscous", "lateral_asperity"),
    "sealing gaps": ("tip_shear",),
    "mesh and contacts": ("mesh_friction", "contact_friction"),
    "shaft seal": ("shaft_seal",),
    "start-up": ("startup",),
}
"""Accounts of friction by interface."""


@final
@dataclass(frozen=True)
class Ledger:
    """Integrals over the evaluation window; an account that is missing counts as zero.

    Parameters
    ----------
    duration : float
        Length of the window. [s]
    shaft_angle : float
        Angle that the shaft turns in the window. [rad]
    mass : mapping
        Masses named as in :data:`MASS_ENTRIES`. [kg]
    energy : mapping
        Energies named as in :data:`ENERGY_ENTRIES` or by ``path_losses``. [J]
    path_losses : mapping
        Accounts of the losses in the machine's flow paths, with readable names.

    Raises
    ------
    KeyError
        If an account has an unknown name.
    """

    duration: float
    shaft_angle: float
    mass: Mapping[str, float]
    energy: Mapping[str, float]
    path_losses: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        known = {*ENERGY_ENTRIES, *self.path_losses, *(TRAPPED + k for k in self.path_losses)}
        unknown = (set(self.mass) - set(MASS_ENTRIES)) | (set(self.energy) - known)
        if unknown:
            raise KeyError(f"unknown ledger entries {sorted(unknown)}")

    @property
    def losses(self) -> Mapping[str, str]:
        """Accounts of all dissipated energies with readable names."""
        return {**self.path_losses, **LOSS_ENTRIES}

    @property
    def port_energy(self) -> float:
        """Hydraulic energy given to the fluid, out minus in, drain included. [J]."""
        out = self.energy.get("port_outlet", 0.0) + self.energy.get("port_drain", 0.0)
        return out - self.energy.get("port_inlet", 0.0)

    @property
    def fluid_energy(self) -> float:
        """Hydraulic energy given to the fluid less what supply pumps of a circuit bring. [J]."""
        return self.port_energy - self.energy.get("supply", 0.0)

    @property
    def shaft_energy(self) -> float:
        """Work of the shaft on the machine. [J]."""
        return self.energy.get("shaft", 0.0)

    @property
    def loss_energy(self) -> float:
        """Sum of all dissipated energies. [J]."""
        return sum(self.energy.get(name, 0.0) for name in self.losses)

    @property
    def kept_energy(self) -> float:
        """Growth of the energy in fluid, walls, motion and contacts. [J]."""
        return sum(self.energy.get(name, 0.0) for name in CHANGE_ENTRIES)

    @property
    def energy_remainder(self) -> float:
        """What the energy balance leaves unexplained. [J]."""
        work = self.shaft_energy + self.energy.get("radial_load", 0.0)
        return work - self.fluid_energy - self.loss_energy - self.kept_energy

    @property
    def mass_remainder(self) -> float:
        """What the mass balance leaves unexplained. [kg]."""
        out = sum(self.mass.get(name, 0.0) for name in ("outlet", "drain", "stored_change"))
        return self.mass.get("inlet", 0.0) - out

    @property
    def mass_balance_error(self) -> float:
        """Unexplained mass over the largest of inlet, outlet and stored mass. [-]."""
        scale = max(abs(self.mass.get(name, 0.0)) for name in ("inlet", "outlet", "stored_change"))
        return abs(self.mass_remainder) / scale if scale > 0.0 else 0.0

    @property
    def energy_balance_error(self) -> float:
        """Unexplained energy over the largest of shaft, port, supply and kept energy. [-].

        Where nothing is driven, as between tanks of one pressure, what was stored feeds the losses.
        """
        supply = self.energy.get("supply", 0.0)
        given = self.shaft_energy, self.port_energy, supply, self.kept_energy
        scale = max(abs(energy) for energy in given)
        return abs(self.energy_remainder) / scale if scale > 0.0 else 0.0


def ledger_from(
    quantities: Mapping[str, float],
    duration: float,
    shaft_angle: float,
    path_losses: Mapping[str, str] | None = None,
) -> Ledger:
    """Build a ledger from one flat mapping, where masses start with ``mass_``.

    Parameters
    ----------
    quantities : mapping
        ``mass_inlet`` ... [kg] and energies [J].
    duration : float
        Length of the window. [s]
    shaft_angle : float
        Angle that the shaft turns in the window. [rad]
    path_losses : mapping, optional
        Accounts of the losses in the machine's flow paths, with readable names.
    """
    mass = {k[5:]: float(v) for k, v in quantities.items() if k.startswith("mass_")}
    energy = {k: float(v) for k, v in quantities.items() if not k.startswith("mass_")}
    return Ledger(duration, shaft_angle, mass, energy, path_losses or {})


@final
@dataclass(frozen=True)
class LedgerRow:
    """One line of the power ledger."""

    name: str
    """Account."""
    label: str
    """Readable name."""
    kind: Literal["supplied", "delivered", "loss", "stored", "remainder"]
    """``supplied``, ``delivered``, ``loss``, ``stored`` or ``remainder``."""
    power: float
    """Mean power over the window, positive. [W]"""
    share: float
    """Power over the supplied power. [-]"""


def power_ledger(ledger: Ledger) -> list[LedgerRow]:
    """Return the ledger as mean powers; supplied = delivered + losses + stored + remainder.

    Supplied is the shaft in a pump and the fluid in a motor. Accounts that are zero are
    left out, except the remainder.
    """
    pumping = ledger.shaft_energy >= 0.0
    shaft = ("shaft", "shaft", abs(ledger.shaft_energy))
    fluid = ("ports", "fluid", ledger.fluid_energy * (1.0 if pumping else -1.0))
    supplied, delivered = (shaft, fluid) if pumping else (fluid, shaft)
    scale = supplied[2] if supplied[2] != 0.0 else 1.0

    def row(name: str, label: str, kind: str, energy: float) -> LedgerRow:
        power = energy / ledger.duration if ledger.duration > 0.0 else 0.0
        return LedgerRow(name, label, kind, power, energy / scale)  # type: ignore[arg-type]

    rows = [row(*supplied[:2], "supplied", supplied[2])]
    rows.append(row(*delivered[:2], "delivered", delivered[2]))
    losses = [(n, s, ledger.energy.get(n, 0.0)) for n, s in ledger.losses.items()]
    losses.sort(key=lambda entry: -entry[2])
    rows += [row(n, s, "loss", e) for n, s, e in losses if e != 0.0]
    changes = [(n, s, ledger.energy.get(n, 0.0)) for n, s in CHANGE_ENTRIES.items()]
    changes.append(
        ("radial_load", "work against the radial load", -ledger.energy.get("radial_load", 0.0))
    )
    rows += [row(n, s, "stored", e) for n, s, e in changes if e != 0.0]
    return [*rows, row("remainder", "unexplained remainder", "remainder", ledger.energy_remainder)]


@final
@dataclass(frozen=True)
class LossCause:
    """What one cause takes."""

    cause: str
    """``trapping``, ``throttling``, ``leakage``, ``friction`` or ``other``."""
    label: str
    """Where: gap, port or interface."""
    power: float
    """Mean power over the window. [W]"""
    share: float
    """Power over the supplied power. [-]"""
    account: str = ""
    """Account of a gap that leaks, empty for others."""


def loss_causes(ledger: Ledger) -> list[LossCause]:
    """Return all losses by cause; their sum is that of the ledger.

    What ports, grooves and flanks throttle while a chamber is sealed from both ports is trapping;
    a run over time does not tell it apart and books the flanks as throttling.
    """
    energy = ledger.energy
    told = "trapped_volume" in energy
    found = [("trapping", "fluid shut in the mesh", energy.get("trapped_volume", 0.0), "")]
    for account, label in ledger.path_losses.items():
        kind, where = label.split(", ", maxsplit=1)
        cause = "leakage" if told and not account.startswith("throttle_") else kind
        rest = energy.get(account, 0.0) - energy.get(TRAPPED + account, 0.0)
        found.append((cause, where, rest, account if cause == "leakage" else ""))
    for interface, accounts in FRICTION_CAUSES.items():
        found.append(("friction", interface, sum(energy.get(n, 0.0) for n in accounts), ""))
    booked = {name for accounts in FRICTION_CAUSES.values() for name in accounts}
    others = [name for name in LOSS_ENTRIES if name not in booked]
    found += [("other", LOSS_ENTRIES[name], energy.get(name, 0.0), "") for name in others]
    shaft = ledger.shaft_energy
    scale = (shaft if shaft >= 0.0 else -ledger.fluid_energy) or 1.0
    time = ledger.duration or 1.0
    return [
        LossCause(cause, label, value / time, value / scale, account)
        for cause, label, value, account in found
        if value != 0.0
    ]
