"""Tip leakage over the clearance against closed forms: the narrowest tip, and tips in series."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.conftest import REPOSITORY
from toothspace import api
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.types import Array
from toothspace.model.paths import by_kind
from toothspace.results.performance import parts_of
from toothspace.run import run as lumped
from toothspace.solver import outcome
from toothspace.solver.lost_flow import Look

LITRES = 6e4
CLEARANCES = (30.0, 32.0, 34.0, 36.0, 38.0, 40.0, 45.0)
"""Of the casing; the bodies stand 30 um aside in bearings and blocks. [um]"""
STIFFER = 30.0
"""Bulk modulus over that of the oil: closed forms know no compression. [-]"""


def tips_in_series(close: Look) -> float:
    """Leakage of both gears, each through all tips between outlet and inlet. [m3/s].

    With b h^3 dp / (12 mu L) - b u h / 2 through every tip, one flow through all of them and the
    whole pressure difference over them.
    """
    history, seen = close.history, close.seen
    system, condition = history.system, history.system.condition
    viscosity = float(dynamic_viscosity(condition.inlet_pressure, system.arrays.fluid))
    span = condition.outlet_pressure - condition.inlet_pressure
    to_inlet, to_outlet = close.openings[..., 0] > 0.0, close.openings[..., 1] > 0.0
    total, first = 0.0, 0
    for path in by_kind(system.description.paths):
        if path.throat_speed != 0.0:
            shape = path.geometry(path.phases + path.angle_ratio * history.states[:, :1])
            height = np.maximum(seen.raw_height[:, first : first + path.count], path.minimum_height)
            flows = []
            for row in range(0, history.times.size - 1, 24):
                chain = _chain(path.nodes_a, path.nodes_b, to_inlet[row], to_outlet[row])
                h, (_, width, length) = height[row, chain], shape[row, chain].T
                conductance = width * h**3 / (12.0 * viscosity * length)
                drag = 0.5 * width * h * path.throat_speed * condition.shaft_speed
                back = span - np.sum(drag / conductance)
                flows.append(back / np.sum(1.0 / conductance))
            total += float(np.mean(flows))
        first += path.count
    return total


def _chain(behind: Array, ahead: Array, to_inlet: Array, to_outlet: Array) -> list[int]:
    """Tips from the last space at the inlet to the first at the outlet, round the casing."""
    following = {int(a): k for k, a in enumerate(behind)}
    last = [k for k, (a, b) in enumerate(zip(behind, ahead, strict=True))
            if to_inlet[a] and not to_inlet[b]]  # fmt: skip
    chains = []
    for k in last:
        chain = [k]
        while not to_outlet[ahead[chain[-1]]]:
            chain.append(following[int(ahead[chain[-1]])])
        chains.append(chain)
    # the other way from inlet to outlet leads through the mesh
    return max(chains, key=len)


@pytest.fixture(scope="module")
def swept() -> Array:
    """Clearance and narrowest gap [um]; leakage of run, series and narrowest tip [L/min]."""
    looks: list[Look] = []
    parts = outcome.lost_flow_parts

    def noted(close: Look, lost: float) -> dict[str, float]:
        looks.append(close)
        return parts(close, lost)

    rows = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outcome, "lost_flow_parts", noted)
        for clearance in CLEARANCES:
            case = api.load_case(REPOSITORY / "cases" / "egm12_pump.toml", ["fluid.gas_law=none"])
            keys = case.to_dict()
            keys["machine"]["casing"]["radial_clearance"] = f"{clearance} um"
            del keys["machine"]["casing"]["wear_in"]
            made = api.prepare(api.Case.from_dict(keys))
            fluid = made.fluid
            stiff = {
                name: getattr(fluid, name) / STIFFER
                for name in fluid._fields
                if name in ("compliance", "stiffening") or name.endswith("mass_fraction")
            }
            fluid = fluid._replace(**stiff, pressure_viscosity=0.0)
            solution = lumped.simulate(replace(made, fluid=fluid))
            flows = parts_of(solution.data)
            # spaces that are compressed on their way take a part of what leaks
            own = [v for k, v in flows.items() if "tooth_tip" in k or k.startswith(("comp", "gas"))]
            gap = float(solution.data["tip_gap_minimum"].min())
            series = tips_in_series(looks[-1])
            rows.append((clearance, 1e6 * gap, LITRES * sum(own), LITRES * series))
    return np.array(rows).T


def lowest(place: Array, value: Array) -> float:
    """Place of the smallest value, of a parabola through it and its neighbours."""
    k = int(np.clip(np.argmin(value), 1, value.size - 2))
    a, b, _ = np.polyfit(place[k - 1 : k + 2], value[k - 1 : k + 2], 2)
    return float(-0.5 * b / a)


@pytest.mark.slow
def test_leakage_is_that_of_the_tips_in_series(swept: Array) -> None:
    """Within 0.06 % of the flow of 7.4 L/min: a thirtieth of the compression is left."""
    _, _, run, series = swept
    assert np.abs(run - series).max() < 0.0045
    assert run[-1] > 10.0 * run.min()
    assert series.min() < 0.0


@pytest.mark.slow
def test_the_best_gap_is_that_of_the_closed_form(swept: Array) -> None:
    """One tip with all the pressure is best at sqrt(2 mu L u / dp), some that share it at more."""
    _, gap, run, series = swept
    viscosity, land, speed, span = 0.02595, 0.926e-3, 3.171, 199e5
    alone = 1e6 * np.sqrt(2.0 * viscosity * land * speed / span)
    assert alone == pytest.approx(2.77, abs=0.01)
    assert lowest(gap, series) == pytest.approx(alone, abs=1.5)
    assert lowest(gap, run) == pytest.approx(lowest(gap, series), abs=1.0)
