"""Tables of external gear machines against closed forms and independent polygons."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.external_gear_designs import ALL, FOURTEEN, TWELVE, spaces_at
from tests.reference_formulas.space_areas import section_area_rates
from toothspace.gearing.meshing import facing_throats
from toothspace.gearing.openings import space_outlines
from toothspace.gearing.spaces import (
    Spaces,
    drive_spaces,
    driven_spaces,
    section_areas,
)
from toothspace.geometry.gear_pair import pair_from_backlash
from toothspace.machines.external_gear import MACHINE
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.model.description import MachineDescription

DESIGNS = list(ALL)
TWO_PI = 2.0 * np.pi


@pytest.fixture(scope="module", params=DESIGNS)
def design(request: pytest.FixtureRequest) -> tuple[Assembly, MachineDescription]:
    spec = ALL[request.param]
    return assemble(spec), MACHINE.describe(spec)


@pytest.mark.parametrize(
    ("name", "displacement", "ripple"),
    [("egm12_motor", 4.949, 15.69), ("egm12_pump", 4.949, 15.69), ("fuel14", 43.01, 14.03)],
)
def test_displacement_and_ripple_of_the_reference_designs(
    name: str, displacement: float, ripple: float
) -> None:
    """Numbers from 2 pi b (ra^2 - rw^2 - pb^2/12) of both reference designs."""
    summary = MACHINE.describe(ALL[name], nodes=72).geometry_summary
    assert summary["displacement_cm3_per_rev"] == pytest.approx(displacement, rel=2e-3)
    assert summary["flow_ripple_percent"] == pytest.approx(ripple, abs=0.1)


def test_chambers_and_solids_fill_the_casing(
    design: tuple[Assembly, MachineDescription],
) -> None:
    assembly, description = design
    low, high = (t.tip_radius for t in assembly.teeth)
    mesh = assembly.mesh
    lens = sum(
        r**2 * (a - np.sin(a) * np.cos(a))
        for r, a in ((low, mesh.lens_drive), (high, mesh.lens_driven))
    )
    full = np.pi * (low**2 + high**2) - lens
    solids = sum(
        count * (flank.right.area[-1] - flank.left.area[-1] + 0.5 * r**2 * flank.land_angle)
        for count, flank, r in zip(assembly.counts, assembly.teeth, (low, high), strict=True)
    )
    expected = assembly.face_width * (full - solids)
    for shaft_angle in np.linspace(0.0, 1.7, 9):
        total = sum(
            family.volume(family.phases + family.angle_ratio * shaft_angle).sum()
            for family in description.families
        )
        # all chambers are at one fraction between nodes, so their interpolation errors cancel
        assert total == pytest.approx(expected, rel=1e-8)
        exact = sum(section_areas(s).sum() for s in spaces_at(assembly, shaft_angle))
        assert exact * assembly.face_width == pytest.approx(expected, rel=1e-10)


def test_volumes_stay_positive(design: tuple[Assembly, MachineDescription]) -> None:
    _, description = design
    fine = np.linspace(0.0, TWO_PI, 5000)
    for family in description.families:
        assert family.volume.period == TWO_PI
        assert family.volume(fine).min() > 0.0


def test_openings_are_never_negative(design: tuple[Assembly, MachineDescription]) -> None:
    _, description = design
    fine = np.linspace(0.0, TWO_PI, 5000)
    for path in description.paths:
        first = 1 if path.kind == "curved_gap" else 0
        assert path.geometry(fine)[:, first:].min() >= -1e-15, path.name


def test_rates_are_the_derivatives_of_the_areas(
    design: tuple[Assembly, MachineDescription],
) -> None:
    assembly, _ = design
    step = 2e-5
    angles = np.random.default_rng(1).uniform(-1.2, 1.2, 300)
    for build in (drive_spaces, driven_spaces):
        rates = section_area_rates(build(*assembly.teeth, assembly.mesh, angles))
        ratio = 1.0 if build is drive_spaces else assembly.mesh.ratio
        after, before = (
            section_areas(build(*assembly.teeth, assembly.mesh, angles + s * step * ratio))
            for s in (1.0, -1.0)
        )
        error = np.abs((after - before) / (2.0 * step) - rates)
        scale = np.max(np.abs(rates))
        # the throat's ends have a kink where they pass a tip corner
        assert np.quantile(error, 0.97) < 1e-6 * scale
        assert error.max() < 1e-3 * scale


def test_tables_agree_with_shapely_polygons(
    design: tuple[Assembly, MachineDescription],
) -> None:
    """The polygons of all chambers do not overlap, miss the gears, and have the tables' areas."""
    assembly, description = design
    outlines = description.outlines
    for shaft_angle in (0.1, 0.37):
        chambers = []
        for spaces in spaces_at(assembly, shaft_angle):
            areas = section_areas(spaces)
            outlined = space_outlines(spaces)
            assert np.array_equal(space_outlines(spaces, np.array([2]))[0], outlined[2])
            shapes = [shapely.Polygon(each).buffer(0.0) for each in outlined]
            # chords of the sampled flanks and arcs
            assert shapely.area(shapes) == pytest.approx(areas, rel=1e-3, abs=2e-9)
            chambers += shapes
        union = shapely.union_all(chambers)
        assert union.area == pytest.approx(sum(s.area for s in chambers), rel=1e-6)
        for body in description.bodies:
            polygon = shapely.affinity.rotate(
                shapely.Polygon(outlines[body.name]),
                body.speed_ratio * shaft_angle,
                origin=(0, 0),
                use_radians=True,
            )
            gear = shapely.affinity.translate(polygon, *body.center)
            assert union.intersection(gear).area < 1e-3 * gear.area


