"""Set-valued friction against the reference result of a drive train with clutch and brake."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from toothspace.closures.friction import STUCK, next_direction
from toothspace.core.types import Array
from toothspace.validation.claim import data_file

REFERENCE = data_file("modelica_friction")
INERTIA = (1.0, 0.05, 1.0)
STIFFNESS, DAMPING = 160.0, 1.0
CLUTCH, BRAKE = 80.0, 800.0
BRAKE_TIME = 0.5
TOLERANCE = 1e-3
MODES = {1.0: 1, -1.0: -1, 0.0: 0}
FREE = 2


class DriveTrain:
    """Angles and speeds of three inertias, and the states of clutch and brake."""

    def __init__(self) -> None:
        self.state = np.array([0.0, 0.0, 0.0, 100.0, 90.0, 90.0])
        self.clutch, self.brake, self.braking = -1.0, 1.0, 0.0

    def applied(self, time: float, y: Array) -> Array:
        """Torques on the inertias without friction. [N m]."""
        motor = 0.0 if self.braking else 200.0 * np.sin(100.0 * time)
        spring = STIFFNESS * (y[2] - y[1]) + DAMPING * (y[5] - y[4])
        return np.array([motor, spring, -spring])

    def rates(self, time: float, y: Array) -> Array:
        torque = self.applied(time, y)
        if self.clutch == STUCK:
            first = second = (torque[0] + torque[1]) / (INERTIA[0] + INERTIA[1])
        else:
            first = (torque[0] + CLUTCH * self.clutch) / INERTIA[0]
            second = (torque[1] - CLUTCH * self.clutch) / INERTIA[1]
        third = (torque[2] - self.braking * BRAKE * self.brake) / INERTIA[2]
        if self.braking and self.brake == STUCK:
            third = 0.0
        return np.array([*y[3:], first, second, third])

    def clutch_load(self, time: float, y: Array) -> float:
        """Torque that would drive the second inertia ahead of the first if both were stuck."""
        torque = self.applied(time, y)
        common = (torque[0] + torque[1]) / (INERTIA[0] + INERTIA[1])
        return float(torque[1] - INERTIA[1] * common)

    def events(self) -> list[Callable[[float, Array], float]]:
        """Signed distances to the next change of a joint."""
        joints = [
            (self.clutch, lambda t, y: y[4] - y[3], self.clutch_load, CLUTCH),
            (self.brake, lambda t, y: y[5], lambda t, y: self.applied(t, y)[2], BRAKE),
        ]
        found = []
        for direction, speed, load, holding in joints[: 2 if self.braking else 1]:
            if direction == STUCK:
                found.append(lambda t, y, load=load, hold=holding: hold - abs(load(t, y)))
            else:
                found.append(lambda t, y, speed=speed, sense=direction: sense * speed(t, y))
        for event in found:
            event.terminal, event.direction = True, -1.0
        return found

    def switch(self, which: int, time: float) -> None:
        """Let one joint take its next state; its relative speed is zero."""
        y = self.state
        if which == 0:
            y[4] = y[3]
            load, stuck = self.clutch_load(time, y), self.clutch == STUCK
            self.clutch = next_direction(0.0, load, 0.0 if stuck else CLUTCH)
        else:
            y[5] = 0.0
            load, stuck = self.applied(time, y)[2], self.brake == STUCK
            self.brake = next_direction(0.0, load, 0.0 if stuck else BRAKE)

    def run(self, times: Array) -> tuple[Array, Array]:
        """States at the times, and the states of both joints there."""
        samples, joints = [], []
        now = 0.0
        for until in times:
            for end in (BRAKE_TIME, until) if now < BRAKE_TIME <= until else (until,):
                now = self._advance(now, end)
                if end == BRAKE_TIME:
                    self.braking = 1.0
                    self.brake = next_direction(self.state[5], 0.0, BRAKE)
            samples.append(self.state.copy())
            joints.append((self.clutch, self.brake if self.braking else FREE))
        return np.array(samples), np.array(joints)

    def _advance(self, now: float, end: float) -> float:
        while now < end:
            part = solve_ivp(
                self.rates, (now, end), self.state, events=self.events(), rtol=1e-9, atol=1e-9
            )
            self.state, now = part.y[:, -1].copy(), float(part.t[-1])
            for which, found in enumerate(part.t_events):
                if found.size and found[-1] == now:
                    self.switch(which, now)
        return end


@pytest.fixture(scope="module")
def both() -> tuple[dict[str, Array], Array, Array]:
    reference = np.genfromtxt(REFERENCE, delimiter=",", names=True, deletechars="")
    states, joints = DriveTrain().run(reference["time"])
    return {name: reference[name] for name in reference.dtype.names}, states, joints


@pytest.mark.parametrize(
    ("name", "of_state"),
    [
        ("inertia3.w", lambda y: y[:, 3]),
        ("clutch.w_rel", lambda y: y[:, 4] - y[:, 3]),
        ("spring.phi_rel", lambda y: y[:, 2] - y[:, 1]),
    ],
)
def test_signal(both: tuple, name: str, of_state: Callable[[Array], Array]) -> None:
    reference, states, _ = both
    error = np.abs(of_state(states) - reference[name])
    assert error.max() < TOLERANCE * np.abs(reference[name]).max()


def test_states_of_both_joints(both: tuple) -> None:
    reference, _, joints = both
    settled = np.abs(reference["time"] - BRAKE_TIME) > 1e-9
    assert np.array_equal(joints[settled, 0], reference["clutch.mode"][settled])
    assert np.array_equal(joints[settled, 1], reference["brake.mode"][settled])
