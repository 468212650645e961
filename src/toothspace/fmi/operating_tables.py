"""A machine as tables over pressure difference, shaft speed and shaft angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.types import Array
from toothspace.results.performance import lost_flow_rate, mean_torque, means_by_label
from toothspace.results.ripple import whole_revolutions

if TYPE_CHECKING:
    import xarray as xr

    from toothspace.studies.study import Record

PULSATING = ("inlet_flow_rate", "outlet_flow_rate", "shaft_torque")
"""Results of which the ripple is tabulated."""

MEANS: Mapping[str, tuple[str, str]] = {
    "inlet_flow_rate": ("m3/s", "Mean flow into the machine at inlet pressure"),
    "outlet_flow_rate": ("m3/s", "Mean flow out of the machine at outlet pressure"),
    "drain_flow_rate": ("m3/s", "Mean flow from the chambers to the drain"),
    "leakage": ("m3/s", "Mean flow through all gaps from the high to the low port"),
    "lost_flow_rate": ("m3/s", "Flow that the volumetric efficiency lacks"),
    "shaft_torque": ("N m", "Mean torque, absorbed by a pump, delivered by a motor"),
    "hydraulic_power": ("W", "Mean power given to the fluid by a pump, taken by a motor"),
    "power_loss": ("W", "Mean power that the machine dissipates"),
}
"""Tables of mean values: unit and meaning."""

_TURN = 2.0 * np.pi
_UNEVEN = 0.1
"""Share of the ripple by which teeth may differ and count as equal, root mean square. [-]"""


@final
class ShaftSamples:
    """Runs a case: mean values from its ledger, and ripple over a turn of its shaft."""

    label = "shaft samples"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Return lists over the shaft angle, numbers, and warnings of the run."""
        from toothspace import api

        solution = api.simulate(case)
        summary = solution.summary()
        if not solution.status.succeeded:
            return summary
        warnings = [warning.sentence for warning in solution.warnings]
        data, found = solution.data, {}
        for name in PULSATING:
            angle, values, turns = whole_revolutions(data["shaft_angle"].values, data[name].values)
            steps = angle.size // turns
            at = np.arange(steps) * (_TURN / steps)
            # angles of the last revolutions, which begin anywhere
            turned = np.interp(at, angle[-steps:], values[-steps:], period=_TURN)
            found[f"{name}_ripple"] = (turned - turned.mean()).tolist()
        data, ledger = solution.data, solution.ledger
        flows = {
            f"{port}_flow_rate": ledger.mass[port]
            / (ledger.duration * float(data[f"{port}_density"]))
            for port in ("inlet", "outlet")
        }
        powers = {
            "hydraulic_power": abs(ledger.port_energy) / ledger.duration,
            "power_loss": ledger.loss_energy / ledger.duration,
        }
        return {
            **found,
            **flows,
            **powers,
            "drain_flow_rate": float(data["drain_flow_rate"].mean()),
            "leakage": sum(means_by_label(data, "leakage").values()),
            "lost_flow_rate": lost_flow_rate(data, ledger),
            "shaft_torque": mean_torque(data, ledger),
            "displacement": float(data["displacement"]),
            "warnings": warnings,
            **summary,
        }


def tables_of(
    records: Sequence[Record], pressures: Sequence[float], speeds: Sequence[float], teeth: int
) -> xr.Dataset:
    """Tables of a machine from its runs.

    Mean values over ``shaft_speed`` and ``pressure_difference``, ripple also over ``shaft_angle``
    of one period: a tooth pitch, or a turn where the teeth differ. ``ripple_left_out`` is what the
    mean tooth leaves out of the ripple, root mean square. [-]

    Parameters
    ----------
    records : sequence of Record
        What :class:`ShaftSamples` gave, speeds running slowest.
    pressures, speeds : sequence of float
        Pressure differences [Pa] and shaft speeds [rad/s].
    teeth : int
        Periods that a turn of the shaft has if all teeth are alike. [-]
    """
    import xarray as xr

    grid = ("shaft_speed", "pressure_difference")
    shape = (len(speeds), len(pressures))
    numbers = [record.numbers for record in records]
    means = {
        name: (grid, np.array([one[name] for one in numbers]).reshape(shape), _about(*text))
        for name, text in MEANS.items()
    }
    turns = {name: np.array([one[f"{name}_ripple"] for one in numbers]) for name in PULSATING}
    pitches = {name: _mean_tooth(values, teeth) for name, values in turns.items()}
    uneven = max(uneven for _, uneven in pitches.values())
    even = uneven < _UNEVEN
    period = _TURN / teeth if even else _TURN
    ripples = {name: pitches[name][0] if even else turns[name] for name in PULSATING}
    steps = ripples[PULSATING[0]].shape[1]
    waves = {
        f"{name}_ripple": (
            (*grid, "shaft_angle"),
            values.reshape(*shape, steps),
            _about(MEANS[name][0], "Deviation from the mean over one period"),
        )
        for name, values in ripples.items()
    }
    angles = np.arange(steps) * (period / steps)
    constants = {
        "displacement": ((), numbers[0]["displacement"], _about("m3/rad", "Geometric volume")),
        "period": ((), period, _about("rad", "Period of the ripple over the shaft angle")),
        "ripple_left_out": ((), uneven if even else 0.0, _about("1", "Ripple not tabulated")),
    }
    axes = {
        "shaft_speed": ("shaft_speed", list(speeds), _about("rad/s", "Shaft speed")),
        "pressure_difference": (
            "pressure_difference",
            list(pressures),
            _about("Pa", "Inlet minus outlet pressure of a motor, outlet minus inlet of a pump"),
        ),
        "shaft_angle": ("shaft_angle", angles, _about("rad", "Shaft angle within the period")),
    }
    return xr.Dataset(means | waves | constants, coords=axes)


def _mean_tooth(turns: Array, teeth: int) -> tuple[Array, float]:
    """Ripple of the mean tooth, and what it leaves out over the whole, root mean square."""
    steps = turns.shape[1]
    count = round(steps / teeth)
    start = np.arange(steps) * (_TURN / steps)
    at = (np.arange(teeth)[:, None] + np.arange(count) / count) * (_TURN / teeth)
    each = np.array([np.interp(at, start, turn, period=_TURN) for turn in turns])
    tooth = each.mean(axis=1)
    whole = np.sqrt(np.mean(turns**2, axis=1))
    rest = np.sqrt(np.mean((each - tooth[:, None]) ** 2, axis=(1, 2)))
    return tooth, float(np.max(rest / np.maximum(whole, np.finfo(float).tiny)))


def _about(units: str, meaning: str) -> dict[str, str]:
    return {"units": units, "long_name": meaning}
