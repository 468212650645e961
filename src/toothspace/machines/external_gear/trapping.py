"""Pressure of the tooth spaces in the mesh without a run, and which groove edge to move.

While two pairs of flanks touch, the spaces between them have no way out but the relief grooves and
the backlash. Volume rates, groove openings and throats together give their pressures.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.gap_flow import curved_gap_conductance
from toothspace.closures.orifice import DISCHARGE_COEFFICIENT, orifice_conductance
from toothspace.core.constants import ATMOSPHERIC_PRESSURE
from toothspace.core.types import Array, IntArray
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import displacement, relative_radius
from toothspace.gearing.short_circuit import (
    DENSITY,
    SHORT_CIRCUIT_LIMIT,
    TYPICAL,
    DesignCondition,
    in_series,
)
from toothspace.gearing.spaces import Spaces, section_areas
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.flow_paths import grooves_by_port, mouth_lengths
from toothspace.model.description import DesignCheck

PEAK_LIMIT = 1.5
"""Highest pressure of a trapped space over the high pressure. [-]"""

SINGLE_FLANK_LIMIT = 0.1
"""Pressure drop in the backlash over the high pressure up to which both spaces act as one. [-]"""

VISCOSITY = 0.027
"""Dynamic viscosity of the estimate, ISO VG 46 at 50 degC. [Pa s]"""

_NODES = 720
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


@final
@dataclass(frozen=True)
class Way:
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
    to_inlet: Way
    to_outlet: Way
    """Openings of the bore and grooves of both faces to either port."""
    throat: Way
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


def mesh_chain(assembly: Assembly, spaces: tuple[Spaces, Spaces]) -> MeshChain:
    """Put the spaces round the centre line in the order in which throats join them.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh, with relief grooves or without.

    Returns
    -------
    MeshChain
        Three spaces of each gear over one pitch of the shaft angle.
    """
    count = spaces[0].angles.size // assembly.counts[0]
    order = [(turn, gear) for turn in (-1, 0, 1) for gear in (0, 1)]
    rows = [_rows(spaces[gear], count, turn, gear) for turn, gear in order]
    # the trailing throat of a drive space, then the leading one of the drive space behind
    passages = [_rows(spaces[0], count, turn + gear, 0) for turn, gear in order[:-1]]
    throats = [_throat(assembly, side) for side in (spaces[0].left, spaces[0].right)]
    growth = []
    for side in spaces:
        area, step = section_areas(side), 2.0 * np.pi / side.angles.size
        rate = (np.roll(area, -1) - np.roll(area, 1)) / (2.0 * step)
        growth.append(assembly.face_width * rate * side.angle_ratio)
    ports = [_ports(assembly, side) for side in spaces]

    def gathered(port: str) -> Way:
        ways = [ports[gear][port] for _, gear in order]
        return _columns(ways, rows)

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


def _columns(ways: list[Way], rows: list[IntArray]) -> Way:
    pairs = list(zip(ways, rows, strict=True))
    return Way(
        np.column_stack([way.area[at] for way, at in pairs]),
        np.column_stack([way.conductance[at] for way, at in pairs]),
    )


def _ports(assembly: Assembly, spaces: Spaces) -> dict[str, Way]:
    width, grooves, found = assembly.face_width, grooves_by_port(assembly, spaces), {}
    for port, length in mouth_lengths(assembly, spaces).items():
        area = width * length
        conductance = orifice_conductance(area, 2.0 * area / (width + length), VISCOSITY)
        if port in grooves:
            groove, diameter = grooves[port].T
            area = area + 2.0 * groove
            conductance = conductance + 2.0 * orifice_conductance(groove, diameter, VISCOSITY)
        found[port] = Way(DISCHARGE_COEFFICIENT * area, conductance)
    return found


def _throat(assembly: Assembly, side: Throats) -> Way:
    # without a complete throat both spaces are wide open to the same port
    gap = np.where(side.weight > 0.0, np.maximum(side.gap, 0.0), 0.0)
    width = assembly.face_width
    rounding = min(assembly.spec.drive.tip_rounding, assembly.spec.driven.tip_rounding)
    radius = relative_radius(assembly.mesh, side, rounding)
    return Way(width * gap, curved_gap_conductance(gap, width, radius, VISCOSITY))


def trapping(chain: MeshChain, assembly: Assembly, condition: DesignCondition) -> Trapping:
    r"""Pressures of the spaces in the mesh, of an incompressible fluid at one shaft speed.

    Parameters
    ----------
    condition : DesignCondition
        Pressure and shaft speed.

    Returns
    -------
    Trapping
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
    speed, difference = condition.shaft_speed, condition.pressure_difference
    pressures = _pressures(chain, assembly.spec.keys.mode == "pump", condition)
    joined = in_series(chain.to_inlet.area, chain.to_outlet.area).sum(axis=1)
    for here, there in ((chain.to_outlet, chain.to_inlet), (chain.to_inlet, chain.to_outlet)):
        through = in_series(chain.throat.area, in_series(here.area[:, :-1], there.area[:, 1:]))
        joined += through.sum(axis=1)
    rate = float(np.mean(joined) * np.sqrt(2.0 * difference / DENSITY))
    return Trapping(
        peak_pressure=float(pressures.max()),
        exchange_drop=_exchange_drop(chain, speed),
        short_circuit=rate / (displacement(assembly) * speed),
    )


