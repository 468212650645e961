"""Pads against closed forms, a manufactured solution and an exchange of the axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.plane.film import solve_plane
from toothspace.films.plane.pad import Pad, Pocket
from toothspace.films.reynolds.equation import film_balance
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.numerics.complementarity import Constraint, solve_complementarity

VISCOSITY, SPEED, LENGTH, WIDTH, HEIGHT = 0.01, 1.0, 0.02, 0.01, 10e-6
ENDLESS = Pad(
    length=LENGTH,
    width=WIDTH,
    inlet_height=2.0 * HEIGHT,
    outlet_height=HEIGHT,
    fluid=FilmFluid(VISCOSITY),
    grid=(50, 4),
    side_condition="no_flow",
)


def _order(errors: list[float]) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_endless_incline_converges_with_second_order() -> None:
    """Load, friction and flow of the fixed incline, h1/h0 = 2 (Hamrock, ch. 8)."""
    load = 6.0 * VISCOSITY * SPEED * LENGTH**2 * WIDTH / HEIGHT**2 * (np.log(2.0) - 2.0 / 3.0)
    friction = VISCOSITY * SPEED * LENGTH * WIDTH / HEIGHT * (4.0 * np.log(2.0) - 2.0)
    flow = SPEED * HEIGHT * WIDTH * 2.0 / 3.0
    errors = {"load": [], "friction": [], "flow": []}
    for rows in (25, 50, 100):
        film = replace(ENDLESS, grid=(rows, 4)).solve(speed=SPEED)
        errors["load"].append(abs(film.load / load - 1.0))
        errors["friction"].append(abs(film.friction / friction - 1.0))
        errors["flow"].append(abs(film.inlet_flow / flow - 1.0))
    for name, values in errors.items():
        assert _order(values) == pytest.approx(2.0, abs=0.1), name
        assert values[-1] < 1e-3, name


def test_stepped_pad_is_exact() -> None:
    """The pressure of Rayleigh's step is linear on both sides, so no error is left."""
    depth, rows = 8e-6, 50
    start = 0.7 * LENGTH
    pad = replace(
        ENDLESS, inlet_height=HEIGHT, pocket=Pocket(depth, -1.0, 1.0 + start, 1.0), grid=(rows, 4)
    )
    film = pad.solve(speed=SPEED)
    deep, shallow = (HEIGHT + depth) ** 3 / start, HEIGHT**3 / (LENGTH - start)
    peak = 6.0 * VISCOSITY * SPEED * depth / (deep + shallow)
    assert film.load == pytest.approx(0.5 * peak * LENGTH * WIDTH, rel=1e-10)


def test_diverging_pad_cavitates_and_conserves_mass() -> None:
    pad = replace(ENDLESS, inlet_height=HEIGHT, outlet_height=3.0 * HEIGHT, width=0.02)
    pad = replace(pad, side_condition="pressure", grid=(60, 31))
    film = pad.solve(speed=SPEED)
    assert film.status.succeeded
    assert film.mass_balance_error < 1e-10
    assert film.inlet_flow == pytest.approx(film.outlet_flow + film.side_flow, rel=1e-9)
    assert 0.1 < film.cavitated_fraction < 0.99
    assert film.film_fraction.min() < 0.7
    assert film.load < 0.0


def _manufactured_error(rows: int) -> float:
    """Largest error of the pressure sin(pi x/L) cos(pi y/W) in a gap curved both ways."""
    pad = replace(
        ENDLESS,
        shape=lambda x, y: HEIGHT * (1.0 + 0.5 * x / LENGTH + 0.8 * (y / WIDTH) ** 2),
        grid=(rows, rows),
        side_condition="pressure",
        ambient_pressure=0.0,
    )
    film = pad._film(SPEED, 0.0)
    x, y, h = film.points.x, film.points.y, film.gap.centre
    a, b = np.pi / LENGTH, np.pi / WIDTH
    pressure = 1e6 * np.sin(a * x) * np.cos(b * y)
    p_x, p_y = 1e6 * a * np.cos(a * x) * np.cos(b * y), -1e6 * b * np.sin(a * x) * np.sin(b * y)
    h_x, h_y = HEIGHT * 0.5 / LENGTH, HEIGHT * 1.6 * y / WIDTH**2
    divergence = 3.0 * h**2 * (h_x * p_x + h_y * p_y) - h**3 * (a**2 + b**2) * pressure
    source = 0.5 * SPEED * h_x - divergence / (12.0 * VISCOSITY)
    balance = film_balance(film.grid, film.gap, film.fluid.fields(pressure), 0.0)
    balance = balance._replace(source=source * film.grid.area)
    solution = solve_complementarity(balance, Constraint.CONSERVING)
    return float(np.abs(solution.potential - pressure).max()) / 1e6


