"""A whole pump from one STEP assembly equals the one that its figures describe."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from examples import pump_from_cad as drawing
from toothspace import api
from toothspace.case import load_case
from toothspace.case.case import Case
from toothspace.core.errors import CaseError

pytestmark = pytest.mark.slow

pytest.importorskip("OCP")

CASES = Path(__file__).parents[2] / "cases"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Case:
    path = tmp_path_factory.mktemp("assembly") / "pump.step"
    drawing.write_assembly(path, drawing.Pump())
    return drawing.case_of(path)


@pytest.fixture(scope="module")
def described() -> Case:
    keys = {
        "machine.casing.radial_clearance": "20 um",
        "machine.casing.outlet_angle": "55 deg",
        "machine.journal_bearings.radial_clearance": "8 um",
        "machine.journal_bearings.friction": None,
        "machine.lateral.side_gap": "8 um",
        "machine.floating_bearing": None,
        "heat": None,
        "machine.gears.normal_backlash": None,
        "machine.gears.center_distance": "34.56747 mm",
        "machine.casing.wear_in": None,
        "machine.bearing_blocks": None,
        "machine.journal_bearings.roughness_shaft": None,
        "machine.journal_bearings.roughness_bush": None,
        "machine.journal_bearings.boundary_friction": None,
        "machine.inlet": None,
        "machine.outlet": None,
        "fluid.free_air_fraction": None,
        "fluid.dissolved_air_fraction": None,
        "fluid.gas_law": None,
        "run.samples_per_revolution": None,
        "run.relative_tolerance": None,
    }
    return load_case(CASES / "egm12_pump.toml").replace(keys)


def test_gears_distance_and_recesses_are_found(drawn: Case) -> None:
    spec, pump = drawn.machine_spec, drawing.Pump()
    assert spec.center_distance == pytest.approx(pump.distance * 1e-3, abs=1e-8)
    assert spec.drive.face_width == pytest.approx(pump.width * 1e-3, abs=2e-6)
    assert spec.grooves.depth == pytest.approx(pump.groove_depth * 1e-3, abs=2e-6)
    closing, opening = spec.grooves.closing_contour, spec.grooves.opening_contour
    assert closing[:, 0].min() == pytest.approx(pump.groove_edge * 1e-3, abs=1e-6)
    assert opening[:, 0].max() == pytest.approx(-pump.groove_edge * 1e-3, abs=1e-6)
    assert np.ptp(closing[:, 1]) == pytest.approx(10e-3, abs=1e-6)


def test_openings_over_the_angle_are_those_of_the_figures(drawn: Case, described: Case) -> None:
    found, wanted = api.describe(drawn), api.describe(described)
    for path in wanted.paths:
        if path.category.label.endswith(("port", "groove")) or path.name.startswith(
            ("port", "groove")
        ):
            (other,) = [one for one in found.paths if one.name == path.name]
            largest = path.geometry.values[:, 0].max()
            difference = other.geometry.values[:, 0] - path.geometry.values[:, 0]
            assert np.abs(difference).max() < 0.01 * largest, path.name
    volumes = [family.volume.values for family in (found.families[0], wanted.families[0])]
    assert np.allclose(*volumes, rtol=2e-3)


def test_whole_run_is_that_of_the_figures(drawn: Case, described: Case) -> None:
    found, wanted = api.simulate(drawn).summary(), api.simulate(described).summary()
    for name in (
        "displacement_cm3_per_rev",
        "mean_flow_L_per_min",
        "mean_torque_N_m",
        "volumetric_efficiency",
        "hydromechanical_efficiency",
        "max_chamber_pressure_bar",
    ):
        assert found[name] == pytest.approx(wanted[name], rel=5e-3), name


def test_direction_of_the_outlet_is_asked_for(drawn: Case) -> None:
    with pytest.raises(CaseError, match="outlet_toward: found nothing"):
        drawn.replace({"machine.outlet_toward": None}).check()
    with pytest.raises(CaseError, match="found a direction along the centre line or the axis"):
        drawn.replace({"machine.outlet_toward": "+y"}).check()


def test_one_gear_twice_is_not_a_pair(drawn: Case) -> None:
    with pytest.raises(CaseError, match=r"driven_gear\.profile_part: found body"):
        drawn.replace({"machine.driven_gear": None}).check()
