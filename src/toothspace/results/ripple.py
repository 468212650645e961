"""Ripple of periodic results and their spectrum in orders of the shaft."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.types import Array, ComplexArray

if TYPE_CHECKING:
    import xarray as xr

AGREEMENT = 2e-4
"""Share of the mean by which revolutions that count as equal may differ: the floor of spectra."""

_TURN = 2.0 * np.pi
PORTS = ("inlet", "outlet")


@final
@dataclass(frozen=True)
class Spectrum:
    """Single-sided amplitude spectrum over shaft orders."""

    order: Array
    """Events per shaft revolution, from zero (the mean). [-]"""
    amplitude: Array
    """Amplitude of each order; the mean at order zero. [unit of the signal]"""
    phase: Array
    """Phase of the cosine of each order at shaft angle zero. [rad]"""


def whole_revolutions(shaft_angle: Array, signal: Array) -> tuple[Array, Array, int]:
    """Cut the last whole revolutions and put them on a uniform angle, end point excluded.

    Raises ValueError if the samples span less than one revolution.

    Parameters
    ----------
    shaft_angle : ndarray, shape (samples,)
        Growing shaft angle. [rad]
    signal : ndarray, shape (samples,)
        Signal. [any unit]

    Returns
    -------
    shaft_angle : ndarray
        Uniform angles. [rad]
    signal : ndarray
        Signal there. [unit of the signal]
    revolutions : int
        How many revolutions they span; at least 1.
    """
    step = float(np.median(np.diff(shaft_angle)))
    span = float(shaft_angle[-1] - shaft_angle[0])
    revolutions = int(np.floor((span + step) / _TURN + 1e-6))
    if revolutions < 1:
        raise ValueError(f"samples span {span / _TURN:.3f} revolutions, at least 1 is needed")
    count = max(round(_TURN / step), 2) * revolutions
    end = shaft_angle[-1] + step if span < revolutions * _TURN - 0.5 * step else shaft_angle[-1]
    uniform = end - revolutions * _TURN + np.arange(count) * (_TURN * revolutions / count)
    return uniform, np.interp(uniform, shaft_angle, signal), revolutions


def spectrum(shaft_angle: Array, signal: Array) -> Spectrum:
    r"""Amplitudes of the harmonics of the shaft.

    Amplitude and phase over the order. [unit of the signal, rad]

    Parameters
    ----------
    shaft_angle : ndarray, shape (samples,)
        Growing shaft angle over at least one revolution. [rad]
    signal : ndarray, shape (samples,)
        Signal. [any unit]

    Notes
    -----
    Discrete Fourier transform over a whole number of revolutions, so that no window is
    needed: :math:`s(\varphi) = \bar s + \sum_k a_k \cos(k\varphi + \alpha_k)`.
    """
    angle, values, revolutions = whole_revolutions(shaft_angle, signal)
    coefficients = np.fft.rfft(values) / values.size
    order = np.arange(coefficients.size) / revolutions
    amplitude = np.abs(coefficients) * 2.0
    amplitude[0] = coefficients[0].real
    phase = np.angle(coefficients * np.exp(-1j * order * angle[0]))
    return Spectrum(order, amplitude, phase)


def resolved_spectrum(shaft_angle: Array, signal: Array) -> Spectrum:
    """Spectrum without the mean and without amplitudes below :data:`AGREEMENT` of it."""
    found = spectrum(shaft_angle, signal)
    floor = AGREEMENT * max(abs(float(np.mean(signal))), np.finfo(float).tiny)
    kept = (found.order > 0.5) & (found.amplitude > floor)
    return Spectrum(found.order[kept], found.amplitude[kept], found.phase[kept])


def harmonics(shaft_angle: Array, signal: Array, orders: Array) -> ComplexArray:
    """Complex amplitudes of a periodic signal at shaft orders, phases of the cosine.

    Peak amplitudes. [unit of the signal]

    Parameters
    ----------
    shaft_angle, signal : ndarray, shape (samples,)
        As for :func:`spectrum`. [rad], [any unit]
    orders : ndarray
        Orders; the nearest resolved ones are taken. [-]
    """
    found = spectrum(shaft_angle, signal)
    places = np.argmin(np.abs(found.order[:, None] - np.asarray(orders)), axis=0)
    return np.asarray(found.amplitude[places] * np.exp(1j * found.phase[places]))


@final
@dataclass(frozen=True)
class PulsationSource:
    """A pump or motor as a source of pulsation, one entry for each harmonic."""

    flow: ComplexArray
    """Flow ripple that it would drive into a circuit without impedance. [m3/s]"""
    impedance: ComplexArray
    """Source impedance, in parallel to that flow. [Pa s/m3]"""
    misfit: Array
    """Root mean square of what the loads leave unexplained, over the source flow; zero with two
    loads. [-]
    """

    @property
    def blocked_pressure(self) -> ComplexArray:
        """Pressure ripple into a circuit of infinite impedance. [Pa]."""
        return np.asarray(self.flow * self.impedance)

    def pressure_into(self, load: complex) -> ComplexArray:
        """Pressure ripple into a load impedance [Pa s/m3]; an endless line is anechoic. [Pa]."""
        return np.asarray(self.flow / (1.0 / self.impedance + 1.0 / load))


def pulsation_source(pressure: ComplexArray, flow: ComplexArray) -> PulsationSource:
    r"""Source flow and source impedance from pressures and flows at a port against several loads.

    Source that fits all loads.

    Parameters
    ----------
    pressure, flow : ndarray of complex, shape (loads, harmonics)
        Amplitudes at the port with at least two different loads. [Pa], [m3/s]

    Notes
    -----
    Norton source :math:`Q = Q_s - P/Z_s` for every harmonic, by least squares over the loads.
    Validity: small ripple, so that the machine answers linearly, at the same mean pressure.

    References
    ----------
    .. [1] ISO 10767-1, *Hydraulic fluid power - Determination of pressure ripple levels generated
       in systems and components*, part 1: its source flow, source impedance, blocked acoustic and
       anechoic pressure ripple; there a second source changes the load, here the line does.
    """
    source, impedance, misfit = [], [], []
    for p, q in zip(pressure.T, flow.T, strict=True):
        scale = float(np.max(np.abs(p))) or 1.0
        matrix = np.column_stack([np.ones_like(p), -p / scale])
        found = np.linalg.lstsq(matrix, q, rcond=None)[0]
        error = np.sqrt(np.mean(np.abs(matrix @ found - q) ** 2))
        source.append(found[0])
        impedance.append(scale / found[1] if found[1] != 0.0 else np.inf)
        misfit.append(error / max(abs(found[0]), 1e-300))
    return PulsationSource(np.array(source), np.array(impedance), np.array(misfit))


def distinct_samples(data: xr.Dataset) -> xr.Dataset:
    """Leave out the last sample if it closes a whole number of revolutions.

    Otherwise the first angle would count twice in means over the samples.
    """
    if "shaft_angle" not in data.sizes or data.sizes["shaft_angle"] < 3:
        return data
    turns = float(data["shaft_angle"][-1] - data["shaft_angle"][0]) / _TURN
    closed = round(turns) >= 1 and abs(turns - round(turns)) < 1e-6
    return data.isel(shaft_angle=slice(0, -1)) if closed else data


def wave(data: xr.Dataset, name: str) -> tuple[Array, Array]:
    """Shaft angle and values of a variable at the ports, as close as the result holds them.

    A steady run keeps them at states that do not hang on its samples.
    """
    dense = f"dense_{name}"
    if dense in data:
        return np.asarray(data["dense_angle"]), np.asarray(data[dense])
    return np.asarray(data["shaft_angle"]), np.asarray(data[name])


def extremes(data: xr.Dataset, name: str) -> tuple[Array, Array]:
    """Smallest and largest values of a variable over a run, one for each label. [its unit]."""
    if f"{name}_minimum" in data:
        return np.asarray(data[f"{name}_minimum"]), np.asarray(data[f"{name}_maximum"])
    if name not in data:
        return np.full(1, np.nan), np.full(1, np.nan)
    values = np.asarray(data[name])
    return values.min(axis=0), values.max(axis=0)


def _span(data: xr.Dataset, name: str) -> float:
    lowest, highest = extremes(data, name)
    return float(highest - lowest)


def _percent(data: xr.Dataset, name: str) -> float:
    """Largest minus smallest value over the magnitude of the mean. [%]."""
    values = wave(data, name)[1]
    mean = abs(float(np.mean(values[:-1] if f"dense_{name}" in data else values)))
    return 100.0 * _span(data, name) / mean if mean > 0.0 else float("nan")


def ripple_percent(signal: Array) -> float:
    """Return the largest minus the smallest value over the magnitude of the mean. [%]."""
    mean = abs(float(np.mean(signal)))
    return 100.0 * float(np.ptp(signal)) / mean if mean > 0.0 else float("nan")


def working_side(data: xr.Dataset) -> str:
    """Return the port where a machine works on its circuit: pump outlet, motor inlet."""
    return "inlet" if data.attrs.get("mode") == "motor" else "outlet"


def flow_ripple_percent(data: xr.Dataset) -> float:
    """Return the flow ripple at the working port. [%]."""
    return _percent(data, f"{working_side(data)}_flow_rate")


def pulsating_side(data: xr.Dataset) -> str:
    """Return the port with the larger pressure ripple; the working port if there is none."""
    ptp = {side: _span(data, f"{side}_pressure") for side in PORTS}
    working = working_side(data)
    other = next(side for side in PORTS if side != working)
    return other if ptp[other] > ptp[working] else working


def pressure_ripple(data: xr.Dataset) -> float:
    """Return the peak-to-peak pressure at the port where it is larger. [Pa]."""
    return _span(data, f"{pulsating_side(data)}_pressure")


def torque_ripple_percent(data: xr.Dataset) -> float:
    """Return the ripple of the shaft torque. [%]."""
    return _percent(data, "shaft_torque")


def high_pass(shaft_angle: Array, signal: Array, lowest_order: float) -> tuple[Array, Array]:
    """Take low orders out of a periodic signal, as filtered measurements have none.

    Parameters
    ----------
    shaft_angle : ndarray, shape (samples,)
        Growing shaft angle over at least one revolution. [rad]
    signal : ndarray, shape (samples,)
        Signal. [any unit]
    lowest_order : float
        Lowest order that stays; the mean and everything below it goes. [events per revolution]

    Returns
    -------
    shaft_angle : ndarray
        Uniform angles of the last whole revolutions. [rad]
    signal : ndarray
        Filtered signal. [unit of the signal]
    """
    return _band(shaft_angle, signal, lowest_order, np.inf)


def low_pass(shaft_angle: Array, signal: Array, highest_order: float) -> tuple[Array, Array]:
    """Take high orders out of a periodic signal, as a slow sensor does.

    As of :func:`high_pass`. [rad], [unit of the signal]

    Parameters
    ----------
    shaft_angle : ndarray, shape (samples,)
        Growing shaft angle over at least one revolution. [rad]
    signal : ndarray, shape (samples,)
        Signal, so often that no order above half the samples of a revolution matters. [any unit]
    highest_order : float
        Highest order that stays, with the mean. [events per revolution]
    """
    return _band(shaft_angle, signal, 0.0, highest_order)


def _band(shaft_angle: Array, signal: Array, lowest: float, highest: float) -> tuple[Array, Array]:
    uniform, values, revolutions = whole_revolutions(shaft_angle, signal)
    parts = np.fft.rfft(values)
    order = np.arange(parts.size) / revolutions
    parts[(order < lowest) | (order > highest)] = 0.0
    return uniform, np.asarray(np.fft.irfft(parts, values.size), dtype=float)
