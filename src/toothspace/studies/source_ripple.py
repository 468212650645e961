"""A machine as a source of pulsation: source flow and source impedance, after ISO 10767-1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, QuantityKey, grid, integer
from toothspace.core.types import Array
from toothspace.plotting.style import BLUE, GREEN, ORANGE, StudyFigure, new_figure, styled
from toothspace.results.ripple import (
    PulsationSource,
    harmonics,
    pulsation_source,
    wave,
    working_side,
)
from toothspace.studies.points import collected, point, status_of
from toothspace.studies.study import Record, Study, StudyContext, StudyResult, StudyTable

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_BAR = 1e5
_LITRE_PER_MINUTE = 6e4


@final
@dataclass(frozen=True, kw_only=True)
class SourceRippleStudy(KeyTable):
    """``kind = "source_ripple"``: source flow and source impedance from lines of two lengths."""

    line_length: tuple[float, ...] = grid(
        QuantityKey(unit="m", above=0, high=1000),
        "Lengths of operating_point.line, at least two; its cells keep their length.",
    )
    harmonics: int = integer(
        "Harmonics of the tooth frequency, ISO 10767-1 asks for ten.", low=1, high=40, default=10
    )

    def __post_init__(self) -> None:
        if len(set(self.line_length)) < 2:
            raise CaseError("line_length", f"{len(self.line_length)} length", "two or more")


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case with lines of several lengths and find the source that fits all of them.

    Parameters
    ----------
    case : Case
        Steady case with ``operating_point.line`` and ``kind = "source_ripple"``.

    Returns
    -------
    StudyResult
        Over ``harmonic`` of the tooth frequency: source flow, source impedance, blocked acoustic
        and anechoic pressure ripple; over ``load`` the pressure ripple with each length.

    Raises
    ------
    CaseError
        If the case has no line, or fewer than two lengths can be run.
    """
    study, operating = case.study, case.operating_point
    assert isinstance(study, SourceRippleStudy)
    if operating is None or operating.line is None or not case.run.preset.has_losses:
        allowed = "allowed a steady case with operating_point.line and compressible fluid"
        raise CaseError(f"{case.source}: study.kind: found no line to pulsate in, {allowed}")
    step = operating.line.length / operating.line.cells
    values = [
        {
            "operating_point.line.length": f"{length:.12g} m",
            "operating_point.line.cells": max(round(length / step), 2),
        }
        for length in study.line_length
    ]
    records = collected(
        [point(case, value) for value in values], context, PortHarmonics(study.harmonics)
    )
    good = [record for record in records if "pressure_real" in record.numbers]
    if len(good) < 2:
        raise CaseError(f"{case.source}: study.line_length: fewer than two lengths could be run")
    source = pulsation_source(_complex(good, "pressure"), _complex(good, "flow"))
    data = _dataset(case, study, source, good, records)
    columns_of = {name: np.asarray(data[name]) for name in data if data[name].dims == ("harmonic",)}
    columns: dict[str, Array] = {
        "harmonic": np.asarray(data["harmonic"]),
        "order": columns_of["order"],
        "frequency (Hz)": columns_of["frequency"],
        "source flow (L/min)": columns_of["source_flow"] * _LITRE_PER_MINUTE,
        "phase of source flow (deg)": np.degrees(columns_of["source_flow_phase"]),
        "source impedance (N s/m5)": columns_of["source_impedance"],
        "phase of source impedance (deg)": np.degrees(columns_of["source_impedance_phase"]),
        "anechoic pressure ripple (bar)": columns_of["anechoic_pressure"] / _BAR,
        "blocked pressure ripple (bar)": columns_of["blocked_pressure"] / _BAR,
        "misfit (%)": 100.0 * columns_of["misfit"],
    }

    def rms(name: str) -> float:
        return float(np.sqrt(0.5 * np.sum(np.asarray(data[name]) ** 2)))

    def listed(name: str, factor: float = 1.0) -> list[float]:
        return (np.asarray(data[name]) * factor).tolist()

    return StudyResult(
        status=status_of(records),
        data=data,
        numbers={
            "source_flow_rms_L_per_min": rms("source_flow") * _LITRE_PER_MINUTE,
            "anechoic_pressure_rms_bar": rms("anechoic_pressure") / _BAR,
            "blocked_pressure_rms_bar": rms("blocked_pressure") / _BAR,
            "largest_misfit_percent": 100.0 * float(np.max(data["misfit"])),
            "frequency_Hz": listed("frequency"),
            "source_flow_L_per_min": listed("source_flow", _LITRE_PER_MINUTE),
            "source_impedance_N_s_per_m5": listed("source_impedance"),
            "source_impedance_phase_deg": listed("source_impedance_phase", 180.0 / np.pi),
            "anechoic_pressure_bar": listed("anechoic_pressure", 1.0 / _BAR),
            "blocked_pressure_bar": listed("blocked_pressure", 1.0 / _BAR),
            "line_length_m": listed("line_length"),
            "pressure_ripple_bar": listed("pressure_ripple", 1.0 / _BAR),
        },
        tables=(
            StudyTable.of("source", {head: column.tolist() for head, column in columns.items()}),
        ),
    )


