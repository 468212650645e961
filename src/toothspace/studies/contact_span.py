"""Teeth that carry the contact forces of a gerotor, and what makes up its torque."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.case.study import ContactSpanStudy
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.results.solution import Solution
from toothspace.studies.measured import read_measured
from toothspace.studies.points import collected, operating_values, point, status_of
from toothspace.studies.records import Record, failed_count
from toothspace.studies.study import StudyContext, StudyResult
from toothspace.studies.tabulate import columns, numbers_table, record_arrays

if TYPE_CHECKING:
    import xarray as xr

_CLEARANCE = "machine.rotors.tip_clearance"
_THEORY = "machine.contact.theory"
_MECHANISM = "contact_friction"

_NUMBERS = (
    ("span_pitches", "span (pitches)"),
    ("least_teeth_loaded", "least teeth loaded"),
    ("most_teeth_loaded", "most teeth loaded"),
    ("mean_contact_force_N", "mean contact force (N)"),
    ("largest_contact_force_N", "largest contact force (N)"),
    ("mean_torque_N_m", "mean torque (N m)"),
    ("contact_friction_torque_N_m", "contact friction (N m)"),
    ("gap_friction_torque_N_m", "gap friction (N m)"),
)


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case as it stands and over ``study.tip_clearance`` and ``pressure_difference``.

    Returns
    -------
    StudyResult
        Over ``point`` the span of contact (one pitch in single-contact theory), teeth loaded,
        forces and torques; over ``shaft_angle`` torques and tooth forces of the case itself.

    Raises
    ------
    CaseError
        If the case is no steady gerotor, or no point can be run.
    """
    import xarray as xr

    study = case.study
    assert isinstance(study, ContactSpanStudy)
    if case.operating_point is None or not hasattr(case.machine, "rotors"):
        allowed = "allowed a steady case of a gerotor"
        raise CaseError(f"{case.source}: study.kind: found no rotors to turn, {allowed}")
    waveforms = _waveforms(case)
    if study.measured is not None:
        waveforms = waveforms.merge(_measured(study.measured, case.operating_point.shaft_speed))
    rotors, ports = case.machine.rotors, case.operating_point
    clearances = study.tip_clearance or (rotors.tip_clearance,)
    own = ports.outlet_pressure - ports.inlet_pressure
    pairs = list(product(clearances, study.pressure_difference or (own,)))
    points = [
        point(
            case,
            {_CLEARANCE: f"{clearance * 1e6:.12g} um"}
            | operating_values(outlet_pressure=ports.inlet_pressure + difference),
        )
        for clearance, difference in pairs
    ]
    records = collected(points, context, ContactNumbers(study.force_fraction))
    heads = {
        "tip clearance (um)": [1e6 * clearance for clearance, _ in pairs],
        "pressure difference (bar)": [1e-5 * difference for _, difference in pairs],
    }
    clearance, difference = np.array(pairs).T
    varied: dict[str, Any] = {
        "tip_clearance": ("point", clearance, {"units": "m"}),
        "pressure_difference": ("point", difference, {"units": "Pa"}),
    }
    return StudyResult(
        status=status_of(records),
        data=waveforms.merge(xr.Dataset(varied | record_arrays(records))),
        numbers=_numbers(pairs, records, waveforms),
        tables=(numbers_table("contact_span", heads, _NUMBERS, records),),
    )


@final
@dataclass(frozen=True)
class ContactNumbers:
    """Runs a case and returns the numbers of its contacts."""

    share: float
    """Share of the mean total contact force that counts as contact. [-]"""

    @property
    def label(self) -> str:
        """What is evaluated."""
        return f"contacts above {self.share!r}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Span, teeth loaded, forces and torques beside the summary numbers."""
        from toothspace import api
        from toothspace.results.tooth_contacts import tooth_forces

        solution = api.simulate(case)
        found = tooth_forces(solution.data, api.describe(case))
        loaded = found.loaded(self.share)
        mechanisms = [str(name) for name in solution.data["mechanism"].values]
        means = np.asarray(solution.data["torque_loss"]).mean(axis=0)
        losses = dict(zip(mechanisms, means, strict=True))
        contact = losses.pop(_MECHANISM)
        return {
            "span_pitches": found.span(self.share),
            "least_teeth_loaded": int(loaded.min()),
            "most_teeth_loaded": int(loaded.max()),
            "mean_contact_force_N": found.mean_total,
            "largest_contact_force_N": float(found.force.max()),
            "contact_friction_torque_N_m": float(contact),
            "gap_friction_torque_N_m": float(sum(losses.values())),
            **solution.summary(),
        }


