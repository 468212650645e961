"""Elastic bodies against closed forms of plates, rings, half-spaces and accelerated bars."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from toothspace.core.errors import GeometryError
from toothspace.elasticity import (
    AreaPressure,
    CylinderSurface,
    ElasticBody,
    InfluenceMatrix,
    PlaneSurface,
    Prism,
    Support,
    SweptShape,
    annulus,
    disc,
    influence,
    influence_matrix,
)

pytestmark = pytest.mark.slow

MODULUS = 200e9
POISSON = 0.3
DENSITY = 7800.0
PRESSURE = 1e6


def _condensed(
    parts: tuple[Prism, ...],
    size: tuple[float, float],
    films: tuple[PlaneSurface | CylinderSurface, ...],
    supports: tuple[Support, ...] = (),
    loads: tuple[AreaPressure, ...] = (),
    poisson: float = POISSON,
) -> InfluenceMatrix:
    body = ElasticBody(SweptShape(parts, *size), MODULUS, poisson, DENSITY, films, loads, supports)
    return influence_matrix(body, estimate_error=False, cache=False)


def _everywhere(half: float) -> shapely.Polygon:
    return shapely.box(-half, -half, half, half)


@pytest.fixture(scope="module")
def plate() -> InfluenceMatrix:
    """Clamped circular plate with radius 20 mm and thickness 2 mm."""
    radius, thickness = 20e-3, 2e-3
    section = disc(radius)
    rim = Support("lateral", _everywhere(2.0 * radius))
    film = PlaneSurface("face", "top", section, 3e-3)
    load = AreaPressure("all", "top", section)
    part = Prism(section, 0.0, thickness)
    return _condensed((part,), (1.6e-3, 1e-3), (film,), (rim,), (load,))


@pytest.fixture(scope="module")
def block() -> InfluenceMatrix:
    """Floating ring with films on top and bottom."""
    section = annulus(10e-3, 20e-3)
    films = (
        PlaneSurface("top", "top", section, 5e-3),
        PlaneSurface("bottom", "bottom", section, 5e-3),
    )
    return _condensed((Prism(section, -6e-3, 6e-3),), (4e-3, 3e-3), films)


def _cell_loads(matrix: InfluenceMatrix, name: str, pressure: float) -> np.ndarray:
    """Nodal loads of a uniform pressure gathered from fine cells."""
    film = next(f for f in matrix.body.films if f.name == name)
    assert isinstance(film, PlaneSurface)
    low_x, low_y, high_x, high_y = film.region.bounds
    x, y = (
        g.ravel()
        for g in np.meshgrid(np.linspace(low_x, high_x, 301), np.linspace(low_y, high_y, 301))
    )
    inside = shapely.contains_xy(film.region, x, y)
    spread = matrix.interpolation(name, np.column_stack([x, y])[inside])
    loads = np.zeros(len(matrix.nodes))
    loads[matrix.of(name)] = spread.T @ np.full(
        inside.sum(), pressure * film.region.area / inside.sum()
    )
    return loads


def test_clamped_plate_bends_as_in_timoshenko(plate: InfluenceMatrix) -> None:
    """p a^4 / (64 D), with the shear of Mindlin p a^2 / (4 k G t), k = 5/6.

    Stresses at a clamped rim are singular; meshes approach the deflection slowly from below.
    """
    radius, thickness = 20e-3, 2e-3
    bending = MODULUS * thickness**3 / (12.0 * (1.0 - POISSON**2))
    shear = 0.5 * MODULUS / (1.0 + POISSON)
    expected = PRESSURE * radius**4 / (64.0 * bending)
    expected += PRESSURE * radius**2 / (4.0 * 5.0 / 6.0 * shear * thickness)
    middle = plate.interpolation("face", np.zeros((1, 2)))
    assert float((middle @ plate.load_cases["all"])[0]) * PRESSURE == pytest.approx(
        expected, rel=0.03
    )


def test_film_loads_act_like_the_same_pressure_as_a_named_load(plate: InfluenceMatrix) -> None:
    named = PRESSURE * plate.load_cases["all"]
    film = plate.deformation(_cell_loads(plate, "face", PRESSURE))
    assert np.abs(film - named).max() < 0.01 * np.abs(named).max()


def test_ring_widens_as_in_lame() -> None:
    """Plane stress: u = p r_i / E ((r_o^2 + r_i^2) / (r_o^2 - r_i^2) + nu)."""
    inner, outer, height = 10e-3, 20e-3, 10e-3
    film = CylinderSurface("bore", inner, 0.0, height, (12, 3))
    ring = _condensed((Prism(annulus(inner, outer), 0.0, height),), (2.5e-3, 2.5e-3), (film,))
    area = 2.0 * np.pi * inner * height
    share = np.tile([0.25, 0.5, 0.25], 12) / 12.0
    found = ring.deformation(PRESSURE * area * share)
    ratio = (outer**2 + inner**2) / (outer**2 - inner**2) + POISSON
    assert found.mean() == pytest.approx(PRESSURE * inner / MODULUS * ratio, rel=0.02)
    assert np.ptp(found) < 0.05 * found.mean()


def test_patch_on_a_half_space_sinks_as_in_love() -> None:
    """Uniform pressure on a circle: middle less edge 2 (1 - nu^2) p a / E (1 - 2 / pi)."""
    radius, wide = 2e-3, 9e-3
    section, patch = disc(wide), disc(radius)
    body = (Prism(section, -8e-3, 0.0), Prism(patch, -1e-3, 0.0))
    film = PlaneSurface("face", "top", disc(1.5 * radius), 0.8e-3)
    base = Support("bottom", section)
    load = AreaPressure("patch", "top", patch)
    half_space = _condensed(body, (1.3e-3, 0.7e-3), (film,), (base,), (load,))
    angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    edge = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    places = half_space.interpolation("face", np.vstack([np.zeros((1, 2)), edge]))
    found = places @ half_space.load_cases["patch"]
    expected = 2.0 * (1.0 - POISSON**2) * radius / MODULUS * (1.0 - 2.0 / np.pi)
    assert found[0] - found[1:].mean() == pytest.approx(expected, rel=0.05)


def test_compliance_is_symmetric_and_positive_semidefinite(block: InfluenceMatrix) -> None:
    compliance = block.compliance
    values = np.linalg.eigvalsh(compliance)
    assert np.abs(compliance - compliance.T).max() <= 1e-12 * np.abs(compliance).max()
    assert values[0] > -1e-10 * values[-1]


def test_rigid_modes_give_force_and_moments_of_film_loads(block: InfluenceMatrix) -> None:
    area = np.pi * (20e-3**2 - 10e-3**2)
    down = block.resultant(_cell_loads(block, "top", PRESSURE))
    up = block.resultant(_cell_loads(block, "bottom", PRESSURE))
    force = PRESSURE * area
    assert down[2] == pytest.approx(-force, rel=1e-3)
    assert up[2] == pytest.approx(force, rel=1e-3)
    assert np.abs(down[3:]).max() < 1e-3 * force * 20e-3


def test_equal_pressure_on_both_faces_gives_hookes_law(block: InfluenceMatrix) -> None:
    loads = _cell_loads(block, "top", PRESSURE) + _cell_loads(block, "bottom", PRESSURE)
    found = block.deformation(loads)
    assert found == pytest.approx(np.full_like(found, PRESSURE * 6e-3 / MODULUS), rel=0.03)


def test_floating_bar_is_strained_by_its_own_inertia() -> None:
    """A bar pushed at its end: u = p l / (3 E) there and -p l / (6 E) at the free end."""
    length, section = 40e-3, disc(3e-3)
    films = (
        PlaneSurface("pushed", "top", section, 3e-3),
        PlaneSurface("free", "bottom", section, 3e-3),
    )
    bar = _condensed((Prism(section, 0.0, length),), (1.5e-3, 2.5e-3), films, poisson=0.0)
    found = bar.deformation(_cell_loads(bar, "pushed", PRESSURE))
    unit = PRESSURE * length / MODULUS
    assert found[bar.of("pushed")].mean() == pytest.approx(unit / 3.0, rel=0.01)
    # the free end moves out of the body, against the push
    assert found[bar.of("free")].mean() == pytest.approx(unit / 6.0, rel=0.02)


def test_error_estimate_is_the_difference_to_a_finer_mesh() -> None:
    section = disc(10e-3)
    film = PlaneSurface("face", "top", section, 4e-3)
    base = Support("bottom", section)

    def made(scale: float) -> InfluenceMatrix:
        shape = SweptShape((Prism(section, 0.0, 6e-3),), scale * 3e-3, scale * 3e-3)
        body = ElasticBody(shape, MODULUS, POISSON, DENSITY, (film,), (), (base,))
        return influence_matrix(body, estimate_error=True, cache=False)

    coarse, fine = made(1.0), made(0.5)
    loads = _cell_loads(coarse, "face", PRESSURE)
    change = np.abs(coarse.deformation(loads) - fine.deformation(loads)).max()
    assert fine.error_estimate < coarse.error_estimate < 0.1
    assert change < 2.0 * coarse.error_estimate * np.abs(fine.deformation(loads)).max()


def test_stored_matrix_comes_back(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(influence, "matrix_folder", lambda: tmp_path)
    section = disc(10e-3)
    film = PlaneSurface("face", "top", section, 6e-3)
    shape = SweptShape((Prism(section, 0.0, 6e-3),), 4e-3, 3e-3)
    body = ElasticBody(shape, MODULUS, POISSON, DENSITY, (film,), (), (Support("bottom", section),))
    first = influence_matrix(body, estimate_error=False)
    assert len(list(tmp_path.glob("*.npz"))) == 1
    second = influence_matrix(body, estimate_error=False)
    assert np.array_equal(first.compliance, second.compliance)


def test_body_that_is_not_held_is_refused() -> None:
    section = disc(10e-3)
    film = PlaneSurface("face", "top", section, 6e-3)
    away = Support("bottom", shapely.box(1.0, 1.0, 2.0, 2.0))
    with pytest.raises(GeometryError, match="support without faces"):
        _condensed((Prism(section, 0.0, 6e-3),), (4e-3, 3e-3), (film,), (away,))


def test_unknown_surface_is_named(block: InfluenceMatrix) -> None:
    with pytest.raises(GeometryError, match="'side'"):
        block.of("side")
