"""Gaps, bearings and lines whose flow is beyond the range of their formulas."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.line_friction import CRITICAL_REYNOLDS
from toothspace.closures.space_flow import pressure_along_space
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.finding import Finding, beyond_too
from toothspace.core.types import Array
from toothspace.model.assembly import System
from toothspace.model.description import MachineDescription
from toothspace.model.path_category import LATERAL_PATHS, OPENINGS
from toothspace.model.paths import by_kind
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.cyclic import History

LAMINAR_GAP = 2000.0
"""Reynolds number of a gap, with twice its height, up to which the flow is laminar. [-]"""

LAMINAR_BEARING = 41.3
"""Taylor number of a bearing from which vortices stand between the walls, root of 1708. [-]"""

SMOOTH_LINE = 1e5
"""Reynolds number of a line up to which Blasius' law of smooth walls holds. [-]"""

_LOOKS = 180
_OPEN = 1e-6
"""Smallest width of a gap that is open. [m]"""


def gap_reynolds_number(mass_flow: Array, width: Array, viscosity: Array) -> Array:
    r"""Reynolds number of the flow in a gap.

    Parameters
    ----------
    mass_flow : ndarray
        Mass flow through the gap. [kg/s]
    width : ndarray
        Width across the flow. [m]
    viscosity : ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    ndarray
        With the hydraulic diameter, twice the height. [-]

    Notes
    -----
    .. math:: Re = \frac{\rho v\, 2 h}{\mu} = \frac{2 \dot m}{b \mu}

    Validity of the gap formulas: laminar, up to about 2000.

    References
    ----------
    .. [1] F. M. White, *Fluid Mechanics*, McGraw-Hill, chapter 6 (textbook: laminar flow in ducts
       by their hydraulic diameter).
    """
    return np.asarray(2.0 * np.abs(mass_flow) / (width * viscosity))


def taylor_number(
    density: float, speed: float, clearance: float, radius: float, viscosity: float
) -> float:
    r"""Taylor number of the flow between a journal and its bearing.

    Parameters
    ----------
    density : float
        Density. [kg/m3]
    speed : float
        Speed of the surface. [m/s]
    clearance : float
        Radial clearance. [m]
    radius : float
        Radius of the journal. [m]
    viscosity : float
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float
        Taylor number. [-]

    Notes
    -----
    .. math:: Ta = \frac{\rho U c}{\mu} \sqrt{\frac{c}{R}}

    Vortices stand between concentric walls where its square exceeds 1708.

    References
    ----------
    .. [1] G. I. Taylor, "Stability of a viscous liquid contained between two rotating cylinders",
       Phil. Trans. R. Soc. A 223, 1923, 289-343.
    .. [2] Proc. Institution of Mechanical Engineers, Conference Proceedings 181, 1966, doi
       10.1243/PIME_CONF_1966_181_040_02 (1708 as the widely accepted critical value).
    """
    return float(density * abs(speed) * clearance / viscosity * np.sqrt(clearance / radius))


@final
@dataclass(frozen=True)
class _Range:
    """A number that formulas hold up to, and where it counts."""

    number: str
    limit: float
    where: str
    advice: str
    reason: str


_GAPS = _Range(
    "Reynolds number",
    LAMINAR_GAP,
    "the gaps",
    "Turbulent films leak less and drag more: narrow the clearance, lower "
    "operating_point.shaft_speed or the pressure, or take thicker oil.",
    "those of laminar flow",
)
_BEARINGS = _Range(
    "Taylor number", LAMINAR_BEARING, "the journal bearings", _GAPS.advice, _GAPS.reason
)
_LINES = _Range(
    "Reynolds number",
    SMOOTH_LINE,
    "lines and hoses",
    "Take a wider bore or less flow: rough walls lose more than these formulas say.",
    "those of smooth lines",
)


