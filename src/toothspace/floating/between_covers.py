"""Where bodies that float between two resting covers stand while the shaft turns."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import Array
from toothspace.floating.equilibrium import (
    Equilibrium,
    SearchSettings,
    find_equilibrium,
    march_angles,
    snapshots_over_pitch,
)
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.housing_friction import housing_friction
from toothspace.floating.motion import Loads, StepSettings, state_at
from toothspace.floating.problem import film_laws
from toothspace.floating.stack import BackPressure, Stack, StackState, WinklerFoundation
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import NO_BODY, FaceCells, FacePlaces, FilmFace, SharedFaces
from toothspace.model.floating_bearing import (
    AxialForce,
    FilmInterface,
    FloatingBearing,
    HousingContact,
    LateralBalance,
    Patch,
    Side,
)
from toothspace.model.lateral_load import chamber_pressures
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.parallel import cores_for_fields
from toothspace.numerics.periodic_table import monotone_table


@final
@dataclass(frozen=True)
class OwnFace:
    """Face map of one body alone; where another stands, the nearest chamber has its pressure."""

    cover: FilmFace
    """Cover that several bodies share."""
    body: int
    """Number of the body."""
    beyond: int
    """Node beyond the outer rim of the cover."""

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Nodes and the body at points; angles in [rad], places in [m]."""
        cover, ring = self.cover, self.cover.chambers
        cells = cover.face_map(shaft_angle, x, y)
        x0, y0 = cover.center
        outside = np.hypot(x - x0, y - y0) > cover.outer_radius
        own = (cells.body == self.body) & ~outside
        nearest = ring.nodes[ring.nearest(shaft_angle, x, y)]
        node = np.where(own | (cells.body == NO_BODY), cells.node, nearest)
        return FaceCells(np.where(outside, self.beyond, node), np.where(own, 0, NO_BODY))


def resting_covers(description: MachineDescription, faces: SharedFaces) -> LateralBalance:
    """Balance of bodies between covers, from what the machine says of the covers.

    Parameters
    ----------
    description : MachineDescription
        Machine with masses, speeds and nodes of its bodies.
    faces : SharedFaces
        Its covers, with bodies that lift or lift and tilt.

    Notes
    -----
    Every film counts for its own body. The film at the outer rim has one pressure, that of its
    chamber in closed form, or of the inner node where its ends are open: the same at both covers.
    """
    face = faces.face
    own = {body.name: body for body in description.bodies}
    beyond = face.inner_node if faces.rim.open_ends else faces.rim.chamber
    sides: tuple[tuple[Side, str, FilmFace], ...] = (
        ("floating", "b", faces.covers[1]),
        ("solid", "a", faces.covers[0]),
    )
    area = np.pi * face.outer_radius**2
    whole, none = Patch(area, face.center), Patch(0.0, face.center)
    assert faces.motion != "none"
    return LateralBalance(
        arrangement="fixed",
        motion=faces.motion,
        interfaces=tuple(
            FilmInterface(
                name=f"{label}_{body.name}",
                body=body.name,
                side=side,
                face=replace(
                    cover,
                    bodies=(body,),
                    center=body.center,
                    inner_radius=body.inner_radius,
                    outer_radius=body.outer_radius,
                    face_map=OwnFace(cover, number, beyond),
                ),
                speed_ratio=own[body.name].speed_ratio,
            )
            for side, label, cover in sides
            for number, body in enumerate(face.bodies)
        ),
        floating=FloatingBearing(
            mass=0.0,
            face=whole,
            high_pressure=whole,
            nose=none,
            preload=AxialForce(0.0),
            housing=HousingContact(),
            gauge_point=face.center,
            axial_play=np.inf,
        ),
        high_node=description.outlet_node if description.mode == "pump" else description.inlet_node,
        low_node=face.inner_node,
        body_forces=tuple(AxialForce(0.0) for _ in face.bodies),
        body_masses=tuple(own[body.name].mass for body in face.bodies),
    )


_GRID = (84, 16)
"""Cells of each film round the circumference and along the radius. [-]"""
_SNAPSHOTS = 2
"""Shaft angles of a pitch over which the search averages forces. [-]"""
_SEARCH = SearchSettings(residual_motion=1e-5)
_STEP = StepSettings(force_tolerance=1e-5)
_IN_MARCH = StepSettings(force_tolerance=1e-5, jacobian_age=60)
_STEPS = 8
"""Steps of the march in a pitch, a multiple of the angles asked for. [-]"""
_MOST_PITCHES = 40
"""Pitches after which bodies that do not come to repeat themselves are left. [-]"""
_REPEATS = 0.05
"""Change of a film height from pitch to pitch, over the smallest one, that counts as none. [-]"""
_ASIDE = 0.01
"""Tilt at the rim over the gap of every body that begins where the smallest tilt grows. [-]"""
_RESTLESS = (
    "Bodies between the covers do not repeat their motion from pitch to pitch: the last of {} is "
    'taken{}. Set machine.lateral.motion = "axial", or machine.lateral.position = "given".'
)


@final
@dataclass(frozen=True, eq=False)
class BodiesBetweenCovers:
    """Bodies over one pitch, and their films."""

    planes: tuple[Array, ...]
    """For every cover the height of the film of every body at its axis [m] and the rotations of
    that plane about x and y. Shape (angles, bodies, 3). [rad]
    """
    places: FacePlaces
    """The same as places of the bodies."""
    asperity_torque: Mapping[str, float]
    """Mean torque of touching asperities on every body. [N m]"""
    last: StackState
    """Films at the end of the pitch."""