def test_manufactured_pressure_converges_with_second_order() -> None:
    errors = [_manufactured_error(rows) for rows in (16, 32, 64)]
    assert _order(errors) == pytest.approx(2.0, abs=0.15)


def _cavity_errors(rows: int) -> tuple[float, float]:
    """Errors of pressure and film fraction for a film that ruptures inside the pad.

    p = P x (b - x)^2 up to x = b, film fraction 1 - (x - b) / (2 L) behind.
    """
    pad = replace(ENDLESS, inlet_height=HEIGHT, grid=(rows, 4), ambient_pressure=0.0)
    film = pad._film(SPEED, 0.0)
    edge = 0.6137 * LENGTH
    scale = 1e6 / LENGTH**3
    x = film.points.x
    full = x < edge
    pressure = np.where(full, scale * x * (edge - x) ** 2, 0.0)
    fraction = np.where(full, 1.0, 1.0 - 0.5 * (x - edge) / LENGTH)
    face = np.linspace(0.0, LENGTH, rows + 1)[:, None]
    slope = np.where(face < edge, scale * (edge - face) * (edge - 3.0 * face), 0.0)
    carried = np.where(face < edge, 1.0, 1.0 - 0.5 * (face - edge) / LENGTH)
    flux = -(HEIGHT**3) / (12.0 * VISCOSITY) * slope + 0.5 * SPEED * HEIGHT * carried
    balance = film_balance(film.grid, film.gap, film.fluid.fields(pressure), 0.0)
    width = film.grid.area / (LENGTH / rows)
    balance = balance._replace(source=np.diff(flux, axis=0) * width)
    solution = solve_complementarity(balance, Constraint.CONSERVING)
    assert solution.converged
    return (
        float(np.abs(solution.potential - pressure).max()) / 1e6,
        float(np.abs(solution.saturation - fraction).max()),
    )


def test_manufactured_cavity_converges_with_first_order() -> None:
    """Upwind transport of the film fraction limits the order to one in the cavity."""
    errors = np.array([_cavity_errors(rows) for rows in (40, 80, 160, 320)])
    pressure_order = np.log2(errors[0, 0] / errors[-1, 0]) / 3.0
    fraction_order = np.log2(errors[0, 1] / errors[-1, 1]) / 3.0
    assert pressure_order > 1.5
    assert fraction_order > 0.9


def test_exchange_of_axes() -> None:
    """A film swept along y equals the transposed film swept along x."""
    pad = replace(
        ENDLESS,
        shape=lambda x, y: HEIGHT * (2.0 + 0.9 * np.sin(600.0 * x + 200.0 * y)),
        grid=(24, 20),
        side_condition="pressure",
        ambient_pressure=1e4,
    )
    film = pad._film(SPEED, 0.0)
    g, h = film.grid, film.gap
    swapped_grid = g._replace(
        shape_x=_turned(g.shape_y),
        shape_y=_turned(g.shape_x),
        sweep_x=_turned(g.sweep_y),
        sweep_y=_turned(g.sweep_x),
        area=_turned(g.area),
        mark=np.ascontiguousarray(g.mark.T),
        prescribed=_turned(g.prescribed),
        west=g.south,
        east=g.north,
        south=g.west,
        north=g.east,
    )
    swapped_gap = h._replace(
        centre=_turned(h.centre),
        face_x=_turned(h.face_y),
        face_y=_turned(h.face_x),
        rate=_turned(h.rate),
        step=_turned(h.step),
    )
    straight = solve_plane(film)
    turned = solve_plane(replace(film, grid=swapped_grid, gap=swapped_gap))
    assert straight.cavitated_fraction() > 0.01
    pressure, fraction = _turned(turned.pressure), _turned(turned.fields.saturation)
    assert pressure == pytest.approx(straight.pressure, rel=1e-9, abs=1e-3)
    assert fraction == pytest.approx(straight.fields.saturation, abs=1e-9)


def _turned(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values.T)


def test_half_pad_equals_whole_pad() -> None:
    """The mirror plane is used for built-in shapes and not for given ones."""
    pad = replace(ENDLESS, side_condition="pressure")
    for lanes in (20, 21):
        half = replace(pad, grid=(32, lanes)).solve(speed=SPEED)
        whole = replace(
            pad, grid=(32, lanes), shape=lambda x, y: HEIGHT * (2.0 - x / LENGTH) + 0.0 * y
        ).solve(speed=SPEED)
        assert half.load == pytest.approx(whole.load, rel=1e-10)
        assert half.friction == pytest.approx(whole.friction, rel=1e-10)
        assert half.side_flow == pytest.approx(whole.side_flow, rel=1e-9)
        assert half.pressure == pytest.approx(whole.pressure, rel=1e-9)


