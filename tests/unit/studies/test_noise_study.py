"""The noise study on forces that are given: levels, differences, ranges, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.study_cases import case_with_study
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.studies import noise, run_study, study_figures

STUDY = """
kind = "noise"
name = "small"
reference = "small"
[study.designs.large]
"machine.gears.face_width" = "15 mm"
[study.designs.refused]
"machine.gears.face_width" = "-1 mm"
[study.casing]
mass = "4 kg"
surface = "500 cm^2"
stiffness = "2e9 N/m"
[study.plate]
length = "800 mm"
width = "600 mm"
thickness = "10 mm"
foot_distance = "100 mm"
shaft_height = "60 mm"
"""


def source(_self: noise.NoiseSource, case: Case) -> dict[str, Any]:
    """Forces in harmonics of twelve teeth, twice as large for wide gears."""
    order = np.arange(1.0, 441.0)
    wide = case.value("machine.gears.face_width") > 0.01
    size = (2.0 if wide else 1.0) * (order % 12 == 0.0) / order
    assert case.value("run.samples_per_revolution") == 1440
    part = [size.tolist(), np.zeros(order.size).tolist()]
    return {
        "inside": {"journal_x": (100.0 * np.array(part)).tolist()},
        "pressure": {},
        "net": {name: part for name in ("net_x", "net_y", "net_moment_z")},
        "ripple": {"ripple": (1e5 * np.array(part)).tolist()},
        "order": order.tolist(),
        "speed": 157.08,
        "status": "done",
    }


def test_levels_differences_and_what_the_free_parameters_leave(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(noise.NoiseSource, "__call__", source)
    result = run_study(case_with_study(STUDY))
    numbers = result.numbers
    assert numbers["design"] == ["small", "large"]
    assert numbers["points_failed"] == 1
    # twice the force, whatever casing and plate are like
    assert numbers["difference_dB"] == pytest.approx([0.0, 20.0 * np.log10(2.0)])
    assert numbers["difference_low_dB"] == pytest.approx(numbers["difference_high_dB"])
    assert numbers["sound_power_level_low_dBA"][0] < numbers["sound_power_level_dBA"][0] - 3.0
    assert numbers["sound_power_level_high_dBA"][0] > numbers["sound_power_level_dBA"][0] + 3.0
    data = result.data
    parts = 10.0 ** (0.1 * data["weighted_power_level"].sel(radiator="total"))
    total = 10.0 * np.log10(parts.sum("band"))
    assert total.values == pytest.approx(data["sound_power_level_dBA"].values)
    assert [f.name for f in study_figures("noise", data)] == ["noise", "casing_forces"]


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ('reference = "third"', "small, large, refused"),
        ('name = "large"', "a name of its own"),
    ],
)
def test_names_that_fit_nothing_are_refused(line: str, word: str) -> None:
    key = line.split(" ", maxsplit=1)[0]
    lines = [line if old.startswith(f"{key} =") else old for old in STUDY.splitlines()]
    with pytest.raises(CaseError, match=word):
        case_with_study("\n".join(lines))


def test_a_preset_without_forces_is_refused() -> None:
    case = case_with_study(STUDY).replace({"run.fidelity": "ideal"})
    with pytest.raises(CaseError, match="forces on the bodies"):
        run_study(case)
