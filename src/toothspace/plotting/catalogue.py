"""All figures of a result, with a caption each, and which of them a result can give."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.model.description import MachineDescription
from toothspace.plotting import (
    bodies,
    film_maps,
    geometry,
    section,
    waveforms,
)
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import has_tooth_contacts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Draw = Callable[[Solution, Any], Figure]


_TURN = 2.0 * np.pi


@final
@dataclass(frozen=True)
class FigureEntry:
    """One figure that a report can show."""

    name: str
    """Name, also of the file when figures are written."""
    caption: str
    """What to see in it."""
    chapter: str
    """Chapter of the report."""
    draw: Draw
    """Makes the figure from a solution and its machine."""
    needs: tuple[str, ...] = ()
    """Result variables without which it cannot be drawn."""
    needs_machine: bool = False
    """Whether the machine description is needed."""
    sampled: str = ""
    """``steady`` if it is over the shaft angle, ``transient`` if over time, ``start`` if it needs a
    shaft that breaks away, ``turn`` if it needs a whole revolution, empty if it can always be
    drawn.
    """
    rotors: bool | None = None
    """Only for machines whose outer body turns freely on its contacts, or only for others."""


FIGURES: tuple[FigureEntry, ...] = (
    FigureEntry(
        "gear_section",
        "Section with the pressure of every chamber at four angles within one tooth pitch; of "
        "helical teeth at three heights along the axis. Dashed: relief grooves, and ports in the "
        "covers.",
        "pressure",
        section.gear_section,
        ("chamber_pressure",),
        needs_machine=True,
        sampled="steady",
    ),
    FigureEntry(
        "chamber_pressure",
        "Pressure in one chamber on its way round. Bars below: to which port or groove it is "
        "open. Shaded: free gas and vapour, where there is any.",
        "pressure",
        waveforms.chamber_pressure_over_turn,
        ("chamber_pressure",),
        sampled="steady",
    ),
    FigureEntry(
        "pocket_cycle",
        "Pressure, volume and open port areas of one pocket over a turn of the outer rotor.",
        "pressure",
        bodies.pocket_cycle,
        ("chamber_pressure", "chamber_volume", "opening_area"),
        needs_machine=True,
        sampled="turn",
        rotors=True,
    ),
    FigureEntry(
        "ripple",
        "Flow and pressure at the working port and shaft torque over one turn, with spectra of "
        "peak amplitudes down to what the run resolves, 2e-4 of the mean. Grey bands: tooth "
        "frequency and its multiples.",
        "ripple",
        waveforms.ripple_and_spectrum,
        ("inlet_flow_rate", "outlet_flow_rate", "shaft_torque"),
        sampled="turn",
    ),
    FigureEntry(
        "bearing_forces",
        "Force that the bearings of each gear carry over one turn, with its spectrum.",
        "ripple",
        waveforms.bearing_force_spectra,
        ("journal_force", "journal_film_height"),
        sampled="turn",
    ),
    FigureEntry(
        "axial_force",
        "Axial force of pressure and helical teeth on each gear over one turn, with its spectrum; "
        "positive along z.",
        "ripple",
        waveforms.axial_force_spectra,
        ("axial_force",),
        sampled="turn",
    ),
    FigureEntry(
        "speed_and_pressure",
        "Shaft speed and pressure difference; shaded: lowest to highest value within a row.",
        "time",
        waveforms.speed_and_pressure,
        ("pressure_difference_highest",),
        sampled="transient",
    ),
    FigureEntry(
        "electric_drive",
        "Speed, torque of motor and machine, and electric power with what becomes of it.",
        "time",
        waveforms.electric_drive,
        ("electric_power", "drive_torque", "shaft_torque", "pressure_difference"),
        sampled="transient",
    ),
    FigureEntry(
        "breakaway_zoom",
        "The shaft stands still until the pressure overcomes the breakaway torque.",
        "time",
        waveforms.breakaway_zoom,
        ("pressure_difference",),
        sampled="start",
    ),
    FigureEntry(
        "torque_shares",
        "Torque of the load and of every friction mechanism.",
        "time",
        waveforms.torque_shares,
        ("torque_loss", "load_torque"),
        sampled="transient",
    ),
    FigureEntry(
        "stribeck_path",
        "Friction torque over speed: from breakaway through mixed to full films, and back.",
        "time",
        waveforms.stribeck_path,
        ("torque_loss",),
        sampled="transient",
    ),
    FigureEntry(
        "torque_ripple",
        "Shaft torque over a turn: as it is, and high-pass filtered as measurements are shown, "
        "without what a shaft that whirls adds.",
        "ripple",
        bodies.torque_ripple,
        ("shaft_torque",),
        needs_machine=True,
        sampled="turn",
        rotors=True,
    ),
    FigureEntry(
        "time_history",
        "Speed, torque, pressures and flows over time.",
        "time",
        waveforms.time_history,
        ("inlet_flow_rate", "outlet_flow_rate", "shaft_torque"),
        sampled="transient",
    ),
    FigureEntry(
        "volumes",
        "Volume of a chamber and its exact derivative. The smallest volume is in the mesh.",
        "geometry",
        lambda _, machine: geometry.volumes(machine),
        needs_machine=True,
    ),
    FigureEntry(
        "groove_timing",
        "Groove timing: ports and grooves that every chamber is open to over one turn, and "
        "openings with the trapped volume where it is smallest.",
        "geometry",
        lambda _, machine: geometry.groove_timing(machine),
        needs_machine=True,
    ),
    FigureEntry(
        "openings",
        "Open area from a chamber to ports and relief grooves.",
        "geometry",
        lambda _, machine: geometry.openings(machine),
        needs_machine=True,
    ),
    FigureEntry(
        "journal_orbits",
        "Path of the gear centres inside the clearance of their bearings. The cross marks the "
        "centre of the bearing, which rests against the housing. Below: the same path, magnified.",
        "bodies",
        bodies.journal_orbits,
        ("body_position",),
    ),
    FigureEntry(
        "force_polar",
        "Pressure force on the gears over a turn; the arrow is its mean.",
        "bodies",
        bodies.force_polar,
        ("body_force",),
    ),
    FigureEntry(
        "contact_forces",
        "Forces between the teeth; steps show where a tooth pair takes over.",
        "bodies",
        waveforms.contact_forces,
        ("contact_force",),
        sampled="steady",
        rotors=False,
    ),
    FigureEntry(
        "tooth_contact_forces",
        "Contact force of every tooth of the outer rotor, and how many are loaded at a time.",
        "bodies",
        lambda solution, _: bodies.tooth_contact_forces(solution),
        ("tooth_force",),
        sampled="steady",
        rotors=True,
    ),
    FigureEntry(
        "contact_span",
        "Contact force over the place of a tooth, the largest pocket at the top. Single-contact "
        "theory has each tooth carry over one pitch.",
        "bodies",
        lambda solution, _: bodies.contact_span(solution),
        ("tooth_force",),
        sampled="turn",
        rotors=True,
    ),
    FigureEntry(
        "lateral_films",
        "Films beside the gears, seen from the floating side: height, pressure and asperity "
        "pressure at the last shaft angle, and the wear indicator (asperity pressure times "
        "sliding speed) as a mean over the revolution. White: tooth spaces, or no contact.",
        "bodies",
        film_maps.lateral_films,
        ("film_wear_power", "film_radius"),
    ),
    FigureEntry(
        "casing_wear",
        "Depth that the gears cut into the casing at the break-in condition. It belongs on the "
        "low-pressure side.",
        "bodies",
        bodies.casing_wear,
        ("running_in_depth",),
    ),
    FigureEntry(
        "ledger_waterfall",
        "From supplied to delivered power.",
        "losses",
        waveforms.ledger_waterfall,
    ),
    FigureEntry("loss_bars", "Every loss by cause.", "losses", waveforms.loss_bars),
    FigureEntry(
        "torque_breakdown",
        "Friction torque by mechanism, as felt at the shaft.",
        "losses",
        waveforms.torque_breakdown,
        ("torque_loss",),
    ),
    FigureEntry(
        "leakage_by_path",
        "Leakage by path, each flow by the share of the way to low pressure that it falls.",
        "losses",
        waveforms.leakage_by_path,
        ("leakage",),
    ),
)
"""Figures in the order of the report."""


def available_figures(
    solution: Solution, description: MachineDescription | None = None
) -> list[FigureEntry]:
    """List the figures that a result, with or without its machine, can give."""
    return [entry for entry in FIGURES if _possible(entry, solution, description)]


def machine_figure(description: MachineDescription, name: str, **options: Any) -> Figure:
    """Draw a machine before any run: ``section``, ``volumes`` or ``openings``."""
    draw = {
        "section": section.machine_section,
        "volumes": geometry.volumes,
        "openings": geometry.openings,
    }
    return draw[name](description, **options)


def _possible(
    entry: FigureEntry, solution: Solution, description: MachineDescription | None
) -> bool:
    if any(name not in solution.data for name in entry.needs):
        return False
    steady, turns = "shaft_angle" in solution.data.sizes, 0.0
    if steady and solution.data.sizes["shaft_angle"] > 2:
        angle = solution.data["shaft_angle"].values
        turns = (angle[-1] - angle[0] + angle[1] - angle[0]) / _TURN
    sampled = {
        "": True,
        "transient": not steady,
        "start": entry.sampled == "start" and bool(np.isfinite(solution.breakaway_time)),
        "steady": turns != 0.0,
        "turn": turns > 1.0 - 1e-6,
    }
    if not sampled[entry.sampled]:
        return False
    if entry.rotors is not None and entry.rotors != (
        description is not None and has_tooth_contacts(description)
    ):
        return False
    if not entry.needs_machine:
        return entry.chapter != "losses" or solution.ledger.loss_energy > 0.0
    if description is None:
        return False
    drawn = description if description.winding is None else description.winding.section
    return entry.name != "gear_section" or drawn.chamber_outlines is not None
