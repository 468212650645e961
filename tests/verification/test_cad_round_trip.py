"""Parameters to a file of the profile and back to tables: displacement and chamber volumes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.conftest import REPOSITORY
from toothspace import api
from toothspace.cli import main
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription

CASES = REPOSITORY / "cases"
ANGLES = np.linspace(0.0, 2.0 * np.pi, 721)


def volume(description: MachineDescription) -> Array:
    family = description.families[0]
    return family.volume(family.phases[0] + family.angle_ratio * ANGLES)[:, 0]


@pytest.mark.parametrize(
    "suffix",
    ["dxf", *(pytest.param(one, marks=pytest.mark.slow) for one in ("stl", "step", "txt"))],
)
def test_exported_profile_gives_the_tables_back(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Displacement within 0.1 %, V over the angle within 0.2 % of its range."""
    source = CASES / "egm12_motor.toml"
    monkeypatch.chdir(tmp_path)
    assert main(["geometry", str(source), "--export", suffix]) == 0
    text = (CASES / "egm12_motor_profile.toml").read_text(encoding="utf-8")
    path = tmp_path / "case.toml"
    drive = tmp_path / f"egm12_motor_drive.{suffix}"
    path.write_text(text.replace("profiles/egm12_drive.txt", drive.as_posix()), encoding="utf-8")
    before, after = (api.describe(api.load_case(file)) for file in (source, path))
    assert after.displacement == pytest.approx(before.displacement, rel=1e-3)
    first, second = volume(before)[:-1], volume(after)[:-1]
    shifted = min(float(np.abs(np.roll(second, k) - first).max()) for k in range(first.size))
    assert shifted < 2e-3 * np.ptp(first)