@final
@dataclass(frozen=True)
class PortHarmonics:
    """Runs a case; harmonics of pressure and line flow at its working port, ``count`` of them."""

    count: int

    @property
    def label(self) -> str:
        """What is evaluated."""
        return f"port harmonics {self.count}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Real and imaginary parts beside the summary numbers."""
        from toothspace import api

        solution = api.simulate(case)
        data, teeth = solution.data, api.describe(case).families[0].count
        orders = teeth * np.arange(1.0, self.count + 1)
        side = working_side(data)
        pressure = harmonics(*wave(data, f"{side}_pressure"), orders)
        flow = harmonics(*wave(data, "line_flow_rate"), orders)
        flow *= -1.0 if side == "inlet" else 1.0
        return {
            "teeth": teeth,
            "pressure_real": pressure.real.tolist(),
            "pressure_imag": pressure.imag.tolist(),
            "flow_real": flow.real.tolist(),
            "flow_imag": flow.imag.tolist(),
            **solution.summary(),
        }


def _complex(records: Sequence[Record], name: str) -> Any:
    return np.array(
        [
            np.array(r.numbers[f"{name}_real"]) + 1j * np.array(r.numbers[f"{name}_imag"])
            for r in records
        ]
    )


def _dataset(
    case: Case,
    study: SourceRippleStudy,
    source: PulsationSource,
    good: Sequence[Record],
    records: Sequence[Record],
) -> xr.Dataset:
    import xarray as xr

    from toothspace import api

    operating = case.operating_point
    assert operating is not None
    assert operating.line is not None
    is_motor = getattr(case.machine, "mode", "") == "motor"
    pressure = operating.inlet_pressure if is_motor else operating.outlet_pressure
    line = operating.line.characteristic_impedance(pressure, api.fluid_of(case))
    harmonic = np.arange(1.0, study.harmonics + 1)
    order = int(good[0].numbers["teeth"]) * harmonic
    curves: dict[str, tuple[Array, str]] = {
        "order": (order, "1"),
        "frequency": (order * operating.shaft_speed / (2.0 * np.pi), "Hz"),
        "source_flow": (np.abs(source.flow), "m3/s"),
        "source_flow_phase": (np.angle(source.flow), "rad"),
        "source_impedance": (np.abs(source.impedance), "N s/m5"),
        "source_impedance_phase": (np.angle(source.impedance), "rad"),
        "anechoic_pressure": (np.abs(source.pressure_into(line)), "Pa"),
        "blocked_pressure": (np.abs(source.blocked_pressure), "Pa"),
        "misfit": (source.misfit, "1"),
    }
    ripple = [record.number("pressure_ripple_bar") * _BAR for record in records]
    return xr.Dataset(
        {name: ("harmonic", values, {"units": unit}) for name, (values, unit) in curves.items()}
        | {
            "line_length": ("load", np.array(study.line_length), {"units": "m"}),
            "pressure_ripple": ("load", np.array(ripple), {"units": "Pa"}),
        },
        coords={"harmonic": harmonic},
    )


def figures(data: xr.Dataset) -> list[StudyFigure]:
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


STUDY = Study(SourceRippleStudy, run, figures)
