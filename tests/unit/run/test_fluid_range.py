"""What lies outside the data of the fluid or the range of its law is a finding."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.fake_solution import fake_solution
from toothspace import api
from toothspace.core.frozen import Columns
from toothspace.core.units import ZERO_CELSIUS
from toothspace.library import fluids
from toothspace.model.fluid import temperature_range
from toothspace.results.credibility import with_warnings
from toothspace.run.condition import condition_of, fluid_findings, fluid_of

CASES = Path(__file__).resolve().parents[3] / "cases"


def test_oil_too_thick_to_fill_a_pump_is_told() -> None:
    case = api.load_case(CASES / "egm12_pump.toml")
    assert not list(fluid_findings(case, fluid_of(case)))
    cold = case.replace({"fluid.temperature": "-25 degC"})
    [told] = fluid_findings(cold, fluid_of(cold))
    assert told.allowed == "up to 1620 mm2/s"
    warm = case.replace({"fluid.temperature": "0 degC"})
    assert not list(fluid_findings(warm, fluid_of(warm)))


def test_a_table_that_its_law_misses_is_told() -> None:
    """Viscosities that rise with the fourth power of the pressure are no exponential."""
    pressure = np.array([1e5, 2e7, 4e7])
    columns = {
        "temperature [K]": np.full(3, 323.15),
        "pressure [Pa]": pressure,
        "density [kg/m3]": 850.0 * (1.0 + pressure / 1.6e9),
        "dynamic_viscosity [Pa s]": 0.03 * (1.0 + 3.0 * (pressure / 4e7) ** 4),
    }
    case = api.load_case(CASES / "egm12_pump.toml")
    fluid = {"table": Columns(columns), "temperature": "50 degC"}
    case = api.load_case({**case.to_dict(), "fluid": fluid})
    [told] = fluid_findings(case, fluid_of(case))
    assert told.quantity == "Fit of the viscosities of the fluid"


@pytest.mark.parametrize("place", ["node_pressure", "film_pressure"])
def test_pressures_of_circuits_and_films_beyond_the_data_are_told(place: str) -> None:
    solution = fake_solution()
    data = solution.data.assign({place: ("place", [1e5, 1.5e8])})
    told = with_warnings(type(solution)(**{**vars(solution), "data": data}), 1e8).warnings
    assert [x.found for x in told if x.quantity == "Highest pressure, range of the fluid"] == [
        "1500 bar"
    ]


STARTS = sorted(CASES.glob("startup*.toml"))


@pytest.mark.parametrize(
    ("path", "name"),
    [(path, "jet_a1") for path in STARTS] + [(STARTS[0], name) for name in fluids()],
    ids=lambda given: getattr(given, "stem", given),
)
def test_hoses_take_the_liquid_at_its_hottest(path: Path, name: str) -> None:
    """Walls that nobody asked to be softer than the liquid are refused for no oil."""
    hottest = temperature_range(name)[1] - ZERO_CELSIUS
    case = api.load_case(path)
    tables = case.to_dict()
    tables["fluid"] = {"name": name, "temperature": f"{hottest:.6g} degC"}
    tables.pop("study", None)
    for element in tables["circuit"].values():
        if isinstance(element, dict) and element.get("kind") == "hose":
            for key in ("effective_bulk_modulus", "wall_stiffening", "wall_relaxation_time"):
                element.pop(key, None)
    hot = api.load_case(tables)
    assert condition_of(hot, api.describe(hot)).circuit is not None
