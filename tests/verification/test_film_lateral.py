"""Films between discs and rings against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.films import FilmFluid, LateralFilm, LateralSolution, RoughSurfaces
from toothspace.films.plane.ring import FaceFilms
from toothspace.numerics.complementarity import residual

VISCOSITY = 0.02
RING = LateralFilm(
    inner_radius=9e-3,
    outer_radius=20e-3,
    side_gap=10e-6,
    fluid=FilmFluid(VISCOSITY),
    grid=(48, 24),
    inner_pressure=1e5,
    outer_pressure=50e5,
)
DISC = replace(RING, inner_radius=0.0, inner_pressure=None, outer_pressure=1e5, grid=(8, 24))


def test_squeezed_disc_converges_with_second_order() -> None:
    """Stefan's disc: F = 3 pi mu R^4 V / (2 h^3)."""
    velocity, radius, gap = 1e-3, 20e-3, 10e-6
    exact = 1.5 * np.pi * VISCOSITY * radius**4 * velocity / gap**3
    errors = []
    for lanes in (16, 32, 64):
        disc = replace(
            RING,
            inner_radius=0.0,
            outer_radius=radius,
            side_gap=gap,
            grid=(8, lanes),
            inner_pressure=None,
            outer_pressure=0.0,
        )
        film = disc.solve(squeeze_velocity=-velocity)
        errors.append(abs(film.load[0] / exact - 1.0))
        swept = np.pi * radius**2 * velocity
        assert film.outer_flow == pytest.approx(swept, rel=1e-9)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.2)


def test_radial_flow_of_a_rotating_ring() -> None:
    """Leakage Q = 2 pi h^3 dp / (12 mu ln(ro/ri)); rotation changes nothing in a plane gap."""
    drop = RING.outer_pressure - RING.inner_pressure  # type: ignore[operator]
    exact = 2.0 * np.pi * RING.side_gap**3 * drop
    exact /= 12.0 * VISCOSITY * np.log(RING.outer_radius / RING.inner_radius)
    for speed in (0.0, 150.0, -150.0):
        film = RING.solve(shaft_speed=speed)
        assert film.inner_flow == pytest.approx(exact, rel=1e-10)
        assert film.outer_flow == pytest.approx(-exact, rel=1e-10)
        assert film.mass_balance_error < 1e-10


def test_friction_torque_of_a_ring() -> None:
    """M = pi mu omega (ro^4 - ri^4) / (2 h)."""
    speed = 150.0
    exact = np.pi * VISCOSITY * speed * (RING.outer_radius**4 - RING.inner_radius**4)
    exact /= 2.0 * RING.side_gap
    film = replace(RING, grid=(16, 96)).solve(shaft_speed=speed)
    assert film.friction_torque == pytest.approx(-exact, rel=2e-4)


def test_mean_leakage_of_a_tilted_ring() -> None:
    """Sector-wise h^3: h0^3 (1 + 1.5 k^2 (r/R)^2), exact without flow round the ring."""
    lean = 0.3 * RING.side_gap / RING.outer_radius
    tilted = replace(RING, tilt=(0.0, lean), grid=(96, 48), inner_radius=18e-3)
    plane = replace(tilted, tilt=(0.0, 0.0))
    ratio = tilted.solve().inner_flow / plane.solve().inner_flow
    assert ratio == pytest.approx(1.0 + 1.5 * (0.3 * 0.95) ** 2, rel=0.01)


def test_tilted_rotating_ring_cavitates_and_conserves_mass() -> None:
    lean = 0.6 * RING.side_gap / RING.outer_radius
    film = replace(RING, tilt=(lean, 0.0), inner_pressure=1e5, outer_pressure=1e5).solve(
        shaft_speed=800.0
    )
    assert film.status.succeeded
    assert film.cavitated_fraction > 0.01
    assert film.mass_balance_error < 1e-10
    # the wedge pushes on the convergent half: rotation from x to y, narrowest at -y
    assert film.load[2] * 1.0 > 0.0


def test_pattern_that_turns_with_the_face_sees_the_opposite_wedge() -> None:
    """h fixed to the rotating face: squeeze turns the sign of the wedge."""
    lean = 0.3 * RING.side_gap / RING.outer_radius
    ring = replace(RING, tilt=(lean, 0.0), cavitation="guembel", cavitation_pressure=-1e9)
    base = ring.solve().load
    resting = ring.solve(shaft_speed=100.0).load - base
    turning = ring.solve(shaft_speed=100.0, gap_speed=100.0).load - base
    assert turning[1:] == pytest.approx(-resting[1:], rel=5e-3, abs=5e-3 * np.abs(resting).max())


