"""Floating bearing of the fuel pump: position, films and nose pressure in the source's words."""

from __future__ import annotations

from functools import cache

import numpy as np

from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.studies.bearing_path import solve_path
from toothspace.studies.bearing_points import LateralStudy
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    Effort,
    Evidence,
    ValidationSource,
    holds,
    within,
)
from toothspace.validation.resources import shipped

SOURCE = ValidationSource(
    "lateral_gap_friction",
    "Position hysteresis of the floating bearing of a fuel pump",
    "D. Thiagarajan, A. Vacca, S. Watkins, Mech. Syst. Signal Process. 129 (2019) 659-676.",
    "The publication is normalised. Reference pressure 194 bar and speed 8500 rpm, gears, springs, "
    "areas and grooves are reconstructed; the seal line is free and stands at 6.45 mm, in a window "
    "of 0.12 mm in which both loops show what the source says.",
)

LARGEST_FILM = 4.0
"""Mean film of a bearing that runs on its film; films of the source are of the order of 3. [um]"""

MOVED = 0.05
"""Change of position that counts as one. [um]"""

_COARSE = ("run.film_grid=[84, 10]", "run.film_angles_per_pitch=4")
_SHORT = ("run.film_grid=[105, 15]", "run.film_angles_per_pitch=4")
"""Least grid on which films at the top of a loop are those of the default one."""


SEAL_LINES = (5.8, 6.1, 6.2, 6.4)
"""Places of the seal line whose loops are compared on a coarse grid. [mm]"""


@cache
def _loop(name: str, effort: Effort) -> LateralStudy:
    return solve_path(shipped(name, *(() if effort == "full" else _SHORT)))


@cache
def _moved(name: str, seal_line: float) -> LateralStudy:
    area = f'{{seal_line_x="{seal_line} mm"}}'
    moved = f"machine.floating_bearing.high_pressure_area={area}"
    return solve_path(shipped(name, *_COARSE, moved))


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


def _first_set(effort: Effort) -> Evidence:
    study = _loop("hysteresis_055", effort)
    films = _films(study)
    top = films.size // 2
    up, down = films[: top + 1], films[top:][::-1]
    values = _loop_values(study)
    thicker = "film thickness increases with increasing pressure"
    higher = "gap heights of the second leg are higher at the same pressure"
    for k in range(top):
        step = f"film growth from step {k + 1} to {k + 2}"
        values.append(within(step, up[k + 1] - up[k], "um", thicker, 1e-3))
        step = f"second leg above first at step {k + 1}"
        values.append(within(step, down[k] - up[k], "um", higher, 1e-3))
    values.append(_between_legs(_positions(study), "Fig. 22: a loop"))
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


def _statements(study: LateralStudy) -> bool:
    """Whether a loop shows what sections 4.2 and 4.3 say, on films of at most 4 um."""
    films = _films(study)
    top = films.size // 2
    up, down = films[: top + 1], films[top:][::-1]
    return bool(
        study.status is Status.DONE
        and films.max() <= LARGEST_FILM
        and np.all(np.diff(up) > 0.0)
        and np.all(down[:top] > up[:top])
    )


def _window(effort: Effort) -> Evidence:
    lines = SEAL_LINES if effort == "full" else SEAL_LINES[2:3]
    found = {
        name: [_moved(name, line) for line in lines]
        for name in ("hysteresis_055", "hysteresis_078")
    }
    held = np.array([[_statements(study) for study in loops] for loops in found.values()])
    largest = {n: np.array([_films(study).max() for study in s]) for n, s in found.items()}
    words = {True: f"at most {LARGEST_FILM:g} um", False: "statements do not all hold"}
    values = [
        within(f"{name}, seal line at {line:g} mm: largest mean film", film, "um", words[shows])
        for (name, films), row in zip(largest.items(), held.tolist(), strict=True)
        for line, film, shows in zip(lines, films, row, strict=True)
    ]
    text = "seal lines at which all statements hold in both sets"
    both = np.count_nonzero(held.all(axis=0))
    values.append(within(text, both, "-", "one pump shows both loops", 1.0))
    axes = "seal line (mm)", "mean film (um)"
    curves = tuple(
        ComparedCurve(f"Largest mean film, {name}", *axes, np.array(lines), films)
        for name, films in largest.items()
    )
    return Evidence(tuple(values), curves)


def _second_set(effort: Effort) -> Evidence:
    study = _loop("hysteresis_078", effort)
    positions = _positions(study)
    trend = "captures the trend of the bearing movement"
    values = _loop_values(study)
    for k in range(positions.size // 2):
        step = f"rise of position from step {k + 1} to {k + 2}"
        values.append(within(step, positions[k + 1] - positions[k], "um", trend, 1e-3))
    values.append(_between_legs(positions, "Fig. 23: a loop"))
    return Evidence(tuple(values), _curves(study), study.dataset())


def _nose_pressure(effort: Effort) -> Evidence:
    study = solve_path(shipped("nose_pressure", *(() if effort == "full" else _COARSE)))
    positions = _positions(study).reshape(3, -1)
    ranges = np.ptp(positions, axis=1)
    speed = float(abs(positions[0, 0] - positions[1, 0]))
    share = np.linspace(0.0, 25.0, positions.shape[1])
    axes = "nose pressure (% of outlet)", "position (um)"
    curves = tuple(
        ComparedCurve(f"position at {name}", *axes, share, row)
        for name, row in zip(("OC1", "OC2", "OC3"), positions, strict=True)
    )
    text, words = "change over the nose pressure at", "nose pressure relevant at OC1 and OC2"
    none, most = "no influence at the highest outlet pressure", max(*ranges[:2], MOVED)
    values = (
        holds("all points found", study.status is Status.DONE, "fifteen points"),
        within(f"{text} OC1", ranges[0], "um", words, MOVED),
        within(f"{text} OC2", ranges[1], "um", words, MOVED),
        within(f"{text} OC3", ranges[2], "um", none, 0.0, MOVED),
        within("change by speed, OC1 to OC2", speed, "um", "speed is secondary", 0.0, float(most)),
    )
    return Evidence(values, curves)


CLAIMS = (
    Claim(
        "fuel_pump_loop_055",
        SOURCE,
        "Section 4.2: film thickness increases with pressure, is "
        "higher on the second leg at the same pressure, and the position shows a loop.",
        "Sign alone; films at most 4 um, as those of the source are of the order of 3.",
        _first_set,
        10.0,
    ),
    Claim(
        "fuel_pump_loop_078",
        SOURCE,
        "Section 4.3: the trend of the bearing movement.",
        "Sign alone; films at most 4 um.",
        _second_set,
        8.0,
    ),
    Claim(
        "fuel_pump_window",
        SOURCE,
        "Sections 4.2 and 4.3 with one balanced area: seal lines at which films thicken with "
        "pressure and are thicker on the second leg in both sets.",
        "Sign alone; films at most 4 um. Coarse grid: 84 x 10 cells, four angles.",
        _window,
        15.0,
    ),
    Claim(
        "fuel_pump_nose",
        SOURCE,
        "Section 4.4: nose pressure matters at OC1 and OC2, not at OC3; speed is secondary.",
        "A move counts from 0.05 um on.",
        _nose_pressure,
        15.0,
        reason=(
            "The nose matters at OC1 and OC2 and not at OC3, but speed moves the bearing by more "
            "than the nose does, by 1.8 um from OC1 to OC2."
        ),
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