def _exchange_drop(chain: MeshChain, speed: float) -> float:
    # a shut space that shrinks passes all through the wider of its throats
    sides = np.pad(chain.throat.area, ((0, 0), (1, 1)))
    way = np.maximum(sides[:, :-1], sides[:, 1:])
    shut = chain.to_inlet.area + chain.to_outlet.area == 0.0
    shut &= (chain.growth < 0.0) & (way > 0.0)
    velocity = speed * chain.growth[shut] / way[shut]
    return float(0.5 * DENSITY * np.max(velocity**2, initial=0.0))


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


def design_condition(assembly: Assembly) -> DesignCondition:
    """Pressure and speed of running-in, or typical ones where the gears do not run in."""
    wear = assembly.spec.keys.casing.wear_in
    return TYPICAL if wear is None else DesignCondition(wear.pressure, wear.shaft_speed)


def trapping_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Peak of the trapped spaces and exchange through the backlash.

    Returns
    -------
    tuple of DesignCheck
        At the pressure and speed of running-in; empty without that condition or without grooves.
    """
    grooves = assembly.spec.grooves
    if assembly.spec.keys.casing.wear_in is None or grooves is None:
        return ()
    condition, estimate = design_condition(assembly), _estimates(assembly)
    found = estimate(grooves)
    peak_limit = PEAK_LIMIT * condition.pressure
    drop_limit = SINGLE_FLANK_LIMIT * condition.pressure
    calm = found.peak_pressure <= peak_limit
    nearest = min(_EDGE_STEPS, int(np.ceil(grooves.closing_side_offset / _EDGE_STEP))) - 1
    closing = ""
    if not calm:
        closing = _edge_advice(
            grooves, "closing", nearest, lambda new: estimate(new).peak_pressure <= peak_limit
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
            passed=found.exchange_drop <= drop_limit,
            reason=_sealing(assembly, grooves, single=found.exchange_drop <= drop_limit),
        ),
    )


def sealing_edge(assembly: Assembly) -> str:
    """Where to move the edge of the opening-side groove so that the mesh parts both ports.

    Returns
    -------
    str
        A sentence; empty where the mesh parts them, or without grooves.
    """
    grooves, estimate = assembly.spec.grooves, _estimates(assembly)

    def parts(new: ReliefGrooves) -> bool:
        return estimate(new).short_circuit <= SHORT_CIRCUIT_LIMIT

    if grooves is None or parts(grooves):
        return ""
    return _edge_advice(grooves, "opening", _EDGE_STEPS - 1, parts)


def _estimates(assembly: Assembly) -> Callable[[ReliefGrooves], Trapping]:
    """What the mesh does with relief grooves at the condition of the rules."""
    spaces, condition = assembly.spaces(_NODES), design_condition(assembly)

    def estimate(grooves: ReliefGrooves) -> Trapping:
        moved = replace(assembly, spec=replace(assembly.spec, grooves=grooves))
        return trapping(mesh_chain(moved, spaces), moved, condition)

    return estimate


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


def _sealing(assembly: Assembly, grooves: ReliefGrooves, *, single: bool) -> str:
    pair = assembly.pair
    words = (
        "The backlash joins both enclosed spaces to one: single-flank timing"
        if single
        else "The backlash is too narrow to join the enclosed spaces: dual-flank timing, each "
        "needs a groove of its own"
    )
    if pair is None:
        return f"{words}."
    spacing = pair.relief_groove_spacing * (1.0 if single else 0.5)
    have = grooves.closing_side_offset + grooves.opening_side_offset
    return (
        f"{words}, in which grooves {spacing * 1e3:.4g} mm apart just never close; here they are "
        f"{have * 1e3:.4g} mm apart."
    )
