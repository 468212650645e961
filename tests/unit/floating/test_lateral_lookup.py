"""Tabulated lateral films in a run: values between nodes, lag of the gap, limits, balances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

from toothspace import api
from toothspace.case import load_case
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.arrays import FILM_FORCE, FLOW, HEIGHT, MOTION_RATIO, SystemArrays
from toothspace.model.assembly import System, assemble
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_load import (
    _add_face,
    load_period,
    load_weights,
    preload_of,
    with_lateral_leakage,
)
from toothspace.model.lateral_lookup import fill_film_rates
from toothspace.model.lateral_table import (
    ASPERITY_STRESS,
    DRAG_STRESS,
    FORCE_SHARE,
    HEIGHT_RATIO,
    LAG_TIME,
    LOAD_SCALE,
    MOMENT_SHARE,
    SHEAR_RATIO,
    LateralTable,
)
from toothspace.results.ledger import Ledger
from toothspace.results.solution import Solution
from toothspace.run import run as run_module
from toothspace.run.run import Marches, Run, SeatSearch
from toothspace.solver.compiled_model import evaluate_state, observe
from toothspace.solver.initial import start_state

CASE = Path(__file__).resolve().parents[3] / "cases" / "egm12_motor_reduced.toml"
FORCES, PRESSURES, SLIDES = np.array([-0.6, 0.0, 0.4]), np.array([1e7, 3e7]), np.array([1.0, 8.0])
SHAPE = (3, 1, 2, 2)
LAG_NUMBER = 4e6


@dataclass(frozen=True)
class Films:
    """Straight lines along every axis, of force share, pressure in MPa and slide in Pa."""

    def log_leakage(self, force: Array, pressure: Array, slide: Array) -> Array:
        return 1.0 + 2.0 * force + 0.05 * pressure + 0.1 * slide

    def shear(self, force: Array, pressure: Array, slide: Array) -> Array:
        return 1.5 - force * (1.0 + 0.1 * slide) + 0.02 * pressure

    def drag(self, force: Array, pressure: Array, slide: Array) -> Array:
        return -1e-3 * (1.0 + force * slide * pressure)

    def asperity(self, force: Array, pressure: Array, slide: Array) -> Array:
        return 2e-3 * (1.0 - force) + 0.0 * (pressure + slide)

    def table(self) -> LateralTable:
        force, _, pressure, slide = np.meshgrid(
            FORCES, [0.0], 1e-6 * PRESSURES, SLIDES, indexing="ij"
        )
        at = force, pressure, slide
        return LateralTable(
            force_share=FORCES,
            moment_share=np.zeros(1),
            pressure=PRESSURES,
            slide=SLIDES,
            leakage_factor=np.exp(self.log_leakage(*at)),
            shear_share=self.shear(*at),
            drag_share=self.drag(*at),
            asperity_share=self.asperity(*at),
            lag_number=np.full(SHAPE, LAG_NUMBER),
        )


def one_node(leakage: float = 1.0, shear: float = 1.0) -> LateralTable:
    """Table that says the same at every load, pressure and speed."""
    one, none = np.ones((1, 1, 1, 1)), np.zeros((1, 1, 1, 1))
    return LateralTable(
        force_share=np.zeros(1),
        moment_share=np.zeros(1),
        pressure=np.array([1e7]),
        slide=np.ones(1),
        leakage_factor=leakage * one,
        shear_share=shear * one,
        drag_share=none,
        asperity_share=none,
        lag_number=LAG_NUMBER * one,
    )


@pytest.fixture(scope="module")
def run() -> Run:
    case = load_case(CASE)
    return api.prepare(replace(case, run=replace(case.run, film_tables=None)))


def _begun(run: Run, machine: MachineDescription, angle: float = 0.0) -> tuple[SystemArrays, Array]:
    system = assemble(machine, run.fluid, replace(run.condition, shaft_angle=angle))
    return system.arrays, start_state(system)


@pytest.fixture(scope="module")
def tabulated(run: Run) -> tuple[SystemArrays, Array]:
    return _begun(run, replace(run.machine, lateral_table=Films().table()))


@pytest.mark.parametrize(("force", "counts_as"), [(0.13, 0.13), (-0.27, -0.27), (0.9, 0.4)])
def test_values_between_nodes(
    run: Run, tabulated: tuple[SystemArrays, Array], force: float, counts_as: float
) -> None:
    arrays, begin = tabulated
    state = begin.copy()
    state[arrays.size.film] = force
    evaluate_state(arrays, state)
    now, films = arrays.lateral.now, Films()
    viscosity, difference = float(run.fluid.dynamic_viscosity), 199e5
    at = np.array(counts_as), np.array(1e-6 * difference), np.array(viscosity * state[1])
    balance = run.machine.lateral_balance
    assert balance is not None
    unit = difference * balance.floating.high_pressure.area
    reach = balance.interfaces[0].face.outer_radius
    closed = arrays.constant.lateral_torque
    assert now[LOAD_SCALE] == pytest.approx(unit, rel=1e-6)
    assert now[HEIGHT_RATIO] == pytest.approx(np.exp(films.log_leakage(*at) / 3.0), rel=1e-6)
    assert now[SHEAR_RATIO] == pytest.approx(films.shear(*at), rel=1e-6)
    torque = unit * reach
    assert closed * now[DRAG_STRESS] == pytest.approx(torque * films.drag(*at), rel=1e-6)
    assert closed * now[ASPERITY_STRESS] == pytest.approx(torque * films.asperity(*at), rel=1e-6)
    assert now[LAG_TIME] == pytest.approx(LAG_NUMBER * viscosity / difference, rel=1e-6)


def test_areas_on_which_pressures_press_add_up_to_the_side_of_a_gear(run: Run) -> None:
    """Teeth and spaces between bore and tips, whatever part of it counts to which pressure."""
    balance = run.machine.lateral_balance
    assert balance is not None
    sides = [own for own in balance.interfaces if own.side == "floating"]
    assert len(sides) == 2
    for own in sides:
        found = []
        for share in (0.1, 0.6):
            weights = np.zeros((run.machine.drain_node + 1, 2))
            _add_face(weights, own, share * load_period(balance))
            assert weights[:, 0].min() >= 0.0
            found.append(weights[:, 0].sum())
        ring = np.pi * (own.face.outer_radius**2 - own.face.inner_radius**2)
        assert found[0] == pytest.approx(found[1], rel=0.02)
        assert 0.8 * ring < found[0] < 1.001 * ring


@pytest.mark.slow
def test_load_is_that_of_the_faces(run: Run) -> None:
    machine = replace(run.machine, lateral_table=Films().table())
    balance = machine.lateral_balance
    assert balance is not None
    found, wanted = [], []
    unit = 199e5 * balance.floating.high_pressure.area
    # the ports' parts count by their mean over a pitch, so the means of a pitch agree
    for share in (np.arange(4) + 0.5) / 4:
        arrays, state = _begun(run, machine, share * load_period(balance))
        seen = observe(arrays, state[None, :])
        found.append(seen.lateral[0, [FORCE_SHARE, MOMENT_SHARE]] * seen.lateral[0, LOAD_SCALE])
        pressure = seen.pressure[0, : run.machine.drain_node + 1]
        load = pressure @ load_weights(balance, state[0], pressure.size) - preload_of(balance)
        wanted.append(load / np.array([1.0, balance.interfaces[0].face.outer_radius]))
    assert np.mean(found, axis=0) == pytest.approx(np.mean(wanted, axis=0), abs=0.01 * unit)


def test_films_follow_the_load_by_their_lag(tabulated: tuple[SystemArrays, Array]) -> None:
    arrays, begin = tabulated
    first = arrays.size.film

    def rates(_: float, carried: Array) -> Array:
        state, rate = begin.copy(), np.zeros(arrays.size.total)
        state[first : first + 2] = carried
        evaluate_state(arrays, state)
        fill_film_rates.py_func(arrays, state, rate)
        return rate[first : first + 2]

    evaluate_state(arrays, begin)
    asked, lag = float(arrays.lateral.now[FORCE_SHARE]), float(arrays.lateral.now[LAG_TIME])
    assert FORCES[0] < asked < 0.0
    times = lag * np.array([0.5, 1.0, 3.0])
    path = solve_ivp(rates, (0.0, times[-1]), [0.3, 0.0], t_eval=times, rtol=1e-9, atol=1e-12)
    assert path.y[0] == pytest.approx(asked + (0.3 - asked) * np.exp(-times / lag), rel=1e-6)
    # a table of one moment holds it
    assert np.all(path.y[1] == 0.0)


def test_films_stay_at_the_edge_of_their_table(run: Run) -> None:
    table = replace(Films().table(), force_share=FORCES + 1.0)
    arrays, state = _begun(run, replace(run.machine, lateral_table=table))
    rate = np.zeros(arrays.size.total)
    assert state[arrays.size.film] == pytest.approx(0.4)
    evaluate_state(arrays, state)
    fill_film_rates.py_func(arrays, state, rate)
    assert rate[arrays.size.film] == 0.0
    state[arrays.size.film] = 0.7
    fill_film_rates.py_func(arrays, state, rate)
    assert rate[arrays.size.film] < 0.0


def test_one_node_is_a_machine_of_other_gaps(run: Run) -> None:
    plain, wider = run.machine, with_lateral_leakage(run.machine, 8.0)
    arrays, state = _begun(run, wider)
    table = replace(one_node(8.0), seat_factor=8.0)
    looked_up, begun = _begun(run, replace(plain, lateral_table=table))
    film = arrays.size.film
    evaluate_state(arrays, state)
    evaluate_state(looked_up, np.concatenate([state[:film], begun[film : film + 2], state[film:]]))
    for column in (FLOW, HEIGHT):
        assert looked_up.path[:, column] == pytest.approx(
            arrays.path[:, column], rel=1e-12, abs=0.0
        )
    closed, _ = _begun(run, plain)
    evaluate_state(closed, state)
    assert not np.allclose(closed.path[:, HEIGHT], arrays.path[:, HEIGHT], rtol=0.1)


@pytest.mark.slow
def test_run_with_the_closed_form_as_a_table_is_that_of_the_closed_form(run: Run) -> None:
    coarse = replace(run.case.run, samples_per_revolution=60, max_revolutions=2)
    ready = replace(run, case=replace(run.case, run=coarse)).worn().with_films()
    march, tables = Marches(ready), (None, one_node(), Films().table())
    runs = [march(replace(ready.machine, lateral_table=table)) for table in tables]
    plain, same, films = (one.summary() for one in runs)
    for name in ("mean_torque_N_m", "mean_flow_L_per_min", "torque_loss_lateral_viscous_N_m"):
        assert same[name] == pytest.approx(plain[name], rel=1e-4), name
    # friction that no viscosity makes and gaps that move leave the energy whole
    assert abs(films["energy_balance_error"]) < 1e-5  # type: ignore[arg-type]
    assert films["torque_loss_lateral_asperity_N_m"] > 0.0  # type: ignore[operator]
    assert films["axial_load_N"] != 0.0
    assert "lateral_leakage_factor" not in runs[0].data


@pytest.mark.slow
@pytest.mark.parametrize("share", [-2.0, 0.1, 1.0, 3.0])
def test_asperities_of_the_faces_oppose_the_own_speed_of_a_gear(share: float) -> None:
    """With compliant teeth the driven gear turns on its own; the flow past it pulls as before."""
    case = load_case(CASE, ('run.mesh="elastic"',))
    run = api.prepare(replace(case, run=replace(case.run, film_tables=None)))
    none = one_node()
    pulling = replace(none, drag_share=none.drag_share - 1e-3)
    rubbing = replace(none, asperity_share=none.asperity_share + 2e-3)
    torques = []
    for table in (none, pulling, rubbing):
        arrays, state = _begun(run, replace(run.machine, lateral_table=table))
        k = int(np.argmin(arrays.motion[:, MOTION_RATIO]))
        state[arrays.size.velocity + k] = (1.0 - share) * state[1]
        evaluate_state(arrays, state)
        torques.append(arrays.motion[k, FILM_FORCE])
    assert arrays.motion[k, MOTION_RATIO] == -1.0
    balance = run.machine.lateral_balance
    assert balance is not None
    area, reach = balance.floating.high_pressure.area, balance.interfaces[0].face.outer_radius
    half = 0.5 * 199e5 * area * reach
    assert torques[1] - torques[0] == pytest.approx(-1e-3 * half, rel=1e-3)
    assert torques[2] - torques[0] == pytest.approx(np.sign(share) * 2e-3 * half, rel=1e-3)


def test_start_with_tabulated_films(tmp_path: Path) -> None:
    case = tmp_path / "start.toml"
    case.write_text(
        f"""base = "{CASE.parent / "startup_fan_drive.toml"}"