def _waveforms(case: Case) -> xr.Dataset:
    """Torques from ideal to complete and with a single contact, and the forces of the teeth."""
    import xarray as xr

    from toothspace import api
    from toothspace.results.tooth_contacts import tooth_forces

    complete = api.simulate(case.at_point({}))
    ideal = api.simulate(case.at_point({"run.fidelity": "ideal"}))
    single = api.simulate(case.at_point({_THEORY: "single"}))
    angle = _last_turn(complete)
    found = tooth_forces(complete.data, api.describe(case))
    friction = np.asarray(complete.data["torque_loss"].sel(mechanism=_MECHANISM))
    torque = np.asarray(complete.data["shaft_torque"])
    torques = {
        "ideal_torque": _torque(ideal, angle),
        "torque_with_gaps": torque - friction,
        "shaft_torque": torque,
        "single_contact_torque": _torque(single, angle),
    }
    pascal = {"units": "Pa"}
    means = [_mean_torque(ideal), _mean_torque(complete) - float(friction.mean())]
    means += [_mean_torque(complete), _mean_torque(single)]
    forces = (("shaft_angle", "tooth"), found.force, {"units": "N"})
    places = (("shaft_angle", "tooth"), found.place, {"units": "rad"})
    return xr.Dataset(
        {name: ("shaft_angle", values, {"units": "N m"}) for name, values in torques.items()}
        | {"outlet_pressure": ("shaft_angle", np.asarray(complete.data["outlet_pressure"]), pascal)}
        | {"tooth_force": forces, "tooth_place": places}
        | {"mean_torque": ("stage", means, {"units": "N m"})},
        coords={"shaft_angle": ("shaft_angle", angle, {"units": "rad"}), "stage": list(torques)},
    )


def _measured(path: Path, shaft_speed: float) -> xr.Dataset:
    """Measured columns over the shaft angle; without that column, at constant speed."""
    import xarray as xr

    found = read_measured(path)
    if found.times is None:
        raise CaseError(f"{path}: columns: found no time, allowed signals over 'time [s]'")
    channels = dict(found.channels)
    angle = channels.pop("shaft_angle", shaft_speed * found.times)
    if angle[-1] - angle[0] < 2.0 * np.pi:
        raise CaseError(f"{path}: time: found less than a turn, allowed whole revolutions")
    return xr.Dataset(
        {f"measured_{name}": ("measured_sample", values) for name, values in channels.items()}
        | {"measured_angle": ("measured_sample", angle, {"units": "rad"})}
    )


def _last_turn(solution: Solution) -> Array:
    angle = np.asarray(solution.data["shaft_angle"], dtype=float)
    return angle - angle[0]


def _mean_torque(solution: Solution) -> float:
    """Mean of the ledger: it has the short impacts between the samples. [N m]."""
    return float(solution.summary()["mean_torque_N_m"])


def _torque(solution: Solution, angle: Array) -> Array:
    """Shaft torque of another run of the same machine at the same angles within a turn."""
    own = _last_turn(solution)
    return np.asarray(
        np.interp(angle, own, np.asarray(solution.data["shaft_torque"]), period=2.0 * np.pi)
    )


def _numbers(
    pairs: Sequence[tuple[float, float]], records: Sequence[Record], waveforms: xr.Dataset
) -> dict[str, Any]:
    means = {
        f"mean_{name}_N_m": float(waveforms["mean_torque"].sel(stage=name))
        for name in waveforms["stage"].values
    }
    found = columns(records)
    return {
        **means,
        "points": len(records),
        "points_failed": failed_count(records),
        "tip_clearance_um": [1e6 * clearance for clearance, _ in pairs],
        "pressure_difference_bar": [1e-5 * difference for _, difference in pairs],
        **{name: found[name] for name, _ in _NUMBERS if name in found},
        "point_status": [r.status for r in records],
    }
