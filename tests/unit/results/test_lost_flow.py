"""Parts of the lost flow: they sum to it, in every machine and with every preset."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.aeration import gas_volume_fraction, vapour_fraction
from toothspace.closures.density import mixture_density
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.path_category import INLET_PORT, LATERAL, PathCategory
from toothspace.results.performance import LABELS, leakages_of, means_by_label, parts_of
from toothspace.results.solution import Solution
from toothspace.solver import lost_flow, outcome
from toothspace.solver.lost_flow import (
    Look,
    chamber_leakage,
    lost_flow_parts,
    path_leakage,
    shares,
)

CASES = Path(__file__).resolve().parents[3] / "cases"
MACHINES = ["egm12_pump", "crescent_motor", "gerotor_cycloidal"]
MORE = ["egm12_motor", "egm12_pump_line", "fuel14_pump", "crescent_pump", "gerotor_trochoidal"]
SUM = 1e-6
"""Part of the theoretical flow to which the parts shall sum."""


def run(name: str, *overrides: str) -> Solution:
    case = api.load_case(CASES / f"{name}.toml", list(overrides))
    return api.simulate(replace(case, study=None))


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> list[Look]:
    """What the lost flows of a run are found from, run by run."""
    kept: list[Look] = []

    def noted(close: Look, lost: float) -> dict[str, float]:
        kept.append(close)
        return lost_flow_parts(close, lost)

    monkeypatch.setattr(outcome, "lost_flow_parts", noted)
    return kept


def exchange_in_the_mesh(close: Look) -> float:
    """Flow lost by timing, and by exchange through ports, grooves and the mesh. [m3/s].

    From the flows of the paths themselves: volume that is not displaced while a chamber counts to
    the working side, and flows between chambers and ports that stand at different shares.
    """
    history, seen, share = close.history, close.seen, shares(close)
    system, times, leakage = history.system, history.times, path_leakage(close, share)
    fluid = system.arrays.fluid
    inlet = float(seen.pressure[:, system.description.inlet_node].mean())
    density = float(mixture_density(inlet, fluid.feed_gas_mass_fraction, fluid))
    first, chambers = system.arrays.path_index[:, col.NODE_A], system.arrays.size.chambers
    fall = share[:, first] - np.take_along_axis(share, seen.path_partner, axis=1)
    inside = np.array([c.role not in ("load", "circuit") for c in system.categories])
    flows = np.where(inside[system.arrays.path_index[:, col.CATEGORY]], seen.path_flow * fall, 0.0)
    exchanged = float(np.trapezoid(flows.sum(axis=1) - sum(leakage).sum(axis=1), times))
    volume, inner = seen.volume[:, :chambers], share[:, :chambers]
    swept = float(np.sum(0.5 * (inner[1:] + inner[:-1]) * np.diff(volume, axis=0)))
    turned = float(history.states[-1, 0] - history.states[0, 0])
    displaced = system.description.displacement * turned
    if system.description.mode == "motor":
        # lost flow of a motor is what it takes beyond its displacement
        displaced = -displaced
    return (exchanged / density + swept + displaced) / float(times[-1] - times[0])


def assert_parts_sum(solution: Solution) -> None:
    parts, summary = parts_of(solution.data), solution.summary()
    speed = solution.ledger.shaft_angle / solution.ledger.duration
    theoretical = float(solution.data["displacement"]) * speed * 6e4
    lost = float(summary["lost_flow_L_per_min"])
    # by the efficiency, whatever the parts are
    efficiency = float(summary["volumetric_efficiency"])
    motor = solution.data.attrs["mode"] == "motor"
    assert lost / theoretical == pytest.approx(
        1.0 / efficiency - 1.0 if motor else 1.0 - efficiency, abs=SUM
    )
    assert sum(parts.values()) * 6e4 == pytest.approx(lost, abs=SUM * theoretical)
    told = [float(summary[f"{name}_L_per_min"]) for name in parts]
    assert sum(told) == pytest.approx(lost, abs=SUM * theoretical)
    for path, flow in leakages_of(parts).items():
        assert summary[f"leakage_{path}_L_per_min"] == pytest.approx(flow * 6e4, abs=1e-12)


def assert_shares_follow_openings(close: Look) -> None:
    """Chambers open to one port stand at that side, closed ones between."""
    description, share = close.history.system.description, shares(close)
    inside = share[:, : description.chamber_count]
    inlet, outlet = (close.openings[..., k] > 0.0 for k in (0, 1))
    work, other = (inlet, outlet) if description.mode == "motor" else (outlet, inlet)
    assert np.all(inside[work & ~other] == 1.0)
    assert np.all(inside[other & ~work] == 0.0)
    assert share.min() == 0.0
    assert share.max() == 1.0


@pytest.mark.parametrize(
    "name", [*MACHINES, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)]
)
def test_parts_sum_to_the_lost_flow_of_every_machine(name: str, looks: list[Look]) -> None:
    solution = run(name, "run.revolutions=2")
    assert_parts_sum(solution)
    assert_shares_follow_openings(looks[-1])
    parts = parts_of(solution.data)
    assert set(LABELS) <= set(parts)
    # what is drawn over the angle is on average what is summed
    drawn = means_by_label(solution.data, "leakage")
    summed = leakages_of(parts)
    largest = max(map(abs, summed.values()))
    assert largest > 0.0
    for path, flow in summed.items():
        assert drawn[path] == pytest.approx(flow, abs=0.01 * largest), path


@pytest.mark.parametrize(
    "overrides",
    [
        ["run.fidelity=ideal"],
        ["run.revolutions=1", "run.samples_per_revolution=100"],
        pytest.param(["run.revolutions=1", "run.mesh=elastic"], marks=pytest.mark.slow),
        pytest.param(["run.revolutions=1", 'operating_point.outlet_pressure="1.0 bar"',
         "operating_point.outlet_load=fixed_pressure"], marks=pytest.mark.slow),
        ["run.revolutions=1", "machine.driven_gear.tooth_count=13"],
        pytest.param(["run.revolutions=1", "run.fidelity=films"], marks=pytest.mark.slow),
    ],
    ids=["ideal", "odd samples", "elastic mesh", "no pressure", "unequal teeth", "films"],
)  # fmt: skip
def test_parts_sum_in_every_kind_of_run(overrides: list[str]) -> None:
    solution = run("egm12_pump", *overrides)
    if "ideal" in overrides[0]:
        assert solution.summary()["lost_flow_L_per_min"] == pytest.approx(0.0, abs=1e-3)
        return
    assert_parts_sum(solution)


@pytest.mark.parametrize(
    "name", [pytest.param("egm12_pump", marks=pytest.mark.slow), "gerotor_cycloidal"]
)
def test_what_leaks_out_of_chambers_is_what_paths_leak(name: str, looks: list[Look]) -> None:
    run(name, "run.revolutions=1")
    history, seen = looks[-1].history, looks[-1].seen
    leaving = chamber_leakage(history)
    density = seen.density[:, history.system.description.inlet_node]
    total = sum(path_leakage(looks[-1], shares(looks[-1]))).sum(axis=1) / density
    assert leaving.sum(axis=1) == pytest.approx(total, rel=1e-9, abs=1e-3 * float(total.mean()))
    # most of it from chambers at high pressure
    high = seen.pressure[:, : leaving.shape[1]] > 0.5 * seen.pressure.max()
    assert leaving[high].sum() > 0.9 * leaving.sum()


@pytest.mark.slow
def test_walls_of_a_pump_drag_forward_and_those_of_a_motor_back() -> None:
    pump, motor = (
        parts_of(run(name, "run.revolutions=2").data) for name in ("egm12_pump", "egm12_motor")
    )
    assert pump["drag_leakage_tooth_tip"] < 0.0 < pump["pressure_leakage_tooth_tip"]
    assert motor["drag_leakage_tooth_tip"] > 0.0


@pytest.mark.slow
def test_tips_that_would_cut_an_unworn_casing_are_named() -> None:
    narrow = ['machine.casing.radial_clearance="10 um"', "run.revolutions=1"]
    unworn = api.load_case(CASES / "egm12_pump.toml", narrow).to_dict()
    del unworn["machine"]["casing"]["wear_in"]
    told = [w.text for w in api.simulate(api.Case.from_dict(unworn)).warnings]
    assert any("would cut" in text and "drive" in text for text in told)
    assert not any("would cut" in w.text for w in run("egm12_pump", *narrow).warnings)


@pytest.mark.parametrize(
    "name",
    [
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("egm12_pump", "egm12_motor", "crescent_pump")
        ),
        "gerotor_cycloidal",
    ],
)
def test_exchange_in_the_mesh_is_that_of_the_flows_of_the_paths(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The rest of the mass balance against the integral over paths and swept volumes."""
    seen = []

    def noted(close: Look, lost: float) -> dict[str, float]:
        seen.append((lost_flow_parts(close, lost), exchange_in_the_mesh(close)))
        return seen[-1][0]

    monkeypatch.setattr(outcome, "lost_flow_parts", noted)
    solution = run(name, "run.revolutions=2")
    parts, exchange = seen[-1]
    speed = solution.ledger.shaft_angle / solution.ledger.duration
    theoretical = float(solution.data["displacement"]) * speed
    # trapezoids over 2880 states of flows with narrow peaks
    assert exchange == pytest.approx(parts["mesh_exchange_flow"], abs=1e-4 * theoretical)