[circuit]
duration = "0.03 s"
[circuit.supply]
speed = [["0 s", "300 rpm"], ["0.2 s", "600 rpm"]]
[run]
time_samples = 60
film_tables = "{CASE.parent / "tables" / "egm12_lateral.nc"}"
"""
    )
    run = api.simulate(load_case(case))
    assert run.status is Status.DONE
    # it turns, and is still behind the supply of equal displacement
    assert 3.0 < run.summary()["max_shaft_speed_rpm"] < 300.0  # type: ignore[operator]
    load = run.data["axial_load"].values
    # springs press alone at first, then the pressure presses the more
    assert load[-1] < 2.0 * load[1] < 0.0
    leakage = run.data["lateral_leakage_factor"].values
    assert np.ptp(leakage) > 0.1 * leakage.mean()
    assert abs(run.summary()["energy_balance_error"]) < 1e-4  # type: ignore[arg-type]


def _seated(
    run: Run, leak: Callable[[float], float], monkeypatch: pytest.MonkeyPatch
) -> tuple[Solution, list[float]]:
    """Run whose gaps leak by a factor that follows the one of the seats, and the latter's."""
    seats: list[float] = []

    def march(machine: System, *_: object) -> SimpleNamespace:
        assert machine.description.lateral_table is not None
        seat = machine.description.lateral_table.seat_factor
        return SimpleNamespace(status=Status.DONE, seat=seat, system=machine)

    def solution(history: SimpleNamespace, *_: object) -> Solution:
        seats.append(history.seat)
        values = {
            "lateral_leakage_factor": leak(history.seat),
            "lateral_load_beyond": 0.0,
            "shaft_speed": 100.0,
        }
        data = xr.Dataset({k: ("sample", np.full(4, v)) for k, v in values.items()})
        return Solution(Status.DONE, data, Ledger(1.0, 1.0, {}, {}))

    monkeypatch.setattr(run_module, "march_to_balance", march)
    monkeypatch.setattr(run_module, "first_turn_state", lambda history: None)
    monkeypatch.setattr(run_module, "flow_regimes", lambda history: ())
    monkeypatch.setattr(run_module, "running_in_depths", lambda history: {})
    monkeypatch.setattr(run_module, "solution_from", solution)
    machine = replace(run.machine, lateral_table=one_node())
    return replace(run, machine=machine).march(), seats


