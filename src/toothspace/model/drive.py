r"""The shaft: prescribed speed, or free under the torques of machine, load and friction.

.. math:: J \dot\omega = -M_{machine}(p, \omega) - M_{start}(\omega) - M_{load}(\omega),
    \qquad J = J_{load} + \sum_k J_k i_k^2

with the ratios i of all bodies that turn rigidly with the shaft. Start-up friction is set
valued: a shaft at rest is held, and does not move at all, while the torque on it is below the
breakaway torque. Sliding, its friction is that of the Stribeck law beyond the breakaway speed
and stays at the breakaway torque below it, where the printed law only regularises.
"""

from __future__ import annotations

from toothspace.circuit.history import scheduled
from toothspace.closures.friction import running_share, stribeck_hump
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays


@kernel
def load_torque(s: SystemArrays, speed: float) -> float:
    """Torque that the load takes at its speed at the present time. [N m]."""
    drive = s.drive
    by_speed = drive[col.LOAD_LINEAR] + drive[col.LOAD_SQUARE] * abs(speed)
    by_speed += drive[col.LOAD_CUBIC] * speed * speed
    return speed * by_speed + drive[col.PRESENT_LOAD]


@kernel
def taken_torque(s: SystemArrays, state: Array) -> float:
    """Torque that load or coupling takes from the shaft. [N m]."""
    drive = s.drive
    if drive[col.COUPLING_STIFFNESS] == 0.0:
        return load_torque(s, state[1])
    place = s.size.load
    slip = state[1] - state[place + 1]
    return drive[col.COUPLING_STIFFNESS] * state[place] + drive[col.COUPLING_DAMPING] * slip


@kernel
def load_power(s: SystemArrays, state: Array) -> tuple[float, float]:
    """Power that the load takes, and that the coupling dissipates. [W]."""
    drive = s.drive
    if drive[col.FREE] == 0.0:
        return 0.0, 0.0
    if drive[col.COUPLING_STIFFNESS] == 0.0:
        return load_torque(s, state[1]) * state[1], 0.0
    speed = state[s.size.load + 1]
    slip = state[1] - speed
    return load_torque(s, speed) * speed, drive[col.COUPLING_DAMPING] * slip * slip


@kernel
def fill_load_rates(s: SystemArrays, state: Array, rate: Array) -> None:
    """Rates of the twist of an elastic coupling and of the speed of the load beyond it."""
    drive, place = s.drive, s.size.load
    if drive[col.COUPLING_STIFFNESS] == 0.0:
        return
    speed = state[place + 1]
    rate[place] = state[1] - speed
    driving = taken_torque(s, state) - load_torque(s, speed)
    rate[place + 1] = driving / drive[col.LOAD_INERTIA]


@kernel
def fill_load_weights(s: SystemArrays, state: Array, weight: Array) -> None:
    """Error allowed in the twist of an elastic coupling and in the speed beyond it."""
    drive, place = s.drive, s.size.load
    if drive[col.COUPLING_STIFFNESS] == 0.0:
        return
    tolerance = s.constant.relative_tolerance
    rest = drive[col.BREAKAWAY] / drive[col.COUPLING_STIFFNESS]
    weight[place] = tolerance * max(abs(state[place]), rest, tolerance)
    weight[place + 1] = tolerance * max(abs(state[place + 1]), 1.0)


@kernel
def load_energy(s: SystemArrays, state: Array) -> float:
    """Energy in the twist of the coupling and in the load beyond it. [J]."""
    drive, place = s.drive, s.size.load
    if drive[col.COUPLING_STIFFNESS] == 0.0:
        return 0.0
    twist = drive[col.COUPLING_STIFFNESS] * state[place] * state[place]
    return 0.5 * (twist + drive[col.LOAD_INERTIA] * state[place + 1] * state[place + 1])


