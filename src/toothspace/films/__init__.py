"""Thin films: the average-flow Reynolds equation and the films of gear machines.

================ ==================================================================
module           responsibility
================ ==================================================================
:mod:`.reynolds` average-flow Reynolds equation on structured grids, cavitation, roughness
:mod:`.journal`  film between a shaft and its bush: loads, equilibrium, coefficients, orbits
:mod:`.plane`    films between nearly parallel faces: pads, rings, faces of gears and rotors
thermal          bulk heat balance of a film
field_files      NetCDF and VTK files of the fields
summaries        solved films to named numbers, and how far these depend on the grid
public           what ``toothspace.films`` offers
================ ==================================================================
"""

import importlib
from types import ModuleType


def _public() -> ModuleType:
    return importlib.import_module("toothspace.films.public")


def __getattr__(name: str) -> object:
    """Import a public name on first use: a run without solved films loads none of them."""
    if name.startswith("__"):
        raise AttributeError(name)
    return getattr(_public(), name)


def __dir__() -> list[str]:
    """List the public names."""
    return list(_public().__all__)
