"""Lateral films reduced to tables over the axial load on the floating bearing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.types import Array

_MARGIN = 0.1
"""Part of the range of a table by which a load may lie outside and takes the edge. [-]"""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LateralTable:
    """Friction and leakage beside the gears over force and moment on the floating bearing.

    Parameters
    ----------
    force : ndarray, shape (n,)
        Unbalanced axial force F_z, positive away from the gears, rising. [N]
    moment : ndarray, shape (m,)
        Unbalanced moment M_x about the middle of the face, rising; one where nothing tilts. [N m]
    extra_share : ndarray, shape (n, m)
        Torque at the shaft beyond that of the closed form, over it, both at the condition. [-]
    pressure_share : ndarray, shape (n, m)
        Part of the torque that does not depend on viscosity and speed, over the same. [-]
    leakage_factor : ndarray, shape (n, m)
        Leakage over that of the closed form; its logarithm is linear between the nodes. [-]
    condition_load : tuple of float
        Force [N] and moment [N m] at the condition that the table was made at.
    condition_slide : float
        Viscosity times shaft speed there. [Pa]
    """

    force: Array
    moment: Array
    extra_share: Array
    pressure_share: Array
    leakage_factor: Array
    condition_load: tuple[float, float]
    condition_slide: float

    def __call__(
        self, force: float, moment: float, slide: float | None = None
    ) -> tuple[float, float]:
        """Extra torque over the closed form and leakage factor at a force [N] and moment [N m].

        ``slide`` is viscosity times shaft speed [Pa], by default that of the condition. A load
        outside the table counts as its edge; :meth:`check` refuses it.
        """
        places = (_place(self.force, force), _place(self.moment, moment))
        leakage = float(np.exp(_bilinear(np.log(self.leakage_factor), *places)))
        extra = _bilinear(self.extra_share, *places)
        if slide is not None:
            # what does not grow with the speed is the less of a torque that does
            growth = self.condition_slide / slide - 1.0
            extra += growth * _bilinear(self.pressure_share, *places)
        return extra, leakage

    def force_of(self, factor: float, moment: float) -> float:
        """Force [N] at which films leak by a factor [-] more, at a moment [N m]; rising with it."""
        column = _place(self.moment, moment)
        found = [
            _bilinear(np.log(self.leakage_factor), float(i), column) for i in range(self.force.size)
        ]
        return float(np.interp(np.log(factor), np.maximum.accumulate(found), self.force))

    def check(self, force: float, moment: float) -> None:
        """Refuse a load far outside the table.

        Raises
        ------
        CaseError
            If the load lies outside by more than a tenth of its range.
        """
        _check(self.force, force, "F_z", "N")
        _check(self.moment, moment, "M_x", "N m")


def _place(nodes: Array, value: float) -> float:
    """Place between the nodes; outside counts as the edge."""
    return float(np.interp(value, nodes, np.arange(nodes.size)))


def _check(nodes: Array, value: float, name: str, unit: str) -> None:
    margin = _MARGIN * (nodes[-1] - nodes[0])
    if nodes.size > 1 and not nodes[0] - margin <= value <= nodes[-1] + margin:
        raise CaseError(
            f"run.film_tables: found {name} = {value:.5g} {unit} at this condition, allowed "
            f"{nodes[0]:.5g} to {nodes[-1]:.5g} {unit}: make tables near it"
        )


def _bilinear(values: Array, row: float, column: float) -> float:
    last_row, last_column = (n - 1 for n in values.shape)
    i, j = int(row), int(column)
    k, m = min(i + 1, last_row), min(j + 1, last_column)
    s, t = row - i, column - j
    low = (1.0 - t) * values[i, j] + t * values[i, m]
    high = (1.0 - t) * values[k, j] + t * values[k, m]
    return float((1.0 - s) * low + s * high)
