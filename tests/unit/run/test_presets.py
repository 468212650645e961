"""Models of the interfaces: those of the preset, those chosen by the case, and where they show."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

from toothspace import api
from toothspace.case.presets import INTERFACES, MODELS, PRESETS
from toothspace.core.errors import CaseError
from toothspace.run.run import interface_models, unused_tables

REPOSITORY = Path(__file__).resolve().parents[3]
PUMP = REPOSITORY / "cases" / "egm12_pump.toml"


def test_every_preset_runs_and_names_known_interfaces_and_models() -> None:
    for preset in PRESETS.values():
        assert callable(import_module(preset.module).simulate)
        assert set(preset.interfaces) in (set(), set(INTERFACES))
        assert {model for offered in preset.interfaces.values() for model in offered} <= set(MODELS)


@pytest.mark.parametrize("preset", list(PRESETS))
def test_a_case_without_choice_takes_the_models_of_its_preset(preset: str) -> None:
    models = interface_models(api.load_case(PUMP, [f"run.fidelity={preset}"]))
    assert models == {name: offered[0] for name, offered in PRESETS[preset].interfaces.items()}


def test_elastic_solves_its_journals_as_films_does() -> None:
    films, elastic = (
        interface_models(api.load_case(PUMP, [f"run.fidelity={preset}"]))
        for preset in ("films", "elastic")
    )
    assert films["journal"] == elastic["journal"] == "reynolds"
    assert elastic["lateral"] == "elastic"


def test_a_case_chooses_the_model_of_one_interface() -> None:
    chosen = ["run.fidelity=films", "run.interfaces.lateral=closed_form", "run.mesh=elastic"]
    models = interface_models(api.load_case(PUMP, chosen))
    assert (models["journal"], models["lateral"]) == ("reynolds", "closed_form")
    assert models["contact"] == "compliant"


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        (
            ["run.fidelity=lumped", "run.interfaces.lateral=elastic"],
            r"run\.interfaces\.lateral: found 'elastic' with 'lumped', "
            r"allowed 'closed_form' or 'reynolds'",
        ),
        (
            ["run.fidelity=ideal", "run.interfaces.journal=reynolds"],
            r"run\.interfaces\.journal: found 'reynolds' with 'ideal', allowed none",
        ),
    ],
)
def test_a_model_that_the_preset_does_not_offer_is_refused(chosen: list[str], message: str) -> None:
    with pytest.raises(CaseError, match=message):
        interface_models(api.load_case(PUMP, chosen))


def test_tables_leave_no_choice() -> None:
    case = api.load_case(PUMP, ["run.interfaces.journal=reynolds"])
    with pytest.raises(CaseError, match="tables of these films"):
        interface_models(case, ("journal",))
    assert interface_models(api.load_case(PUMP), ("lateral",))["lateral"] == "table"


def test_keys_of_another_preset_are_named_as_unused() -> None:
    case = api.load_case(PUMP, ["run.film_grid=[100, 20]", "run.flank_sealing=dual"])
    assert {"run.film_grid", "run.flank_sealing"} <= set(unused_tables(case))
    elastic = api.load_case(PUMP, ["run.film_grid=[100, 20]", "run.fidelity=elastic"])
    assert "run.film_grid" not in unused_tables(elastic)
