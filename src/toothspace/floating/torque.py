"""Torque of the lateral films in the equations of the lumped machine."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.floating.motion import Balance
from toothspace.model.description import LumpedLateralFilm, MachineDescription
from toothspace.model.path_category import LATERAL_PATHS

if TYPE_CHECKING:
    import xarray as xr

_FRICTION = ("lateral_viscous", "lateral_asperity")


def lumped_torque(data: xr.Dataset) -> float:
    """Torque at the shaft that the faces of a lumped run ask for, mean of its samples. [N m].

    Friction, and the work of the faces that drag fluid to higher pressure.
    """
    friction = data["torque_loss"].sel(mechanism=list(_FRICTION)).sum("mechanism")
    return float(friction.mean()) + _drag_torque(data)


def with_film_torque(
    description: MachineDescription, viscosity: float, data: xr.Dataset, balance: Balance
) -> MachineDescription:
    """Give the faces of a lumped machine the torque of solved films.

    Parameters
    ----------
    viscosity : float
        Viscosity that its films are sheared with. [Pa s]
    data : xarray.Dataset
        Samples of its last run, with the torque that dragged fluid asks for already.
    balance : Balance
        Films in equilibrium, a state for every shaft angle.

    Notes
    -----
    The power of every body's films at its present speed becomes its drag. What the lateral paths
    of the run ask for by drag against pressure is part of that power, and is left out.
    """
    stack = balance.states[0].stack
    powers: dict[str, Array] = {}
    for state in balance.states:
        for own, gap in zip(state.films, state.mean_gaps(), strict=True):
            lost = own.losses
            sides = sum(f.grid.interface.body == own.grid.interface.body for f in state.films)
            entry = np.array([lost.shear, lost.asperity, gap / sides]) / len(balance.states)
            body = own.grid.interface.body
            powers[body] = powers.get(body, np.zeros(3)) + entry
    doubled = _drag_torque(data) * stack.shaft_speed / len(powers)
    ratios = {body.name: body.speed_ratio for body in description.bodies}

    def dragged(film: LumpedLateralFilm) -> LumpedLateralFilm:
        if film.body not in powers:
            return film
        shear, asperity, height = powers[film.body]
        power = shear + asperity - doubled
        speed = ratios[film.body] * stack.shaft_speed
        drag = power / (film.faces * viscosity * film.viscosity_ratio * speed**2)
        share = asperity / power if asperity > 0.0 else 0.0
        return replace(film, drag=drag, asperity_share=share, height=height)

    return replace(description, laterals=tuple(map(dragged, description.laterals)))


def pressure_torque(balance: Balance) -> float:
    """Torque at the shaft that does not depend on viscosity and speed. [N m].

    Drag of the flow that pressure drives along the faces, and asperities; mean over the states.
    """
    lost = [film.losses for state in balance.states for film in state.films]
    power = sum(one.drag + one.asperity for one in lost) / len(balance.states)
    return power / balance.states[0].stack.shaft_speed


def _drag_torque(data: xr.Dataset) -> float:
    """Torque at the shaft of the drag of all lateral paths against pressure. [N m]."""
    return float(data["drag_torque"].sel(path=[c.name for c in LATERAL_PATHS]).sum("path").mean())
