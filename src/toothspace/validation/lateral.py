"""Floating bearing of the fuel pump: position, films and nose pressure in the source's words."""

from __future__ import annotations

from functools import cache

import numpy as np

from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.floating.problem import lateral_problem
from toothspace.model.floating_bearing import HousingContact
from toothspace.studies.bearing_path import solve_path
from toothspace.studies.bearing_points import LateralStudy, PointCondition, prepare
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    Effort,
    Evidence,
    ValidationSource,
    holds,
    shipped,
    within,
)

SOURCE = ValidationSource(
    "lateral_gap_friction",
    "Position hysteresis of the floating bearing of a fuel pump",
    "D. Thiagarajan, A. Vacca, S. Watkins, Mech. Syst. Signal Process. 129 (2019) 659-676.",
    "The publication is normalised. Reference pressure 194 bar and speed 8500 rpm, gears, "
    "springs, areas and grooves are reconstructed. The outlet reaches 210 degrees round the gears: "
    "Eq. 16 and Fig. 9 have low pressure on one region of the bearing, and from 205 to 210 degrees "
    "the films push it off with one area at every speed and pressure. Seal line, springs and the "
    "stiffness of the bearing are free, chosen so that the faces rub little.",
)

LARGEST_FILM = 4.0
"""Mean film of a bearing that runs on its film; films of the source are of the order of 3. [um]"""

MOVED = 0.05
"""Change that counts as one: what the eddy-current sensor of section 3 resolves. [um]"""

_ANGLES, _SHIPPED = (55.0, 180.0, 210.0, 230.0), (210.0,)
"""How far the outlet reaches round the gears: tried, and in the cases. [deg]"""
_RIGID = (
    "run.film_grid=[84, 10]",
    "run.film_angles_per_pitch=3",
    "run.deformation=winkler",
)
_COARSE = ("run.film_grid=[84, 10]", "run.film_angles_per_pitch=4")
_SHORT = ("run.film_grid=[105, 15]", "run.film_angles_per_pitch=4")
"""Least grid on which films at the top of a loop are those of the default one."""


@cache
def _loop(name: str, effort: Effort) -> LateralStudy:
    # a few newtons decide whether friction holds the bearing at low pressure: as fine as the case
    whole = effort == "full" or name == "hysteresis_055"
    return solve_path(shipped(name, *(() if whole else _SHORT)))


def _films(study: LateralStudy) -> Array:
    return np.array([float(np.mean(point.numbers.gaps)) for point in study.points]) * 1e6


def _positions(study: LateralStudy) -> Array:
    return np.array([point.numbers.position for point in study.points]) * 1e6


def _curves(study: LateralStudy) -> tuple[ComparedCurve, ...]:
    along = np.arange(len(study.outlet_pressures), dtype=float)
    rows = ("position", _positions(study)), ("mean film", _films(study))
    return tuple(
        ComparedCurve(
            f"{name}, way up then down", "point along the loop", f"{name} (um)", along, values
        )
        for name, values in rows
    )


def _loop_values(study: LateralStudy) -> list[ComparedValue]:
    largest, words = _films(study).max(), "of the order of 3 um"
    return [
        holds("all points found", study.status is Status.DONE, "seven points or five"),
        within("largest mean film", largest, "um", words, 0.0, LARGEST_FILM),
    ]


def _between_legs(positions: Array, words: str) -> ComparedValue:
    top = positions.size // 2
    gap = np.max(positions[top:][::-1] - positions[: top + 1])
    return within("largest gap between the legs, position", gap, "um", words, MOVED)


def _held(study: LateralStudy) -> list[ComparedValue]:
    """Points at which friction leaves the bearing where it was, which tell of friction alone."""
    return [
        within(f"point {k + 1}: held by friction", held, "1 = true", "")
        for k, held in enumerate(study.held_by_friction)
    ]


def _ways(study: LateralStudy) -> tuple[Array, Array]:
    """Mean films on the way up, and on the way down at the same pressures. [um]."""
    films = _films(study)
    top = films.size // 2
    return films[: top + 1], films[top:][::-1]