def test_given_cells_feed_the_film() -> None:
    given = np.full(RING.grid, np.nan)
    given[10:20, 8:16] = 80e5
    film = replace(RING, given_pressure=given).solve(shaft_speed=100.0)
    assert film.pressure[12, 10] == pytest.approx(80e5, rel=1e-12)
    b, fields = film.plane.balance, film.plane.fields
    fed = residual(b, b, np.maximum(fields.potential, 0.0), fields.saturation)[10:20, 8:16].sum()
    assert fed == pytest.approx(film.inner_flow + film.outer_flow, rel=1e-8)
    assert film.max_pressure == pytest.approx(80e5)
    assert film.mass_balance_error < 1e-10


def test_uniform_pressure_gives_force_over_area_and_no_moment() -> None:
    film = replace(RING, inner_pressure=7e5, outer_pressure=7e5).solve()
    area = np.pi * (RING.outer_radius**2 - RING.inner_radius**2)
    assert film.load[0] == pytest.approx(7e5 * area, rel=1e-10)
    assert np.abs(film.load[1:]).max() < 1e-9 * film.load[0]


def test_stiffness_is_the_derivative_of_the_load() -> None:
    lean = 0.4 * RING.side_gap / RING.outer_radius
    ring = replace(RING, tilt=(lean, -0.5 * lean), inner_pressure=1e5, outer_pressure=3e5)
    speed = 600.0
    stiffness, damping = ring.solve(shaft_speed=speed).plane.rigid_coefficients()
    moved = [
        lambda s: replace(ring, side_gap=ring.side_gap + s * 1e-11),
        lambda s: replace(ring, tilt=(ring.tilt[0] + s * 1e-9, ring.tilt[1])),
        lambda s: replace(ring, tilt=(ring.tilt[0], ring.tilt[1] + s * 1e-9)),
    ]
    for k, step in enumerate((1e-11, 1e-9, 1e-9)):
        high = moved[k](1.0).solve(shaft_speed=speed).load
        low = moved[k](-1.0).solve(shaft_speed=speed).load
        column = -(high - low) / (2.0 * step)
        assert stiffness[:, k] == pytest.approx(column, rel=1e-4, abs=1e-5 * np.abs(column).max())
    high = ring.solve(shaft_speed=speed, squeeze_velocity=1e-7).load
    low = ring.solve(shaft_speed=speed, squeeze_velocity=-1e-7).load
    assert damping[:, 0] == pytest.approx(-(high - low) / 2e-7, rel=1e-5)


def test_rough_faces_carry_by_contact() -> None:
    rough = RoughSurfaces(moving_roughness=0.4e-6, resting_roughness=0.25e-6)
    film = replace(RING, side_gap=0.8e-6, surfaces=rough).solve(shaft_speed=1.0)
    smooth = replace(RING, side_gap=0.8e-6).solve(shaft_speed=1.0)
    assert film.load[0] > 1.01 * smooth.load[0]
    assert abs(film.friction_torque) > abs(smooth.friction_torque)


def test_wrong_shapes_are_refused() -> None:
    with pytest.raises(CaseError, match=r"film\.given_pressure"):
        replace(RING, given_pressure=np.zeros((3, 3)))
    with pytest.raises(CaseError, match=r"film\.inner_radius"):
        replace(RING, inner_radius=30e-3)


def test_tangent_of_a_rough_film_holds_contact() -> None:
    """Stiffness of film and asperities together against central differences of the load."""
    surfaces = RoughSurfaces(moving_roughness=0.6e-6, resting_roughness=0.8e-6, hardness=0.5e9)
    film = replace(RING, side_gap=2.2e-6, tilt=(2e-5, -1e-5), surfaces=surfaces)
    stiffness, _ = film.solve(shaft_speed=50.0).coefficients()
    plain, _ = film.solve(shaft_speed=50.0).plane.rigid_coefficients()
    assert stiffness[0, 0] > 1.05 * plain[0, 0]
    for k, step in enumerate((1e-10, 1e-8, 1e-8)):
        loads = []
        for sign in (1.0, -1.0):
            tilt = [2e-5, -1e-5]
            if k > 0:
                tilt[k - 1] += sign * step
            gap = 2.2e-6 + (sign * step if k == 0 else 0.0)
            moved = replace(film, side_gap=gap, tilt=(tilt[0], tilt[1]))
            loads.append(moved.solve(shaft_speed=50.0).load)
        expected = -(loads[0] - loads[1]) / (2.0 * step)
        size = np.abs(stiffness[:, k]).max()
        np.testing.assert_allclose(stiffness[:, k], expected, atol=1e-4 * size)


def _twin(moving: float, resting: float, **more: float) -> LateralSolution:
    """Parallel ring of one rough and one smooth face, at a gap of three times the roughness."""
    ring = LateralFilm(
        inner_radius=0.01,
        outer_radius=0.03,
        side_gap=3e-6,
        fluid=FilmFluid(VISCOSITY),
        grid=(16, 32),
        inner_pressure=1e5,
        outer_pressure=1e5,
        surfaces=RoughSurfaces(moving_roughness=moving, resting_roughness=resting, **more),  # type: ignore[arg-type]
    )
    return ring.solve(shaft_speed=100.0)


