"""Fronts of several objectives, with a stand-in for the simulation."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from tests.study_cases import Answer, answer, case_with_study
from toothspace import api
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.report.study import study_report_html
from toothspace.studies import run_study
from toothspace.studies.pareto import not_beaten

CLEARANCE = "machine.casing.radial_clearance"
SPEED = "operating_point.shaft_speed"


def pareto(text: str = "", method: str = "sobol", vary: str = "") -> str:
    return f"""
kind = "pareto"
objectives = {{volumetric_efficiency = "maximise", mean_flow_L_per_min = "maximise"}}
method = "{method}"
{text}
[study.vary]
{vary or f'"{CLEARANCE}" = {{from = "5 um", to = "40 um"}}'}
"{SPEED}" = {{from = "500 rpm", to = "3000 rpm"}}
"""


def test_rows_that_no_other_beats() -> None:
    merits = np.array([[1.0, 5.0], [2.0, 2.0], [2.0, 3.0], [5.0, 1.0], [5.0, 1.0], [6.0, 6.0]])
    # two equal rows do not beat one another
    assert not_beaten(merits).tolist() == [True, True, False, True, True, False]


def test_a_search_finds_the_front(calls: list[Case], tmp_path: Path) -> None:
    """Efficiency falls and flow grows with the clearance, flow with the speed: full speed is best.

    Efficiency 1 - 1e-4 c^2 of at least 0.91 leaves clearances up to 30 um.
    """
    pytest.importorskip("pymoo")
    text = "evaluation_count = 120\npopulation_size = 20\ndrawn_designs = 1\n"
    text += "constraints = {volumetric_efficiency = {low = 0.91}}"
    result = run_study(case_with_study(pareto(text, "nsga2")), tmp_path)
    assert result.status is Status.DONE
    assert len(calls) <= 120
    front = result.data.where(result.data["front"], drop=True)
    assert front.sizes["point"] == result.numbers["front_count"] > 5
    assert float(front["volumetric_efficiency"].min()) >= 0.91
    assert float(front[CLEARANCE].min()) < 8.0
    assert float(front[CLEARANCE].max()) > 26.0
    assert float(front[SPEED].min()) > 2500.0
    count = len(calls)
    again = run_study(case_with_study(pareto(text, "nsga2")), tmp_path, resume=True)
    assert len(calls) == count
    assert again.numbers["front"] == result.numbers["front"]
    assert (tmp_path / "front.csv").is_file()
    assert study_report_html(result).count("<figure") == 3
    assert result.to_dataframe()["front"].sum() == result.numbers["front_count"]


def test_geometry_decides_before_a_run(calls: list[Case]) -> None:
    """Designs out of the limits of the geometry cost no run; the others have the displacement."""
    text = 'evaluation_count = 6\naddendum = 1.1\ndisplacement = "4.95 cm^3/rev"\n'
    text += "drawn_designs = 1\nconstraints = {contact_ratio = {low = 1.3}}"
    vary = '"machine.gears.tooth_count" = {from = 10, to = 14}\n'
    vary += '"machine.gears.profile_shift" = {from = 0.0, to = 0.6}\n'
    vary += '"machine.relief_grooves.closing_side_offset" = {from = "2.6 mm", to = "4.2 mm"}\n'
    vary += '"machine.casing.outlet_angle" = {from = "60 deg", to = "200 deg"}'
    result = run_study(case_with_study(pareto(text, vary=vary), "egm12_pump"))
    assert len(calls) == 6
    assert (result.data["contact_ratio"] >= 1.3).all()
    assert (result.data["root_clearance_mm"] > 0.1).all()
    numbers = api.describe(calls[0]).geometry_summary
    assert numbers["displacement_cm3_per_rev"] == pytest.approx(4.95, rel=1e-6)
    assert numbers["contact_ratio"] == pytest.approx(float(result.data["contact_ratio"][0]))
    # edges of grooves and ports are what the machine then has
    closing = [case.machine.relief_grooves.closing_side_offset * 1e3 for case in calls]
    varied = result.data["machine.relief_grooves.closing_side_offset"].values
    np.testing.assert_allclose(closing, varied)
    outlet = [np.degrees(case.machine.casing.outlet_angle) for case in calls]
    np.testing.assert_allclose(outlet, result.data["machine.casing.outlet_angle"].values)
    assert result.data["section"].sizes["drawn"] == 1


def test_failed_runs_are_infeasible_values(monkeypatch: pytest.MonkeyPatch) -> None:
    def simulate(case: Case) -> Answer:
        numbers = answer(case)
        if numbers["volumetric_efficiency"] > 0.95:
            raise ZeroDivisionError
        return Answer(numbers)

    monkeypatch.setattr(api, "simulate", simulate)
    result = run_study(case_with_study(pareto("evaluation_count = 16\ndrawn_designs = 0")))
    assert result.numbers["points_failed"] + result.numbers["points_feasible"] == 16
    assert result.numbers["points_failed"] > 4
    feasible = result.data["feasible"].values
    assert not feasible[result.data["point_status"].values == "failed"].any()
    assert result.status is Status.DONE


def test_what_cannot_be_searched_is_told(
    calls: list[Case], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CaseError, match=r"objectives: found 1, allowed at least two"):
        case_with_study(pareto().replace(', mean_flow_L_per_min = "maximise"', ""))
    with pytest.raises(CaseError, match=r"objectives\.mean_flo: found 'mean_flo', which is no"):
        run_study(case_with_study(pareto().replace("mean_flow_L_per_min", "mean_flo")))
    with pytest.raises(CaseError, match="addendum or displacement, but no varied key of gears"):
        run_study(case_with_study(pareto("addendum = 1.1")))
    monkeypatch.setitem(sys.modules, "pymoo.algorithms.moo.nsga2", None)
    with pytest.raises(CaseError, match=r"needs the package pymoo.*toothspace\[design\]"):
        run_study(case_with_study(pareto(method="nsga2")))
    assert not calls


@pytest.mark.slow
def test_two_workers_find_the_front_of_one(tmp_path: Path) -> None:
    """Generations go to processes, and come back in their order: the same designs and numbers."""
    pytest.importorskip("pymoo")
    text = """
kind = "pareto"
objectives = {pressure_ripple_bar = "minimise", overall_efficiency = "maximise"}
method = "nsga2"
evaluation_count = 9
population_size = 4
drawn_designs = 1
[study.vary]
"machine.relief_grooves.closing_side_offset" = {from = "3.0 mm", to = "4.0 mm"}
"machine.casing.inlet_angle" = {from = "60 deg", to = "80 deg"}
"""
    case = case_with_study(text, "egm12_pump").replace(
        {
            "heat.model": "adiabatic",
            "run.samples_per_revolution": 90,
            "run.relative_tolerance": 1e-5,
        }
    )
    one = run_study(case, tmp_path / "one", workers=1)
    two = run_study(case, tmp_path / "two", workers=2)
    assert one.status is two.status is Status.DONE
    assert one.data.identical(two.data)
    assert one.data.sizes["point"] == 9
    assert one.numbers["front_count"] == two.numbers["front_count"] >= 1
    again = run_study(case, tmp_path / "two", workers=2, resume=True)
    assert again.data.identical(one.data)
