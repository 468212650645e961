"""Figures of a machine as a source of pulsation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.plotting.lateral_figures import StudyFigure
from toothspace.plotting.style import BLUE, GREEN, ORANGE, new_figure, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_BAR = 1e5
_LITRE_PER_MINUTE = 6e4


def source_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return source flow and impedance, and the pressure ripple that they make."""
    return [
        StudyFigure(
            "source_ripple",
            "Source flow and source impedance by harmonics of the tooth frequency. The impedance "
            "of a volume of fluid falls with the frequency at a phase of -90°.",
            source_and_impedance(data),
        ),
        StudyFigure(
            "source_pressure",
            "Pressure ripple into a blocked port and into an endless line of the bore of the case.",
            source_pressures(data),
        ),
    ]


@styled
def source_and_impedance(data: xr.Dataset) -> Figure:
    """Amplitude of the source flow, amplitude and phase of the source impedance."""
    figure = new_figure(7.2, 5.6)
    flow, impedance, phase = figure.subplots(3, 1, sharex=True)
    hertz = np.asarray(data["frequency"])
    width = 0.35 * float(hertz[0])
    flow.bar(hertz, np.asarray(data["source_flow"]) * _LITRE_PER_MINUTE, width, color=BLUE)
    flow.set_ylabel("Source flow (L/min)")
    flow.set_title("Source by harmonics of the tooth frequency, peak amplitudes")
    impedance.semilogy(hertz, np.asarray(data["source_impedance"]), "o-", color=ORANGE)
    impedance.set_ylabel("Impedance (N s/m⁵)")
    phase.plot(hertz, np.degrees(data["source_impedance_phase"]), "o-", color=GREEN)
    phase.set_ylim(-180.0, 180.0)
    phase.set_yticks([-180, -90, 0, 90, 180])
    phase.set(ylabel="Its phase (deg)", xlabel="Frequency (Hz)")
    return figure


@styled
def source_pressures(data: xr.Dataset) -> Figure:
    """Blocked acoustic and anechoic pressure ripple by harmonics."""
    figure = new_figure(7.2, 3.2)
    axes = figure.subplots()
    hertz = np.asarray(data["frequency"])
    width = 0.28 * float(hertz[0])
    for name, color, shift in (("blocked", BLUE, -0.5), ("anechoic", ORANGE, 0.5)):
        values: Array = np.asarray(data[f"{name}_pressure"]) / _BAR
        rms = float(np.sqrt(0.5 * np.sum(values**2)))
        label = f"{name}, r.m.s. {rms:.3g} bar"
        axes.bar(hertz + shift * width, values, width, color=color, label=label)
    axes.set_title("Pressure ripple, peak amplitudes")
    axes.set_ylabel("Pressure (bar)")
    axes.set_xlabel("Frequency (Hz)")
    axes.legend()
    return figure
