"""Marches of one run: each begins where the last one ended, with a load orifice too."""

from __future__ import annotations

import pytest

import toothspace as ts
from toothspace.run.run import Marches


@pytest.mark.slow
def test_a_march_against_an_orifice_begins_where_the_last_one_ended() -> None:
    case = ts.load_case("egm12_pump").replace({"machine.casing.wear_in": None, "heat": None})
    run = ts.prepare(case)
    march = Marches(run)
    first, again = march(run.machine), march(run.machine)
    assert again.statistics["rhs"] < 0.8 * first.statistics["rhs"]
    one, two = (found.summary()["overall_efficiency"] for found in (first, again))
    assert two == pytest.approx(one, abs=1e-5)


@pytest.mark.slow
def test_a_march_of_other_parts_begins_anew() -> None:
    case = ts.load_case("egm12_pump").replace({"machine.casing.wear_in": None, "heat": None})
    run = ts.prepare(case)
    march = Marches(run)
    march(run.machine)
    other = ts.prepare(case.replace({"machine.bearing_blocks": None}))
    found = Marches(other, None, march.last)(other.machine)
    assert found.status.succeeded
