"""What a wall and a gas charge keep is the work that the fluid does on them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from toothspace.model import arrays as col
from toothspace.model.chambers import wall_energy

COMPLIANCE, VOLUME, PRECHARGE, EXPONENT = 2e-13, 3e-5, 20e5, 1.4


def node(*, gas: bool) -> np.ndarray:
    made = np.zeros(col.NODE_COLUMNS)
    made[col.WALL_COMPLIANCE] = COMPLIANCE
    made[col.PRECHARGE], made[col.GAS_EXPONENT] = PRECHARGE, EXPONENT
    made[col.GAS_VOLUME] = VOLUME if gas else 0.0
    return made


@pytest.mark.parametrize("pressure", [5e5, 60e5, 300e5])
def test_a_wall_keeps_the_work_of_widening_it(pressure: float) -> None:
    work, _ = quad(lambda p: p * COMPLIANCE, 0.0, pressure)
    assert wall_energy(node(gas=False), pressure) == pytest.approx(work, rel=1e-12)


@pytest.mark.parametrize("pressure", [5e5, 60e5, 300e5])
def test_a_gas_charge_keeps_the_work_of_compressing_it(pressure: float) -> None:
    def volume(p: float) -> float:
        return VOLUME * (PRECHARGE / p) ** (1.0 / EXPONENT)

    highest = max(pressure, PRECHARGE)
    work, _ = quad(lambda p: volume(p) / EXPONENT, PRECHARGE, highest)
    kept = wall_energy(node(gas=True), pressure) - wall_energy(node(gas=False), pressure)
    assert kept == pytest.approx(work, rel=1e-8, abs=1e-12)
