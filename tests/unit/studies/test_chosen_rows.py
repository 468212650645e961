"""Rows of a measured map that a calibration fits, the others being predicted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.studies.calibrate import CalibrateStudy, _used_rows
from toothspace.studies.measured import read_measured

BENCH = Path(__file__).resolve().parents[3] / "cases" / "measured" / "egm12_bench.csv"
BOUNDS = {"machine.lateral.side_gap": ("5 um", "14 um")}


def _rows(*rows: int) -> np.ndarray:
    study = CalibrateStudy(data=BENCH, fit=BOUNDS, fit_rows=rows)
    return _used_rows(study, read_measured(BENCH), 2, "case")


def test_named_rows_are_fitted_and_all_others_held_out() -> None:
    assert np.flatnonzero(_rows(2, 11)).tolist() == [1, 10]


def test_rows_beyond_the_file_are_refused() -> None:
    with pytest.raises(CaseError, match="fit_rows: found row 13, allowed 1 to 12"):
        _rows(13)


def test_fewer_numbers_than_keys_are_refused() -> None:
    study = CalibrateStudy(data=BENCH, fit=BOUNDS, fit_rows=(1,))
    with pytest.raises(CaseError, match="2 numbers for 3 keys"):
        _used_rows(study, read_measured(BENCH), 3, "case")
