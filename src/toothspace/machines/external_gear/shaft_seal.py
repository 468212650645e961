"""Torque of the shaft seal: a number, or from a table of the force at its lip."""

from __future__ import annotations

from toothspace.core.errors import CaseError
from toothspace.core.signals import read_grid
from toothspace.machines.external_gear.parameter_tables import SealParameters

_COLUMNS = {"temperature": "degC", "penetration": "mm", "friction_force": "N"}


def seal_torque(seals: SealParameters | None, shaft_diameter: float) -> float:
    """Torque of the seal; with a table the bilinear force at its condition times the radius. [N m].

    Parameters
    ----------
    seals : SealParameters or None
        Keys of ``[machine.seals]``.
    shaft_diameter : float
        Diameter under the lip. [m]

    Raises
    ------
    CaseError
        If the table is no full grid, or the condition lies outside it.

    Notes
    -----
    Force over temperature and penetration as Nikas and Sayles (2006) give it for seals.
    """
    if seals is None:
        return 0.0
    if seals.table is None:
        return seals.shaft_seal_torque or 0.0
    from scipy.interpolate import RegularGridInterpolator

    *axes, values = read_grid(seals.table, _COLUMNS)
    for name, axis in zip(("temperature", "penetration"), axes, strict=True):
        asked = getattr(seals, name)
        if not axis[0] <= asked <= axis[-1]:
            allowed = f"{axis[0]:.6g} to {axis[-1]:.6g} in SI units, the range of the table"
            raise CaseError(f"seals.{name}", f"{asked:.6g}", allowed)
    force = RegularGridInterpolator(axes, values)([[seals.temperature, seals.penetration]])
    return float(force[0]) * 0.5 * shaft_diameter