LAW = fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08))
GAP = PathCategory("gap", "gaps", "#000000", "gap")
KINDS = (GAP, INLET_PORT, LATERAL)


def made_up(
    pressure: Array, openings: Array | None = None, mode: str = "pump", **seen: Array
) -> Look:
    """States of three chambers between an inlet, an outlet and a drain, with what is seen there."""
    samples = len(pressure)
    index = np.zeros((4, 2 + max(col.NODE_A, col.CATEGORY)), int)
    # a gap from the first chamber to the next and back, a face to the drain, and a port
    index[:, col.NODE_A] = [0, 1, 2, 0]
    index[:, col.CATEGORY] = [0, 0, 2, 1]
    size = SimpleNamespace(chambers=3, nodes=6, mass=2, gas=4)
    arrays = SimpleNamespace(
        size=size,
        path_index=index,
        fluid=LAW,
        # volumes of the ports hold fluid of their own
        dynamic_index=np.array([-1, -1, -1, 0, 1, -1]),
    )
    description = SimpleNamespace(inlet_node=3, outlet_node=4, drain_node=5, mode=mode)
    system = SimpleNamespace(arrays=arrays, description=description, categories=KINDS)
    states = np.zeros((samples, 6))
    states[:, 1] = 100.0
    times = 0.5 + 2e-3 * np.arange(samples)
    history = SimpleNamespace(system=system, states=states, times=times)
    nothing = np.zeros((samples, 4))
    looked = {
        "pressure": pressure,
        "density": np.full_like(pressure, 800.0),
        "path_partner": np.tile([1, 0, 5, 4], (samples, 1)),
        "path_flow": nothing,
        "path_drag": nothing,
        "path_carried": nothing,
    }
    closed = np.zeros((samples, 3, 5))
    return Look(
        cast(Any, history),
        cast(Any, SimpleNamespace(**(looked | seen))),
        closed if openings is None else openings,
        np.zeros((samples, 4), dtype=bool),
    )


