"""Lumped simulation of the 6/7 cycloidal gerotor against SciPy and SUNDIALS.

All lobe contacts and the planar motion of the outer rotor at 2000 rpm. Same comparison as
``bench_lumped``: one compiled right-hand side and analytic Jacobian, the package's error weights.
"""

from __future__ import annotations

from pathlib import Path

from benchmarks.bench_lumped import (
    Problem,
    callback_microseconds,
    measure,
    print_at_tolerances,
)

CASE = Path(__file__).resolve().parents[1] / "cases" / "gerotor_cycloidal.toml"
SPEED = 2000.0
TOLERANCES = (1e-6,)
OVERRIDES = (
    f"operating_point.shaft_speed={SPEED:g} rpm",
    "operating_point.outlet_load=fixed_pressure",
)


def main() -> None:
    """Print the table of integrators."""
    problem = Problem(CASE, OVERRIDES)
    rhs, jac = callback_microseconds(problem)
    outcomes = measure(problem, TOLERANCES)
    print(f"Lumped, {CASE.stem}, {SPEED:g} rpm, one revolution")
    print(
        f"{problem.core} core states (every lobe contact, planar motion and gas included), cyclic "
        f"after {problem.revolutions_to_cyclic} revolutions; right-hand side {rhs:.1f} us, "
        f"Jacobian {jac:.1f} us per call from Python"
    )
    print_at_tolerances(outcomes)
