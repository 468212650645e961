"""Grooved journal bearing with mass-conserving cavitation against an independent program."""

from __future__ import annotations

import pytest

from toothspace.validation.claim import rows_of
from toothspace.validation.published_films import elrod_film

ROWS = [{key: float(text) for key, text in row.items()} for row in rows_of("elrod_1981")]


def _label(row: dict[str, float]) -> str:
    return f"{row['eps_h']}-{row['n_x']:.0f}-{'guembel' if row['guembel'] else 'jfo'}"


@pytest.mark.parametrize("row", ROWS, ids=_label)
def test_forces_friction_and_flow(row: dict[str, float]) -> None:
    film = elrod_film(row)
    assert -film.force == pytest.approx([row["F_h_N"], row["F_v_N"]], rel=0.01)
    assert film.bush_friction_torque == pytest.approx(row["M_fr_Nm"], rel=0.005)
    assert film.max_pressure == pytest.approx(row["pmax_Pa"], rel=0.005)
    assert film.side_flow == pytest.approx(-row["V_dot_m3ps"], rel=0.04)
    if not row["guembel"]:
        assert film.mass_balance_error < 1e-10
