"""Test problems of the stiff integrator, all behind one set of compiled callbacks."""

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import njit
from toothspace.numerics.ndf import bind
from toothspace.numerics.ndf_types import (
    DONE,
    NdfCallbacks,
    make_record,
    make_settings,
    make_state,
)
from toothspace.numerics.static_lu import analyse

LINEAR, OSCILLATOR, NETWORK, RELAY, BLOW_UP, NOT_A_NUMBER = 0, 1, 2, 3, 4, 5
ROBERTSON, VAN_DER_POL, HIRES, RING, KINK = 6, 7, 8, 9, 10
CELLS = 8


class Problem(NamedTuple):
    kind: np.ndarray
    tolerance: np.ndarray


@njit
def rhs(t, y, params, dydt):
    kind = params.kind[0]
    if kind == LINEAR:
        u, v = y[0] - np.sin(t), y[1] - np.cos(t)
        dydt[0] = -3.0 * u + v + np.cos(t)
        dydt[1] = 0.5 * u - 2.0 * v - np.sin(t)
    elif kind == OSCILLATOR:
        dydt[0], dydt[1] = y[1], -y[0]
    elif kind == NETWORK:
        _network(y, dydt)
    elif kind == RELAY:
        dydt[0] = -1.0 if t < 1.0 else 2.0
    elif kind == BLOW_UP:
        dydt[0] = y[0] * y[0]
    elif kind == NOT_A_NUMBER:
        dydt[0] = -1.0 if t < 1.0 else np.nan
    else:
        _classical_rhs(kind, t, y, dydt)


@njit
def _network(y, dydt):
    dydt[:] = 0.0
    for i in range(CELLS):
        j = (i + 1) % CELLS
        flow = 10.0 ** (0.5 * i) * (y[i] - y[j]) * abs(y[i] + y[j])
        dydt[i] -= flow
        dydt[j] += flow
    out = 3.0 * y[0] ** 2
    dydt[0] -= out
    dydt[CELLS - 1] += 1.0
    dydt[CELLS] = out
    dydt[CELLS + 1] = -1.0


@njit
def _classical_rhs(kind, t, y, f):
    if kind == ROBERTSON:
        fast = 1e4 * y[1] * y[2]
        f[0] = -0.04 * y[0] + fast
        f[2] = 3e7 * y[1] ** 2
        f[1] = -f[0] - f[2]
    elif kind == VAN_DER_POL:
        f[0], f[1] = y[1], 1000.0 * (1.0 - y[0] ** 2) * y[1] - y[0]
    elif kind == HIRES:
        q = 280.0 * y[5] * y[7]
        f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007
        f[1] = 1.71 * y[0] - 8.75 * y[1]
        f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4]
        f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3]
        f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6]
        f[5] = -q + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6]
        f[6] = q - 1.81 * y[6]
        f[7] = -f[6]
    elif kind == RING:
        n = y.size
        for i in range(n):
            f[i] = _rate(i) * (y[i - 1] - y[i]) + _rate(i + 1) * (y[(i + 1) % n] - y[i])
            f[i] += 100.0 * (np.sin(20.0 * t + i) - y[i])
    elif kind == KINK:
        f[0] = 1000.0 * (max(np.sin(t), 0.0) ** 2 - y[0])


@njit
def _rate(i):
    return 10.0 ** (i % 7)


@njit(_nrt=True)  # allocates, which callbacks otherwise must not
def jacobian(t, y, params, jac, basis):
    """Differences of the right-hand side by central steps, exact for quadratics."""
    n_total, n_core = jac.shape
    trial, low, high = y.copy(), np.zeros(n_total), np.zeros(n_total)
    for j in range(n_core):
        step = 1e-6 * max(abs(y[j]), 1e-6)
        trial[j] = y[j] + step
        above = trial[j]
        rhs(t, trial, params, high)
        trial[j] = y[j] - step
        rhs(t, trial, params, low)
        for i in range(n_total):
            jac[i, j] = (high[i] - low[i]) / (above - trial[j])
        trial[j] = y[j]
    if params.kind[0] == NETWORK:
        _balance_network(jac)


@njit
def _balance_network(jac):
    """Close the column sums, which differences leave open by round-off."""
    for j in range(CELLS):
        total = 0.0
        for i in range(CELLS + 2):
            if i != (j + 1) % CELLS:
                total += jac[i, j]
        jac[(j + 1) % CELLS, j] = -total


@njit
def weights(t, y, params, w):
    for i in range(w.size):
        w[i] = params.tolerance[0] * abs(y[i]) + params.tolerance[1]


@njit
def event_values(t, y, params, g):
    kind = params.kind[0]
    if kind == OSCILLATOR:
        g[0], g[1] = y[0], y[1] + 0.5
    elif kind == RELAY:
        g[0] = t - 1.0


@njit
def finish(t, y, params, dydt, w, g):
    rhs(t, y, params, dydt)
    weights(t, y, params, w)
    event_values(t, y, params, g)


_initial_state, _advance = bind(NdfCallbacks(rhs, finish, jacobian, weights, event_values))


@njit
def integrate(params, program, settings, state, record, time, y0):
    """Begin where start values are given, go on to a time elsewhere: one entry, compiled once."""
    if y0.size > 0:
        _initial_state(params, program, settings, state, time, y0)
        return DONE
    return _advance(params, program, settings, state, record, time)


class Run:
    """One integration of one problem, resumable."""

    def __init__(self, kind, y0, relative, absolute, n_ledger=0, t0=0.0, pattern=None, **choices):
        y0 = np.asarray(y0, dtype=float)
        self.params = Problem(np.array([kind]), np.array([relative, absolute]))
        n_core = y0.size - n_ledger
        full = np.ones((y0.size, n_core), dtype=bool)
        self.program = analyse(full if pattern is None else pattern)
        self.settings = make_settings(**choices)
        self.state = make_state(self.program, y0.size, self.settings.event_actions.size)
        self.record = make_record(np.zeros(0), y0.size)
        self._integrate(t0, y0)

    def sample(self, times):
        self.record = make_record(times, self.state.y.size)

    def to(self, t_end):
        return self._integrate(t_end, np.zeros(0))

    def _integrate(self, time, y0):
        given = (self.params, self.program, self.settings, self.state, self.record)
        return integrate(*given, float(time), y0)

    @property
    def y(self):
        return self.state.y

    def count(self, name):
        return int(self.state.control[name][0])


def plain_rhs(kind):
    """Right-hand side for SciPy."""
    params = Problem(np.array([kind]), np.zeros(2))

    def evaluate(t, y):
        dydt = np.zeros_like(y)
        rhs(t, y, params, dydt)
        return dydt

    return evaluate
