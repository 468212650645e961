"""Surrogates against a known function, scikit-learn, and themselves after a file."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import toothspace as ts
from toothspace.core.errors import CaseError
from toothspace.studies.variation import unit_samples

GAP, SPEED = "machine.lateral.side_gap", "operating_point.shaft_speed"


def peaks(gap: np.ndarray, speed: np.ndarray) -> np.ndarray:
    return 200.0 + 3.0 * (gap - 7.0) ** 2 + 10.0 * np.sin(speed / 500.0)


def study(count: int = 60, noise: float = 0.0) -> xr.Dataset:
    shares = unit_samples(2, "sobol", count, 1)
    gap, speed = 4.0 + 6.0 * shares[:, 0], 500.0 + 2500.0 * shares[:, 1]
    rng = np.random.default_rng(0)
    values = peaks(gap, speed) + noise * rng.normal(size=count)
    return xr.Dataset(
        {
            GAP: ("point", gap, {"units": "um"}),
            SPEED: ("point", speed, {"units": "rpm"}),
            "max_chamber_pressure_bar": ("point", values),
            "volumetric_efficiency": ("point", np.full(count, 0.9)),
        }
    )


@pytest.fixture(scope="module")
def surrogate() -> ts.Surrogate:
    pytest.importorskip("sklearn")
    return ts.fit_surrogate(study())


def test_a_smooth_function_is_found_within_its_error_bars(surrogate: ts.Surrogate) -> None:
    rng = np.random.default_rng(5)
    gap, speed = rng.uniform(4.2, 9.8, 200), rng.uniform(600.0, 2900.0, 200)
    found = surrogate.predict({GAP: gap, SPEED: speed})
    off = found["max_chamber_pressure_bar"] - peaks(gap, speed)
    error = surrogate.processes["max_chamber_pressure_bar"].hold_out_error
    assert found["max_chamber_pressure_bar"].attrs["hold_out_error"] == error
    # the span is 45 bar; a hold-out error of fewer points is an upper bound of that of all
    assert 0.0 < error < 0.5
    assert float(np.sqrt(np.mean(off**2))) < error
    deviation = found["max_chamber_pressure_bar_deviation"]
    assert float((abs(off) < 3.0 * deviation + 1e-3).mean()) > 0.9
    assert (found["volumetric_efficiency"] == 0.9).all()


def test_noise_shows_in_the_hold_out_error() -> None:
    pytest.importorskip("sklearn")
    found = ts.fit_surrogate(study(80, noise=2.0), ["max_chamber_pressure_bar"])
    error = found.processes["max_chamber_pressure_bar"].hold_out_error
    assert 1.5 < error < 3.5


def test_own_prediction_is_that_of_scikit_learn(surrogate: ts.Surrogate) -> None:
    """Same covariance, so mean and deviation must agree to rounding."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern

    own = surrogate.processes["max_chamber_pressure_bar"]
    kernel = ConstantKernel(own.variance) * Matern(own.lengths, nu=2.5)
    other = GaussianProcessRegressor(kernel, alpha=own.noise, optimizer=None)
    other.fit(own.points, own.values)
    shares = unit_samples(2, "latin_hypercube", 20, 3)
    mean, spread = other.predict(shares, return_std=True)
    found, deviation = own.predict(shares)
    np.testing.assert_allclose(found, own.mean + own.deviation * mean, rtol=1e-7)
    np.testing.assert_allclose(deviation, own.deviation * spread, rtol=1e-3, atol=1e-4)


def test_a_surrogate_is_read_back_the_same(surrogate: ts.Surrogate, tmp_path: Path) -> None:
    again = ts.load_surrogate(surrogate.save(tmp_path / "pump.json"))
    at = {GAP: "0.006 mm", SPEED: [900.0, 2000.0]}
    xr.testing.assert_identical(again.predict(at), surrogate.predict(at))
    (tmp_path / "other.json").write_text("{}")
    with pytest.raises(CaseError, match=r"other\.json: found no surrogate"):
        ts.load_surrogate(tmp_path / "other.json")


def test_what_a_surrogate_cannot_say_is_told(
    surrogate: ts.Surrogate, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CaseError, match="allowed values from 4"):
        surrogate.predict({GAP: "20 um", SPEED: 1000.0})
    with pytest.raises(CaseError, match=f"no value of {SPEED}"):
        surrogate.predict({GAP: "5 um"})
    with pytest.raises(CaseError, match="found 4 points with"):
        ts.fit_surrogate(study(4))
    with pytest.raises(CaseError, match="max_chamber_pressure_bar"):
        ts.fit_surrogate(study(), ["max_chamber_pressure"])
    monkeypatch.setitem(sys.modules, "sklearn.gaussian_process", None)
    with pytest.raises(CaseError, match=r"toothspace\[design\]"):
        ts.fit_surrogate(study(8))