def test_drag_belongs_to_the_rough_face() -> None:
    """The rough face is dragged alike, whether it turns or rests (Patir and Cheng 1979)."""
    turning, resting = _twin(1e-6, 0.0), _twin(0.0, 1e-6)
    assert turning.friction_torque == pytest.approx(-resting.resting_friction_torque, rel=1e-12)
    assert turning.resting_friction_torque == pytest.approx(-resting.friction_torque, rel=1e-12)
    assert abs(turning.friction_torque + turning.resting_friction_torque) > 0.01 * abs(
        turning.friction_torque
    )


def test_contact_brakes_one_face_and_drags_the_other() -> None:
    dry, rubbing = _twin(7e-7, 7e-7, boundary_friction=0.0), _twin(7e-7, 7e-7)
    brake = dry.friction_torque - rubbing.friction_torque
    drag = rubbing.resting_friction_torque - dry.resting_friction_torque
    assert rubbing.contact_torque > 0.0
    assert brake == pytest.approx(rubbing.contact_torque, rel=1e-9)
    assert drag == pytest.approx(rubbing.contact_torque, rel=1e-9)
    assert dry.friction_torque == pytest.approx(-dry.resting_friction_torque, rel=1e-12)
    assert rubbing.power_loss == pytest.approx(-100.0 * rubbing.friction_torque)


def test_memory_of_a_full_film_is_its_squeeze() -> None:
    """One time step between two gaps equals the film squeezed at the mean velocity."""
    step, velocity = 1e-4, -2e-3
    before = DISC.solve()
    after = replace(DISC, side_gap=DISC.side_gap + velocity * step)
    remembered = after.solve(history=before.history(step))
    squeezed = after.solve(squeeze_velocity=velocity)
    assert remembered.plane.pressure == pytest.approx(squeezed.plane.pressure, rel=1e-9)


def test_disc_pulled_off_refills_without_loss_of_liquid() -> None:
    """It tears, draws liquid in from the rim in every step, and is full again at rest."""
    step, film = 2e-4, DISC
    found = film.solve()
    torn = 0.0
    for number in range(12):
        before = found.history(step)
        film = replace(film, side_gap=film.side_gap + (5e-6 if number < 3 else 0.0))
        found = film.solve(history=before)
        assert found.status.succeeded
        area = found.plane.film.grid.area
        gained = float(((found.history(step).content - before.content) * area).sum())
        assert gained == pytest.approx(-found.outer_flow * step, rel=1e-9, abs=1e-18)
        torn = max(torn, found.cavitated_fraction)
    assert torn > 0.2
    found = film.solve(history=found.history(10.0))
    assert found.cavitated_fraction == 0.0
    assert found.history(step).content == pytest.approx(film.side_gap, rel=1e-9)
    with pytest.raises(CaseError, match="keep the grid"):
        replace(film, grid=(8, 8)).solve(history=found.history(step))


def test_a_leaning_pattern_that_turns_is_the_same_in_every_direction() -> None:
    """Lean about x or about y: a quarter turn of load and gap."""
    lean = 0.3 * RING.side_gap / RING.outer_radius
    one, other = (
        replace(RING, tilt=tilt).solve(shaft_speed=100.0, gap_speed=70.0)
        for tilt in ((lean, 0.0), (0.0, lean))
    )
    load, about_x, about_y = one.load
    assert other.load == pytest.approx([load, -about_y, about_x], rel=1e-6, abs=1e-9 * load)
    oblique = replace(RING, tilt=(0.6 * lean, 0.8 * lean)).solve(shaft_speed=100.0, gap_speed=70.0)
    turned = [load, 0.6 * about_x - 0.8 * about_y, 0.8 * about_x + 0.6 * about_y]
    assert oblique.load == pytest.approx(turned, rel=1e-3, abs=1e-3 * abs(about_y))


def test_a_recess_all_over_a_ring_is_sheared_at_its_own_depth() -> None:
    """pi mu omega (R^4 - r^4)/(2 (h + d))."""
    deep = replace(RING, depth=np.full(RING.grid, 15e-6), outer_pressure=1e5)
    film = deep.solve(shaft_speed=100.0)
    exact = 0.5 * np.pi * VISCOSITY * 100.0 * (0.02**4 - 0.009**4) / 25e-6
    assert -film.friction_torque == pytest.approx(exact, rel=2e-3)


def test_films_of_two_bodies_press_on_one_face_about_its_origin() -> None:
    """Force p times area at the axes; moments are r x F of a force along z."""
    ring = replace(RING, outer_pressure=2e5, inner_pressure=2e5)
    film = ring.solve()
    area = np.pi * (0.02**2 - 0.009**2)
    faces = FaceFilms(("one", "other"), ((0.03, -0.01), (-0.02, 0.04)), (film, film))
    force = 2e5 * area
    expected = [2.0 * force, (-0.01 + 0.04) * force, -(0.03 - 0.02) * force]
    assert faces.load == pytest.approx(expected, rel=1e-6)
