"""What of a result lies outside the range of its models, in words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.status import Status
from toothspace.model.description import DesignCheck
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

BALANCE_LIMITS = {"mass_balance_error": 1e-6, "energy_balance_error": 1e-4}
"""Balance errors above which a result is not to be trusted. [-]"""

VOLUMETRIC_LIMIT = 1.001
"""Volumetric efficiency above which a warning says why it is above 1. [-]"""

OVERALL_LIMIT = 1.0 + 1e-6
"""Overall efficiency above which a warning says so; an ideal machine reaches 1. [-]"""

LEAKAGE_LIMIT = 0.5
"""Volumetric efficiency below which a warning says so. [-]"""

PULL_LIMIT = 0.05
"""Pull of a rigid mesh, over its largest push, above which a warning says so. [-]"""

IMPACT_LIMIT = 0.5
"""Change of a contact force between two samples, over the largest, that is an impact. [-]"""

_BAR = 1e5
_COMPARED = (
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "mean_torque_N_m",
    "flow_ripple_percent",
    "max_chamber_pressure_bar",
)
_PRESSURES = ("chamber_pressure_highest", "chamber_pressure", "inlet_pressure", "outlet_pressure")


def with_warnings(
    solution: Solution, highest_pressure: float, checks: Iterable[DesignCheck] = ()
) -> Solution:
    """Solution whose provenance says what is outside the range of the models.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    highest_pressure : float
        Pressure up to which the properties of the fluid are known. [Pa]
    checks : iterable of DesignCheck
        Design-rule report of the machine. What it says of files that were read is reported, and
        all of it where pressures leave the range of the fluid or the run ended at a step.
    """
    pressure = list(_pressure(solution, highest_pressure))
    broken = bool(pressure) or solution.status is Status.STEP_TOO_SMALL
    rules = [c.sentence for c in checks if not c.passed and (c.of_drawing or broken)]
    told = (pressure, _numbers(solution), _bodies(solution), rules)
    found = "\n".join(sentence for part in told for sentence in part)
    return solution.with_note(found)


def with_interval(solution: Solution, drawn: Solution) -> Solution:
    """Solution that says how far it moves with the flanks of the file.

    Parameters
    ----------
    solution : Solution
        Result with what was fitted to the file.
    drawn : Solution
        The same run with what the file holds.

    Returns
    -------
    Solution
        With every number of the second run among the statistics, as ``as_drawn_...``, and a
        warning with those that a reader looks at first.
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
    return solution.with_note(text, **numbers)


def _pressure(solution: Solution, highest: float) -> Iterator[str]:
    data = solution.data
    present = [name for name in _PRESSURES if name in data]
    largest = max((float(data[name].max()) for name in present), default=0.0)
    if largest > highest:
        yield (
            f"Pressures reach {largest / _BAR:.4g} bar; the properties of the fluid are known to "
            f"{highest / _BAR:.4g} bar only. Look where fluid is enclosed: relief grooves, "
            "backlash and the timing of the ports."
        )


def _numbers(solution: Solution) -> Iterator[str]:
    numbers = {k: v for k, v in solution.summary().items() if isinstance(v, int | float)}
    volumetric = numbers.get("volumetric_efficiency", math.nan)
    if volumetric > VOLUMETRIC_LIMIT:
        yield f"Volumetric efficiency is {volumetric:.4f}, above 1: {_surplus(numbers)}"
    overall = numbers.get("overall_efficiency", math.nan)
    if volumetric < 0.0:
        yield (
            "More leaks back than is displaced, so that the mean flow runs backwards: the machine "
            "cannot hold this pressure at this speed. Look at the clearances."
        )
    elif volumetric < LEAKAGE_LIMIT:
        yield (
            f"Volumetric efficiency is {volumetric:.3f}, below {LEAKAGE_LIMIT:g}. Look at the "
            "clearances, the speed, and whether the chambers fill."
        )
    if overall < 0.0 and not volumetric < 0.0:
        yield (
            "The shaft is driven from outside although this is a motor: friction takes more than "
            "the pressure gives. Raise the pressure difference or look at the clearances."
        )
    if overall > OVERALL_LIMIT:
        yield (
            f"Overall efficiency is {overall:.4f}, above 1, which no machine has. "
            "Tighten run.relative_tolerance."
        )
    whole = solution.status in (Status.DONE, Status.NOT_CYCLIC, Status.NOT_REPEATING)
    for name, limit in BALANCE_LIMITS.items():
        value = numbers.get(name, math.nan)
        if value > limit and whole:
            yield (
                f"{name.replace('_', ' ').capitalize()} is {value:.1e}, above {limit:.0e}; "
                "tighten run.relative_tolerance."
            )


def _bodies(solution: Solution) -> Iterator[str]:
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
            yield (
                "The bearing blocks lean against the side away "
                "from their mean load: they are seated once, for pressures at rest. Set "
                "machine.mode to the way the machine runs, or let them follow their load, "
                'machine.bearing_blocks.motion = "free".'
            )


def _pull(contact_force: DataArray) -> Iterator[str]:
    """A rigid mesh between flanks that would part."""
    force = contact_force.sum("contact")
    push, pull = max(float(force.max()), 0.0), -float(force.min())
    if pull > PULL_LIMIT * push:
        yield (
            f"The rigid mesh pulls with up to {pull:.3g} N where teeth would part or touch with "
            f'the other flanks (it pushes with up to {push:.3g} N). Set run.mesh = "elastic".'
        )


def _impacts(data: Dataset) -> Iterator[str]:
    """Contacts of a steady run that are made with a blow, which samples may miss."""
    force = data["contact_force"]
    if force.sizes.get("shaft_angle", 0) < 2:
        return
    largest, change = float(force.max()), float(np.abs(force.diff("shaft_angle")).max())
    if change > IMPACT_LIMIT * largest:
        yield (
            f"Contacts are made with a blow: forces change by {change:.3g} N, of {largest:.3g} N, "
            "from one sample to the next. Extremes of torque and contact force depend on "
            "run.samples_per_revolution; the low orders of the torque do not."
        )


def _surplus(numbers: Mapping[str, float]) -> str:
    """Why more is delivered than displaced: what walls drag, or else what chambers give back."""
    leakage = sum(v for k, v in numbers.items() if re.fullmatch("leakage_.*_L_per_min", k))
    if leakage < min(numbers.get("mesh_exchange_flow_L_per_min", 0.0), 0.0):
        return (
            f"moving walls drag {-leakage:.3g} L/min more through the gaps than the pressure "
            "drives back, which the displacement does not count. So it is with thick oil at low "
            "pressure; look at the clearances and the temperature."
        )
    return (
        "fluid enclosed in the chambers expands in them or is drawn past the ports. Look at the "
        "timing of the ports."
    )
