r"""One accepted step of the stiff integrator: Newton iteration, error, step and order.

Numerical differentiation formulas of order 1 to 5 in backward differences,

.. math:: \sum_{m=1}^{k} \frac{1}{m} \nabla^m y_{n+1}
          - \kappa_k \gamma_k (y_{n+1} - y^{(0)}_{n+1}) = h f(t_{n+1}, y_{n+1}).

References
----------
.. [1] L. F. Shampine and M. W. Reichelt, "The MATLAB ODE suite", SIAM J. Sci. Comput. 18
   (1997) 1-22, table 1 and section 2.
.. [2] A. C. Hindmarsh et al., "SUNDIALS", ACM Trans. Math. Softw. 31 (2005) 363-396,
   section 2.1 (correction of an iteration matrix with an old step).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.types import Array
from toothspace.numerics.dense_output import change_step
from toothspace.numerics.ndf_types import (
    DONE,
    MAX_STEPS,
    NOT_FINITE,
    STEP_TOO_SMALL,
    Compiled,
    NdfCallbacks,
    NdfSettings,
    NdfState,
    kernel,
)
from toothspace.numerics.static_lu import SINGULAR, LuProgram, factorise, ledger_product, solve

HARMONIC = (0.0, 1.0, 3.0 / 2.0, 11.0 / 6.0, 25.0 / 12.0, 137.0 / 60.0)
"""Sums of 1/m up to the order: gamma_k of [1]_."""

KAPPA = (0.0, -0.1850, -1.0 / 9.0, -0.0823, -0.0415, 0.0)
"""Coefficients kappa_k of [1]_, table 1."""

ERROR_CONSTANT = (
    1.0,
    0.1850 * -1.0 + 0.5,
    -1.0 / 9.0 * 1.5 + 1.0 / 3.0,
    -0.0823 * 11.0 / 6.0 + 0.25,
    -0.0415 * 25.0 / 12.0 + 0.2,
    1.0 / 6.0,
    1.0 / 7.0,
)
"""Error over the (k+1)-th backward difference: kappa_k gamma_k + 1/(k+1)."""

NEWTON_LIMIT = 4
FIRST_TOLERANCE = 0.1
LATER_TOLERANCE = 0.3
REFACTOR_CHANGE = 0.2
JACOBIAN_AGE = 30
SLOW_RATE = 0.3
FRESH_RATE = 0.2
RESET_RATE = 0
RATE_MEMORY = 0.3
SAFETY = (1.4, 1.35, 1.5)
LEAST_GROWTH = 1.15
LEAST_CUT = 0.9
MOST_GROWTH = 8.0


@kernel
def error_norm(vector: Array, inverse_weights: Array, max_share: float) -> float:
    """Return the blend of root mean square and maximum of vector over weights, [-]."""
    squares = 0.0
    largest = 0.0
    n = inverse_weights.size
    for i in range(n):
        value = vector[i] * inverse_weights[i]
        squares += value * value
        largest = max(largest, abs(value))
    return (1.0 - max_share) * np.sqrt(squares / n) + max_share * largest


@kernel
def _apply_plan(state: NdfState) -> None:
    control = state.control[0]
    if control.next_step != control.step or control.next_order != control.order:
        control.order = control.next_order
        change_step(
            state.differences, control.order, control.next_step / control.step, state.change
        )
        control.step = control.next_step
        control.equal_steps = 0


@kernel
def _cut_step(state: NdfState, ratio: float) -> None:
    control = state.control[0]
    control.next_step = ratio * control.step
    _apply_plan(state)


@kernel
def _predict(state: NdfState) -> None:
    """Fill work rows: 0 predicted state, 1 constant part of the formula."""
    control = state.control[0]
    differences = state.differences
    order = control.order
    predicted, constant = state.work[0], state.work[1]
    inverse_alpha = 1.0 / ((1.0 - KAPPA[order]) * HARMONIC[order])
    weight = HARMONIC[1] * inverse_alpha
    for i in range(predicted.size):
        predicted[i] = differences[0, i] + differences[1, i]
        constant[i] = weight * differences[1, i]
    for j in range(2, order + 1):
        weight = HARMONIC[j] * inverse_alpha
        for i in range(predicted.size):
            predicted[i] += differences[j, i]
            constant[i] += weight * differences[j, i]


@kernel
def _prepare_matrix(program: LuProgram, state: NdfState, gamma: float) -> bool:
    """Factorise if gamma moved away from that of the factors; False if that is impossible."""
    control = state.control[0]
    if abs(gamma - control.gamma_factored) > REFACTOR_CHANGE * gamma:
        control.factorisations += 1
        control.gamma_factored = gamma
        if RESET_RATE:
            control.rate_known = 0
        control.dense_factors = factorise(
            program, state.jacobian, gamma, state.factors, state.pivots
        )
    return control.dense_factors != SINGULAR


@kernel
def _start_trial(state: NdfState) -> None:
    predicted, correction, trial = state.work[0], state.work[2], state.work[3]
    for i in range(trial.size):
        trial[i] = predicted[i]
        correction[i] = 0.0


@kernel
def _correct(program: LuProgram, state: NdfState, gamma: float) -> None:
    """Add one simplified Newton correction to all states; ledger rows follow the core."""
    control = state.control[0]
    delta = state.delta
    n = delta.size
    predicted, constant, correction = state.work[0], state.work[1], state.work[2]
    trial, slope, scratch = state.work[3], state.work[4], state.work[5]
    damping = 2.0 / (1.0 + gamma / control.gamma_factored)
    for i in range(n):
        delta[i] = gamma * slope[i] - constant[i] - correction[i]
    solve(program, state.factors, state.pivots, control.dense_factors, delta, scratch)
    for i in range(n):
        delta[i] *= damping
        correction[i] += delta[i]
        trial[i] = predicted[i] + correction[i]
    product = scratch[n:]
    ledger_product(program, state.jacobian, delta, product)
    for i in range(n, trial.size):
        residual = gamma * slope[i] - constant[i] - correction[i]
        correction[i] += damping * residual + control.gamma_factored * product[i - n]


@kernel
def _judge(control: Any, iteration: int, size: float, old_size: float) -> int:
    """Return 1 converged, 0 go on, -1 too slow."""
    if size <= 1e-6:
        return 1
    if iteration == 0:
        if control.rate_known == 0:
            control.rate = 0.0
            return 0
        left = size * control.rate / (1.0 - control.rate)
        return 1 if left <= FIRST_TOLERANCE else 0
    if size > 0.9 * old_size:
        return -1
    control.rate = max(RATE_MEMORY * control.rate, size / old_size)
    control.rate_known = 1
    left = size * control.rate / (1.0 - control.rate)
    if left <= LATER_TOLERANCE:
        return 1
    return -1 if left * control.rate ** (NEWTON_LIMIT - 1 - iteration) > LATER_TOLERANCE else 0


@kernel
def _reject(settings: NdfSettings, state: NdfState, error: float, failed_before: bool) -> None:
    """Cut the step after a failed error test, to a lower order if that is better."""
    control = state.control[0]
    order = control.order
    if failed_before:
        _cut_step(state, 0.5)
        return
    ratio = max(0.1, error ** (-1.0 / (order + 1)) / SAFETY[1])
    if order > settings.lowest_order:
        lower = ERROR_CONSTANT[order - 1] * error_norm(
            state.differences[order], state.inverse_weights, settings.max_norm_share
        )
        lower_ratio = max(0.1, lower ** (-1.0 / order) / SAFETY[0])
        if lower_ratio > ratio:
            ratio = lower_ratio
            control.next_order = order - 1
    _cut_step(state, min(ratio, 0.9))


@kernel
def _accept(settings: NdfSettings, state: NdfState, error: float) -> None:
    """Move the differences to the new time and plan the next step."""
    control = state.control[0]
    order = control.order
    differences, correction = state.differences, state.work[2]
    for i in range(correction.size):
        differences[order + 2, i] = correction[i] - differences[order + 1, i]
        differences[order + 1, i] = correction[i]
    for j in range(order, -1, -1):
        for i in range(correction.size):
            differences[j, i] += differences[j + 1, i]
    control.time += control.step
    control.steps += 1
    control.equal_steps += 1
    control.jacobian_age += 1
    if control.rate_known == 1 and control.rate > SLOW_RATE:
        control.jacobian_age += JACOBIAN_AGE
    if control.equal_steps > order:
        _plan(settings, state, error)


@kernel
def _plan(settings: NdfSettings, state: NdfState, error: float) -> None:
    """Choose order and step of the next step; small changes are not worth their cost."""
    control = state.control[0]
    order = control.order
    best_order = order
    best = _growth(error, order, SAFETY[1])
    if order > settings.lowest_order:
        lower = _growth(_difference_error(settings, state, order - 1), order - 1, SAFETY[0])
        if lower > best:
            best, best_order = lower, order - 1
    if order < settings.highest_order:
        higher = _growth(_difference_error(settings, state, order + 1), order + 1, SAFETY[2])
        if higher > best:
            best, best_order = higher, order + 1
    step = min(best * control.step, settings.max_step)
    ratio = step / control.step
    if ratio >= LEAST_GROWTH or ratio <= LEAST_CUT or (best_order != order and ratio >= 1.0):
        control.next_order = best_order
        control.next_step = step


@kernel
def _difference_error(settings: NdfSettings, state: NdfState, order: int) -> float:
    return ERROR_CONSTANT[order] * error_norm(
        state.differences[order + 1], state.inverse_weights, settings.max_norm_share
    )


@kernel
def _growth(error: float, order: int, safety: float) -> float:
    return min(MOST_GROWTH, 1.0 / (safety * max(error, 1e-30) ** (1.0 / (order + 1))))


def bind_weights(weights: Compiled) -> Compiled:
    """Return the compiled function that sets the inverse error weights of a problem."""

    @kernel
    def update_weights(params: Any, state: NdfState) -> None:
        """Set the inverse error weights at the last accepted state."""
        inverse = state.inverse_weights
        weights(state.control[0].time, state.differences[0], params, inverse)
        for i in range(inverse.size):
            inverse[i] = 1.0 / inverse[i]

    return update_weights


def bind_step(callbacks: NdfCallbacks) -> Compiled:
    """Return the compiled function that makes one step of a problem.

    Parameters
    ----------
    callbacks : NdfCallbacks
        Compiled functions of the problem.

    Returns
    -------
    callable
        ``take_step(params, program, settings, state)``: advances by one accepted step and
        returns DONE or the reason why not.
    """
    update_weights = bind_weights(callbacks.weights)
    refresh_jacobian = _bind_refresh(callbacks.jacobian)
    iterate = _bind_iterate(callbacks.rhs, refresh_jacobian)

    @kernel
    def take_step(params: Any, program: LuProgram, settings: NdfSettings, state: NdfState) -> int:
        """Advance by one accepted step; return DONE or the reason why not."""
        control = state.control[0]
        _apply_plan(state)
        update_weights(params, state)
        stale = control.jacobian_age >= JACOBIAN_AGE
        failed_before = False
        finite = True
        while True:
            if control.steps + control.rejected >= settings.max_steps:
                return MAX_STEPS
            if not control.step > max(settings.min_step, 1e-15 * abs(control.time)):
                return STEP_TOO_SMALL if finite else NOT_FINITE
            _predict(state)
            if stale:
                refresh_jacobian(params, state, state.work[0])
                stale = False
            size = iterate(params, program, settings, state)
            if size < 0.0:
                control.newton_failures += 1
                control.rejected += 1
                finite = finite and size > -2.0
                stale = True
                _cut_step(state, 0.3)
                continue
            error = ERROR_CONSTANT[control.order] * size
            if error <= 1.0:
                _accept(settings, state, error)
                return DONE
            control.rejected += 1
            control.jacobian_age += 1
            _reject(settings, state, error, failed_before)
            failed_before = True

    return take_step


def _bind_refresh(jacobian: Compiled) -> Compiled:
    @kernel
    def refresh_jacobian(params: Any, state: NdfState, y: Array) -> None:
        control = state.control[0]
        jacobian(control.time + control.step, y, params, state.jacobian)
        control.jacobian_calls += 1
        control.jacobian_age = 0
        control.gamma_factored = 0.0
        control.rate = FRESH_RATE

    return refresh_jacobian


def _bind_iterate(rhs: Compiled, refresh_jacobian: Compiled) -> Compiled:
    @kernel
    def iterate(params: Any, program: LuProgram, settings: NdfSettings, state: NdfState) -> float:
        """Solve the formula; return the norm of y minus prediction, -1 if slow, -2 not finite.

        A slow iteration with an old Jacobian goes on with a new one. Work rows: 2 y minus
        prediction, 3 trial state, 4 derivative, 5 scratch.
        """
        control = state.control[0]
        gamma = control.step / ((1.0 - KAPPA[control.order]) * HARMONIC[control.order])
        trial = state.work[3]
        if not _prepare_matrix(program, state, gamma):
            return -1.0
        _start_trial(state)
        old_size = 0.0
        iteration = 0
        while True:
            rhs(control.time + control.step, trial, params, state.work[4])
            control.rhs_calls += 1
            control.iterations += 1
            _correct(program, state, gamma)
            size = error_norm(state.delta, state.inverse_weights, settings.max_norm_share)
            if not np.isfinite(size):
                return -2.0
            verdict = _judge(control, iteration, size, old_size)
            if verdict > 0:
                return error_norm(state.work[2], state.inverse_weights, settings.max_norm_share)
            iteration += 1
            if verdict < 0:
                if control.jacobian_age == 0:
                    return -1.0
                if size > old_size:
                    _start_trial(state)
                refresh_jacobian(params, state, trial)
                if not _prepare_matrix(program, state, gamma):
                    return -1.0
                iteration = 0
            old_size = size

    return iterate