def cover_stack(
    description: MachineDescription, fluid: FluidLaw, shaft_speed: float, grid: tuple[int, int]
) -> Stack:
    """Films of both sides of all bodies between the shared covers of a machine, rigid."""
    assert description.shared_faces is not None
    balance = resting_covers(description, description.shared_faces)
    grids = tuple(FaceGrid(interface, *grid) for interface in balance.interfaces)
    rigid = WinklerFoundation((0.0,) * len(grids))
    return Stack(balance, grids, film_laws(balance, fluid, "jfo"), rigid, shaft_speed)


def bodies_between_covers(
    description: MachineDescription,
    condition: OperatingCondition,
    fluid: FluidLaw,
    turn: Array,
    grid: tuple[int, int] = _GRID,
) -> BodiesBetweenCovers:
    """Follow bodies between their covers until they repeat their motion from pitch to pitch.

    Parameters
    ----------
    description : MachineDescription
        Machine with ``shared_faces`` whose bodies move.
    condition : OperatingCondition
        Shaft speed and port pressures; chambers have those of their paths at rest.
    turn : ndarray
        Growth of the table angles at which places are asked for, evenly over a pitch. [rad]
    grid : tuple of int
        Cells of each film round the circumference and along the radius. [-]

    Notes
    -----
    The search for the equilibrium under mean forces gives the place to begin at; from there the
    march counts the squeeze between the covers. At rest there is no march. Where the search finds
    no equilibrium, or one from which small tilts grow, all bodies begin a little aside.
    """
    faces = description.shared_faces
    assert faces is not None
    stack = cover_stack(description, fluid, condition.shaft_speed, grid)
    pressures = chamber_pressures(description, condition)
    mean, balance = pressures(0.0), stack.balance
    low = float(mean[balance.low_node])
    back = BackPressure(float(mean[balance.high_node]), low, low)
    loads = Loads(back, housing_friction(balance.floating.housing, 0.0))
    snapshots = snapshots_over_pitch(stack, pressures, _SNAPSHOTS)
    start = state_at(stack, snapshots, stack.start(faces.face.gap))
    with cores_for_fields():
        found = find_equilibrium(stack, snapshots, loads, start, _SEARCH, _STEP)
        track, warning = [found.balance.states[0]], ""
        if condition.shaft_speed > 0.0:
            track, restless = _repeated(stack, pressures, loads, found)
            reason = f"; {found.reason}" if found.reason else ""
            warning = _RESTLESS.format(_MOST_PITCHES, reason) if restless else ""
    asked = np.round(turn / faces.face.chambers.pitch * len(track)).astype(int) % len(track)
    # heights, places of the bodies and their asperity friction at the states asked for
    states = [track[k] for k in asked]
    bodies, count = stack.balance.bodies, len(stack.balance.bodies)
    heights = np.array(
        [
            [stack.film_face_motion(k, s.position, s.velocity).position for k in range(2 * count)]
            for s in states
        ]
    )
    resting = stack.balance.interfaces[-1].face.gap
    places = np.zeros((len(states), count, 4))
    torque = dict.fromkeys(bodies, 0.0)
    for row, state in zip(places, states, strict=True):
        for b, body in enumerate(bodies):
            first = stack.first_body + 3 * b
            row[b, :3] = state.position[first : first + 3] - np.array([resting, 0.0, 0.0])
            films = [f for f in state.films if f.grid.interface.body == body]
            row[b, 3] = min(float(f.gap[f.boundary.mask.film].min()) for f in films)
            speed = abs(films[0].grid.interface.speed_ratio) * stack.shaft_speed
            power = sum(f.losses.asperity for f in films)
            torque[body] += power / speed / len(states) if speed > 0.0 else 0.0
    table = monotone_table(faces.face.period, places.reshape(len(states), -1))
    # films of the floating side come first, covers with the lower one
    planes = (heights[:, count:], heights[:, :count])
    return BodiesBetweenCovers(planes, FacePlaces(bodies, table, warning), torque, track[-1])


def _repeated(
    stack: Stack, pressures: Callable[[float], Array], loads: Loads, found: Equilibrium
) -> tuple[list[StackState], bool]:
    """States over the last pitch, from its beginning on, and whether it differs from the former."""
    period = stack.balance.interfaces[0].face.period
    now = found.balance
    if not found.settled:
        # at rest with every body tilted about both axes by a small part of its gap
        q, body = now.position.copy(), stack.first_body
        if stack.balance.motion == "full":
            tilted = np.arange(body, stack.size) % 3 > 0
            q[body:][tilted] += _ASIDE * stack.play / stack.arms[body:][tilted]
        rest = (replace(s, position=q, velocity=np.zeros_like(q)) for s in now.states)
        now = replace(now, states=tuple(rest))
    before = now.states[0]
    for pitch in range(_MOST_PITCHES):
        angles = (pitch + np.arange(1, _STEPS + 1) / _STEPS) * period
        march = list(march_angles(stack, pressures, loads, now, angles, _IN_MARCH))
        now, converged = march[-1], all(balance.converged for balance in march)
        change = np.abs((now.position - before.position) * stack.arms).max()
        before = now.states[0]
        if found.settled and converged and change <= _REPEATS * before.smallest_gap():
            break
    states = [balance.states[0] for balance in march]
    return [states[-1], *states[:-1]], change > _REPEATS * before.smallest_gap()
