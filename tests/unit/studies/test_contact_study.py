"""Study of gerotor contacts: measured columns and figures, without a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace.core.errors import CaseError
from toothspace.studies.contact_span import TORQUE_STAGES, _measured
from toothspace.studies.contact_span import figures as contact_span_figures

TURN = 2.0 * np.pi


def study_data(pressure_ripple: float) -> xr.Dataset:
    angle = np.linspace(0.0, TURN, 361)
    torque = 3.6 + 0.1 * np.sin(6.0 * angle)
    names = [name for name, _, _ in TORQUE_STAGES]
    waves = {name: ("shaft_angle", torque) for name in names}
    waves["outlet_pressure"] = ("shaft_angle", 40e5 + pressure_ripple * np.cos(6.0 * angle))
    return xr.Dataset(
        {
            **waves,
            "mean_torque": ("stage", [3.5, 3.6, 3.7, 3.6]),
            "tooth_force": (("shaft_angle", "tooth"), np.ones((361, 7))),
            "tip_clearance": ("point", [1e-5, 1e-5, 4e-5, 4e-5]),
            "pressure_difference": ("point", [5e5, 4e6, 5e5, 4e6]),
            "span_pitches": ("point", [1.3, 2.9, 0.9, 1.2]),
            "mean_torque_N_m": ("point", [0.6, 4.2, 0.6, 3.7]),
        },
        coords={"shaft_angle": angle, "stage": names},
    )


def measured_file(folder: Path, turns: float) -> Path:
    time = np.linspace(0.0, 0.08 * turns, 200)
    torque = 3.7 + 0.1 * np.sin(6.0 * TURN * time / 0.08)
    rows = [f"{t:.6f},{m:.4f}" for t, m in zip(time, torque, strict=True)]
    path = folder / "measured.csv"
    path.write_text("time [s],shaft_torque [N m]\n" + "\n".join(rows), encoding="utf-8")
    return path


def test_figures_show_measured_columns(tmp_path: Path) -> None:
    data = study_data(1e5).merge(_measured(measured_file(tmp_path, 2.0), TURN / 0.08))
    figures = {found.name: found for found in contact_span_figures(data)}
    assert set(figures) == {"torque_stages", "ripple_over_turn", "contact_span"}
    panels = figures["ripple_over_turn"].figure.axes
    assert [len(axes.lines) for axes in panels] == [2, 2, 1]
    filtered = panels[1].lines[0].get_ydata()
    assert np.ptp(filtered) == pytest.approx(0.2, rel=0.01)
    assert np.mean(filtered) == pytest.approx(0.0, abs=1e-9)
    assert "measured" in figures["ripple_over_turn"].caption


def test_a_constant_outlet_pressure_is_not_shown() -> None:
    figures = {found.name: found for found in contact_span_figures(study_data(0.0))}
    assert len(figures["ripple_over_turn"].figure.axes) == 2


def test_measured_columns_need_a_whole_turn(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="less than a turn"):
        _measured(measured_file(tmp_path, 0.5), TURN / 0.08)
