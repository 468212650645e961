from __future__ import annotations

from pathlib import Path

import pytest

from toothspace.core.errors import CaseError
from toothspace.machines.external_gear.parameters import seal_torque
from toothspace.machines.external_gear.spec import SealParameters

TABLE = """temperature [degC],penetration [mm],friction_force [N]
20,0.2,10
20,0.4,20
80,0.2,6
80,0.4,14
"""


def seals(path: Path, temperature: float, penetration: float) -> SealParameters:
    return SealParameters(table=path, temperature=temperature + 273.15, penetration=penetration)


def test_force_between_the_points_times_the_shaft_radius(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(TABLE, encoding="utf-8")
    assert seal_torque(seals(path, 50.0, 0.3e-3), 18e-3) == pytest.approx(12.5 * 9e-3)
    assert seal_torque(seals(path, 80.0, 0.2e-3), 18e-3) == pytest.approx(6.0 * 9e-3)


def test_number_without_a_table() -> None:
    assert seal_torque(SealParameters(shaft_seal_torque=0.15), 18e-3) == 0.15
    assert seal_torque(None, 18e-3) == 0.0


def test_outside_the_table_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(TABLE, encoding="utf-8")
    with pytest.raises(CaseError, match=r"seals\.temperature"):
        seal_torque(seals(path, 120.0, 0.3e-3), 18e-3)


@pytest.mark.parametrize(("row", "count"), [("", 3), ("80,0.2,14\n", 4)])
def test_a_grid_with_a_hole_is_refused(row: str, count: int, tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(TABLE.replace("80,0.4,14\n", row), encoding="utf-8")
    with pytest.raises(CaseError, match=f"{count} rows at 2 values of temperature"):
        seal_torque(seals(path, 50.0, 0.3e-3), 18e-3)


@pytest.mark.parametrize("keys", [{}, {"shaft_seal_torque": 0.1, "temperature": 300.0}])
def test_half_a_table_is_refused(keys: dict[str, float]) -> None:
    with pytest.raises(CaseError):
        SealParameters(**keys)
