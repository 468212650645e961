"""Parts of the lost flow: they sum to it, in every machine and with every preset."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.density import mixture_density
from toothspace.model import arrays as col
from toothspace.results.performance import LABELS, leakages_of, means_by_label, parts_of
from toothspace.results.solution import Solution
from toothspace.solver import outcome
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
