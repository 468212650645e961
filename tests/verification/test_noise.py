"""Forces on the casing of a pump that was run: what pressures and journals leave is inertia."""

from __future__ import annotations

import numpy as np
import pytest

import toothspace as ts
from toothspace.results.noise import casing_forces


@pytest.mark.slow
def test_a_closed_casing_keeps_no_force_but_the_inertia_of_the_gears() -> None:
    """Sums over both gears, where the force between them drops out, of spectra of one run."""
    solution = ts.simulate("egm12_pump", run__relative_tolerance=1e-8)
    forces = casing_forces(solution.data, ts.describe("egm12_pump").bodies, 23.7e-3)
    # the lowest harmonics of the teeth, which samples of velocities resolve
    teeth = np.isin(forces.order, [12.0, 24.0, 36.0, 48.0])
    for axis in "xy":
        pairs = {**forces.inside, **forces.pressure}
        parts = [z for name, z in pairs.items() if name.endswith(f"gear_{axis}")]
        assert len(parts) == 4
        largest = np.abs(parts)[:, teeth].max()
        rest = np.sum(parts, axis=0)[teeth]
        assert np.abs(rest).max() < 5e-3 * largest
        inertia = forces.net[f"net_{axis}"][teeth]
        assert inertia == pytest.approx(rest, rel=0.05, abs=2e-5 * largest)
