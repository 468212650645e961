from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.core.signals import read_columns, read_signal

GOOD = "time [s];speed [rpm];opening [1]\n0;0;0\n1,5;60;1\n".replace("1,5", "1.5")


def written(folder: Path, text: str) -> Path:
    path = folder / "signal.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_columns_in_si_units_with_either_separator(tmp_path: Path) -> None:
    for text in (GOOD, GOOD.replace(";", ",")):
        columns = read_columns(written(tmp_path, text), {"speed": "rpm", "opening": "1"})
        assert columns["speed"] == pytest.approx([0.0, 2.0 * np.pi])
        assert columns["opening"] == pytest.approx([0.0, 1.0])


def test_signal_over_time(tmp_path: Path) -> None:
    signal = read_signal(written(tmp_path, GOOD), "speed", "rpm")
    assert signal == pytest.approx(np.array([[0.0, 0.0], [1.5, 2.0 * np.pi]]))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("speed [rpm]", "speed", "allowed one named 'speed \\[rpm\\]'"),
        ("speed [rpm]", "speed [bar]", "found the unit 'bar', allowed 'rpm'"),
        ("60", "sixty", "found 'sixty', allowed a number"),
        ("60", "nan", "allowed a number in every row"),
        ("60", "9" * 40 + "x" * 40, "found '9+[.]{3}x+', allowed a number in every row"),
        (";60;1", "", "found 'nothing'"),
        ("1.5;", "0;", "times that fall or repeat"),
        ("\n0;0;0\n1.5;60;1", "", "found no rows"),
    ],
)
def test_bad_files_get_one_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = written(tmp_path, GOOD.replace(old, new))
    with pytest.raises(CaseError, match=message) as caught:
        read_signal(path, "speed", "rpm")
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="allowed a CSV file"):
        read_signal(tmp_path / "nowhere.csv", "speed", "rpm")
