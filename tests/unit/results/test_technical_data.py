"""Technical data of asset administration shells: what the template asks for, and valid."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.fake_solution import fake_solution
from toothspace.core.errors import CaseError
from toothspace.results.technical_data import write_technical_data


def written(folder: Path) -> dict[str, Any]:
    path = write_technical_data(fake_solution(36), folder / "pump.json", "ACME", "12-495")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def test_the_submodel_has_what_its_template_asks_for(tmp_path: Path) -> None:
    """Elements of cardinality One of IDTA 02003-2-0 with their meanings, and the numbers."""
    found = written(tmp_path)
    (submodel,) = found["submodels"]
    assert submodel["semanticId"]["keys"][0]["value"] == "0173-1#01-AHX837#002"
    general, areas = submodel["submodelElements"]
    meanings = {one["idShort"]: one["semanticId"]["keys"][0]["value"] for one in general["value"]}
    assert meanings == {
        "ManufacturerName": "0173-1#02-AAO677#004",
        "ManufacturerProductDesignation": "0173-1#02-AAW338#003",
        "ManufacturerArticleNumber": "0173-1#02-AAO676#005",
        "ManufacturerOrderCode": "0173-1#02-AAO227#004",
    }
    section = areas["value"][0]["value"][-1]
    numbers = {one["idShort"]: one for one in section["value"]}
    flow = numbers["mean_flow_L_per_min"]
    assert float(flow["value"]) == fake_solution(36).summary()["mean_flow_L_per_min"]
    content = flow["embeddedDataSpecifications"][0]["dataSpecificationContent"]
    assert content["unit"] == "L/min"
    assert (
        found["assetAdministrationShells"][0]["submodels"][0]["keys"][0]["value"]
        == (submodel["id"])
    )


def test_it_keeps_the_rules_of_asset_administration_shells(tmp_path: Path) -> None:
    """The reader and the rules of the metamodel 3.0, of its own project."""
    reading = pytest.importorskip("aas_core3.jsonization")
    rules = pytest.importorskip("aas_core3.verification")
    environment = reading.environment_from_jsonable(written(tmp_path))
    assert [f"{error.path}: {error.cause}" for error in rules.verify(environment)] == []


def test_what_no_case_knows_must_be_given(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"--article: found nothing, allowed a text"):
        write_technical_data(fake_solution(36), tmp_path / "pump.json", "ACME", " ")