LEVELS = np.array([[6e5, 6e5, 6e5, 1e5, 11e5, 1e5]])
"""Chambers half way from 1 to 11 bar."""


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_a_chamber_stands_where_its_pressure_or_its_port_says(mode: str) -> None:
    high, low = (1, 0) if mode == "pump" else (0, 1)
    pressure = LEVELS if mode == "pump" else LEVELS[:, [0, 1, 2, 4, 3, 5]]
    opened = np.zeros((1, 3, 5))
    opened[0, 1, high], opened[0, 2, low] = 1e-9, 1e-9
    found = shares(made_up(pressure, opened, mode))
    ports = [0.0, 1.0] if mode == "pump" else [1.0, 0.0]
    assert found[0].tolist() == [0.5, 1.0, 0.0, *ports, 0.0]
    both = np.zeros((1, 3, 5))
    both[..., :2] = 1e-9
    beyond = pressure * [[1.0, 3.0, 0.01, 1.0, 1.0, 1.0]]
    for openings in (both, None):
        found = shares(made_up(beyond, openings, mode))
        assert found[0, :3].tolist() == [0.5, 1.0, 0.0]
    level = shares(made_up(np.full((1, 6), 1e5), None, mode))
    assert level[0, :3].tolist() == [0.5, 0.5, 0.5]


def test_flows_count_with_what_they_fall_and_by_what_drives_them() -> None:
    """At 100 rad/s and 800 kg/m3 a drag of 1 cm3/rad carries 80 g/s with it."""
    share = np.array([[0.75, 0.25, 0.5, 0.0, 1.0, 0.0]])
    density = np.full((1, 6), 800.0)
    density[0, 1] = 700.0
    look = made_up(
        LEVELS,
        density=density,
        path_flow=np.array([[0.1, -0.2, 0.3, 0.4]]),
        path_drag=np.array([[1e-6, 2e-6, 0.0, 0.0]]),
        path_carried=np.array([[0.25e-6, 0.5e-6, 0.0, 0.0]]),
    )
    pressure, drag = path_leakage(look, share)
    # from the first to the second, which falls by a half; back it comes from the first again
    forward, back = 0.5 * (0.1 - 0.08), -0.5 * (-0.2 - 0.16)
    assert pressure[0] == pytest.approx([forward + back, 0.0, 0.5 * 0.3])
    assert drag[0] == pytest.approx([0.5 * 0.06 - 0.5 * 0.12, 0.0, 0.0])
    trapped = replace(look, trapped=np.array([[False, True, False, False]]))
    assert path_leakage(trapped, share)[0][0, 0] == pytest.approx(forward)


