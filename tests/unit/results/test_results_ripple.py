from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from toothspace.results.ripple import (
    distinct_samples,
    flow_ripple_percent,
    harmonics,
    high_pass,
    low_pass,
    pressure_ripple,
    pulsation_source,
    resolved_spectrum,
    ripple_percent,
    spectrum,
    torque_ripple_percent,
    whole_revolutions,
)

TURN = 2.0 * np.pi


@pytest.mark.parametrize("end_point", [False, True])
@pytest.mark.parametrize("revolutions", [1, 2])
def test_spectrum_finds_amplitude_and_phase(end_point: bool, revolutions: int) -> None:
    angle = 1.3 + np.linspace(0.0, revolutions * TURN, 720 * revolutions + 1)
    angle = angle if end_point else angle[:-1]
    result = spectrum(angle, 7.0 + 0.5 * np.cos(12.0 * angle + 0.4))
    k = int(np.flatnonzero(np.isclose(result.order, 12.0))[0])
    assert result.amplitude[0] == pytest.approx(7.0, abs=1e-9)
    assert result.amplitude[k] == pytest.approx(0.5, abs=1e-9)
    assert result.phase[k] == pytest.approx(0.4, abs=1e-9)
    rest = np.delete(result.amplitude, [0, k])
    assert np.max(rest) < 1e-9


def test_surplus_samples_are_cut_to_whole_revolutions() -> None:
    angle = np.arange(900) * TURN / 720.0
    result = spectrum(angle, np.cos(10.0 * angle))
    assert result.amplitude[10] == pytest.approx(1.0, abs=1e-9)


def test_less_than_a_revolution_is_refused() -> None:
    angle = np.linspace(0.0, 3.0, 100)
    with pytest.raises(ValueError, match=r"samples span 0.477 revolutions, at least 1"):
        spectrum(angle, angle)


def test_a_closing_sample_is_not_counted_twice() -> None:
    closed = xr.Dataset(coords={"shaft_angle": np.linspace(0.0, TURN, 13)})
    assert distinct_samples(closed).sizes["shaft_angle"] == 12
    open_end = closed.isel(shaft_angle=slice(0, 12))
    assert distinct_samples(open_end).sizes["shaft_angle"] == 12


def test_ripple_is_peak_to_peak_over_mean() -> None:
    assert ripple_percent(np.array([9.0, 10.0, 11.0])) == pytest.approx(20.0)


@pytest.mark.parametrize(("pump_outlet", "expected"), [(3.0e5, 3.0e5), (0.0, 1.0e5)])
def test_pressure_ripple_is_that_of_the_port_that_pulsates(
    pump_outlet: float, expected: float
) -> None:
    wave = 0.5 * np.array([1.0, -1.0, 1.0, -1.0])
    data = xr.Dataset(
        {
            "inlet_pressure": ("shaft_angle", 2.0e5 + 1.0e5 * wave),
            "outlet_pressure": ("shaft_angle", 2.0e7 + pump_outlet * wave),
        },
        attrs={"mode": "pump"},
    )
    assert pressure_ripple(data) == pytest.approx(expected)


def test_high_pass_takes_low_orders_out() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 721)
    kept = 0.3 * np.sin(12.0 * angle)
    signal = 5.0 + 2.0 * np.cos(angle) + np.sin(2.0 * angle) + kept
    uniform, filtered = high_pass(angle, signal, 3.0)
    assert filtered == pytest.approx(0.3 * np.sin(12.0 * uniform), abs=1e-3)


def test_low_pass_keeps_the_mean_and_what_a_slow_sensor_sees() -> None:
    angle = np.linspace(0.0, TURN, 721)
    seen = 5.0 + 2.0 * np.cos(angle)
    uniform, filtered = low_pass(angle, seen + np.sin(12.0 * angle), 11.0)
    assert filtered == pytest.approx(5.0 + 2.0 * np.cos(uniform), abs=1e-3)


def test_spectrum_leaves_out_what_a_run_does_not_resolve() -> None:
    angle = np.linspace(0.0, TURN, 721)[:-1]
    noise = 1e-3 * np.cos(7.0 * angle)
    assert resolved_spectrum(angle, 200.0 + noise).order.size == 0
    assert list(resolved_spectrum(angle, 200.0 + noise + np.cos(12.0 * angle)).order) == [12.0]


def test_harmonics_keep_amplitude_and_phase() -> None:
    angle = np.linspace(0.0, TURN, 721)[:-1]
    signal = 3.0 + 2.0 * np.cos(12.0 * angle + 0.3) + 0.5 * np.cos(24.0 * angle - 1.0)
    found = harmonics(angle, signal, np.array([12.0, 24.0]))
    assert found == pytest.approx([2.0 * np.exp(0.3j), 0.5 * np.exp(-1.0j)], abs=1e-9)


def test_source_is_found_from_loads_of_known_impedance() -> None:
    """A flow in parallel to a volume, against lines without friction that an orifice ends."""
    frequency = 2.0 * np.pi * 300.0 * np.arange(1.0, 11.0)
    flow = 8e-6 * np.exp(0.4j) / np.arange(1.0, 11.0)
    inner = 1.0 / (1j * frequency * 50e-6 / 1.7e9)
    pressures, flows = [], []
    for length in (0.8, 1.1, 1.5):
        wave, line, end = np.tan(frequency * length / 1300.0), 1.4e10, 3.3e11
        load = line * (end + 1j * line * wave) / (line + 1j * end * wave)
        pressures.append(flow / (1.0 / inner + 1.0 / load))
        flows.append(pressures[-1] / load)
    source = pulsation_source(np.array(pressures), np.array(flows))
    assert source.flow == pytest.approx(flow, rel=1e-9)
    assert source.impedance == pytest.approx(inner, rel=1e-9)
    assert source.misfit == pytest.approx(0.0, abs=1e-9)
    assert source.blocked_pressure == pytest.approx(flow * inner, rel=1e-9)
    parallel = inner / (1.0 + inner / (2e10 + 1e10j))
    assert source.pressure_into(2e10 + 1e10j) == pytest.approx(flow * parallel, rel=1e-9)
    assert abs(source.pressure_into(1e30)) == pytest.approx(abs(flow * inner), rel=1e-6)


