"""Extremes and spectra come from dense states: they do not hang on the samples that are kept."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.results.ripple import spectrum, wave
from toothspace.results.solution import Solution

CASES = Path(__file__).resolve().parents[3] / "cases"
WITHIN = 0.01
"""Relative change of an extreme from 180 to 2880 samples."""
EXTREMES = (
    "flow_ripple_percent", "torque_ripple_percent", "pressure_ripple_bar",
    "max_chamber_pressure_bar", "min_chamber_pressure_bar", "cavitation_index_W",
    "mean_loaded_contacts", "mean_flow_L_per_min", "lost_flow_L_per_min",
)  # fmt: skip


def run(name: str, samples: int, *overrides: str) -> Solution:
    chosen = [*overrides, f"run.samples_per_revolution={samples}"]
    case = api.load_case(CASES / f"{name}.toml", chosen)
    return api.simulate(replace(case, study=None))


@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("egm12_pump", ["run.fidelity=ideal"]),
        ("gerotor_cycloidal", []),
        pytest.param("egm12_pump", [], marks=pytest.mark.slow),
        pytest.param("crescent_motor", [], marks=pytest.mark.slow),
        pytest.param("fuel14_pump", [], marks=pytest.mark.slow),
        pytest.param("egm12_motor", [], marks=pytest.mark.slow),
        pytest.param("crescent_pump", [], marks=pytest.mark.slow),
        pytest.param("gerotor_trochoidal", [], marks=pytest.mark.slow),
        pytest.param("egm12_pump_line", [], marks=pytest.mark.slow),
        pytest.param("egm12_motor_line", [], marks=pytest.mark.slow),
        pytest.param("egm12_pump", ["run.mesh=elastic"], marks=pytest.mark.slow),
    ],
)
def test_extremes_do_not_hang_on_the_samples(name: str, overrides: list[str]) -> None:
    coarse, fine = (run(name, samples, *overrides) for samples in (180, 2880))
    few, many = coarse.summary(), fine.summary()
    for key in EXTREMES:
        if key in few:
            assert few[key] == pytest.approx(many[key], rel=WITHIN, abs=1e-9), key
    side = "inlet" if coarse.data.attrs["mode"] == "motor" else "outlet"
    one, other = (spectrum(*wave(s.data, f"{side}_flow_rate")) for s in (coarse, fine))
    assert one.order.size == other.order.size
    np.testing.assert_allclose(
        one.amplitude, other.amplitude, atol=WITHIN * other.amplitude[1:].max()
    )
    for name_ in ("contact_force_maximum", "journal_film_height_minimum"):
        if name_ in coarse.data:
            ends = (np.asarray(s.data[name_]) for s in (coarse, fine))
            np.testing.assert_allclose(*ends, rtol=WITHIN, atol=1e-9)


def test_samples_are_some_of_the_dense_states_or_stand_between_them() -> None:
    whole, odd = (
        run("egm12_pump", 720, "run.revolutions=1", "heat.model=network"),
        run("egm12_pump", 500, "run.revolutions=1", "heat.model=network"),
    )
    # steps of the integrator differ by rounding from run to run
    for name in ("chamber_pressure_maximum", "shaft_torque_minimum"):
        np.testing.assert_allclose(whole.data[name], odd.data[name], rtol=1e-3)
    assert whole.data.sizes["dense_angle"] == odd.data.sizes["dense_angle"]
    assert odd.data.sizes["shaft_angle"] == 501
    peak = float(odd.data["chamber_pressure"].max())
    assert peak <= float(odd.data["chamber_pressure_maximum"].max()) * (1.0 + 1e-4)