def _first_set(effort: Effort) -> Evidence:
    study = _loop("hysteresis_055", effort)
    up, _ = _ways(study)
    values = _loop_values(study)
    thicker = "the film thickness increases with increasing pressure"
    for k, growth in enumerate(np.diff(up)):
        step = f"film growth from step {k + 1} to {k + 2}"
        values.append(within(step, growth, "um", thicker, MOVED))
    values += [_between_legs(_positions(study), "Fig. 22: a loop"), *_held(study)]
    shown = "Figs. 15 to 21: films of both interfaces"
    sides = np.array([str(name).partition("_")[0] for name in study.points[0].films])
    gaps = np.array([point.numbers.gaps for point in study.points]) * 1e6
    for side in dict.fromkeys(sides.tolist()):
        mean = gaps[:, sides == side].mean(axis=1)
        values += [
            within(f"{side} side: film at point {k + 1}", film, "um", shown)
            for k, film in enumerate(mean)
        ]
    return Evidence(tuple(values), _curves(study), study.dataset())


def _second_leg(effort: Effort) -> Evidence:
    study = _loop("hysteresis_055", effort)
    up, down = _ways(study)
    higher = "the gap heights in the second leg are higher for a given outlet pressure"
    values = [
        within(f"second leg above first at step {k + 1}", down[k] - up[k], "um", higher, MOVED)
        for k in range(up.size - 1)
    ]
    return Evidence((*values, *_held(study)), _curves(study))


