from __future__ import annotations

import numpy as np
import pytest

from toothspace.results.variables import VARIABLES, dataset_from

CONTRACT = [
    "shaft_angle",
    "shaft_speed",
    "shaft_torque",
    "inlet_flow_rate",
    "outlet_flow_rate",
    "inlet_pressure",
    "outlet_pressure",
    "chamber_pressure",
    "chamber_volume",
    "chamber_gas_fraction",
    "body_position",
    "body_force",
    "contact_force",
    "contact_gap",
    "leakage",
    "torque_loss",
    "power_loss",
    "film_pressure",
    "film_height",
    "film_contact_pressure",
    "film_deformation",
    "bearing_position",
    "running_in_depth",
]


def test_contract_names_are_in_the_table() -> None:
    assert set(CONTRACT) <= set(VARIABLES)


def test_dataset_carries_units_and_labels() -> None:
    angle = np.linspace(0.0, 1.0, 5)
    data = dataset_from(
        {"shaft_angle": angle, "time": angle, "leakage": np.zeros((5, 2))},
        {"path": ["tooth_tip", "drain"]},
    )
    assert data["leakage"].dims == ("shaft_angle", "path")
    assert data["leakage"].attrs["units"] == "m3/s"
    assert list(data["path"].values) == ["tooth_tip", "drain"]
    assert "time" in data.coords


def test_transient_dataset_is_over_time() -> None:
    time = np.linspace(0.0, 1.0, 5)
    data = dataset_from({"shaft_angle": time, "time": time}, {}, sample="time")
    assert data["shaft_angle"].dims == ("time",)


def test_unknown_name_is_refused() -> None:
    with pytest.raises(KeyError, match="unknown result variable 'presure'"):
        dataset_from({"presure": np.zeros(3)}, {})


def test_unknown_label_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown mechanism label"):
        dataset_from({"torque_loss": np.zeros((5, 1))}, {"mechanism": ["magic"]})


def test_wrong_number_of_axes_is_refused() -> None:
    with pytest.raises(ValueError, match="chamber_pressure has 1 axes"):
        dataset_from({"chamber_pressure": np.zeros(3)}, {})