@final
class FlowRegimes:
    """Largest Reynolds and Taylor numbers of all gaps, bearings and lines that were looked at."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._highest: dict[_Range, dict[str, float]] = {_GAPS: {}, _BEARINGS: {}, _LINES: {}}

    def look(self, states: Array, seen: Observation, looks: int) -> None:
        """Take states [SI] and what is seen at them into account, gaps at so many of them."""
        every = slice(None, None, max(len(states) // looks, 1))
        speed = float(np.abs(states[:, 1]).max(initial=0.0))
        self._note(_GAPS, _gaps(self._system, states[every], seen, every))
        self._note(_BEARINGS, _bearings(self._system, speed))
        self._note(_LINES, _lines(self._system, states))

    def _note(self, range_: _Range, places: Iterable[tuple[str, float]]) -> None:
        highest = self._highest[range_]
        for label, number in places:
            highest[label] = max(number, highest.get(label, 0.0))

    def findings(self) -> Iterator[Finding]:
        """Say where formulas were used beyond their range."""
        for range_, highest in self._highest.items():
            beyond = {label: number for label, number in highest.items() if number > range_.limit}
            if beyond:
                worst = max(beyond, key=lambda label: beyond[label])
                found = f"{beyond[worst]:.3g} ({worst})"
                beside = beyond_too(beyond, worst)
                yield Finding(
                    "warning",
                    f"{range_.number} reaches {found}{beside}; the formulas of {range_.where} are "
                    f"{range_.reason}, up to {range_.limit:g}.",
                    quantity=f"{range_.number} of {range_.where}",
                    found=found,
                    allowed=f"up to {range_.limit:g}",
                    advice=range_.advice,
                )


def flow_regimes(history: History) -> Iterator[Finding]:
    """Say in which gaps, bearings and lines of a revolution formulas are beyond their range."""
    regimes, states = FlowRegimes(history.system), history.states
    few = np.ascontiguousarray(states[:: max(len(states) // _LOOKS, 1)])
    regimes.look(few, observe(history.system.arrays, few), len(few))
    return regimes.findings()


def _gaps(
    system: System, states: Array, seen: Observation, every: slice
) -> Iterator[tuple[str, float]]:
    """Largest Reynolds number of every gap whose geometry is its own."""
    first, description = 0, system.description
    partners, flows = seen.path_partner[every], seen.path_flow[every]
    root = np.sqrt(dynamic_viscosity(seen.pressure[every], system.arrays.fluid))
    # solved faces have conductances for widths
    solved = any(film.drag is not None for film in description.laterals)
    for path in by_kind(description.paths):
        members = slice(first, first + path.count)
        first += path.count
        # throats between flanks, and tooth spaces, count the kinetic energy of their flow
        throat = path.kind == "orifice" or path.category.role in ("mesh", "along")
        if throat or (solved and path.category in LATERAL_PATHS):
            continue
        at = path.phases + path.angle_ratio * states[:, :1]
        tables = path.own or (path.geometry,)
        width = (
            np.asarray(tables[0](at)[..., 1])
            if len(tables) == 1
            else np.stack([table(at[:, k])[:, 1] for k, table in enumerate(tables)], axis=1)
        )
        ends = np.take_along_axis(root, partners[:, members], axis=1)
        viscosity = root[:, path.nodes_a] * ends * path.viscosity_ratio
        flow = np.where(width > _OPEN, flows[:, members], 0.0)
        width = np.maximum(width, _OPEN) * path.multiplicity
        number = gap_reynolds_number(flow, width, viscosity)
        yield path.category.label, float(number.max(initial=0.0))


def _bearings(system: System, speed: float) -> Iterator[tuple[str, float]]:
    """Taylor number of every journal bearing at a speed of the shaft [rad/s]."""
    fluid = system.arrays.fluid
    viscosity = float(dynamic_viscosity(system.condition.drain_pressure, fluid))
    ratios = {body.name: body.speed_ratio for body in system.description.bodies}
    for journal in system.description.journals:
        radius = 0.5 * journal.diameter
        number = taylor_number(
            fluid.reference_density,
            ratios[journal.body] * speed * radius,
            journal.radial_clearance,
            radius,
            viscosity * journal.viscosity_ratio,
        )
        yield journal.body.replace("_", " "), number


def _lines(system: System, states: Array) -> Iterator[tuple[str, float]]:
    """Largest Reynolds number in every line and hose that carries waves."""
    circuit, first = system.condition.circuit, system.arrays.size.column
    if circuit is None:
        return
    inner = {node.name for node in circuit.nodes}
    for element in circuit.elements:
        if element.states:
            name = next(
                end for end in (element.node_a, element.node_b) if ":" in end and end in inner
            )
            flow = float(np.abs(states[:, first]).max(initial=0.0))
            yield name.partition(":")[0], CRITICAL_REYNOLDS * flow / element.law.critical_flow
        first += element.states


_ALONG_PLACES, _ALONG_ANGLES = 65, 180
_LARGEST_ALONG = 0.05
"""Pressure along a tooth space over that between the ports up to which it has one. [-]"""
_SHUT = 0.1
"""Section of a space that counts as shut over the largest: little oil is left to leave. [-]"""


def pressure_along_spaces(
    description: MachineDescription, fluid: FluidLaw, shaft_speed: float
) -> float:
    """Largest pressure that oil needs to leave a tooth space of a helix at one end. [Pa].

    See :func:`~toothspace.closures.space_flow.pressure_along_space`. From where no port, notch or
    groove is open at the end that leads, until that end is in the middle of the mesh. Zero with
    straight teeth and at rest.

    Parameters
    ----------
    description : MachineDescription
        Machine whose table angles are half a turn in the middle of the mesh.
    fluid : FluidLaw
        Oil in the spaces.
    shaft_speed : float
        Shaft speed. [rad/s]
    """
    winding, largest = description.winding, 0.0
    if winding is None or shaft_speed == 0.0:
        return 0.0
    width = winding.twist / abs(winding.turn_per_length)
    first = 0
    for family in winding.section.families:
        shut = np.linspace(0.5 * np.pi, np.pi, _ALONG_ANGLES)
        lead = winding.twist * family.angle_ratio * np.linspace(0.0, 1.0, _ALONG_PLACES)
        places = shut[:, None] - lead
        area = family.volume(places)[..., 0] / width
        least = _SHUT * float(area.max())
        rate = np.where(area > least, family.volume.derivative(places)[..., 0] / width, 0.0)
        found = pressure_along_space(
            np.maximum(area, least),
            np.minimum(rate, 0.0),
            # of a square space that closes to a slit between its flanks
            np.maximum(area, least) / np.sqrt(area.max()),
            abs(winding.turn_per_length) * family.angle_ratio,
            width,
            shaft_speed * family.angle_ratio,
            fluid.reference_density,
            fluid.dynamic_viscosity,
        )
        leading = [
            path.geometry(shut)[:, 0]
            for path in winding.section.paths
            if path.category.role in OPENINGS and path.nodes_a[0] == first
        ]
        enclosed = np.sum(leading, axis=0) <= 0.0
        largest = max(largest, float(found.sum(axis=0).max(initial=0.0, where=enclosed)))
        first += family.phases.size
    return largest


def along_spaces(pressure: float, difference: float, slices: int = 1) -> Iterator[Finding]:
    """Say where one pressure for a tooth space along the helix is not enough.

    Parameters
    ----------
    pressure, difference : float
        Pressure along a space, and that between the ports. [Pa]
    slices : int
        Parts of the width with a pressure of their own.
    """
    limit = slices * _LARGEST_ALONG * abs(difference)
    if pressure <= limit:
        return
    found, allowed = (f"{1e-5 * value:.3g} bar" for value in (pressure, limit))
    yield Finding(
        "warning",
        f"Oil needs up to {found} along a tooth space to leave it at one end; one pressure for "
        f"{'a space' if slices == 1 else 'a slice of it'} holds up to {allowed}, a twentieth of "
        f"that between the ports{'' if slices == 1 else f' for each of {slices} slices'}.",
        quantity="pressure along a tooth space",
        found=found,
        allowed=f"up to {allowed}",
        advice="Set axial_slices of the gears, lower operating_point.shaft_speed, or take narrower "
        "gears; peaks at the shut end are higher than the run says.",
    )
