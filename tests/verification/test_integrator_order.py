import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tests.stiff_problems import (
    HIRES,
    KINK,
    LINEAR,
    RELAY,
    RING,
    ROBERTSON,
    VAN_DER_POL,
    Run,
    plain_rhs,
)
from toothspace.numerics.ndf_types import DONE


def _exact_linear(t):
    return np.array([np.sin(t), np.cos(t)])


def _error_with_fixed_step(order, step):
    """March from exact differences, order and step held, to t = 2."""
    run = Run(LINEAR, _exact_linear(0.0), 0.0, 1e30, max_step=step, orders=(order, order))
    rows = np.array([_exact_linear(-m * step) for m in range(order + 1)])
    for j in range(order + 1):
        run.state.differences[j] = rows[0]
        rows = rows[:-1] - rows[1:]
    for name, value in (("order", order), ("step", step)):
        run.state.control[name] = run.state.control[f"next_{name}"] = value
    assert run.to(2.0) == DONE
    assert run.count("order") == order
    assert run.count("steps") == round(2.0 / step)
    return np.abs(run.y - _exact_linear(2.0)).max()


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_each_formula_has_its_order(order):
    coarse, fine = _error_with_fixed_step(order, 1 / 32), _error_with_fixed_step(order, 1 / 64)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize(("worst", "grows"), [(0.0, True), (0.7, False)])
def test_after_a_failure_a_step_grows_by_the_largest_error_since(worst, grows):
    """A step that agrees by chance among others that hardly pass lets nothing grow."""
    run = Run(LINEAR, _exact_linear(0.0), 1e-4, 1e-4, max_step=1.0)
    first = run.state.control["step"][0]
    run.state.control["worst"] = worst
    assert run.to(1.5 * first) == DONE
    assert run.count("steps") == 2
    assert run.count("rejected") == 0
    planned = run.state.control["next_step"][0] / first
    assert planned > 2.0 if grows else planned <= 1.0
    assert run.state.control["worst"][0] == 0.0


def test_a_failed_step_is_remembered():
    """The derivative jumps at t = 1, where a step fails."""
    run = Run(RELAY, [0.0], 1e-6, 1e-6, max_step=0.3)
    assert run.to(0.9) == DONE
    while run.count("rejected") == 0:
        assert run.state.control["worst"][0] == 0.0
        assert run.to(run.state.control["time"][0] + 1e-9) == DONE
    assert run.state.control["worst"][0] == run.state.control["error"][0] > 0.0


def _reference(kind, y0, t_end, absolute):
    solution = solve_ivp(
        plain_rhs(kind), (0.0, t_end), y0, method="Radau", rtol=1e-10, atol=absolute
    )
    return solution.y[:, -1]


@pytest.mark.slow
def test_robertson():
    y0 = [1.0, 0.0, 0.0]
    run = Run(ROBERTSON, y0, 1e-8, 1e-14)
    assert run.to(1e4) == DONE
    np.testing.assert_allclose(run.y, _reference(ROBERTSON, y0, 1e4, 1e-16), rtol=1e-6)
    assert run.count("steps") < 800


@pytest.mark.slow
def test_van_der_pol_relaxation():
    y0 = [2.0, 0.0]
    run = Run(VAN_DER_POL, y0, 1e-8, 1e-8)
    assert run.to(1000.0) == DONE
    np.testing.assert_allclose(run.y, _reference(VAN_DER_POL, y0, 1000.0, 1e-12), rtol=1e-4)
    assert run.count("steps") < 2500


@pytest.mark.slow
def test_hires_published_solution():
    # E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996),
    # section IV.10; digits of the Bari test set at t = 321.8122.
    expected = [
        0.7371312573325668e-3,
        0.1442485726316185e-3,
        0.5888729740967575e-4,
        0.1175651343283149e-2,
        0.2386356198831331e-2,
        0.6238968252742796e-2,
        0.2849998395185769e-2,
        0.2850001604814231e-2,
    ]
    run = Run(HIRES, [1.0, 0, 0, 0, 0, 0, 0, 0.0057], 1e-9, 1e-13)
    assert run.to(321.8122) == DONE
    np.testing.assert_allclose(run.y, expected, rtol=2e-6)


def _ring_pattern(n):
    eye = np.eye(n, dtype=bool)
    return eye | np.roll(eye, 1, axis=1) | np.roll(eye, -1, axis=1)


def _ring_run(tolerance, n=26):
    return Run(RING, np.zeros(n), tolerance, tolerance, pattern=_ring_pattern(n))


def _ring_exact(t, n=26):
    """Solution by the matrix exponential; sine and cosine of the forcing are two more states."""
    rate = 10.0 ** (np.arange(n + 1) % 7)
    matrix = np.zeros((n + 2, n + 2))
    for i in range(n):
        matrix[i, i] -= rate[i] + rate[i + 1] + 100.0
        matrix[i, i - 1 if i > 0 else n - 1] += rate[i]
        matrix[i, (i + 1) % n] += rate[i + 1]
        matrix[i, n], matrix[i, n + 1] = 100.0 * np.cos(i), 100.0 * np.sin(i)
    matrix[n, n + 1], matrix[n + 1, n] = 20.0, -20.0
    return (expm(matrix * t) @ np.r_[np.zeros(n), 0.0, 1.0])[:n]


@pytest.mark.slow
def test_stiff_ring_of_chambers_with_sparse_factors():
    run = _ring_run(1e-7)
    assert run.program.dense[0] == 0
    assert run.to(0.3) == DONE
    np.testing.assert_allclose(run.y, _ring_exact(0.3), atol=3e-6)
    radau = _reference(RING, np.zeros(26), 0.3, 1e-10)
    np.testing.assert_allclose(run.y, radau, atol=3e-6)


@pytest.mark.slow
def test_error_follows_the_tolerance():
    exact = _ring_exact(0.3)
    errors = []
    for tolerance in (1e-4, 1e-6, 1e-8):
        run = _ring_run(tolerance)
        run.to(0.3)
        errors.append(np.abs(run.y - exact).max())
    assert all(e < 30.0 * t for e, t in zip(errors, (1e-4, 1e-6, 1e-8), strict=True))
    assert errors[0] > 5.0 * errors[1] > 25.0 * errors[2]


@pytest.mark.slow
def test_kinks_of_the_right_hand_side_cost_few_steps():
    # max(sin t, 0)^2 has a jump in its second derivative twice a turn; y lags by 1 ms. Without a
    # largest step the hump after a long rest would be stepped over.
    run = Run(KINK, [0.0], 1e-6, 1e-8, max_step=0.5)
    times = np.linspace(0.1, 12.0, 120)
    run.sample(times)
    assert run.to(12.0) == DONE
    reference = solve_ivp(
        plain_rhs(KINK), (0, 12), [0.0], "Radau", times, rtol=1e-9, atol=1e-12, max_step=0.05
    )
    np.testing.assert_allclose(run.record.samples[:, 0], reference.y[0], atol=2e-5)
    assert run.count("steps") < 400
    assert run.count("rejected") < 0.3 * run.count("steps")
