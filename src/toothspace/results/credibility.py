"""What of a result lies outside the range of its models, in words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.finding import Finding, beyond_too
from toothspace.core.status import Status
from toothspace.core.units import ZERO_CELSIUS
from toothspace.results.performance import by_label
from toothspace.results.solution import Solution, tooth_pitch

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

    from toothspace.results.solution import Solution


BALANCE_LIMITS = {"mass_balance_error": 1e-6, "energy_balance_error": 1e-4}
"""Balance errors above which a result is not to be trusted. [-]"""

VOLUMETRIC_LIMIT = 1.001
"""Volumetric efficiency above which a warning says why it is above 1. [-]"""

HYDROMECHANICAL_LIMIT = 1.001
"""Hydromechanical efficiency above which a warning says why it is above 1. [-]"""

OVERALL_LIMIT = 1.0 + 1e-6
"""Overall efficiency above which a warning says so; an ideal machine reaches 1. [-]"""

LEAKAGE_LIMIT = 0.5
"""Volumetric efficiency below which a warning says so. [-]"""

PULL_LIMIT = 0.05
"""Pull of a rigid mesh, over its largest push, above which a warning says so. [-]"""

IMPACT_LIMIT = 0.5
"""Change of a contact force between two samples, over the largest, that is an impact. [-]"""

CUT_LIMIT = 0.5e-6
"""Depth to which tips may run against a wall, of the order of its roughness. [m]"""

WHOLE = (Status.DONE, Status.NOT_CYCLIC, Status.NOT_REPEATING, Status.NOT_REACHED)
"""How a run ends whose masses and energies are those of a whole revolution."""

_BAR = 1e5
_ANY = 0.0, math.inf
_COMPARED = (
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "mean_torque_N_m",
    "flow_ripple_percent",
    "max_chamber_pressure_bar",
)
_PRESSURES = (
    "chamber_pressure_highest",
    "chamber_pressure_maximum",
    "chamber_pressure",
    "inlet_pressure",
    "outlet_pressure",
    "node_pressure_highest",
    "node_pressure",
    "film_pressure",
)
_SHOWN = {
    "outlet_temperature_degC": "outlet",
    "drain_temperature_degC": "drain",
    "highest_film_temperature_degC": "hottest film",
}
"""Places whose temperature every steady run has, by the names of the summary."""
_RISE = "lateral_temperature_rise"


def with_warnings(
    solution: Solution, highest_pressure: float, temperatures: tuple[float, float] = _ANY
) -> Solution:
    """Solution whose warnings, once asked, say what is outside the range of the models.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    highest_pressure : float
        Pressure up to which the properties of the fluid are known. [Pa]
    temperatures : tuple of float
        Temperatures between which they are known. [K]
    """
    return solution.with_later(partial(_doubts, solution, highest_pressure, temperatures))


def _doubts(
    solution: Solution, highest_pressure: float, temperatures: tuple[float, float]
) -> Iterator[Finding | str]:
    yield from _pressure(solution, highest_pressure)
    if solution.status in WHOLE:
        yield from temperatures_beyond(solution, *temperatures)
    yield from _numbers(solution)
    yield from _bodies(solution)
    yield from _skipped(solution)
    yield from _tips(solution.data)


def with_interval(solution: Solution, drawn: Solution) -> Solution:
    """Solution that says how far it moves with the flanks of the file.

    With every number of the second run among the statistics, as ``as_drawn_...``, and a warning
    with those that a reader looks at first.

    Parameters
    ----------
    solution : Solution
        Result with what was fitted to the file.
    drawn : Solution
        The same run with what the file holds.
    """
    fitted, other = (
        {k: v for k, v in one.summary().items() if isinstance(v, float) and math.isfinite(v)}
        for one in (solution, drawn)
    )
    told = ", ".join(
        f"{name.replace('_', ' ')} {other[name]:.4g} for {fitted[name]:.4g}"
        for name in _COMPARED
        if name in other and name in fitted
    )
    text = f"Flanks as in the file, not the involute that fits them, give {told}."
    numbers = {f"as_drawn_{name}": value for name, value in other.items() if name in fitted}
    return solution.with_note(Finding("warning", text, severity="note"), **numbers)


def _pressure(solution: Solution, highest: float) -> Iterator[Finding]:
    data = solution.data
    present = [name for name in _PRESSURES if name in data]
    largest = max((float(data[name].max()) for name in present), default=0.0)
    if largest > highest:
        reached, known = f"{largest / _BAR:.4g} bar", f"{highest / _BAR:.4g} bar"
        yield Finding(
            "warning",
            f"Pressures reach {reached}; the properties of the fluid are known to {known} only.",
            quantity="Highest pressure, range of the fluid",
            found=reached,
            allowed=f"up to {known}",
            severity="serious",
            advice=f"Let enclosed fluid out: {_way_out(solution)}, or change the timing of the "
            "ports.",
        )


def _way_out(solution: Solution) -> str:
    """What lets enclosed fluid out of the chambers of this machine."""
    data = solution.data
    if "chamber" in data.coords and str(data["chamber"].values[0]).startswith("pocket"):
        return "widen machine.rotors.tip_clearance, let the kidneys reach all over the pockets"
    if "[machine.relief_grooves]" in solution.provenance.get("case_toml", ""):
        return "move the edges of machine.relief_grooves nearer together, widen backlash"
    sides = "two sides of the mesh, their offsets and depth"
    return f"give machine.relief_grooves ({sides}), widen backlash"


def _numbers(solution: Solution) -> Iterator[Finding]:
    numbers = {k: v for k, v in solution.summary().items() if isinstance(v, int | float)}
    whole = solution.status in WHOLE
    if whole:
        yield from _efficiencies(numbers)
    for name, limit in BALANCE_LIMITS.items():
        value = numbers.get(name, math.nan)
        if value > limit and whole:
            label = name.replace("_", " ").capitalize()
            yield Finding(
                "warning",
                f"{label} is {value:.1e}, above {limit:.0e}.",
                quantity=label,
                found=f"{value:.1e}",
                allowed=f"up to {limit:.0e}",
                severity="serious",
                advice="Tighten run.relative_tolerance.",
            )


def _efficiencies(numbers: Mapping[str, float]) -> Iterator[Finding]:
    """Efficiencies above 1, below zero, or low."""
    volumetric = numbers.get("volumetric_efficiency", math.nan)
    overall = numbers.get("overall_efficiency", math.nan)
    name = "Volumetric efficiency"
    if volumetric > VOLUMETRIC_LIMIT:
        leakage = sum(v for k, v in numbers.items() if re.fullmatch("leakage_.*_L_per_min", k))
        reason, advice = (
            (
                f"moving walls drag {-leakage:.3g} L/min more through the gaps than the pressure "
                "drives back, which the displacement does not count, as with thick oil at low "
                "pressure.",
                "Look at the clearances and the temperature.",
            )
            if leakage < min(numbers.get("mesh_exchange_flow_L_per_min", 0.0), 0.0)
            else (
                "fluid enclosed in the chambers expands in them or is drawn past the ports.",
                "Look at the timing of the ports.",
            )
        )
        yield Finding(
            "warning",
            f"{name} is {volumetric:.4f}, above 1: {reason}",
            quantity=name,
            found=f"{volumetric:.4f}",
            allowed="up to 1",
            severity="serious",
            advice=advice,
        )
    if volumetric < 0.0:
        yield Finding(
            "warning",
            "More leaks back than is displaced, so that the mean flow runs backwards: the machine "
            "cannot hold this pressure at this speed.",
            quantity=name,
            found=f"{volumetric:.3f}",
            allowed="0 to 1",
            severity="serious",
            advice="Look at the clearances.",
        )
    elif volumetric < LEAKAGE_LIMIT:
        yield Finding(
            "warning",
            f"{name} is {volumetric:.3f}, below {LEAKAGE_LIMIT:g}.",
            quantity=name,
            found=f"{volumetric:.3f}",
            allowed=f"from {LEAKAGE_LIMIT:g}",
            advice="Look at the clearances, the speed, and whether the chambers fill.",
        )
    hydromechanical = numbers.get("hydromechanical_efficiency", math.nan)
    if hydromechanical > HYDROMECHANICAL_LIMIT and volumetric >= 0.0:
        name = "Hydromechanical efficiency"
        yield Finding(
            "warning",
            f"{name} is {hydromechanical:.4f}, above 1: spaces meet less than the pressure "
            "difference of the ports, as where they join both or open late, so that the torque is "
            "below displacement times pressure; the flow lost with it counts as volumetric.",
            quantity=name,
            found=f"{hydromechanical:.4f}",
            allowed="up to 1",
            severity="serious",
            advice="Judge the overall efficiency, and look at overlap, grooves and ports.",
        )
    name = "Overall efficiency"
    if overall < 0.0 and not volumetric < 0.0:
        yield Finding(
            "warning",
            "The shaft is driven from outside although this is a motor: friction takes more than "
            "the pressure gives.",
            quantity=name,
            found=f"{overall:.3f}",
            allowed="0 to 1",
            severity="serious",
            advice="Raise the pressure difference or look at the clearances.",
        )
    if overall > OVERALL_LIMIT:
        yield Finding(
            "warning",
            f"{name} is {overall:.4f}, above 1, which no machine has.",
            quantity=name,
            found=f"{overall:.4f}",
            allowed="0 to 1",
            severity="serious",
            advice="Tighten run.relative_tolerance.",
        )


def _bodies(solution: Solution) -> Iterator[Finding]:
    """Teeth that would part, contacts that hit, bearing blocks on the side away from the load."""
    data = solution.data
    if "contact_force" in data:
        rigid = solution.provenance.get("contact_model") == "rigid"
        yield from _pull(data["contact_force"]) if rigid else _impacts(data)
    if "seat_position" in data and "journal_force" in data:
        rest = [d for d in data["journal_force"].dims if d not in ("body", "axis")]
        # each block holds the bearings of all bodies
        carried = -(data["journal_force"].mean(rest) * data["seat_position"]).sum()
        if carried < 0.0:
            yield Finding(
                "warning",
                "The bearing blocks lean against the side away from their mean load: they are "
                "seated once, for pressures at rest.",
                quantity="Place of the bearing blocks",
                severity="serious",
                advice="Set machine.mode to the way the machine runs, or let them follow their "
                'load, machine.bearing_blocks.motion = "free".',
            )


def _skipped(solution: Solution) -> Iterator[Finding]:
    """A body that turned so far from its place in the mesh that teeth would have skipped."""
    if solution.status is not Status.OUT_OF_MESH:
        return
    turned = by_label(solution.data["body_rotation"][-1])
    angles = {name: math.degrees(abs(angle)) for name, angle in turned.items()}
    body = max(angles, key=lambda name: angles[name])
    pitch = math.degrees(tooth_pitch(solution.data))
    found = f"{angles[body]:.3g} deg"
    yield Finding(
        "warning",
        f"{body.replace('_', ' ').capitalize()} has turned by {found} from its place in the mesh, "
        f"at a tooth pitch of {pitch:.3g} deg: nothing holds it to its mate, and the run ends "
        "there.",
        quantity="Turning out of the mesh",
        found=found,
        allowed=f"up to {0.5 * pitch:.3g} deg",
        severity="serious",
        advice="Narrow the play between the teeth: machine.rotors.tip_clearance, or "
        "machine.gears.normal_backlash.",
    )


def _tips(data: Dataset) -> Iterator[Finding]:
    """Tips that would cut into a wall that has not been run in."""
    if "tip_gap_minimum" not in data or "running_in_depth" in data:
        return
    for name, gap in by_label(data["tip_gap_minimum"]).items():
        depth = -gap
        if depth > CUT_LIMIT:
            found = f"{1e6 * depth:.2g} µm"
            yield Finding(
                "warning",
                f"Tips ({name.replace('_', ' ')}) would cut {found} into the wall round them; the "
                "gap keeps the height of the roughness there, which no machine as made has.",
                quantity=f"Cut of the tips, {name.replace('_', ' ')}",
                found=found,
                allowed=f"up to {1e6 * CUT_LIMIT:g} µm",
                severity="serious",
                advice="Widen machine.casing.radial_clearance, narrow the play of bearings and "
                "bearing blocks, or run the machine in, [machine.casing.wear_in].",
            )


def _pull(contact_force: DataArray) -> Iterator[Finding]:
    """A rigid mesh between flanks that would part."""
    force = contact_force.sum("contact")
    push, pull = max(float(force.max()), 0.0), -float(force.min())
    if pull > PULL_LIMIT * push:
        yield Finding(
            "warning",
            f"The rigid mesh pulls with up to {pull:.3g} N where teeth would part or touch with "
            f"the other flanks (it pushes with up to {push:.3g} N).",
            quantity="Pull of the rigid mesh",
            found=f"{pull:.3g} N",
            allowed=f"up to {PULL_LIMIT * push:.3g} N",
            severity="serious",
            advice='Set run.mesh = "elastic".',
        )


def _impacts(data: Dataset) -> Iterator[Finding]:
    """Contacts of a steady run that are made with a blow, which samples may miss."""
    force = data["contact_force"]
    if force.sizes.get("shaft_angle", 0) < 2:
        return
    largest, change = float(force.max()), float(np.abs(force.diff("shaft_angle")).max())
    if change > IMPACT_LIMIT * largest:
        angles = data.get("dense_angle", data["shaft_angle"])
        states = round(2.0 * math.pi / float(np.median(np.diff(angles))))
        yield Finding(
            "warning",
            f"Contacts are made with a blow: forces change by {change:.3g} N, of {largest:.3g} N, "
            "from one sample to the next.",
            quantity="Change of the contact force from one sample to the next",
            found=f"{change:.3g} N",
            allowed=f"up to {IMPACT_LIMIT * largest:.3g} N",
            advice=f"Extremes of torque and contact force come from {states} states of a "
            "revolution, which may miss the peak of a blow; the low orders of the torque do not "
            "depend on it.",
        )


def temperatures_beyond(solution: Solution, low: float, high: float) -> Iterator[Finding]:
    """Say which temperatures lie outside the range of the fluid.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    low, high : float
        Temperatures between which the properties of the fluid are known. [K]
    """
    found = temperatures_of(solution)
    outside = {place: t for place, t in found.items() if not low <= t <= high}
    if not outside:
        return
    worst = max(outside, key=lambda place: max(outside[place] - high, low - outside[place]))
    reached = f"{outside[worst] - ZERO_CELSIUS:.4g} °C ({worst})"
    known = f"{low - ZERO_CELSIUS:.4g} to {high - ZERO_CELSIUS:.4g} °C"
    beside = beyond_too(outside, worst)
    yield Finding(
        "warning",
        f"Temperatures reach {reached}{beside}; the properties of the fluid are known from "
        f"{known} only.",
        quantity="Temperature, range of the fluid",
        found=reached,
        allowed=known,
        severity="serious",
        advice="Let more oil pass where it is hot (wider gaps and bearings, "
        "heat.bearing_flushing), lower speed or pressure, or cool the casing "
        "(heat.housing_conductance); warm films thin with heat.model = 'coupled' alone.",
    )


def temperatures_of(solution: Solution) -> dict[str, float]:
    """Temperatures of a steady run by place. [K]."""
    numbers = solution.summary()
    found = {
        place: float(numbers[name]) + ZERO_CELSIUS
        for name, place in _SHOWN.items()
        if name in numbers
    }
    if "temperature" in solution.data:
        for node, value in zip(
            solution.data["heat_node"].values, solution.data["temperature"].values, strict=True
        ):
            found.setdefault(str(node).replace("_", " "), float(value))
    if _RISE in solution.statistics:
        supply = float(solution.data["fluid_temperature"])
        found["lateral film"] = supply + float(solution.statistics[_RISE])
    return {place: value for place, value in found.items() if np.isfinite(value)}
