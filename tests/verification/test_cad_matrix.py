"""Gears drawn by independent programs, in every format, against the DIN formulas.

Needs ``pip install 'toothspace[generators]'``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_finder import FoundGear, find_gears
from toothspace.geometry.gear_pair import pair_from_backlash
from toothspace.geometry.involute import InvoluteGear

WIDTH = 10e-3
BACKLASH = 20e-6


@dataclass(frozen=True)
class Drawn:
    """A gear as an independent program draws it."""

    program: str
    tooth_count: int
    module_mm: float
    angle_deg: float
    shift: float = 0.0

    def ideal(self, tip_diameter: float) -> InvoluteGear:
        angle = np.deg2rad(self.angle_deg)
        return InvoluteGear(
            self.tooth_count, self.module_mm * 1e-3, angle, self.shift, tip_diameter
        )

    def part(self) -> Any:
        if self.program == "py_gearworks":
            generator = pytest.importorskip("py_gearworks")
            return generator.SpurGear(
                number_of_teeth=self.tooth_count,
                module=self.module_mm,
                height=WIDTH * 1e3,
                pressure_angle=np.deg2rad(self.angle_deg),
                profile_shift=self.shift,
                dedendum_coefficient=1.25,
            ).build_part()
        gear = pytest.importorskip("bd_warehouse.gear")
        return gear.SpurGear(
            module=self.module_mm,
            tooth_count=self.tooth_count,
            pressure_angle=self.angle_deg,
            thickness=WIDTH * 1e3,
        )


GEARS = [
    Drawn("py_gearworks", 7, 3.0, 25.0, 0.4),
    Drawn("py_gearworks", 12, 2.75, 20.0, 0.3),
    Drawn("py_gearworks", 17, 2.0, 20.0),
    Drawn("py_gearworks", 24, 2.54, 14.5, 0.1),
    Drawn("py_gearworks", 40, 1.0, 28.0),
    Drawn("bd_warehouse", 10, 3.0, 25.0),
    Drawn("bd_warehouse", 20, 2.0, 20.0),
    Drawn("bd_warehouse", 30, 1.0, 14.5),
]
FORMATS = ["step", "stl 0.001", "stl 0.01", "stl 0.1", "txt", "dxf"]
TURNS = [(0.0, 0.0, 0.0), (0.0, 90.0, 0.0), (90.0, 0.0, 0.0), (25.0, -40.0, 10.0)]
UNITS = {"mm": 1e-3, "in": 25.4e-3}


def written(folder: Path, part: Any, kind: str, unit: str) -> Path:
    build123d = pytest.importorskip("build123d")
    name, _, tolerance = kind.partition(" ")
    path = folder / f"gear.{name}"
    if name == "step":
        build123d.export_step(part, path)
        return path
    factor = 1e-3 / UNITS[unit]
    if name == "stl":
        copy = build123d.scale(part, factor)
        build123d.export_stl(copy, path, tolerance=float(tolerance) * factor, angular_tolerance=0.6)
        return path
    points = outline_of(part) * factor
    if name == "txt":
        np.savetxt(path, points, fmt="%.9f")
        return path
    import ezdxf

    drawing = ezdxf.new()
    drawing.modelspace().add_lwpolyline([tuple(point) for point in points], close=True)
    drawing.saveas(path)
    return path


def outline_of(part: Any) -> np.ndarray:
    """Points every few micrometres on the edges of the lowest face, in mm."""
    face = min(part.faces(), key=lambda found: found.center().Z)
    pieces = []
    for edge in face.outer_wire().order_edges():
        share = np.linspace(0.0, 1.0, 60)[:-1]
        pieces.append(np.array([[p.X, p.Y] for p in (edge.position_at(s) for s in share)]))
    ring = shapely.LinearRing(np.vstack(pieces))
    if ring.is_simple:
        return shapely.get_coordinates(ring)[:-1]
    # edges that run backwards are put in order by their ends
    ordered = [pieces[0]]
    return np.vstack(ordered + pieces[1:])


def turned(part: Any, angles: tuple[float, float, float]) -> Any:
    build123d = pytest.importorskip("build123d")
    return build123d.Rotation(*angles) * part


def contact_ratio(found: FoundGear, distance: float) -> float:
    flank = found.detected.profile.involute
    pitch = 2.0 * np.pi * flank.base_radius / found.detected.tooth_count
    length = np.sqrt(distance**2 - 4.0 * flank.base_radius**2)
    low = length - flank.roll_length(flank.tip_form_radius)
    if flank.undercut:
        low = max(low, flank.roll_length(flank.form_radius))
    return (length - 2.0 * low) / pitch


def displacement(found: FoundGear, distance: float) -> float:
    profile = found.detected.profile
    pitch = 2.0 * np.pi * profile.base_radius / profile.tooth_count
    return WIDTH * (profile.tip_radius**2 - (0.5 * distance) ** 2 - pitch**2 / 12.0)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(GEARS)), ids=lambda k: str(GEARS[k]))
def test_gears_of_other_programs(tmp_path: Path, number: int) -> None:
    """Displacement 0.1 %, contact ratio 0.01, base diameter 3 um, or chords are named.

    Programs lay splines through a few points of the involute: their own error, read from the
    exact section of the STEP file, adds to the 3 um.
    """
    drawn = GEARS[number]
    part = drawn.part()
    own_error = 0.0
    for place, kind in enumerate(FORMATS):
        unit = "in" if kind in {"stl 0.01", "dxf"} else "mm"
        solid = kind.startswith("st")
        turn = TURNS[(number + place) % len(TURNS)] if solid else (0.0, 0.0, 0.0)
        path = written(tmp_path, turned(part, turn), kind, unit)
        (found,) = find_gears(path, 1e-3 if kind == "step" else UNITS[unit]).gears
        detected = found.detected
        assert detected.tooth_count == drawn.tooth_count, kind
        data = gear_data(detected.profile)
        assert data is not None, kind
        assert data.standard, kind
        ideal = drawn.ideal(2.0 * detected.profile.tip_radius)
        pair = pair_from_backlash(ideal, ideal, BACKLASH)
        volume = pair.displacement_per_radian(WIDTH)
        assert displacement(found, pair.center_distance) == pytest.approx(volume, rel=1e-3), kind
        if kind == "step":
            own_error = detected.involute.form_error
        limit = 3e-6 + 4.0 * own_error
        if detected.chord_height > 2e-6:
            limit += 2.0 * detected.chord_height
        assert 2.0 * detected.profile.base_radius == pytest.approx(
            2.0 * ideal.base_radius, abs=limit
        ), kind
        if detected.chord_height < 20e-6:
            ratio = contact_ratio(found, pair.center_distance)
            assert ratio == pytest.approx(pair.contact_ratio, abs=0.01), kind