def test_samples_and_chambers_keep_their_own_leakage(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over two samples; a chamber loses what leaves it, at the density of the inlet."""
    density = np.full((2, 6), 800.0)
    density[:, 3] = [850.0, 840.0]
    flow = np.array([[0.1, 0.0, 0.3, 0.0], [0.0, 0.2, 0.5, 0.0]])
    drag = np.full((2, 4), 3e-7)
    look = made_up(np.tile(LEVELS, (2, 1)), density=density, path_flow=flow, path_drag=drag)
    share = np.tile([[0.75, 0.25, 0.5, 0.0, 1.0, 0.0]], (2, 1))
    pressure, dragged = path_leakage(look, share)
    assert pressure + dragged == pytest.approx(np.array([[0.05, 0.0, 0.15], [-0.1, 0.0, 0.25]]))
    monkeypatch.setattr(lost_flow, "look_at", lambda _: look)
    monkeypatch.setattr(lost_flow, "shares", lambda _: share)
    found = chamber_leakage(look.history)
    expected = np.array([[0.05, 0.0, 0.15], [0.0, -0.1, 0.25]]) / density[:, [3]]
    assert found == pytest.approx(expected)


def test_trapped_fluid_throttles_in_every_part_alike() -> None:
    """100 and 200 W in the mesh over 2 ms are 0.3 J, in four parts of a turn 1.2 J."""
    look = made_up(np.tile(LEVELS, (2, 1)), path_loss=np.array([[100.0] * 4, [200.0] * 4]))
    mesh = PathCategory("flank", "flanks", "#000000", "mesh")
    look.history.system.categories = (mesh, INLET_PORT, LATERAL)
    trapped = np.zeros((2, 4), dtype=bool)
    trapped[:, 0] = trapped[:, 2] = True
    losses = replace(look, trapped=trapped, copies=4).trapped_losses()
    assert losses == pytest.approx({f"trapped_{mesh.account}": 1.2, "trapped_volume": 1.2})


def test_what_chambers_and_ports_take_up_is_lost_by_hand() -> None:
    """Two samples 2 ms apart: leakage, compression, gas, ports; timing is what remains."""
    pressure = np.array([[1e5, 6e5, 11e5, 1e5, 11e5, 1e5], [6e5, 6e5, 1e5, 1e5, 11e5, 1e5]])
    gas = np.full((2, 6), LAW.feed_gas_mass_fraction)
    free = np.where(np.arange(6) == 0, np.array([[1.0], [3.0]]), 1.0) * 0.25 * gas
    density = mixture_density(pressure, free, LAW)
    density[1, 1] *= 0.9  # that chamber holds vapour
    volume = np.tile([[2e-6, 1e-6, 3e-6, 0.0, 0.0, 0.0]], (2, 1))
    volume[1, 1] = 1.5e-6
    flow = np.tile([[0.1, 0.0, 0.3, 0.0]], (2, 1))
    look = made_up(pressure, path_flow=flow, gas=free, density=density, volume=volume)
    look.history.states[:, 2:4] = [[0.5, 0.7], [0.9, 0.8]]
    fed = float(mixture_density(1e5, LAW.feed_gas_mass_fraction, LAW))
    share = np.array([[0.0, 0.5, 1.0], [0.5, 0.5, 0.0]])
    inside = slice(0, 3)
    own = pressure[:, inside], free[:, inside], LAW
    alpha = gas_volume_fraction(*own) + vapour_fraction(1.0 / density[:, inside], *own)
    assert alpha[1, 1] > 0.09
    liquid = density[:, inside] / (1.0 - alpha)
    inlet = float(gas_volume_fraction(1e5, LAW.feed_gas_mass_fraction, LAW))
    displaced = (alpha - inlet) * liquid * volume[:, inside]
    stored = (density[:, inside] - fed) * volume[:, inside]
    between = share.mean(axis=0)
    of_gas = -float(np.sum(between * np.diff(displaced, axis=0)))
    of_all = float(np.sum(between * np.diff(stored, axis=0)))
    per_mass = 1.0 / (fed * 2e-3)
    parts = lost_flow_parts(look, 0.25)
    assert parts["gas_flow"] == pytest.approx(per_mass * of_gas)
    assert parts["compression_flow"] == pytest.approx(per_mass * (of_all - of_gas))
    # of the volumes at the ports that of the working side counts
    assert parts["port_volume_flow"] == pytest.approx(per_mass * 0.1)
    # gaps fall by -1/2 and 0, faces by 1 and 0
    assert parts["pressure_leakage_gap"] == pytest.approx(per_mass * 0.1 * -0.25 * 2e-3)
    lateral = parts[f"pressure_leakage_{LATERAL.name}"]
    assert lateral == pytest.approx(per_mass * 0.3 * 0.5 * 2e-3)
    assert sum(parts.values()) == pytest.approx(0.25)
    look.history.system.description.mode = "motor"
    assert lost_flow_parts(look, 0.0)["port_volume_flow"] == pytest.approx(per_mass * 0.4)