def _second_set(effort: Effort) -> Evidence:
    study = _loop("hysteresis_078", effort)
    positions = _positions(study)
    trend = "captures the trend of the bearing movement"
    values = _loop_values(study)
    for k in range(positions.size // 2):
        step = f"rise of position from step {k + 1} to {k + 2}"
        values.append(within(step, positions[k + 1] - positions[k], "um", trend, MOVED))
    values += [_between_legs(positions, "Fig. 23: a loop"), *_held(study)]
    return Evidence(tuple(values), _curves(study), study.dataset())


def _nose_pressure(effort: Effort) -> Evidence:
    coarse = () if effort == "full" else (*_COARSE, "study.nose_pressure_fractions=[0.0, 0.25]")
    study = solve_path(shipped("nose_pressure", *coarse))
    positions = _positions(study).reshape(3, -1)
    ranges = np.ptp(positions, axis=1)
    share = np.linspace(0.0, 25.0, positions.shape[1])
    axes = "nose pressure (% of outlet)", "position (um)"
    curves = tuple(
        ComparedCurve(f"position at {name}", *axes, share, row)
        for name, row in zip(("OC1", "OC2", "OC3"), positions, strict=True)
    )
    text, words = "change over the nose pressure at", "the effect of the nose pressure is relevant"
    none = "the nose pressure value does not influence the resulting position"
    values = (
        holds("all points found", study.status is Status.DONE, "three conditions"),
        within(f"{text} OC1", ranges[0], "um", words, MOVED),
        within(f"{text} OC2", ranges[1], "um", words, MOVED),
        within(f"{text} OC3", ranges[2], "um", none, 0.0, MOVED),
        *_held(study),
    )
    return Evidence(values, curves)


def _speed(effort: Effort) -> Evidence:
    """Force that speed adds on a bearing at one place, beside what friction and the nose can do."""
    angles = _ANGLES if effort == "full" else _SHIPPED
    found = {angle: opening_forces(angle) for angle in angles}
    values = []
    for angle, (slow, fast, breakaway, nose) in found.items():
        change, words = abs(fast - slow), "the rotational speed also plays a (secondary) influence"
        name = f"outlet up to {angle:g} deg: "
        limit = breakaway if angle in _SHIPPED else np.inf
        least = 0.0 if angle in _SHIPPED else -np.inf
        values += [
            within(name + "opening force by speed", change, "N", words, least, limit),
            within(name + "breakaway", breakaway, "N", ""),
            within(name + "force of the nose at a quarter of the outlet", nose, "N", ""),
        ]
    return Evidence(tuple(values))


@cache
def opening_forces(outlet_angle: float) -> tuple[float, float, float, float]:
    """Opening force at 2 um from OC2 and from OC1, breakaway force and force of the nose. [N].

    Parameters
    ----------
    outlet_angle : float
        How far the outlet reaches round the gears. [deg]
    """
    angle = f"machine.casing.outlet_angle={outlet_angle} deg"
    case = shipped("nose_pressure", *_RIGID, angle)
    points = prepare(case, HousingContact(friction_coefficient=0.02))
    inlet, outlet = 3.9e5, 29.1e5
    forces, breakaway = [], 0.0
    for speed in (2550.0, 4675.0):
        condition = PointCondition(
            label="",
            outlet_pressure=outlet,
            inlet_pressure=inlet,
            shaft_speed=speed * np.pi / 30.0,
        )
        run = points.run
        data = points.lumped(condition)(run.machine).data
        problem = lateral_problem(run.machine, run.fluid, data, points.settings)
        states = problem.started(2e-6).states
        forces.append(float(np.mean([state.film_force()[0] for state in states])))
        breakaway = problem.loads.friction.breakaway_force
    nose = points.balance.floating.nose.area * (0.25 * outlet - inlet)
    return forces[0], forces[1], breakaway, nose


CLAIMS = (
    Claim(
        "fuel_pump_loop_055",
        SOURCE,
        "Section 4.2: 'the film thickness increases with increasing pressure', and Fig. 22 shows a "
        "loop of the position.",
        "A change counts from the 0.05 um of the sensor on; grids agree so but at the top. "
        "Films at most 4 um, as those of the source are normalised by one of the order of 3.",
        _first_set,
        10.0,
    ),
    Claim(
        "fuel_pump_second_leg",
        SOURCE,
        "Section 4.2: 'the gap heights in the second leg of these simulations are higher for a "
        "given outlet pressure since the starting gaps are higher'.",
        "A change counts from the 0.05 um of the sensor on.",
        _second_leg,
        10.0,
        computed_with="fuel_pump_loop_055",
    ),
    Claim(
        "fuel_pump_loop_078",
        SOURCE,
        "Section 4.3: 'the model captures the trend of the bearing movement' (Fig. 23).",
        "A change counts from the 0.05 um of the sensor on; films at most 4 um.",
        _second_set,
        8.0,
        reason=(
            "The bearing rises at every step and comes back in a loop, but at 155.2 bar its mean "
            "film is 5.9 um, beyond the own limit: bearing and gears are compressed there, and "
            "1.5 % of the flow passes. A bearing of 60 mm in place of 38 mm stays at 4.0 um there, "
            "and the second leg is no longer higher at low pressure "
            "(docs/validation/lateral_gap.md). The source deviates most at this pressure, too."
        ),
    ),
    Claim(
        "fuel_pump_nose",
        SOURCE,
        "Section 4.4: at OC3 'the nose pressure value does not influence the resulting position', "
        "at OC1 and OC2 'the effect of the nose pressure becomes relevant'.",
        "The table of conditions is lost, and these are assumed. A move counts from the 0.05 um of "
        "the sensor on.",
        _nose_pressure,
        15.0,
        reason=(
            "At the start gap of 2 um a side bent faces stand on their asperities. These push the "
            "bearing off at OC3, by more than friction holds, and balance it within friction at "
            "OC1 and OC2. With the seal line at -2.4 mm and springs of 62 N all three statements "
            "hold, but the second leg of the loop is no longer higher at 19.4 bar "
            "(docs/validation/lateral_gap.md)."
        ),
    ),
    Claim(
        "fuel_pump_speed",
        SOURCE,
        "Section 4.4: 'the rotational speed also plays a (secondary) influence'.",
        "The conditions are lost, so it is judged in forces: from OC2 to OC1 speed may change the "
        "opening force by less than friction holds. The grid of 84 x 10 cells is good for 5 %.",
        _speed,
        0.5,
    ),
    Claim(
        "fuel_pump_loop_numbers",
        SOURCE,
        "Figs. 22 and 23: measured positions in normalised units.",
        "The reference length and the zero of the sensor are not published, so that "
        "heights cannot be compared.",
        None,
    ),
)
