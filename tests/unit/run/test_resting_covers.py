"""Lateral films of the elastic preset, and how warm films enter them and the results."""

from __future__ import annotations

from pathlib import Path

import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.floating.problem import balance_of, film_laws
from toothspace.run.run import interface_models, unused_tables

CASES = Path(__file__).resolve().parents[3] / "cases"


@pytest.mark.parametrize(
    ("name", "model"),
    [
        ("egm12_motor", "elastic"),
        ("fuel14_pump", "elastic"),
        ("crescent_pump", "reynolds"),
        ("gerotor_trochoidal", "reynolds"),
        ("gerotor_cycloidal", "reynolds"),
    ],
)
def test_films_are_solved_beside_covers_that_rest(name: str, model: str) -> None:
    case = load_case(CASES / f"{name}.toml", ["run.fidelity=elastic"])
    assert interface_models(case)["lateral"] == model


def test_solved_films_have_the_viscosity_of_their_temperature() -> None:
    case = load_case(CASES / "egm12_motor.toml")
    balance, fluid = balance_of(api.describe(case)), api.fluid_of(case)
    laws = film_laws(balance, fluid, "jfo", {"drive_gear": 0.5})
    found = {
        one.body: law.fluid.dynamic_viscosity
        for one, law in zip(balance.interfaces, laws, strict=True)
    }
    assert found["drive_gear"] == pytest.approx(0.5 * fluid.dynamic_viscosity)
    assert found["driven_gear"] == pytest.approx(fluid.dynamic_viscosity)


def test_warm_films_are_said_to_be_unused_without_losses() -> None:
    assert "heat.model" in unused_tables(
        load_case(CASES / "egm12_motor.toml", ["run.fidelity=ideal"])
    )
    assert "heat.model" not in unused_tables(load_case(CASES / "egm12_motor.toml"))