def test_rigid_coefficients_are_derivatives() -> None:
    """Central differences of load and moments with lift and rotations of the pad."""
    base = replace(ENDLESS, side_condition="pressure", grid=(40, 21))

    def moved(lift: float, about_x: float, about_y: float, rate: float) -> np.ndarray:
        pad = replace(
            base,
            shape=lambda x, y: HEIGHT * (2.0 - x / LENGTH) + lift + about_x * y - about_y * x,
        )
        plane = pad.solve(speed=SPEED, squeeze_velocity=rate).plane
        return plane.load(plane.pressure)

    pad = replace(base, shape=lambda x, y: HEIGHT * (2.0 - x / LENGTH) + 0.0 * y)
    plane = pad.solve(speed=SPEED).plane
    stiffness, damping = plane.rigid_coefficients()
    rounding = 32.0 * np.finfo(float).eps * np.abs(plane.load(plane.pressure)).max()
    for k, step in enumerate((1e-11, 1e-9, 1e-9)):
        unit = [0.0, 0.0, 0.0]
        unit[k] = step
        column = -(moved(*unit, 0.0) - moved(*(-u for u in unit), 0.0)) / (2.0 * step)
        allowed = 1e-6 * np.abs(column).max() + rounding / step
        assert stiffness[:, k] == pytest.approx(column, rel=1e-5, abs=allowed)
    column = -(moved(0.0, 0.0, 0.0, 1e-7) - moved(0.0, 0.0, 0.0, -1e-7)) / 2e-7
    assert damping[:, 0] == pytest.approx(column, rel=1e-6, abs=1e-6 * np.abs(column).max())


def test_pressure_dependent_fluid_settles() -> None:
    fluid = FilmFluid(VISCOSITY, pressure_viscosity=2e-8, compressible=True)
    pad = replace(ENDLESS, inlet_height=2e-6, outlet_height=1e-6, fluid=fluid, grid=(40, 16))
    film = replace(pad, side_condition="pressure").solve(speed=SPEED)
    plain = replace(pad, side_condition="pressure", fluid=FilmFluid(VISCOSITY)).solve(speed=SPEED)
    assert film.status.succeeded
    assert film.mass_balance_error < 1e-10
    assert film.load > 1.02 * plain.load


def test_impossible_input_is_refused() -> None:
    with pytest.raises(CaseError, match=r"film\.ambient_pressure"):
        replace(ENDLESS, cavitation_pressure=2e5)
    with pytest.raises(CaseError, match="smallest gap"):
        replace(ENDLESS, outlet_height=-1e-6).solve(speed=SPEED)


def test_forces_on_pad_and_wall_balance() -> None:
    """Both drags differ by the pressure on the inclined face, W (h1 - h0) / L."""
    film = replace(ENDLESS, inlet_height=2.0 * HEIGHT, grid=(256, 4)).solve(speed=SPEED)
    pad = film.pad
    lean = (pad.inlet_height - pad.outlet_height) / pad.length
    assert film.friction - film.resting_friction == pytest.approx(film.load * lean, rel=1e-3)
    assert film.power_loss == pytest.approx(film.friction * SPEED)
    ratio = pad.inlet_height / pad.outlet_height
    scale = VISCOSITY * SPEED * pad.length * pad.width / pad.outlet_height
    exact = 4.0 * np.log(ratio) / (ratio - 1.0) - 6.0 / (ratio + 1.0)
    assert film.friction == pytest.approx(scale * exact, rel=1e-4)


def _parallel(moving: float, resting: float, **more: float) -> Pad:
    rough = RoughSurfaces(moving_roughness=moving, resting_roughness=resting, **more)
    return replace(
        ENDLESS, inlet_height=3e-6, outlet_height=3e-6, surfaces=rough, cavitation_pressure=-1e9
    )


def test_drag_belongs_to_the_rough_wall_of_a_pad() -> None:
    """Parallel walls: what is rough is dragged alike, whether it slides or rests."""
    sliding, resting = (
        _parallel(*walls).solve(speed=SPEED) for walls in ((1e-6, 0.0), (0.0, 1e-6))
    )
    assert sliding.friction == pytest.approx(resting.resting_friction, rel=1e-9)
    assert sliding.resting_friction == pytest.approx(resting.friction, rel=1e-9)
    assert abs(sliding.friction - sliding.resting_friction) > 0.01 * sliding.friction


def test_asperities_drag_both_walls_of_a_pad() -> None:
    """By the boundary coefficient of what they carry, with the direction of the motion."""
    dry = _parallel(1e-6, 1e-6, boundary_friction=0.0).solve(speed=SPEED)
    for speed in (SPEED, -SPEED):
        film = _parallel(1e-6, 1e-6, boundary_friction=0.2).solve(speed=speed)
        sense = np.sign(speed)
        assert film.contact_load > 0.0
        assert film.contact_friction == pytest.approx(sense * 0.2 * film.contact_load)
        for name in ("friction", "resting_friction"):
            more = getattr(film, name) - sense * getattr(dry, name)
            assert more == pytest.approx(film.contact_friction, rel=1e-6), name


