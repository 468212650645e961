"""Draw ``gerotor_contacts.png``: contacts of a rotor pair and their gaps over the angle.

Run from the root of the repository: ``PYTHONPATH=. python docs/pictures/gerotor_contacts.py``.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from tests.drawn_rotors import ECCENTRICITY, INNER_COUNT, OUTER_COUNT, cycloidal
from toothspace.geometry.curve import turned
from toothspace.machines.gerotor.contact_table import LobeContact, lobe_contacts
from toothspace.machines.gerotor.profiles import Rotors
from toothspace.plotting.style import BLUE, CYCLE, GREY, INK, ORANGE, styled

CLEARANCE = 40e-6
DISPLACEMENT, ROTATION = (-3.3e-6, -5.7e-6), -2.1e-3  # mean with 20 um at the faces
NODE = 20


def draw_section(axes: plt.Axes, rotors: Rotors, contacts: tuple[LobeContact, ...]) -> None:
    """Rotors at one angle with the normals of all contacts."""
    pitch_point = np.array([0.0, -1e3 * OUTER_COUNT * ECCENTRICITY])
    nodes = contacts[0].gap.size // contacts[0].copies
    angle = NODE * contacts[0].pitch / nodes
    place = np.linspace(0.0, 1.0, 2000)
    inner_curve, outer_curve = rotors.inner_curve, rotors.outer_curve
    inner = turned(inner_curve.point(place * inner_curve.length), rotors.turns * angle)
    outer = turned(outer_curve.point(place * outer_curve.length), np.asarray(angle))
    axes.plot(*(1e3 * (inner - [0.0, ECCENTRICITY])).T, color=INK, linewidth=1.0)
    axes.plot(*(1e3 * outer).T, color=GREY, linewidth=1.0)
    for color, contact in zip(CYCLE, contacts, strict=False):
        rows = NODE + nodes * np.arange(contact.copies)
        for row in rows[contact.near[rows]]:
            point = 1e3 * contact.outer_point[row]
            axes.plot(*np.array([point, pitch_point]).T, color=color, linewidth=0.5)
            axes.plot(*point, "o", color=color, markersize=4)
    axes.plot(*pitch_point, "s", color=ORANGE, markersize=5)
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title("Contacts, normals, pitch point")


def draw_gaps(
    axes: plt.Axes, nominal: tuple[LobeContact, ...], lagging: tuple[LobeContact, ...]
) -> None:
    """Gaps of all kinds of contact over the angle: nominal and where the rotors run."""
    shifted = [contact.normal @ np.array(DISPLACEMENT) for contact in lagging]
    for contacts, moved, style in ((nominal, [0.0] * len(nominal), ":"), (lagging, shifted, "-")):
        for color, contact, shift in zip(CYCLE, contacts, moved, strict=False):
            angle = np.degrees(np.arange(contact.gap.size) * contact.period / contact.gap.size)
            shown = np.where(contact.near, 1e6 * (contact.gap + shift), np.nan)
            axes.plot(angle, shown, style, color=color, linewidth=1.2)
    axes.axhline(0.0, color=BLUE, linewidth=0.6)
    axes.set_ylim(-10.0, 120.0)
    axes.set_xlabel("angle of the outer rotor [deg]")
    axes.set_ylabel("gap [µm]")
    axes.set_title("Gaps: dotted nominal, full displaced")


@styled
def draw() -> Figure:
    """Draw section and gaps side by side."""
    inner, outer = cycloidal(CLEARANCE)
    rotors = Rotors(inner, outer, INNER_COUNT, ECCENTRICITY, CLEARANCE)
    behind = replace(rotors, outer=turned(outer, np.asarray(ROTATION)))
    contacts = lobe_contacts(rotors)
    figure, (section, gaps) = plt.subplots(
        1, 2, figsize=(10.0, 4.4), layout="constrained", width_ratios=(4, 5)
    )
    draw_section(section, rotors, contacts)
    draw_gaps(gaps, contacts, lobe_contacts(behind))
    return figure


if __name__ == "__main__":
    draw().savefig(Path(__file__).with_suffix(".png"), dpi=110)
