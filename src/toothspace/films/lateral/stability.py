"""Small motions that grow from an equilibrium of bearings and gears."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eig

from toothspace.core.types import Array, ComplexArray
from toothspace.films.lateral.motion import Balance, Loads, levers_of
from toothspace.films.lateral.stack import Stack
from toothspace.films.lateral.stops import stop_forces

_ROUNDING = 1e-5
"""Growth over the fastest decay below which it counts as none. [-]"""
_UNDAMPED = 1e-12
"""Damping over the largest from which it is rounding. [-]"""


def growing_motion(stack: Stack, balance: Balance, loads: Loads) -> tuple[float, Array]:
    """Fastest growth of a motion that tips bodies in equilibrium, and its shape.

    Parameters
    ----------
    balance : Balance
        Equilibrium with its Jacobian; bearings that friction holds take no part.
    loads : Loads
        Friction in the housing.

    Returns
    -------
    tuple
        Rate [1/s], zero if every motion decays, and coordinates with the largest one. [m, rad]

    Notes
    -----
    With the films' damping D and the stiffness K of films and stops small motions follow
    D dq/dt = -K q; masses play no part. What turns carries its film along: K is not symmetric and
    motions circle. Those that circle faster than they grow do not tip a body, and are left out,
    as are those that no film damps: a cover holds all that moves together.
    """
    assert balance.jacobian is not None
    stiffness = balance.jacobian[0] + stop_forces(stack, balance.position)[1]
    basis = _moving(stack, balance, loads) / stack.arms[:, None]
    rates, shapes = _modes(basis.T @ stiffness @ basis, basis.T @ balance.jacobian[1] @ basis)
    tipping = np.where(np.abs(rates.imag) < rates.real, rates.real, -np.inf)
    k = int(np.argmax(tipping))
    fastest = float(np.abs(rates).max())
    if tipping[k] <= _ROUNDING * fastest:
        return 0.0, np.zeros(stack.size)
    return float(rates[k].real), basis @ shapes[:, k].real


def _modes(stiffness: Array, damping: Array) -> tuple[ComplexArray, ComplexArray]:
    """Rates [1/s] of the damped motions, and their shapes as columns."""
    (force, drag), shapes = eig(-stiffness, damping, homogeneous_eigvals=True)
    damped = np.abs(drag) > _UNDAMPED * np.abs(drag).max()
    return force[damped] / drag[damped], shapes[:, damped]


def _moving(stack: Stack, balance: Balance, loads: Loads) -> Array:
    """Motions of the free coordinates that leave bearings where friction holds them."""
    every = np.eye(stack.size)[:, stack.free]
    if not loads.friction.holds or loads.friction.coulomb_force == 0.0:
        return every
    bars = zip(levers_of(stack), balance.slides, strict=True)
    held = [lever @ every for lever, slides in bars if slides == 0]
    if not held:
        return every
    left = np.linalg.svd(np.array(held))[2][len(held) :]
    return np.asarray(every @ left.T)
