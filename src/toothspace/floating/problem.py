"""Lateral films and floating bearings of a machine whose chamber pressures are known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.closures.contact_rough import real_contact_share
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.viscosity import HIGHEST_PRESSURE
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.thermal import FilmHeating
from toothspace.floating.compliant_film import Accuracy
from toothspace.floating.deformation import Fineness
from toothspace.floating.elastic_faces import axial_forces, loaded_bodies, node_pressures
from toothspace.floating.equilibrium import (
    Equilibrium,
    SearchSettings,
    find_equilibrium,
    march_angles,
    snapshots_over_pitch,
)
from toothspace.floating.face_film import FaceFilm, FilmLaw, film_law
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.housing_friction import (
    HousingFriction,
    housing_friction,
    normal_force,
)
from toothspace.floating.motion import Balance, Loads, StepSettings, balance_force, state_at
from toothspace.floating.stack import (
    BackPressure,
    Compliance,
    HoldingSpring,
    Snapshot,
    Stack,
    WinklerFoundation,
)
from toothspace.model.description import MachineDescription
from toothspace.model.floating_bearing import STICK, FilmInterface, LateralBalance
from toothspace.numerics.parallel import cores_for_fields

if TYPE_CHECKING:
    import xarray as xr

NO_FLOATING_PART = "machine: found no floating part in balance, allowed a machine with one"
_TOUCH = 1e-4
"""Asperity pressure over hardness that counts as contact. [-]"""
_SETTLED = Accuracy(linear=1e-7)
"""Accuracy of films in the search, whose solutions are corrections of former ones."""
_MARCHED = Accuracy(settled=1e-3, linear=5e-2)
"""Accuracy of films within one step of the march, whose force balance repeats them."""
_JACOBIAN_AGE = 60
"""Iterations of the march that one Jacobian serves. [-]"""
_FINENESS = Fineness(waves=16, degree=2, phases=6)
"""Basis functions of the deformation that are predicted: those of the teeth are the finest. [-]"""
_IN_MARCH = Fineness(waves=12, degree=2, phases=8)
"""The same in a march: a step begins so near its end that fewer basis functions do."""
_ON_THE_WAY = 0.01
"""Force out of balance over the viscous one at which a step of the search is done. [-]"""
_HELD = 1e6
"""Stiffness of the holding spring over the force behind the bearing. [1/m]"""
_MEMORY = 2
"""Iterations from which the rest of the deformation is extrapolated. [-]"""


@final
@dataclass(frozen=True, kw_only=True)
class LateralSettings:
    """Grids and laws of the lateral films."""

    grid: tuple[int, int] = (126, 18)
    """Cells of each film round the circumference and along the radius. [-]"""
    angles: int = 2
    """Shaft angles of one tooth pitch over which forces are averaged. [-]"""
    deformation: str = "winkler"
    """How faces deform. One of ``winkler``, ``bodies``, ``none``."""
    cavitation: str = "jfo"
    """Cavitation model of the films."""
    heating: FilmHeating | None = None
    """How the films warm up; None: at the temperature of the fluid."""
    dwell: float = 1e3
    """Longest time at one operating point; the smooth friction law creeps that long. [s]"""


@final
@dataclass(frozen=True, eq=False)
class LateralProblem:
    """One operating point of the lateral gaps."""

    stack: Stack
    """Bodies and films."""
    snapshots: tuple[Snapshot, ...]
    """Shaft angles over which forces are averaged."""
    loads: Loads
    """Pressures behind the bearing and friction in the housing."""
    node_pressure: Callable[[float], Array]
    """Pressures of all nodes at a shaft angle. [Pa]"""
    settings: LateralSettings
    """Grids and laws."""

    def started(self, gap: float) -> Balance:
        """State without motion with one gap everywhere. [m]."""
        return state_at(self.stack, self.snapshots, self.stack.start(gap))

    def continued(self, position: Array) -> Balance:
        """State without motion at the positions of another operating point. [m, rad]."""
        return state_at(self.stack, self.snapshots, position)

    def held_at(self, opening: float) -> LateralProblem:
        """Same problem with a stiff spring on the mean lift in place of friction. [m].

        At rest the spring pulls with what films and back leave.
        """
        stiffness = _HELD * balance_force(self.stack, self.loads.back)
        free = HousingFriction(0.0, self.loads.friction.breakaway_speed, STICK)
        stack = replace(self.stack, holding_spring=HoldingSpring(opening, stiffness))
        return replace(self, stack=stack, loads=Loads(self.loads.back, free))

    def settle(self, start: Balance, known: Equilibrium | None = None) -> Equilibrium:
        """Let bearings and gears move until they settle, forces averaged over a pitch.

        ``known`` is what settled from the same start at nearly the same pressures and viscosities.
        """
        search = SearchSettings(longest_time=self.settings.dwell)
        # on the way the bodies need follow no closer than implicit steps that grow by three do
        step = replace(self._step(1e-6), drag_tolerance=_ON_THE_WAY)
        # films of bodies that fly apart overflow: the search ends and says so
        with cores_for_fields(), np.errstate(over="ignore", invalid="ignore"):
            return find_equilibrium(
                self.stack, self.snapshots, self.loads, start, search, step, known
            )

    def march(
        self, start: Balance, steps: int, revolutions: float = 1.0, progress: Progress | None = None
    ) -> LateralTrack:
        """March over the shaft angle with transient squeeze.

        An interrupt by the user after the first step keeps the steps that are done.

        Raises KeyboardInterrupt if interrupted before.
        """
        angles = np.arange(1, round(steps * revolutions) + 1) * 2.0 * np.pi / steps
        step = replace(self._step(9e-5), jacobian_age=_JACOBIAN_AGE, passes=1)
        if step.fineness is not None:
            step = replace(step, fineness=_IN_MARCH)
        laws = tuple(law._replace(accuracy=_MARCHED) for law in self.stack.laws)
        stack = replace(self.stack, laws=laws)
        track = LateralTrack(angles)

        try:
            with cores_for_fields():
                march = march_angles(stack, self.node_pressure, self.loads, start, angles, step)
                for done, balance in enumerate(march, 1):
                    track.take(balance, wear_map([balance]))
                    if progress:
                        progress(done / angles.size, f"film step {done} of {angles.size}")
        except KeyboardInterrupt:
            if not track.positions:
                raise
            track.interrupted = True
        return track

    def _step(self, tolerance: float) -> StepSettings:
        bends = self.settings.deformation == "bodies"
        return StepSettings(
            force_tolerance=tolerance,
            max_iterations=40 if bends else 25,
            memory=_MEMORY if bends else 0,
            jacobian_age=_JACOBIAN_AGE if bends else 1,
            fineness=_FINENESS if bends else None,
        )


@final
@dataclass(frozen=True)
class LateralNumbers:
    """Numbers of lateral films in one state, all sides together."""

    position: float
    """Position of the floating bearing at its gauge point, away from the gears. [m]"""
    gaps: Array
    """Mean gap of every film. [m]"""
    smallest_gap: float
    """Smallest gap. [m]"""
    leakage: float
    """Flow from high to low pressure that would lose the same power. [m3/s]"""
    bore_flow: float
    """Flow into the shaft bores. [m3/s]"""
    viscous_torque: float
    asperity_torque: float
    """Friction at the shaft. [N m]"""
    contact_force: float
    """Load that asperities carry. [N]"""
    real_contact_area: float
    """Area of touching asperities by ``toothspace.closures.contact_rough``. [m2]"""
    contact_share: float
    """Part of the film area with asperity pressure above 1e-4 of the hardness. [-]"""
    wear_power: float
    """Largest asperity pressure times sliding speed. [W/m2]"""
    friction_force: float
    """Friction of the housing on the floating bearing. [N]"""
    hold_down_force: float
    """Force that holds the solid bearing on its cover, negative if it lifts off; with two floating
    bearings not a number. [N]
    """
    tipping_margin: float
    """How far inside its rim the solid bearing is pressed on its cover, negative if it tips; with
    two floating bearings not a number. [m]
    """
    positions: Array
    """Positions of all floating bearings or their parts, along z. [m]"""
    tilt: float
    """Largest tilt of a floating bearing or part. [rad]"""


def lateral_problem(
    description: MachineDescription,
    fluid: FluidLaw,
    data: xr.Dataset,
    settings: LateralSettings,
    nose_pressure: float | None = None,
) -> LateralProblem:
    """Lateral films at the operating point of a lumped solution.

    Raises CaseError if the machine has no floating bearing.

    Parameters
    ----------
    description : MachineDescription
        The machine, with its lateral balance.
    data : xarray.Dataset
        Samples of one revolution: chamber and port pressures, journal forces.
    nose_pressure : float, optional
        Absolute pressure on the nose; default the low pressure. [Pa]
    """
    balance = balance_of(description)
    shaft_speed = float(data["shaft_speed"].mean())
    pressures = node_pressures(description, balance, data)
    mean = pressures(0.0)
    high, low = float(mean[balance.high_node]), float(mean[balance.low_node])
    back = BackPressure(high, low, low if nose_pressure is None else nose_pressure)
    grids = tuple(FaceGrid(i, *settings.grid) for i in balance.interfaces)
    deforms = settings.deformation == "winkler"
    compliance: Compliance = WinklerFoundation(
        tuple(i.winkler_compliance * deforms for i in balance.interfaces)
    )
    if settings.deformation == "bodies":
        compliance = loaded_bodies(description, balance, grids, back, data)
    warmth = {film.body: film.viscosity_ratio for film in description.laterals}
    laws = film_laws(balance, fluid, settings.cavitation, warmth)
    if balance.shaft_stiffness is not None:
        shaft = balance.shaft_stiffness
    else:
        loads = 0.5 * np.linalg.norm(data["journal_force"].values.mean(axis=0)[:, :2], axis=1)
        own = {journal.body: journal for journal in description.journals}
        held = []
        for body, load, tilt in zip(balance.bodies, loads, balance.body_tilts, strict=False):
            clearance = own[body].radial_clearance
            apart = 2.0 * clearance / tilt - own[body].length  # half of it reaches the far end
            held.append(0.5 * float(load) * apart**2 / clearance)
        shaft = min(held, default=0.0)
    stack = Stack(
        replace(balance, shaft_stiffness=shaft),
        grids,
        tuple(law._replace(accuracy=_SETTLED) for law in laws),
        compliance,
        shaft_speed,
        thrust=axial_forces(data),
    )
    snapshots = snapshots_over_pitch(stack, pressures, settings.angles)
    difference = high - low
    # two blocks share the force of every shaft
    shafts = -0.5 * data["journal_force"].values.mean(axis=0)[:, :2]
    toward_low = np.array([1.0 if description.mode == "pump" else -1.0, 1.0])
    whole = balance.floating.housing
    if not balance.halves:
        normal = normal_force(whole, difference, shafts.sum(axis=0) * toward_low)
        loads = Loads(back, housing_friction(whole, normal))
    else:
        normals = [
            normal_force(half.housing, difference, shaft * toward_low)
            for half, shaft in zip(balance.halves, shafts, strict=True)
        ]
        parts = tuple(
            housing_friction(half.housing, normal)
            for half, normal in zip(balance.halves, normals, strict=True)
        )
        loads = Loads(back, housing_friction(whole, sum(normals)), parts)
    return LateralProblem(stack, snapshots, loads, pressures, settings)


def balance_of(description: MachineDescription) -> LateralBalance:
    """Lateral balance of a machine.

    Raises CaseError if it has none.
    """
    balance = description.lateral_balance
    if balance is None:
        raise CaseError(NO_FLOATING_PART)
    return balance


def film_laws(
    balance: LateralBalance,
    fluid: FluidLaw,
    cavitation: str,
    viscosity_ratio: Mapping[str, float] = MappingProxyType({}),
) -> tuple[FilmLaw, ...]:
    """Laws of all films of a machine with a fluid and a cavitation model.

    ``viscosity_ratio`` is that in the warm films of a body over that of the fluid; one if not
    given. [-]
    """

    def one(interface: FilmInterface) -> FilmLaw:
        liquid = FilmFluid(
            fluid.dynamic_viscosity * viscosity_ratio.get(interface.body, 1.0),
            fluid.pressure_viscosity,
            limit_pressure=HIGHEST_PRESSURE,
        )
        surfaces = interface.face.surfaces
        rough = surfaces is not None and surfaces.roughness > 0.0
        return film_law(RoughSurfaces(**vars(surfaces)) if rough else None, liquid, cavitation)

    return tuple(map(one, balance.interfaces))


def numbers_of(problem: LateralProblem, balance: Balance) -> LateralNumbers:
    """Mean numbers of a state over its snapshots."""
    stack, back = problem.stack, problem.loads.back
    speed, count = stack.shaft_speed, len(balance.states)
    films = [film for state in balance.states for film in state.films]
    lost = [film.losses for film in films]
    held_down = [float(s.hold_down(back.low)[0]) for s in balance.states]
    margins = [s.tipping_margin(back.low) for s in balance.states]
    span = max(back.high - back.low, 1.0)
    areas = []
    for f in films:
        own = f.grid.interface.face.surfaces
        if own is None or own.roughness <= 0.0:
            area = 0.0
        else:
            share = real_contact_share(
                f.contact,
                own.roughness,
                own.correlation_length,
                own.effective_modulus,
                own.hardness,
            )
            area = float((share * f.grid.area).sum())
        areas.append(area)
    return LateralNumbers(
        position=stack.gauge(balance.position),
        gaps=np.mean([s.mean_gaps() for s in balance.states], axis=0),
        smallest_gap=min(s.smallest_gap() for s in balance.states),
        leakage=sum(x.pressure for x in lost) / count / span,
        bore_flow=sum(x.bore_flow for x in lost) / count,
        viscous_torque=sum(x.shear for x in lost) / count / speed,
        asperity_torque=sum(x.asperity for x in lost) / count / speed,
        contact_force=sum(float((f.contact * f.grid.area).sum()) for f in films) / count,
        real_contact_area=sum(areas) / count,
        contact_share=float(np.mean([_contact_share(f) for f in films])),
        wear_power=max(float(wear_power(f, speed).max()) for f in films),
        friction_force=float(balance.friction[: max(len(stack.balance.halves), 1)].sum()),
        hold_down_force=float("nan") if stack.two_floating else min(held_down),
        tipping_margin=float("nan") if stack.two_floating else min(margins),
        positions=stack.positions(balance.position),
        tilt=max(stack.tilts(balance.position)),
    )


def wear_power(film: FaceFilm, shaft_speed: float) -> Array:
    """Asperity pressure times sliding speed, the indicator of wear. [W/m2]."""
    speed = abs(film.grid.interface.speed_ratio) * shaft_speed * film.grid.radius
    return film.contact * speed


def _contact_share(film: FaceFilm) -> float:
    area = np.where(film.boundary.mask.film, film.grid.area, 0.0)
    surfaces = film.grid.interface.face.surfaces
    hardness = np.inf if surfaces is None else surfaces.hardness
    touching = film.contact > _TOUCH * hardness
    return float((area * touching).sum() / area.sum())


def wear_map(balances: Sequence[Balance]) -> Array:
    """Wear indicator at the places of the bearings, mean over all shaft angles. [W/m2].

    Asperity pressure times sliding speed; zero where no asperity ever touches, shape (films, rows,
    columns).

    Parameters
    ----------
    balances : sequence of Balance
        States, with one or several shaft angles each.
    """
    states = [state for balance in balances for state in balance.states]
    total = np.zeros((len(states[0].films), *states[0].films[0].grid.area.shape))
    for state in states:
        for k, film in enumerate(state.films):
            total[k] += wear_power(film, film.boundary.shaft_speed)
    return total / len(states)


def film_places(stack: Stack) -> Mapping[str, Array]:
    """Places of the cells of all films, by the names of results."""
    return {
        "film_angle": stack.grids[0].angle,
        "film_radius": np.array([grid.radius for grid in stack.grids]),
        "film_center_x": np.array([grid.interface.face.center[0] for grid in stack.grids]),
        "film_center_y": np.array([grid.interface.face.center[1] for grid in stack.grids]),
    }


def film_fields(balance: Balance) -> Mapping[str, Array]:
    """Fields of all films by the names of results: at the last shaft angle, wear over all."""
    films = balance.states[-1].films
    low = films[0].boundary.low_pressure
    deformation = [
        f.compliance * np.where(f.boundary.mask.film, f.total - low, 0.0) + d
        for f, d in zip(films, balance.states[-1].distant, strict=True)
    ]
    return {
        "film_pressure": np.stack([f.pressure for f in films]),
        "film_height": np.stack([np.where(f.boundary.mask.film, f.gap, np.nan) for f in films]),
        "film_contact_pressure": np.stack([f.contact for f in films]),
        "film_wear_power": wear_map([balance]),
        "film_deformation": np.stack(deformation),
        "film_fraction": np.stack([f.plane.fields.saturation for f in films]),
    }


@final
class LateralTrack:
    """Record of a march, which holds the films of its last step only: those of all fill memory.

    Attributes
    ----------
    positions : list of float
        Position of the floating bearing at its gauge point after every step. [m]
    iterations : list of int
        Film solutions of every step. [-]
    residuals : list of float
        Largest residual force of every step over the balance force. [-]
    converged : bool
        Whether every step was in balance.
    interrupted : bool
        Whether the user stopped the march before its end.
    """

    def __init__(self, shaft_angle: Array) -> None:
        self._shaft_angle = shaft_angle
        self.positions: list[float] = []
        self.iterations: list[int] = []
        self.residuals: list[float] = []
        self.converged = True
        self.interrupted = False
        self._wear = np.zeros(())
        self._last: Balance | None = None

    def take(self, balance: Balance, wear: Array) -> None:
        """Add a step with its wear indicator, shape (films, rows, columns). [W/m2]."""
        self.positions.append(balance.states[0].stack.gauge(balance.position))
        self.iterations.append(balance.iterations)
        self.residuals.append(balance.residual)
        self.converged = self.converged and balance.converged
        self._wear = self._wear + wear
        self._last = balance

    @property
    def shaft_angle(self) -> Array:
        """Angles at the ends of the steps that were made. [rad]."""
        return self._shaft_angle[: len(self.positions)]

    @property
    def last(self) -> Balance:
        """State after the last step."""
        assert self._last is not None
        return self._last

    @property
    def wear(self) -> Array:
        """Wear indicator, mean over all steps. [W/m2]."""
        return np.asarray(self._wear / len(self.positions))
