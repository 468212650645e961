"""The one seam: what a machine type gives to the solver, as tables over angles.

A machine type fills a :class:`MachineDescription`; model and solver see nothing else.

Frame and signs: origin at the drive gear (gerotor: centre of the outer rotor), y towards
the driven gear, x towards the outlet, angles right-handed, shaft turning positive.
Every table angle grows with the shaft angle: ``angle = phase + angle_ratio * shaft_angle``.

Nodes of the network are numbered: chambers of the families in their order, then
``inlet``, ``outlet`` and ``drain``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Literal, final

import numpy as np

from toothspace.closures.journal_friction import FrictionCurves
from toothspace.core.finding import DesignCheck
from toothspace.core.keys import quantity
from toothspace.core.lazy import Lazy
from toothspace.core.types import Array, IntArray
from toothspace.model.contact_pair import CONTACT_CHANNELS, ContactPair, RigidMesh
from toothspace.model.film_faces import FacePlaces, FilmFace, SharedFaces
from toothspace.model.floating_bearing import LateralBalance
from toothspace.model.lateral_table import LateralTable
from toothspace.model.ledger import FRICTION_MECHANISMS
from toothspace.model.machine_parts import PATH_CHANNELS, ChamberFamily, FlowPath, Motion, PathKind
from toothspace.model.path_category import PathCategory
from toothspace.numerics.periodic_table import PeriodicTable

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "CONTACT_CHANNELS",
    "PATH_CHANNELS",
    "Body",
    "BodyRole",
    "ChamberFamily",
    "ContactPair",
    "DesignCheck",
    "FlowPath",
    "FreeBlocks",
    "LumpedJournalBearing",
    "LumpedLateralFilm",
    "MachineDescription",
    "Motion",
    "PathKind",
    "RigidMesh",
    "RunningIn",
]

BodyRole = Literal["shaft", "driven", "floating"]
BreakawayLaw = Literal["total", "additive", "interfaces"]


@final
@dataclass(frozen=True)
class Body:
    """A rigid body that may move by micrometres about its kinematic place."""

    name: str
    """Label in results, for example ``drive_gear``."""
    center: tuple[float, float]
    """Nominal centre. [m]"""
    speed_ratio: float
    """Angular speed over shaft speed, negative if it turns the other way. [-]"""
    mass: float
    """Mass. [kg]"""
    inertia: float
    """Moment of inertia about its axis. [kg m2]"""
    role: BodyRole
    """``shaft``: the body that sits on the drive shaft; ``driven``: turned by it through the teeth,
    whichever way; ``floating``: does not turn.
    """
    wetted_area: float = 0.0
    """Area of the teeth that the oil in the chambers wets. [m2]"""


def categories_of(paths: Iterable[FlowPath]) -> tuple[PathCategory, ...]:
    """Categories of paths, in the order in which they appear."""
    return tuple(dict.fromkeys(path.category for path in paths))


@final
@dataclass(frozen=True, eq=False)
class SolvedJournal:
    """What a solved Reynolds equation puts in place of the closed form of a journal bearing."""

    force_nodes: Array
    """Nodes of a :class:`~toothspace.closures.bearing_map.JournalMap`. [-]"""
    shear: Array
    """Viscous shear over that of the closed form, at eccentricity ratios from 0 to ``shear_range``
    in equal steps. Shape (n,). [-]
    """
    shear_range: float = 1.0
    """Last eccentricity ratio; beyond it the last value holds. [-]"""


@final
@dataclass(frozen=True)
class LumpedJournalBearing:
    """Equal journal bearings of one body, sharing its radial load."""

    body: str
    """Body that they carry."""
    count: int
    """Number of bearings."""
    diameter: float
    length: float
    radial_clearance: float
    """Size of each bearing. [m]"""
    roughness: float
    """Combined root mean square roughness of journal and bush. [m]"""
    correlation_length: float
    """Half-height correlation length of the combined roughness. [m]"""
    effective_modulus: float
    """E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]"""
    hardness: float
    """Hardness of the softer surface. [Pa]"""
    boundary_friction: float
    """Friction coefficient of touching asperities. [-]"""
    seat_clearance: float = 0.0
    """Radial clearance of the bearing blocks in the housing; they rest against the wall in the
    direction of the mean load. [m]
    """
    end_condition: Literal["pressure", "no_flow"] = "pressure"
    """Both ends of the film: ``pressure`` (open, fluid leaves there) or ``no_flow`` (closed by
    walls: pressure is uniform along the axis, the limit of a long bearing).
    """
    solved: SolvedJournal | None = None
    """Solved film in place of the closed form."""
    friction: FrictionCurves | None = None
    """Friction coefficient over load and Sommerfeld number, in place of the closed form."""
    viscosity_ratio: float = 1.0
    """Viscosity in the film over that of the fluid. [-]"""


@final
@dataclass(frozen=True)
class FreeBlocks:
    """Bearing blocks that move together in the housing and carry the bearings of all bodies."""

    mass: float
    """Mass of all blocks. [kg]"""
    film: LumpedJournalBearing
    """Film and asperities between blocks and housing; does not turn."""
    port_area: float = 0.0
    """Projected area on which the pressures of inlet and outlet press the blocks towards the other
    port. [m2]
    """


@final
@dataclass(frozen=True)
class LumpedLateralFilm:
    """Film on the faces of one body, with a closed form for its friction."""

    body: str
    """Body whose faces it covers."""
    faces: int
    """Number of faces."""
    height: float
    """Film height at the axis. [m]"""
    inner_radius: float
    root_radius: float
    outer_radius: float
    """Shaft, full annulus and tooth tip radius. [m]"""
    tooth_area_fraction: float
    """Part of the ring between root and outer radius that is tooth, weighted with r^2. [-]"""
    tilt: float = 0.0
    """Change of height at the outer radius over the height at the axis (0 parallel). [-]"""
    face: Lazy[FilmFace] | None = None
    """Gives what stands before its faces, for solving it on a grid, if the machine type can."""
    lagging_face: Lazy[FilmFace] | None = None
    """The same of the end that lags, where that differs."""
    drag: float | None = None
    """Torque per viscosity and speed of the body on one face, in place of the closed form. [m3]"""
    asperity_share: float = 0.0
    """Part of the torque that touching asperities cause. [-]"""
    viscosity_ratio: float = 1.0
    """Viscosity in the film over that of the fluid. [-]"""


@final
@dataclass(frozen=True)
class RunningIn:
    """``wear_in``: condition at which the bodies cut their track into the casing before use."""

    pressure: float = quantity("bar", "Pressure on the high-pressure side.", above=0, high=1000)
    """Absolute pressure on the high-pressure side; the low side is at one atmosphere. [Pa]"""
    shaft_speed: float = quantity("rpm", "Shaft speed.", above=0, high=50000)
    """Shaft speed. [rad/s]"""
    temperature: float = quantity("degC", "Fluid temperature.", low=-60, high=250)
    """Fluid temperature. [K]"""


@final
@dataclass(frozen=True)
class StartupFriction:
    """Friction that holds the shaft at rest."""

    law: BreakawayLaw
    """Whether the torque stands for all interfaces, they resist besides, or it is their sum."""
    torque: float
    """Breakaway torque; zero where it is the sum of the interfaces. [N m]"""
    speed: float
    """Speed up to which friction stays there. [rad/s]"""
    seal_ratio: float = 1.0
    """Friction of the shaft seal at rest over that in running, in the sum of the interfaces. [-]"""


@final
@dataclass(frozen=True)
class Winding:
    """Teeth that wind about the axes of their bodies."""

    turn_per_length: float
    """Shaft angle by which sections along the axis lead, positive where the shaft's teeth are
    right-handed. [rad/m]
    """
    twist: float
    """Shaft angle between the sections at both ends. [rad]"""
    section: MachineDescription
    """The machine with the section of the middle over its whole width."""
    along: Callable[[FlowPath], tuple[FlowPath, ...]]
    """What a path of that section becomes along the teeth."""
    slices: int = 1
    """Parts of the width in each of which a tooth space is a chamber of its own."""


@final
@dataclass(frozen=True)
class MachineDescription:
    """A machine as the solver sees it.

    Parameters
    ----------
    name, mode : str
        Machine type, and ``pump`` or ``motor``.
    displacement : float
        Geometric volume per shaft radian, single flank. [m3/rad]
    bodies, motions, families, paths, journals, laterals, contacts, mesh
        Parts, see their classes.
    winding : Winding or None
        How teeth wind about the axes; None where they run along them.
    seal_torque : float
        Constant shaft seal torque. [N m]
    free_blocks : FreeBlocks or None
        Bearing blocks that follow their load; None: they rest.
    startup : StartupFriction or None
        Friction of the shaft at rest; None leaves it out.
    port_volumes : tuple of float
        Volumes at inlet and outlet. [m3]
    drain : str
        Node that collects the drain: ``inlet``, ``outlet`` or ``external``.
    drain_pressure : float
        Absolute pressure of an external drain. [Pa]
    running_in : RunningIn or None
        Condition of running-in; None leaves the casing as made.
    floating : Lazy or None
        Gives the films beside the gears with the floating bearing, see :attr:`lateral_balance`.
    lateral_table : LateralTable or None
        Drag and leakage beside the gears over the load on that bearing, for closed-form films.
    shared_faces : SharedFaces or None
        Films beside bodies that share their covers, for solving them on a grid.
    face_places : FacePlaces or None
        Where bodies that float between those covers stand, once this is known.
    rings_on_films : bool
        Whether bodies ring on the compressed liquid of films that are chambers.
    outlines : mapping of name to ndarray, shape (points, 2)
        Closed polygons for drawing: one per body (own frame, at shaft angle zero), plus
        ``casing``, grooves and ports in the machine frame. [m]
    chamber_outlines : callable or None
        From a shaft angle to the outlines of the chambers in the machine frame, for drawing; None
        if the machine type gives none. [rad], [m]
    geometry_summary : mapping
        Numbers of ``toothspace geometry --json``, names with unit suffix.
    checks : sequence of DesignCheck
        Design-rule report. This and the summary may be lazy, so that no run waits for them.
    as_drawn : mapping of str to str
        Keys of a case that give the machine with what its files hold in place of what was fitted
        to it, where the two differ more than they should; a run is then made with both.
    """

    name: str
    mode: Literal["pump", "motor"]
    displacement: float
    bodies: tuple[Body, ...]
    motions: tuple[Motion, ...]
    families: tuple[ChamberFamily, ...]
    paths: tuple[FlowPath, ...]
    journals: tuple[LumpedJournalBearing, ...] = ()
    laterals: tuple[LumpedLateralFilm, ...] = ()
    contacts: tuple[ContactPair, ...] = ()
    mesh: RigidMesh | None = None
    winding: Winding | None = None
    seal_torque: float = 0.0
    free_blocks: FreeBlocks | None = None
    startup: StartupFriction | None = None
    port_volumes: tuple[float, float] = (50e-6, 50e-6)
    drain: Literal["inlet", "outlet", "external"] = "inlet"
    drain_pressure: float = 1e5
    running_in: RunningIn | None = None
    floating: Lazy[LateralBalance] | None = None
    lateral_table: LateralTable | None = None
    shared_faces: SharedFaces | None = None
    face_places: FacePlaces | None = None
    rings_on_films: bool = False
    outlines: Mapping[str, Array] = field(default_factory=dict)
    chamber_outlines: Callable[[float], Sequence[Array]] | None = None
    geometry_summary: Mapping[str, object] = field(default_factory=dict)
    checks: Sequence[DesignCheck] = ()
    as_drawn: Mapping[str, str] = field(default_factory=dict)

    @property
    def lateral_balance(self) -> LateralBalance | None:
        """Films beside the gears and the floating bearing, made when asked first; None without.

        Raises GeometryError if loads stand beside the bearing or areas do not fit on it.
        """
        return None if self.floating is None else self.floating.value

    @property
    def known_faces(self) -> dict[str, FilmFace]:
        """What stands before the faces of bodies, where the machine type gives it."""
        return {film.body: film.face.value for film in self.laterals if film.face is not None}

    def with_balance(self, balance: LateralBalance) -> MachineDescription:
        """Machine with another floating bearing."""
        return replace(self, floating=Lazy(partial(replace, balance)))

    @property
    def pitch_angle(self) -> float:
        """Shaft angle after which the chambers look the same. [rad]."""
        first = self.families[0]
        return float(first.volume.period / (first.count * abs(first.angle_ratio)))

    @property
    def chamber_count(self) -> int:
        """Number of chambers of all families."""
        return sum(family.count for family in self.families)

    @property
    def inlet_node(self) -> int:
        """Node number of the inlet."""
        return self.chamber_count

    @property
    def outlet_node(self) -> int:
        """Node number of the outlet."""
        return self.chamber_count + 1

    @property
    def drain_node(self) -> int:
        """Node number of the drain."""
        return self.chamber_count + 2

    @property
    def path_categories(self) -> tuple[PathCategory, ...]:
        """What its flow paths are booked under, in the order in which they appear."""
        return categories_of(self.paths)

    @property
    def friction_mechanisms(self) -> tuple[str, ...]:
        """Friction that the machine can have, of all that the ledger knows, in its order."""
        present: set[str] = {contact.friction_account for contact in self.contacts}
        present |= {"journal_viscous", "journal_asperity"} if self.journals else set()
        present |= {"lateral_viscous", "lateral_asperity"} if self.laterals else set()
        if any(path.shear_speed is not None for path in self.paths):
            present.add("tip_shear")
        if self.mesh is not None:
            present.add("mesh_friction")
        if self.seal_torque != 0.0:
            present.add("shaft_seal")
        if self.startup is not None:
            present.add("startup")
        return tuple(name for name in FRICTION_MECHANISMS if name in present)

    @property
    def chamber_labels(self) -> list[str]:
        """Labels of the chambers, family and number."""
        return [f"{family.name}_{k}" for family in self.families for k in range(family.count)]

    def body_index(self, name: str) -> int:
        """Position of a body in :attr:`bodies`."""
        return [body.name for body in self.bodies].index(name)

    def motion_index(self, body: str, axis: str) -> int:
        """Position of a motion in :attr:`motions`."""
        return [f"{m.body}.{m.axis}" for m in self.motions].index(f"{body}.{axis}")

    @property
    def parts_spaces(self) -> bool:
        """Whether a tooth space that winds about its axis is more than one chamber."""
        winding = self.winding
        return winding is not None and self.chamber_count != winding.section.chamber_count

    def chambers_in_section(self, shaft_angle: float, lead: float) -> IntArray:
        """Chambers that the spaces of a section hold, in the order of its own chambers.

        A space that the mating tooth cuts in two holds the one whose section passes there, one in
        slices that of the slice.

        Parameters
        ----------
        shaft_angle : float
            Shaft angle of the middle. [rad]
        lead : float
            Shaft angle by which the section leads. [rad]
        """
        winding = self.winding
        assert winding is not None
        place = 0.5 + lead / float(np.copysign(winding.twist, winding.turn_per_length))
        part = min(max(int(winding.slices * place), 0), winding.slices - 1)
        found, first = [], 0
        for k, own in enumerate(self.families):
            if k % winding.slices == part:
                ids = np.arange(own.count)
                if winding.slices == 1:
                    ids = _passing(own, winding.section.families[k], shaft_angle + lead)
                found.append(first + ids)
            first += own.count
        return np.concatenate(found)

    def to_dataset(self) -> xr.Dataset:
        """Collect all tables over their angles, outlines and summary in one dataset."""
        attributes: dict[str, str | float] = {"machine": self.name, "mode": self.mode}
        attributes["displacement"] = self.displacement
        for key, value in self.geometry_summary.items():
            if isinstance(value, int | float):
                attributes[key] = float(value)
        return tables_dataset(self.angle_tables(), self.outlines, attributes)

    def angle_tables(self) -> list[AngleTable]:
        """List every table: chamber families, flow paths, contacts."""
        return angle_tables(self.families, self.paths, self.contacts, self.motions)

    def with_running_in(self, depths: Mapping[str, Array]) -> MachineDescription:
        """Deepen wearing gaps by running-in depths of each body at their table nodes. [m]."""

        def deeper(table: PeriodicTable, depth: Array) -> PeriodicTable:
            step = table.period / table.values.shape[0]
            values, slopes = table.values.copy(), table.slopes.copy()
            values[:, 0] += depth
            slopes[:, 0] += (np.roll(depth, -1) - np.roll(depth, 1)) / (2.0 * step)
            return PeriodicTable(table.period, values, slopes)

        paths = list(self.paths)
        for k, path in enumerate(paths):
            depth = depths.get(path.worn_by or "")
            if depth is not None:
                own = tuple(deeper(table, depth) for table in path.own)
                paths[k] = replace(path, geometry=deeper(path.geometry, depth), own=own)
        return replace(self, paths=tuple(paths))


def _passing(own: ChamberFamily, spaces: ChamberFamily, section_angle: float) -> IntArray:
    """Chambers that pass a section in its spaces, at its own shaft angle [rad]."""
    turned = own.angle_ratio * section_angle
    period, turn = own.volume.period, spaces.volume.period
    begun = 0.0 if period == turn else 0.5 * turn  # fillings begin in the middle of the mesh
    wanted = np.mod(spaces.phases + turned - begun, turn)
    away = np.mod(own.phases + turned, period)[:, None] - wanted
    away -= period * np.rint(away / period)
    return np.asarray(np.argmin(np.abs(away), axis=0))


if TYPE_CHECKING:
    import xarray as xr

_CHANNEL_UNITS = {
    "area": "m2",
    "hydraulic_diameter": "m",
    "height": "m",
    "width": "m",
    "length": "m",
    "relative_radius": "m",
    "gap": "m",
    "load_share": "1",
    "radius_a": "m",
    "radius_b": "m",
    "sliding_speed": "m/rad",
    "rolling_speed_sum": "m/rad",
}


@final
@dataclass(frozen=True)
class Column:
    """One tabulated quantity: name, SI unit and values at the nodes of its table."""

    name: str
    units: str
    values: Array


@final
@dataclass(frozen=True)
class AngleTable:
    """All columns of one chamber family, path or contact over its table angle."""

    name: str
    """Name of the family, path or contact."""
    meaning: str
    """What it is, for the header."""
    angle_ratio: float
    """Growth of the table angle per shaft angle. [-]"""
    phases: Array
    """Table angle of each member at shaft angle zero. [rad]"""
    columns: tuple[Column, ...]
    """Quantities; the first is the table angle [rad]."""


def angle_tables(
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    contacts: Sequence[ContactPair],
    motions: Sequence[Motion],
) -> list[AngleTable]:
    """List every table of a machine: chamber families, flow paths, contacts."""
    found: list[AngleTable] = []

    def add(
        meaning: str, part: ChamberFamily | FlowPath | ContactPair, columns: list[Column]
    ) -> None:
        nodes = _nodes(part.volume if isinstance(part, ChamberFamily) else part.geometry)
        columns = [Column("angle", "rad", nodes), *columns]
        found.append(AngleTable(part.name, meaning, part.angle_ratio, part.phases, tuple(columns)))

    for family in families:
        columns = [
            Column("volume", "m3", family.volume.values[:, 0]),
            Column("volume_slope", "m3/rad", family.volume.slopes[:, 0]),
        ]
        by_motion = family.volume_by_motion(_nodes(family.volume))
        columns += _motion_columns("volume", by_motion, motions, ("m2", "m3/rad"))
        add("chamber family", family, columns)
    for path in paths:
        nodes = _nodes(path.geometry)
        columns = _channel_columns(PATH_CHANNELS[path.kind], path.geometry)
        for name, table in (("drag_speed", path.drag_speed), ("shear_speed", path.shear_speed)):
            if table is not None:
                columns.append(Column(name, "m/rad", table(nodes)[:, 0]))
        if path.height_by_motion is not None:
            by_motion = path.height_by_motion(nodes)
            columns += _motion_columns("height", by_motion, motions, ("1", "m/rad"))
        add(f"{path.kind} path ({path.category.name})", path, columns)
    for contact in contacts:
        nodes = _nodes(contact.geometry)
        columns = _channel_columns(CONTACT_CHANNELS, contact.geometry)
        columns += _motion_columns("gap", contact.gap_by_motion(nodes), motions, ("1", "m/rad"))
        if contact.gap_by_shift_and_turn is not None:
            second = contact.gap_by_shift_and_turn(nodes)
            names = ("gap_by_shifts", "1/m"), ("gap_by_shift_and_turn", "1"), ("gap_by_turns", "m")
            columns += [Column(*n, v) for n, v in zip(names, second.T, strict=True)]
        add(f"contact of {contact.body_a} and {contact.body_b}", contact, columns)
    return found


def tables_dataset(
    tables: Sequence[AngleTable],
    outlines: Mapping[str, Array],
    attributes: Mapping[str, str | float],
) -> xr.Dataset:
    """Collect the tables of a machine in one dataset; each has its own angle dimension.

    Variables ``<table>_<quantity>`` over ``<table>_angle``, phases of the members and outlines.

    Parameters
    ----------
    tables : sequence of AngleTable
        Tables of the machine.
    outlines : mapping of str to ndarray
        Outlines by name, shape (n, 2). [m]
    attributes : mapping
        Attributes of the dataset.
    """
    import xarray as xr

    dataset = xr.Dataset(attrs=dict(attributes))
    for table in tables:
        dimension = f"{table.name}_angle"
        for column in table.columns:
            labels = {"units": column.units, "long_name": f"{table.meaning}: {column.name}"}
            dataset[f"{table.name}_{column.name}"] = (dimension, column.values, labels)
        labels = {"units": "rad", "long_name": "table angle of each member at shaft angle zero"}
        dataset[f"{table.name}_phase"] = (f"{table.name}_member", table.phases, labels)
    for name, points in outlines.items():
        labels = {"units": "m", "long_name": f"outline of {name}"}
        dataset[f"{name}_outline"] = ((f"{name}_point", "plane_axis"), points, labels)
    return dataset


def _nodes(table: PeriodicTable) -> Array:
    count = table.values.shape[0]
    return table.period * np.arange(count) / count


def _channel_columns(names: Sequence[str], table: PeriodicTable) -> list[Column]:
    return [Column(n, _CHANNEL_UNITS[n], table.values[:, k]) for k, n in enumerate(names)]


def _motion_columns(
    name: str, values: Array, motions: Sequence[Motion], units: tuple[str, str]
) -> list[Column]:
    return [
        Column(
            f"{name}_by_{motion.body}_{motion.axis}",
            units[1] if motion.axis == "rotation" else units[0],
            values[:, k],
        )
        for k, motion in enumerate(motions)
    ]