@pytest.mark.parametrize("revolutions", [1, 2])
@pytest.mark.parametrize("end_point", [False, True])
def test_whole_revolutions_keep_their_own_samples(end_point: bool, revolutions: int) -> None:
    angle = 1.3 + np.linspace(0.0, revolutions * TURN, 72 * revolutions + 1)
    given = angle if end_point else angle[:-1]
    uniform, values, count = whole_revolutions(given, np.arange(given.size))
    assert count == revolutions
    assert uniform == pytest.approx(angle[:-1])
    assert values == pytest.approx(np.arange(72 * revolutions), abs=1e-9)


def test_the_last_of_one_and_a_half_revolutions_is_taken() -> None:
    angle = np.arange(109) * TURN / 72.0
    uniform, values, count = whole_revolutions(angle, angle)
    assert count == 1
    assert uniform == pytest.approx(angle[36:108])
    assert values == pytest.approx(uniform)


@pytest.mark.parametrize(("amplitude", "count"), [(0.038, 0), (0.042, 1)])
def test_a_spectrum_begins_at_two_ten_thousandths_of_the_mean(amplitude: float, count: int) -> None:
    angle = np.arange(720) * TURN / 720.0
    found = resolved_spectrum(angle, amplitude * np.cos(12.0 * angle) - 200.0)
    assert found.order.size == count


def test_samples_between_whole_revolutions_are_all_distinct() -> None:
    for turns, left in ((2.0, 24), (1.3, 25), (0.5, 25), (2.0 + 1e-4, 25)):
        angle = 1.7 + np.linspace(0.0, turns * TURN, 25)
        data = xr.Dataset(coords={"shaft_angle": angle})
        assert distinct_samples(data).sizes["shaft_angle"] == left


def test_ripples_are_those_of_the_closest_samples() -> None:
    """Samples 9 to 11, between them 8 to 12; the state that closes a turn counts once."""
    data = xr.Dataset(
        {
            "outlet_flow_rate": ("shaft_angle", [9.0, 11.0]),
            "shaft_torque": ("shaft_angle", [-9.0, -11.0]),
        },
        coords={"shaft_angle": [0.0, 3.0]},
        attrs={"mode": "pump"},
    )
    assert flow_ripple_percent(data) == pytest.approx(20.0)
    assert torque_ripple_percent(data) == pytest.approx(20.0)
    close = data.assign(
        dense_angle=("dense", [0.0, 1.0, 2.0, 3.0]),
        dense_outlet_flow_rate=("dense", [8.0, 12.0, 10.0, 8.0]),
        outlet_flow_rate_minimum=8.0,
        outlet_flow_rate_maximum=12.0,
    )
    assert flow_ripple_percent(close) == pytest.approx(40.0)
    still = data.assign(outlet_flow_rate=0.0 * data["outlet_flow_rate"])
    assert np.isnan(flow_ripple_percent(still))
    assert np.isnan(ripple_percent(np.zeros(3)))


def test_what_loads_leave_unexplained_is_told_over_the_source_flow() -> None:
    """Q = 4 - P/5, and 0.1, -0.2, 0.1 that no line through three loads explains."""
    pressure = np.array([[1.0], [2.0], [3.0]], dtype=complex)
    flow = 4.0 - pressure / 5.0 + np.array([[0.1], [-0.2], [0.1]])
    source = pulsation_source(pressure, flow)
    assert source.flow == pytest.approx([4.0])
    assert source.impedance == pytest.approx([5.0])
    assert source.misfit == pytest.approx([0.1 * np.sqrt(2.0) / 4.0])
    assert source.pressure_into(20.0) == pytest.approx([16.0])
    stiff = pulsation_source(pressure, 0.0 * flow)
    assert np.isinf(stiff.impedance[0]) or abs(stiff.impedance[0]) > 1e12


def test_bands_count_orders_of_the_shaft_whatever_the_revolutions() -> None:
    angle = np.linspace(0.0, 2.0 * TURN, 1441)
    signal = 3.0 + np.cos(5.0 * angle) + 0.2 * np.cos(12.0 * angle)
    uniform, quick = high_pass(angle, signal, 8.0)
    assert quick == pytest.approx(0.2 * np.cos(12.0 * uniform), abs=1e-3)
    uniform, slow = low_pass(angle, signal, 8.0)
    assert slow == pytest.approx(3.0 + np.cos(5.0 * uniform), abs=1e-3)


def test_orders_between_those_of_the_shaft_need_revolutions_enough() -> None:
    """Six waves in eleven turns are resolved; what is slower than a half is not."""
    angle = np.arange(11 * 360) * TURN / 360.0
    signal = 200.0 + np.cos(6.0 / 11.0 * angle) + np.cos(5.0 / 11.0 * angle)
    assert resolved_spectrum(angle, signal).order == pytest.approx([6.0 / 11.0])
