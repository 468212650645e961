"""Influence matrix of a body: deformation of its film surfaces per load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.sparse as sp

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, IntArray
from toothspace.elasticity.body import ElasticBody


@final
@dataclass(frozen=True, eq=False)
class InfluenceMatrix:
    r"""Deformation of film surfaces per load.

    Displacements are those of the surface into the body, so they open the film; pressures press
    into the body. Those of a floating body are relative to its motion as a rigid body.

    Notes
    -----
    :math:`u = C \lambda + \sum_k D_k q_k` with nodal loads
    :math:`\lambda_i = \int \phi_i p\,\mathrm dA`. :math:`C` is symmetric and positive
    semidefinite.
    """

    body: ElasticBody = field(repr=False)
    """What was condensed."""
    nodes: Array = field(repr=False)
    """Places of the nodes on their surfaces, shape (n, 2). [m], or [rad] and [m]"""
    surface: IntArray = field(repr=False)
    """Index of the film surface that a node belongs to, shape (n,)."""
    compliance: Array = field(repr=False)
    """C, shape (n, n). [m/N]"""
    load_cases: dict[str, Array] = field(repr=False)
    """D, deformation per unit of each named load, shape (n,). [m/Pa] or [m/N]"""
    resultants: dict[str, Array] = field(repr=False)
    """Force and moment about the centre of mass of each unit load. [N, N m per unit]"""
    rigid_modes: Array = field(repr=False)
    """Displacement by unit translations along and rotations about x, y, z, shape (n, 6). [-, m]"""
    mass: float
    """Mass. [kg]"""
    center_of_mass: Array
    """Centre of mass. [m]"""
    element_count: int
    """Elements of the mesh. [-]"""
    error_estimate: float
    """Largest error of the deformation over its span, from a coarser mesh; NaN if not asked. [-]"""

    def of(self, surface: str) -> slice:
        """Nodes of a film surface, by its name."""
        names = [film.name for film in self.body.films]
        if surface not in names:
            raise GeometryError("elastic body", f"surface {surface!r}", f"are {names}")
        place = np.flatnonzero(self.surface == names.index(surface))
        return slice(int(place[0]), int(place[-1]) + 1)

    def interpolation(self, surface: str, points: Array) -> sp.csr_matrix:
        """Matrix from the nodes of a surface to points on it; its transpose gathers loads.

        Parameters
        ----------
        points : ndarray, shape (k, 2) or (k, 3)
            Places in the frame of the body. [m]
        """
        names = [film.name for film in self.body.films]
        self.of(surface)
        return self.body.films[names.index(surface)].interpolation(points)

    def deformation(self, nodal_loads: Array, loads: Mapping[str, float] | None = None) -> Array:
        """Displacement of the nodes into the body. [m].

        Parameters
        ----------
        nodal_loads : ndarray, shape (n,)
            Loads of the films at the nodes. [N]
        loads : mapping of str to float, optional
            Size of named loads. [Pa] or [N]
        """
        out = self.compliance @ nodal_loads
        for name, size in (loads or {}).items():
            out = out + size * self.load_cases[name]
        return np.asarray(out)

    def resultant(self, nodal_loads: Array, loads: Mapping[str, float] | None = None) -> Array:
        """Force and moment about the centre of mass of film loads and named loads. [N, N m]."""
        out = self.rigid_modes.T @ nodal_loads
        for name, size in (loads or {}).items():
            out = out + size * self.resultants[name]
        return np.asarray(out)