def test_a_pocket_as_wide_as_the_pad_is_sheared_at_its_own_depth() -> None:
    """Rayleigh's steps: q = U/2 sum(l/h^2)/sum(l/h^3), drag mu U l/h + h/2 dp/dx l of each part."""
    depth, part = 1.5 * HEIGHT, 0.4 * LENGTH
    pad = replace(
        ENDLESS, inlet_height=HEIGHT, grid=(200, 4), cavitation_pressure=-1e9,
        pocket=Pocket(depth, 0.3 * LENGTH, part, 1.0),
    )  # fmt: skip
    film = pad.solve(speed=SPEED)
    length, height = np.array([LENGTH - part, part]), np.array([HEIGHT, HEIGHT + depth])
    flow = 0.5 * SPEED * np.sum(length / height**2) / np.sum(length / height**3)
    slope = 12.0 * VISCOSITY * (0.5 * SPEED * height - flow) / height**3
    sheared = np.sum(VISCOSITY * SPEED * length / height)
    pushed = np.sum(0.5 * height * slope * length)
    assert film.inlet_flow == pytest.approx(flow * WIDTH, rel=1e-6, abs=0.0)
    assert film.friction == pytest.approx(WIDTH * (sheared + pushed), rel=0.01)
    assert film.resting_friction == pytest.approx(WIDTH * (sheared - pushed), rel=0.01)


def test_a_pad_that_is_pressed_down_heats_its_film_by_the_work_of_its_load() -> None:
    film = replace(ENDLESS, inlet_height=HEIGHT, ambient_pressure=3e6).solve(
        speed=0.0, squeeze_velocity=-1e-3
    )
    load = VISCOSITY * LENGTH**3 * WIDTH * 1e-3 / HEIGHT**3
    assert film.load == pytest.approx(load, rel=1e-3)
    assert film.dissipated_power == pytest.approx(1e-3 * load, rel=1e-3)


def test_half_a_pad_has_no_moment_about_its_line_of_motion() -> None:
    plane = ENDLESS.solve(speed=SPEED).plane
    assert plane.film.weight == 2.0
    force, about_x, about_y = plane.load(plane.pressure)
    assert about_x == 0.0
    assert about_y < 0.0 < force


def test_a_film_holds_the_liquid_of_gap_and_pocket() -> None:
    """At a pressure of 0.59 GPa the liquid of Dowson and Higginson is 1.17 times as dense."""
    pressed = FilmFluid(VISCOSITY, compressible=True)
    for fluid, dense in ((FilmFluid(VISCOSITY), 1.0), (pressed, 1.17)):
        pad = replace(
            ENDLESS, inlet_height=HEIGHT, fluid=fluid,
            ambient_pressure=0.59e9, cavitation_pressure=0.1e9,
            pocket=Pocket(3.0 * HEIGHT, 0.5 * LENGTH, 0.5 * LENGTH, 1.0),
        )  # fmt: skip
        film = pad.solve(speed=0.0)
        content = film.history(1e-3).content
        np.testing.assert_allclose(
            content,
            dense * film.plane.film.gap.centre * np.repeat([1.0, 4.0], 25)[:, None],
            rtol=1e-6,
        )


def test_the_error_of_a_balance_is_what_is_missing_over_what_flows() -> None:
    plane = ENDLESS.solve(speed=SPEED).plane
    flow = float(np.abs(plane.flows[0]).max())
    assert plane.relative_error(-0.02 * flow, flow) == pytest.approx(0.02, rel=1e-12)
    assert plane.relative_error(1e-30, 1e-30) == 0.0


def test_a_full_film_does_not_feel_the_pressure_of_a_cavity_that_it_has_not() -> None:
    """The density is that of the absolute pressure, which is above both."""
    fluid = FilmFluid(VISCOSITY, compressible=True)
    base = replace(ENDLESS, fluid=fluid, ambient_pressure=1e8)
    low, high = (
        replace(base, inlet_height=2e-6, outlet_height=1e-6, cavitation_pressure=pressure).solve(
            speed=SPEED
        )
        for pressure in (0.0, 9e7)
    )
    assert low.status.succeeded
    assert low.max_pressure > 1.4e8
    np.testing.assert_allclose(high.pressure, low.pressure, rtol=1e-7)
    rigid = replace(low.pad, fluid=FilmFluid(VISCOSITY)).solve(speed=SPEED)
    assert abs(rigid.load / low.load - 1.0) > 5e-4
