"""A case shows its machine before any run, and what it asks for."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pytest

import toothspace as ts


@pytest.mark.parametrize("name", ["egm12_pump", "gerotor_cycloidal", "crescent_motor"])
def test_section_turns_with_the_shaft(name: str) -> None:
    case = ts.load_case(name)
    chambers = ts.describe(case).chamber_count
    figures = case.plot.section(), case.plot.section(shaft_angle=0.1)
    here, there = ([p.get_path().vertices for p in f.axes[0].patches] for f in figures)
    assert len(here) > chambers
    np.testing.assert_allclose(here[0], there[0], err_msg="the housing stands still")
    assert sum(map(len, here)) != sum(map(len, there)) or not np.allclose(
        np.vstack(here), np.vstack(there)
    )
    for figure in figures:
        plt.close(figure)


def test_notebook_view_says_machine_condition_and_displacement() -> None:
    case = ts.load_case("egm12_pump", ["operating_point.shaft_speed=1234 rpm"])
    shown = case._repr_html_()
    for text in ("External gear, pump", "4.95 cm³/rev", "1234 rpm", "<svg"):
        assert text in shown


def test_case_without_a_machine_has_no_picture_and_says_so() -> None:
    case = ts.load_case("journal_bearing")
    assert "100 mm" in case._repr_html_()
    with pytest.raises(ts.CaseError, match="machine: found none"):
        _ = case.plot