@kernel
def add_coupling(s: SystemArrays, state: Array, matrix: Array) -> None:
    """Derivatives of the rates at both ends of an elastic coupling."""
    drive, place = s.drive, s.size.load
    stiffness, damping = drive[col.COUPLING_STIFFNESS], drive[col.COUPLING_DAMPING]
    if stiffness == 0.0:
        return
    speed, inertia = abs(state[place + 1]), drive[col.LOAD_INERTIA]
    by_speed = drive[col.LOAD_LINEAR] + 2.0 * drive[col.LOAD_SQUARE] * speed
    by_speed += 3.0 * drive[col.LOAD_CUBIC] * speed * speed
    matrix[place, 1] += 1.0
    matrix[place, place + 1] -= 1.0
    matrix[place + 1, place] += stiffness / inertia
    matrix[place + 1, 1] += damping / inertia
    matrix[place + 1, place + 1] -= (damping + by_speed) / inertia
    if drive[col.FREE] > 0.0 and drive[col.DIRECTION] != 0.0:
        matrix[1, place] -= stiffness / drive[col.INERTIA]
        matrix[1, 1] -= damping / drive[col.INERTIA]
        matrix[1, place + 1] += damping / drive[col.INERTIA]


@kernel
def update_load(s: SystemArrays, time: float) -> None:
    """Look up the part of the load that is prescribed over time."""
    drive = s.drive
    if drive[col.LOAD_KNOTS] > 0.0:
        first, count = int(drive[col.LOAD_KNOT]), int(drive[col.LOAD_KNOTS])
        drive[col.PRESENT_LOAD] = scheduled(s.schedule, first, count, time)


@kernel
def prescribed_acceleration(s: SystemArrays, time: float) -> float:
    """Slope of a prescribed shaft speed over time; zero where it is constant. [rad/s2]."""
    drive = s.drive
    if drive[col.SPEED_KNOTS] == 0.0:
        return 0.0
    first, count = int(drive[col.SPEED_KNOT]), int(drive[col.SPEED_KNOTS])
    for k in range(first, first + count - 1):
        begin, end = s.schedule[k, 0], s.schedule[k + 1, 0]
        if begin <= time < end:
            return (s.schedule[k + 1, 1] - s.schedule[k, 1]) / (end - begin)
    return 0.0


@kernel
def update_fade(s: SystemArrays, speed: float) -> None:
    """Set the share of the interface friction that is present at this speed. [-].

    Where the breakaway torque stands for all interfaces at rest they fade in with speed; where it
    is their boundary friction, by what is no longer left of that.
    """
    drive = s.drive
    drive[col.FADE] = 1.0
    if drive[col.FROM_INTERFACES] > 0.0:
        drive[col.FADE] = 1.0 - boundary_share_left(s, speed)
    elif drive[col.BREAKAWAY] > 0.0 and drive[col.ADDED_FRICTION] == 0.0:
        drive[col.FADE] = running_share(speed, drive[col.BREAKAWAY_SPEED])


@kernel
def boundary_share_left(s: SystemArrays, speed: float) -> float:
    """Share of the friction at rest beyond that of the seal that is left at a speed. [-]."""
    drive = s.drive
    sliding = max(drive[col.DIRECTION] * speed, drive[col.BREAKAWAY_SPEED])
    hump, _ = stribeck_hump(sliding, drive[col.BREAKAWAY_SPEED])
    return float(hump)


@kernel
def startup_torque(s: SystemArrays, speed: float) -> float:
    """Part of the breakaway torque that is left at a speed, against the direction. [N m]."""
    drive = s.drive
    if drive[col.BREAKAWAY] == 0.0:
        return 0.0
    held = drive[col.BREAKAWAY] - drive[col.RUNNING_FRICTION]
    return drive[col.DIRECTION] * held * boundary_share_left(s, speed)


@kernel
def running_torque(s: SystemArrays) -> float:
    """Friction that does not depend on speed (seal), against the direction. [N m]."""
    return s.drive[col.DIRECTION] * s.drive[col.RUNNING_FRICTION]
