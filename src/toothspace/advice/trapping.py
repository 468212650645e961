"""Spaces in the mesh without a run: cross-port leakage, trapped pressure, edges to move.

While two pairs of flanks touch, the spaces between them have no way out but the relief grooves and
the backlash. Volume rates, groove openings and throats together give their pressures.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np

from toothspace.closures.gap_flow import curved_gap_conductance
from toothspace.closures.orifice import DISCHARGE_COEFFICIENT, orifice_conductance
from toothspace.core.finding import DesignCheck
from toothspace.core.types import Array, IntArray
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.meshing import MeshedGears, displacement, relative_radius
from toothspace.gearing.spaces import Spaces, section_areas
from toothspace.model.description import ChamberFamily, FlowPath

PEAK_LIMIT = 1.5
"""Highest pressure of a trapped space over the high pressure. [-]"""

SINGLE_FLANK_LIMIT = 0.1
"""Pressure drop in the backlash over the high pressure up to which both spaces act as one. [-]"""

VISCOSITY = 0.027
"""Dynamic viscosity of the estimate, ISO VG 46 at 50 degC. [Pa s]"""

_ITERATIONS = 60
_RESIDUAL_CONDUCTANCE = 1e-15
_EDGE_STEP = 0.05e-3
_EDGE_STEPS = 30
_ADVICE = {
    "closing": (
        -1.0,
        " Bring the edge of the closing-side contour nearer to the centre line.",
        " No closing-side edge alone cures it: widen the backlash or deepen the groove.",
    ),
    "opening": (
        1.0,
        " Take the edge of the opening-side contour away from the centre line.",
        " No opening-side edge alone cures it: move the closing-side edge away as well.",
    ),
}
"""Way of the edge that cures, advice for a contour, and where no edge cures."""
SHORT_CIRCUIT_LIMIT = 0.01
"""Flow from high to low pressure through joined openings over the ideal flow. [-]"""
DENSITY = 850.0
"""Density of the estimate, mineral oil. [kg/m3]"""
_ANGLES = 48
_PORTS = ("inlet", "outlet")


@final
@dataclass(frozen=True)
class Opening:
    """Openings of one kind; arrays over angles and spaces."""

    area: Array
    """Discharge coefficient times area. [m2]"""
    conductance: Array
    """Flow rate per pressure drop in creeping flow. [m3/(s Pa)]"""

    def secant(self, drop: Array) -> Array:
        """Flow rate over a pressure drop. [m3/(s Pa)]."""
        open_ = self.area > 0.0
        ratio = self.conductance / np.where(open_, self.area, 1.0)
        root = np.sqrt(1.0 + 2.0 * DENSITY * ratio**2 * np.abs(drop))
        return np.where(open_, 2.0 * self.conductance / (1.0 + root), 0.0)


@final
@dataclass(frozen=True)
class MeshChain:
    """Spaces in the mesh over one pitch, drive and driven ones in turn; shape (angles, spaces)."""

    growth: Array
    """Change of volume with the shaft angle. [m3/rad]"""
    to_inlet: Opening
    to_outlet: Opening
    """Openings of the bore and grooves of both faces to either port."""
    throat: Opening
    """Throats to the next space, shape (angles, spaces - 1)."""


@final
@dataclass(frozen=True)
class Trapping:
    """What the mesh does to the fluid that it encloses, at one pressure and speed."""

    peak_pressure: float
    """Highest pressure of a space in the mesh. [Pa]"""
    exchange_drop: float
    """Largest pressure drop in a throat that alone takes what a space displaces. [Pa]"""
    short_circuit: float
    """Mean flow from high to low pressure through joined openings over the ideal flow. [-]"""


@final
@dataclass(frozen=True, eq=False)
class EnclosedMesh:
    """Tooth spaces in a mesh, what opens them to the ports, and the condition to judge them at."""

    gears: MeshedGears
    """Gears in mesh."""
    spaces: tuple[Spaces, Spaces]
    """Tooth spaces of both gears over a turn."""
    port_openings: tuple[Mapping[str, Array], Mapping[str, Array]]
    """Length of the port openings of drive and driven spaces. [m]"""
    groove_openings: Callable[[ReliefGrooves, Spaces], Mapping[str, Array]]
    """Area and hydraulic diameter into the groove of each port, for grooves of a size. [m2], [m]"""
    grooves: ReliefGrooves | None
    """Relief grooves in the faces."""
    tip_rounding: float
    """Radius of the edge between flank and tip. [m]"""
    is_pump: bool
    """Whether the outlet is at high pressure."""
    condition: DesignCondition
    """Pressure and shaft speed."""
    groove_spacing: float | None
    """Distance at which grooves of an involute pair vent all that is enclosed. [m]"""

    @cached_property
    def trapping(self) -> Trapping:
        """What the mesh does to the fluid that it encloses."""
        return trapping(mesh_chain(self), self)

    def with_grooves(self, grooves: ReliefGrooves) -> EnclosedMesh:
        """The same gears with other relief grooves."""
        return replace(self, grooves=grooves)


def mesh_chain(mesh: EnclosedMesh) -> MeshChain:
    """Put the spaces round the centre line in the order in which throats join them.

    Three spaces of each gear over one pitch of the shaft angle.
    """
    spaces = mesh.spaces
    count = spaces[0].angles.size // mesh.gears.counts[0]
    order = [(turn, gear) for turn in (-1, 0, 1) for gear in (0, 1)]
    rows = [_rows(spaces[gear], count, turn, gear) for turn, gear in order]
    # the trailing throat of a drive space, then the leading one of the drive space behind
    passages = [_rows(spaces[0], count, turn + gear, 0) for turn, gear in order[:-1]]
    throats = []
    for flank in (spaces[0].left, spaces[0].right):
        # without a complete throat both spaces are wide open to the same port
        gap = np.where(flank.weight > 0.0, np.maximum(flank.gap, 0.0), 0.0)
        width = mesh.gears.face_width
        radius = relative_radius(mesh.gears.mesh, flank, mesh.tip_rounding)
        throats.append(Opening(width * gap, curved_gap_conductance(gap, width, radius, VISCOSITY)))
    growth = []
    for side in spaces:
        area, step = section_areas(side), 2.0 * np.pi / side.angles.size
        rate = (np.roll(area, -1) - np.roll(area, 1)) / (2.0 * step)
        growth.append(mesh.gears.face_width * rate * side.angle_ratio)
    ports = []
    for gear in (0, 1):
        face, found = mesh.gears.face_width, {}
        grooves: Mapping[str, Array] = {}
        if mesh.grooves is not None:
            grooves = mesh.groove_openings(mesh.grooves, mesh.spaces[gear])
        for side_port, length in mesh.port_openings[gear].items():
            mouth = face * length
            conductance = orifice_conductance(mouth, 2.0 * mouth / (face + length), VISCOSITY)
            if side_port in grooves:
                groove, diameter = grooves[side_port].T
                mouth = mouth + 2.0 * groove
                conductance = conductance + 2.0 * orifice_conductance(groove, diameter, VISCOSITY)
            found[side_port] = Opening(DISCHARGE_COEFFICIENT * mouth, conductance)
        ports.append(found)

    def gathered(port: str) -> Opening:
        return _columns([ports[gear][port] for _, gear in order], rows)

    return MeshChain(
        np.column_stack([growth[gear][at] for (_, gear), at in zip(order, rows, strict=True)]),
        gathered("inlet"),
        gathered("outlet"),
        _columns([throats[gear] for _, gear in order[:-1]], passages),
    )


def _rows(spaces: Spaces, count: int, turn: int, gear: int) -> IntArray:
    # driven spaces stand half a pitch behind the drive spaces of the same number
    size = spaces.angles.size
    return (size // 2 - gear * (count // 2) + np.arange(count) - turn * count) % size


def _columns(openings: list[Opening], rows: list[IntArray]) -> Opening:
    pairs = list(zip(openings, rows, strict=True))
    return Opening(
        np.column_stack([opening.area[at] for opening, at in pairs]),
        np.column_stack([opening.conductance[at] for opening, at in pairs]),
    )


def trapping(chain: MeshChain, mesh: EnclosedMesh) -> Trapping:
    r"""Pressures of the spaces in the mesh, of an incompressible fluid at one shaft speed.

    Highest pressure, exchange through the backlash and short circuit.

    Notes
    -----
    In each space :math:`\omega\,\mathrm dV/\mathrm d\varphi + \sum Q(\Delta p) = 0` with the laws
    of the flow paths; a space that cannot be filled has pressure zero. Validity: gears centred in
    their bearings, mineral oil, no compressibility (a space that is all but shut has its pressure
    overestimated many times).

    References
    ----------
    .. [1] A. Vacca, M. Guidetti, Modelling and experimental validation of external spur gear
       machines for fluid power applications, Simul. Model. Pract. Theory 19 (2011) 2007-2031.
    """
    condition = mesh.condition
    speed, difference = condition.shaft_speed, condition.pressure_difference
    pressures = _pressures(chain, mesh.is_pump, condition)
    joined = in_series(chain.to_inlet.area, chain.to_outlet.area).sum(axis=1)
    for here, there in ((chain.to_outlet, chain.to_inlet), (chain.to_inlet, chain.to_outlet)):
        through = in_series(chain.throat.area, in_series(here.area[:, :-1], there.area[:, 1:]))
        joined += through.sum(axis=1)
    rate = float(np.mean(joined) * np.sqrt(2.0 * difference / DENSITY))
    # a shut space that shrinks passes all through the wider of its throats
    sides = np.pad(chain.throat.area, ((0, 0), (1, 1)))
    wider = np.maximum(sides[:, :-1], sides[:, 1:])
    shut = chain.to_inlet.area + chain.to_outlet.area == 0.0
    shut &= (chain.growth < 0.0) & (wider > 0.0)
    velocity = speed * chain.growth[shut] / wider[shut]
    return Trapping(
        peak_pressure=float(pressures.max()),
        exchange_drop=float(0.5 * DENSITY * np.max(velocity**2, initial=0.0)),
        short_circuit=rate / (displacement(mesh.gears) * speed),
    )


def _pressures(chain: MeshChain, is_pump: bool, condition: DesignCondition) -> Array:
    """Pressure of each space: flows over pressure drops of the last iterate, solved anew. [Pa]."""
    low, high = ATMOSPHERIC_PRESSURE, condition.pressure
    inlet, outlet = (low, high) if is_pump else (high, low)
    rate = condition.shaft_speed * chain.growth
    count = rate.shape[1]
    found, empty = np.full(rate.shape, high), np.zeros(rate.shape, dtype=bool)
    for _ in range(_ITERATIONS):
        to_inlet = chain.to_inlet.secant(found - inlet) + _RESIDUAL_CONDUCTANCE
        to_outlet = chain.to_outlet.secant(found - outlet) + _RESIDUAL_CONDUCTANCE
        between = chain.throat.secant(np.diff(found, axis=1))
        supply = to_inlet * inlet + to_outlet * outlet - rate
        matrix = np.zeros((rate.shape[0], count, count))
        at = np.arange(count)
        matrix[:, at, at] = to_inlet + to_outlet
        matrix[:, at[:-1], at[:-1]] += between
        matrix[:, at[1:], at[1:]] += between
        matrix[:, at[:-1], at[1:]] = -between
        matrix[:, at[1:], at[:-1]] = -between
        shortage = np.einsum("nij,nj->ni", matrix, found) - supply
        empty = np.where(empty, shortage > 0.0, empty)
        held = np.where(empty[:, :, None], np.eye(count), matrix)
        solved = np.linalg.solve(held, np.where(empty, 0.0, supply)[:, :, None])[:, :, 0]
        empty |= solved < 0.0
        found = np.maximum(solved, 0.0)
    return found


def trapping_checks(mesh: EnclosedMesh) -> tuple[DesignCheck, ...]:
    """Peak of the trapped spaces and exchange through the backlash; nothing without grooves."""
    grooves, condition = mesh.grooves, mesh.condition
    if grooves is None:
        return ()
    found = mesh.trapping
    peak_limit = PEAK_LIMIT * condition.pressure
    drop_limit = SINGLE_FLANK_LIMIT * condition.pressure
    calm, single = found.peak_pressure <= peak_limit, found.exchange_drop <= drop_limit
    nearest = min(_EDGE_STEPS, int(np.ceil(grooves.closing_side_offset / _EDGE_STEP))) - 1
    closing = ""
    if not calm:

        def cures(new: ReliefGrooves) -> bool:
            return mesh.with_grooves(new).trapping.peak_pressure <= peak_limit

        closing = _edge_advice(grooves, "closing", nearest, cures)
    words = (
        "The backlash joins both enclosed spaces to one: single-flank timing"
        if single
        else "The backlash is too narrow to join the enclosed spaces: dual-flank timing, each "
        "needs a groove of its own"
    )
    if mesh.groove_spacing is None:
        sealing = f"{words}."
    else:
        spacing = mesh.groove_spacing * (1.0 if single else 0.5)
        have = grooves.closing_side_offset + grooves.opening_side_offset
        sealing = (
            f"{words}, in which grooves {spacing * 1e3:.4g} mm apart just never close; here they "
            f"are {have * 1e3:.4g} mm apart."
        )
    return (
        DesignCheck(
            name="trapped pressure, estimate",
            value=found.peak_pressure * 1e-5,
            unit="bar",
            allowed=f"up to {peak_limit * 1e-5:.4g} bar {condition}",
            passed=calm,
            reason="The space that is shut first is squeezed through the last corner of its groove "
            "and the backlash, which loads bearings and teeth and heats the oil." + closing,
        ),
        DesignCheck(
            name="exchange through the backlash",
            value=found.exchange_drop * 1e-5,
            unit="bar",
            allowed=f"up to {drop_limit * 1e-5:.4g} bar {condition}",
            passed=single,
            reason=sealing,
        ),
    )


def sealing_edge(mesh: EnclosedMesh) -> str:
    """Where to move the edge of the opening-side groove so that the mesh parts both ports.

    A sentence; empty where the mesh parts them, or without grooves.
    """

    def parts(grooves: ReliefGrooves) -> bool:
        return mesh.with_grooves(grooves).trapping.short_circuit <= SHORT_CIRCUIT_LIMIT

    if mesh.grooves is None or mesh.trapping.short_circuit <= SHORT_CIRCUIT_LIMIT:
        return ""
    return _edge_advice(mesh.grooves, "opening", _EDGE_STEPS - 1, parts)


def _edge_advice(
    grooves: ReliefGrooves, side: str, last: int, cures: Callable[[ReliefGrooves], bool]
) -> str:
    """Where to move the edge of a groove, by no more than some steps, so that it cures a fault."""
    towards, of_contour, in_vain = _ADVICE[side]
    if getattr(grooves, f"{side}_contour") is not None:
        return of_contour
    name = f"{side}_side_offset"

    def moved(step: int) -> ReliefGrooves:
        return replace(grooves, **{name: getattr(grooves, name) + step * towards * _EDGE_STEP})

    # the farther an edge is moved, the more it cures
    step = 1 + bisect_left(range(1, last + 1), True, key=lambda k: cures(moved(k)))
    if step > last:
        return in_vain
    place = f"{getattr(moved(step), name) * 1e3:.4g} mm from the centre line"
    return f" Move the {side}-side edge to {place}."


@final
@dataclass(frozen=True)
class DesignCondition:
    """Condition at which design rules judge; the low-pressure side is at one atmosphere."""

    pressure: float = 200e5
    """Absolute pressure of the high-pressure side. [Pa]"""
    shaft_speed: float = 1500.0 * np.pi / 30.0
    """Shaft speed. [rad/s]"""

    @property
    def pressure_difference(self) -> float:
        """Pressure difference between the ports. [Pa]."""
        return self.pressure - ATMOSPHERIC_PRESSURE

    def __str__(self) -> str:
        """Return the condition in words."""
        return f"at {self.pressure * 1e-5:.4g} bar, {self.shaft_speed * 30.0 / np.pi:.4g} rpm"


TYPICAL = DesignCondition()
"""Condition for machines without one of their own."""


def in_series(first: Array, second: Array) -> Array:
    r"""Area of two openings one behind the other, :math:`A_1 A_2 / \sqrt{A_1^2 + A_2^2}`. [m2]."""
    product, scale = first * second, np.hypot(first, second)
    return np.asarray(product / np.where(scale > 0.0, scale, 1.0), dtype=float)


def joined_area(
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    closed_by: float = 0.0,
) -> float:
    """Area that joins both ports, mean over a pitch of the first family.

    Orifice for openings of single chambers to both ports, and of two that mesh, in series. [m2]

    Parameters
    ----------
    families, paths : sequence of ChamberFamily, FlowPath
        Chambers, and all paths of the machine.
    closed_by : float
        Part by which bearing play closes the throats between meshing chambers. [m]
    """
    first = families[0]
    pitch = 2.0 * np.pi / (first.count * abs(first.angle_ratio))
    angle, rows = pitch * np.arange(_ANGLES) / _ANGLES, np.arange(_ANGLES)[:, None]
    count = sum(family.count for family in families)
    to = {port: np.zeros((_ANGLES, count)) for port in _PORTS}
    for path in paths:
        port = path.category.role.partition("_")[0]
        if path.kind == "orifice" and port in to:
            table = path.geometry(path.phases + path.angle_ratio * angle[:, None])
            np.add.at(to[port], (rows, path.nodes_a[None, :]), path.multiplicity * table[..., 0])
    joined = in_series(to["inlet"], to["outlet"]).sum(axis=1)
    for path in (path for path in paths if path.category.role == "mesh"):
        table = path.geometry(path.phases + path.angle_ratio * angle[:, None])
        # a gap does not contract the flow as the sharp edges of the openings do
        height = np.maximum(table[..., 0] - closed_by, 0.0) / DISCHARGE_COEFFICIENT
        throat = height * table[..., 1]
        here, there = path.nodes_a[None, :], path.partners(angle)
        for port, other in (_PORTS, _PORTS[::-1]):
            through = in_series(to[port][rows, here], to[other][rows, there])
            joined += in_series(throat, through).sum(axis=1)
    return float(joined.mean())


def opening_checks(
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    displacement: float,
    closed_by: float = 0.0,
    condition: DesignCondition = TYPICAL,
) -> tuple[DesignCheck, ...]:
    """Seal between both ports, and relief grooves that chambers meet.

    Short circuit, and opening of the grooves if there are any.

    Parameters
    ----------
    families, paths, closed_by
        See :func:`joined_area`.
    displacement : float
        Displaced volume. [m3/rad]
    condition : DesignCondition
        Pressure and speed of the short circuit.
    """
    velocity = float(np.sqrt(2.0 * condition.pressure_difference / DENSITY))
    flow = DISCHARGE_COEFFICIENT * velocity * joined_area(families, paths, closed_by)
    share = flow / (displacement * condition.shaft_speed)
    short = DesignCheck(
        name="short circuit through the chambers",
        value=100.0 * share,
        unit="%",
        allowed=f"up to {100.0 * SHORT_CIRCUIT_LIMIT:g} % of the ideal flow {condition}",
        passed=share <= SHORT_CIRCUIT_LIMIT,
        reason="While a chamber is open to both ports, by grooves, recesses or the chamber that it "
        "meshes with, fluid at high pressure escapes to the other side.",
    )
    grooves = [
        float(path.geometry(path.geometry.period * np.arange(720) / 720)[:, 0].max())
        for path in paths
        if path.category.role.endswith("_groove")
    ]
    if not grooves:
        return (short,)
    met = DesignCheck(
        name="opening of the relief grooves",
        value=1e6 * min(grooves),
        unit="mm2",
        allowed="above 0 mm2 for every groove and gear",
        passed=min(grooves) > 0.0,
        reason="A groove that no tooth space meets relieves nothing.",
    )
    return short, met