@pytest.mark.parametrize("name", ["egm12_motor", "egm12_pump", "fuel14"])
def test_ideal_flow_follows_the_contact(name: str) -> None:
    """Sum of -dV/dphi on the outlet side of the sealing contact is b (ra^2 - rw^2 - u^2).

    Once from the exact rates, once from the interpolated tables between their nodes.
    """
    assembly, description = assemble(ALL[name]), MACHINE.describe(ALL[name])
    pair = assembly.pair
    assert pair is not None
    mean = (4.9494e-6 if "egm" in name else 43.0056e-6) / TWO_PI
    flows = []
    for shaft_angle in 2.0 * assembly.mesh.half_pitch * np.arange(41) / 41:
        spaces = spaces_at(assembly, shaft_angle)
        u, outlet = _outlet_side(assembly, spaces)
        expected = float(pair.flow_per_radian(assembly.face_width, u))
        exact, tabulated = 0.0, 0.0
        for family, own, there in zip(description.families, spaces, outlet, strict=True):
            exact -= assembly.face_width * section_area_rates(own)[there].sum()
            angle = family.phases + family.angle_ratio * shaft_angle
            tabulated -= family.angle_ratio * family.volume.derivative(angle)[there].sum()
        assert exact == pytest.approx(expected, abs=2e-4 * mean)
        assert tabulated == pytest.approx(expected, abs=2e-3 * mean)
        flows.append((u**2, tabulated))
    slope, largest = np.polyfit(*np.transpose(flows), 1)
    pitch = pair.base_pitch
    ripple = -slope * pitch**2 / 4.0 / (largest + slope * pitch**2 / 12.0) * 100.0
    assert ripple == pytest.approx(15.69 if "egm" in name else 14.03, abs=0.1)


def _outlet_side(
    assembly: Assembly, spaces: tuple[Spaces, Spaces]
) -> tuple[float, tuple[np.ndarray, np.ndarray]]:
    # distance of the sealing contact from the pitch point, and the spaces behind that contact
    (drive, driven), mesh = spaces, assembly.mesh
    assert assembly.pair is not None
    side = drive.left if assembly.loaded_is_left else drive.right
    distance = np.hypot(*(side.middle - [0.0, assembly.pair.pitch_radii[0]]).T)
    distance[(side.weight < 1.0) | (side.gap > 1e-8)] = np.inf
    sealing = drive.angles[np.argmin(distance)]
    # the drive space of a trailing throat lies ahead of it, that of a leading throat behind
    limit = sealing + (-1.0 if assembly.loaded_is_left else 1.0) * mesh.half_pitch
    lag = mesh.turn + 0.5 * assembly.teeth[1].pitch_angle
    behind = driven.angles < mesh.ratio * sealing - lag + 0.1 * mesh.half_pitch
    return float(distance.min()), (drive.angles < limit, behind)


def test_involute_gap_equals_backlash() -> None:
    """The loaded flanks touch all along the path of contact, the others leave the backlash."""
    for name, backlash in (("egm12_pump", 0.02e-3), ("egm12_motor", 0.02e-3)):
        assembly = assemble(ALL[name])
        angles = np.linspace(-0.15, 0.15, 31)
        loaded = facing_throats(assembly.teeth, assembly.mesh, assembly.loaded_is_left, angles)
        coast = facing_throats(assembly.teeth, assembly.mesh, not assembly.loaded_is_left, angles)
        assert np.abs(loaded.gap).max() < 1e-8
        assert coast.gap == pytest.approx(backlash, abs=1e-8)


def test_contact_lies_on_the_line_of_action() -> None:
    pair = pair_from_backlash(TWELVE, TWELVE, 0.02e-3)
    angle = pair.operating_pressure_angle
    assembly = assemble(ALL["egm12_pump"])
    side = facing_throats(assembly.teeth, assembly.mesh, True, np.linspace(-0.1, 0.3, 20))
    assert side.normal == pytest.approx(np.tile([-np.cos(angle), np.sin(angle)], (20, 1)), abs=1e-4)
    assert FOURTEEN.base_radius == pytest.approx(28.549e-3, rel=1e-4)
