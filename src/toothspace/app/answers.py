"""What a machine answers: solved anew after every change, from where the last answer ended."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, final

import numpy as np

from toothspace.api import describe, prepare, simulate
from toothspace.app.drawing import cells_of, rounded
from toothspace.case import Case
from toothspace.core.files import plain
from toothspace.core.finding import status_line
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.section import section_at
from toothspace.results.ledger import loss_causes
from toothspace.results.solution import Solution
from toothspace.results.variables import CURVES
from toothspace.run.heating import HeatSearch
from toothspace.run.run import Marches, Run
from toothspace.run.running_in import Tracks
from toothspace.solver.cyclic import History
from toothspace.solver.lost_flow import chamber_leakage

_BAR, _LITRE_PER_MINUTE = 1e5, 6e4
_QUICK = "lumped"
_MOST_POINTS = 361
_WAVES = (
    "outlet_pressure",
    "inlet_pressure",
    "outlet_flow_rate",
    "inlet_flow_rate",
    "shaft_torque",
)
_COURSE = ("shaft_speed", "pressure_difference")
"""Curves over the shaft angle, and over time."""


@final
class Answers:
    """Solutions of one machine under change.

    A quick answer keeps the run-in casing and the warmth of the films of the last full one and
    begins at its cyclic state; a full answer is that of :func:`toothspace.simulate`.
    """

    def __init__(self) -> None:
        self.march: History | None = None
        """States of the last one, None of presets without."""
        self._last: History | None = None
        self._tracks: Tracks | None = None
        self._warm: MachineDescription | None = None
        self.solution: Solution | None = None
        self.machine: MachineDescription | None = None
        """The last one, and its machine."""

    def quick(self, case: Case, progress: Progress | None = None) -> Solution:
        """Solve a case as it stands, from the last cyclic state; other presets in full."""
        if case.run.fidelity != _QUICK or case.operating_point is None:
            return self.full(case, progress)
        run = prepare(case)
        run = self._worn(run, progress).with_films(progress)
        marches = Marches(run, progress, self._last, by_pitch=True)
        machine = _as_warm(run.machine, self._warm)
        found = marches(machine)
        if found.status is not Status.DONE and self._last is not None:
            marches = Marches(run, progress)
            found = marches(machine)
        # what films and oil warm up to with these losses, without a further round
        heat = HeatSearch(case, run.machine)
        heat.agree_with(found)
        self._last, self.solution, self.machine = marches.last, heat.solution, machine
        self.march = self._last
        return self.solution

    def full(self, case: Case, progress: Progress | None = None) -> Solution:
        """Solve a case with its own running-in and the temperatures that its films reach."""
        if case.run.fidelity != _QUICK or case.operating_point is None:
            self.solution, self.march = simulate(case, progress), None
            self.machine = self.solution.description
            return self.solution
        run = prepare(case).worn(progress)
        self._tracks = run.tracks
        run = run.with_films(progress)
        marches, heat = Marches(run, progress, self._last), HeatSearch(case, run.machine)
        while not heat.agree_with(marches(heat.machine)):
            pass
        self._last, self._warm = marches.last, heat.machine
        self.solution, self.machine = heat.solution, heat.machine
        self.march = self._last
        return self.solution

    def _worn(self, run: Run, progress: Progress | None) -> Run:
        """Run on the casing of the last full answer, if gears of the same kind cut it."""
        tracks, machine = self._tracks, run.machine
        worn = {p.worn_by: p.geometry.values.shape[0] for p in machine.paths if p.worn_by}
        if tracks is None or {body: depth.size for body, depth in tracks.depths.items()} != worn:
            run = run.worn(progress)
            self._tracks = run.tracks
            return run
        return replace(run, machine=machine.with_running_in(tracks.depths), tracks=tracks)


def _as_warm(machine: MachineDescription, warm: MachineDescription | None) -> MachineDescription:
    """Machine whose films have the viscosity of those of another one of its kind."""
    if warm is None or warm.name != machine.name or len(warm.paths) != len(machine.paths):
        return machine
    ratios = {film.body: film.viscosity_ratio for film in warm.laterals}
    journals = {film.body: film.viscosity_ratio for film in warm.journals}
    return replace(
        machine,
        laterals=tuple(
            replace(film, viscosity_ratio=ratios.get(film.body, 1.0)) for film in machine.laterals
        ),
        journals=tuple(
            replace(film, viscosity_ratio=journals.get(film.body, 1.0)) for film in machine.journals
        ),
        paths=tuple(
            replace(path, viscosity_ratio=other.viscosity_ratio)
            for path, other in zip(machine.paths, warm.paths, strict=True)
        ),
    )


def told(solution: Solution) -> dict[str, Any]:
    """Return what there is to know of a solution: the sentence on its status, and findings."""
    return {
        "sentence": status_line(solution.status, solution.findings),
        "findings": [finding.to_dict() for finding in solution.findings],
    }


def shown(
    solution: Solution, machine: MachineDescription | None = None, *, findings: bool = True
) -> dict[str, Any]:
    """Return a solution as the bench shows it: numbers, findings, curves over a turn, losses.

    Parameters
    ----------
    solution : Solution
        The answer.
    machine : MachineDescription, optional
        Its machine, where it is at hand.
    findings : bool
        Whether to look for findings too, a tenth of a second in which a quick answer is waited
        for; None stands for them otherwise.
    """
    found: dict[str, Any] = {
        "status": solution.status.name.lower(),
        **(told(solution) if findings else {"sentence": solution.status.value, "findings": None}),
        "done": solution.status.succeeded,
        "numbers": plain(solution.summary()),
        "case": solution.provenance.get("case_hash", ""),
        "preset": solution.provenance.get("preset", ""),
    }
    found["losses"] = [
        {"cause": loss.cause, "label": loss.label, "watt": plain(loss.power)}
        for loss in loss_causes(solution.ledger)
    ]
    turns = "shaft_angle" in solution.data.sizes
    machine = machine or (solution.description if turns else None)
    if turns and machine is not None:
        found["turn"] = _turn(solution, machine)
    elif "time" in solution.data.sizes:
        found["course"] = _course(solution)
    return found


def _course(solution: Solution) -> dict[str, Any]:
    """Curves over time, thinned to what a screen shows."""
    data = solution.data
    time = np.asarray(data["time"])
    own = slice(None, None, max(1, -(-time.size // (2 * _MOST_POINTS))))
    curves = {}
    for name in (*_COURSE, *_WAVES):
        label, unit, factor = CURVES[name]
        if name in data and data[name].dims == ("time",):
            curves[name] = _curve(label, unit, factor * np.asarray(data[name])[own])
    return {"time": rounded(time[own]), "curves": curves}


def _turn(solution: Solution, description: MachineDescription) -> dict[str, Any]:
    """Curves over one turn of the shaft, thinned to what a screen shows."""
    data = solution.data
    angle = np.degrees(np.asarray(data["shaft_angle"]))
    every = max(1, -(-(angle.size - 1) // (_MOST_POINTS - 1)))
    own = slice(None, None, every)
    curves: dict[str, Any] = {}
    if "chamber_pressure" in data:
        for family in description.families:
            chamber = f"{family.name}_0"
            if chamber in data["chamber"] and np.any(family.volume.slopes):
                trace = np.asarray(data["chamber_pressure"].sel(chamber=chamber))
                name = family.name.removesuffix("_space").replace("_", " ")
                label = f"Pressure, {name} space" if name != "pocket" else "Pressure, pocket"
                curves[f"pressure_{family.name}"] = _curve(label, "bar", trace[own] / _BAR)
        gas = data.get("chamber_gas_fraction")
        if gas is not None:
            most = np.asarray(gas.sel(chamber=f"{description.families[0].name}_0"))
            curves["gas"] = _curve("Free gas", "%", 100.0 * most[own])
    for name in _WAVES:
        label, unit, factor = CURVES[name]
        if name in data:
            curves[name] = _curve(label, unit, factor * np.asarray(data[name])[own])
    if "body_force" in data:
        for body in data["body"].values:
            force = np.asarray(data["body_force"].sel(body=body))[own]
            label = f"Pressure force, {str(body).replace('_', ' ')}"
            curves[f"force_{body}"] = _curve(label, "N", np.hypot(force[:, 0], force[:, 1]))
    return {"angle": rounded(angle[own] - angle[0]), "curves": curves}


def _curve(label: str, unit: str, values: Any) -> dict[str, Any]:
    return {"label": label, "unit": unit, "values": rounded(values, 5)}


def turning_answer(
    case: Case, solution: Solution, march: History | None = None, frames: int = 24
) -> dict[str, Any]:
    """Return a machine turning through one pitch: outlines, pressures, gas, leakage and forces.

    Lengths in mm, pressures in bar, flows that leave chambers through gaps in L/min.

    Parameters
    ----------
    case : Case
        Case with a machine.
    solution : Solution
        Its answer.
    march : History, optional
        States of the answer, where they are at hand; there is no leakage without.
    frames : int
        Pictures of one pitch.
    """
    description, data = describe(case), solution.data
    angle = np.asarray(data["shaft_angle"])
    asked = angle[0] + np.arange(frames) / frames * description.pitch_angle
    pressure = np.asarray(data["chamber_pressure"])
    places = [int(np.argmin(np.abs(angle - one))) for one in asked]
    # of teeth that wind, the section in the middle of their width
    cuts = [section_at(description, float(one), 0.0) for one in asked]

    def drawn(values: Array) -> list[list[float | None]]:
        return [rounded(row[cut.chambers], 4) for row, cut in zip(values, cuts, strict=True)]

    found = {
        "shaft": [float(one) for one in asked],
        "angle": rounded(np.degrees(asked - angle[0])),
        "cells": [cells_of(cut) for cut in cuts],
        "pressure": drawn(pressure[places] / _BAR),
        "ports": {
            port: rounded(np.asarray(data[f"{port}_pressure"])[places] / _BAR, 4)
            for port in ("inlet", "outlet")
        },
    }
    if "chamber_gas_fraction" in data:
        gas = np.asarray(data["chamber_gas_fraction"])[places]
        found["gas"] = drawn(100.0 * gas)
    if march is not None and len(march.states) == angle.size:
        states = replace(march, times=march.times[places], states=march.states[places], dense=None)
        found["leakage"] = drawn(_LITRE_PER_MINUTE * chamber_leakage(states))
    if "body_force" in data:
        found["forces"] = {
            str(body): [rounded(row[:2], 4) for row in np.asarray(data["body_force"])[places, k]]
            for k, body in enumerate(data["body"].values)
        }
    return found