@pytest.mark.slow
@pytest.mark.parametrize("slope", [0.5, -0.3, -5.0])
def test_seats_and_gaps_come_to_agree(
    run: Run, slope: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where more leakage past the seats closes the gaps by far more."""
    found, seats = _seated(run, lambda seat: 20.0 ** (1.0 - slope) * seat**slope, monkeypatch)
    # rounds end with 5 % of the leakage open, a change of the seats of up to twice that
    assert seats[-1] == pytest.approx(20.0, rel=0.11)
    assert not found.warnings


@pytest.mark.slow
def test_seats_that_never_agree_with_the_gaps_are_told(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, seats = _seated(run, lambda seat: 30.0 if seat < 20.0 else 10.0, monkeypatch)
    assert seats[-1] == pytest.approx(20.0, rel=0.05)
    told = " ".join(one.sentence for one in found.warnings)
    assert "leak 0.5" in told or "leak 1.5" in told
    assert "fidelity 'elastic'" in told


def test_load_beyond_the_table_is_told(run: Run) -> None:
    machine = replace(run.machine, lateral_table=one_node())

    def told(beyond: float) -> list[str]:
        values = {"lateral_load_beyond": beyond, "shaft_speed": 100.0}
        data = xr.Dataset({name: ("sample", np.full(4, one)) for name, one in values.items()})
        found = Solution(Status.DONE, data, Ledger(1.0, 1.0, {}, {}))
        return [one.sentence for one in SeatSearch(machine).noted(found).warnings]

    (sentence,) = told(0.5)
    assert "beyond their table in 50 % of the time" in sentence
    assert told(0.0) == []
