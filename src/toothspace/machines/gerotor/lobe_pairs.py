"""Compliant contacts of the lobes as the model reads them; single-contact theory."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import scipy

from toothspace.core.types import Array
from toothspace.gearing.materials import library_material, reduced_modulus
from toothspace.geometry.curve import turned
from toothspace.machines.gerotor.bodies import BODIES, motions
from toothspace.machines.gerotor.contact_table import LobeContact, fading, lobe_contacts
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.profiles import Rotors
from toothspace.model.contact_pair import CONTACT_CHANNELS, ContactPair
from toothspace.model.description import Motion
from toothspace.numerics.periodic_table import monotone_table, sum_of_tables

_ALONG = 2e-6
_WIDER = 1.001
"""Gap of surfaces that face away over the widest of those that do not, at least. [-]"""
LAWS: dict[str, Literal["hertz_line", "johnson", "pereira"]] = {
    "hertz": "hertz_line",
    "johnson": "johnson",
    "pereira": "pereira",
}
"""Law of the model for every law of a case."""


def rotor_contacts(
    parameters: GerotorParameters, rotors: Rotors, clearance: float
) -> tuple[ContactPair, ...]:
    """Contacts of the lobes of a machine, or the one pair of single-contact theory.

    One per kind of contact: ``lobe_0`` lives longest.

    Parameters
    ----------
    parameters : GerotorParameters
        Keys ``[machine]``.
    rotors : Rotors
        Rotors at nominal position.
    clearance : float
        Normal gap of conjugate lobes there. [m]

    Notes
    -----
    Gaps are of second order about the place where the rotors run, the outer one turned until the
    driving lobes touch: farther away by that rotation the nearest places are others.
    """
    sign = 1.0 if parameters.mode == "pump" else -1.0
    turn = -sign * clearance / (rotors.outer_tooth_count * rotors.eccentricity)
    outer = turned(rotors.outer, np.asarray(turn))
    contacts = lobe_contacts(replace(rotors, outer=outer))
    if parameters.contact.theory == "single":
        contacts = (single_contact(contacts[0], sign, rotors.eccentricity),)
    return tuple(_pair(parameters, rotors, f"lobe_{k}", c, turn) for k, c in enumerate(contacts))


def _pair(
    parameters: GerotorParameters, rotors: Rotors, name: str, contact: LobeContact, turn: float
) -> ContactPair:
    settings, ratio = parameters.contact, rotors.speed_ratio
    material = library_material(parameters.rotors.material, "machine.rotors.material")
    moved = motions(parameters)
    columns = [
        contact.gap,
        np.zeros_like(contact.gap),
        contact.radius_inner,
        contact.radius_outer,
        ratio * contact.sliding,
        ratio * contact.rolling_sum,
    ]
    geometry = monotone_table(contact.period, np.column_stack(columns))
    geometry.slopes[:, 0] = np.where(contact.near, contact.gap_rate, 0.0)
    by_shifts, mixed, by_turns = contact.second_derivatives(rotors.eccentricity).T
    shift = np.sum(contact.outer_point * contact.normal, axis=1) * turn
    by_shift, by_turn = by_shifts * shift + mixed * turn, mixed * shift + by_turns * turn
    back = np.zeros((contact.gap.size, len(CONTACT_CHANNELS)))
    back[:, 0] = 0.5 * (by_shift * shift + by_turn * turn) - contact.lever * turn
    back[~contact.near] = 0.0
    along = _by_motion(rotors, contact, moved, along=True)
    about = np.array([float(m.body == BODIES[1] and m.axis == "rotation") for m in moved])
    at_place = _by_motion(rotors, contact, moved, along=False)
    by_motion = at_place - by_shift[:, None] * along - by_turn[:, None] * about
    geometry = sum_of_tables(geometry, monotone_table(contact.period, back))
    # wide clearances leave more at nominal place than what tells surfaces that face away
    apart = max(float(contact.gap.max()), _WIDER * float(geometry.values[contact.near, 0].max()))
    geometry.values[~contact.near, 0] = apart
    return ContactPair(
        name=name,
        body_a=BODIES[0],
        body_b=BODIES[1],
        angle_ratio=ratio,
        phases=np.asarray(contact.pitch * np.arange(contact.copies), dtype=float),
        geometry=geometry,
        gap_by_motion=monotone_table(contact.period, by_motion),
        slip_by_motion=monotone_table(
            contact.period, _by_motion(rotors, contact, moved, along=True)
        ),
        gap_by_shift_and_turn=monotone_table(
            contact.period, contact.second_derivatives(rotors.eccentricity)
        ),
        width=parameters.rotors.face_width,
        effective_modulus=reduced_modulus(material, material),
        roughness=float(np.sqrt(2.0) * parameters.rotors.roughness),
        boundary_friction=settings.boundary_friction,
        law=LAWS[settings.law],
        depth=half_lobe(rotors),
        restitution=settings.restitution,
        approach_speed=settings.impact_speed if settings.impact == "given" else None,
        squeeze_film=settings.squeeze_film == "on",
        facing_gap=apart,
    )


def contact_ratio(pairs: tuple[ContactPair, ...], clearance: float) -> float:
    """Mean number of places where the rotors run along each other.

    Contacts with at most this nominal gap and 2 micrometres, over all angles. [-]

    Parameters
    ----------
    clearance : float
        Normal gap of conjugate lobes. [m]
    """
    limit = clearance + _ALONG
    return float(sum(pair.count * np.mean(pair.geometry.values[:, 0] <= limit) for pair in pairs))


def half_lobe(rotors: Rotors) -> float:
    """Half thickness of an outer lobe on the pitch circle: how deep contacts deform. [m]."""
    return 0.5 * np.pi * rotors.eccentricity


def _by_motion(
    rotors: Rotors, contact: LobeContact, moved: tuple[Motion, ...], *, along: bool
) -> Array:
    """Derivatives of gap or slip by every micro-motion of both rotors."""
    direction = contact.normal
    if along:
        direction = np.column_stack([-direction[:, 1], direction[:, 0]])
    columns = np.zeros((contact.gap.size, len(moved)))
    arms = (contact.inner_point - rotors.inner_center, contact.outer_point)
    for column, motion in zip(columns.T, moved, strict=True):
        side = BODIES.index(motion.body)
        sign = (-1.0, 1.0)[side]
        if motion.axis == "rotation":
            x, y = arms[side].T
            column[:] = sign * (x * direction[:, 1] - y * direction[:, 0])
        elif motion.axis in "xy":
            column[:] = sign * direction[:, "xy".index(motion.axis)]
    return columns


def single_contact(contact: LobeContact, sign: float, eccentricity: float) -> LobeContact:
    """Contact of single-contact theory: one pair carries, over one pitch, where its arm is best.

    The same with wide gaps outside one pitch; at the ends of it load passes on.

    Parameters
    ----------
    contact : LobeContact
        The kind of contact that lives longest.
    sign : float
        1 where the inner rotor drives the outer one (pump), -1 where it is driven (motor).
    eccentricity : float
        Distance of the axes. [m]
    """
    nodes = contact.gap.size // contact.copies
    arm = np.where(contact.near, sign * contact.lever, -np.inf)
    middle = int(np.argmax(scipy.ndimage.minimum_filter1d(arm, nodes + 1, mode="wrap")))
    number = np.arange(contact.gap.size) - middle
    half = contact.gap.size // 2
    distance = np.mod(number + half, contact.gap.size) - half
    beyond = np.abs(distance) - nodes // 2
    extra, slope, wide = fading(beyond, contact.pitch / nodes, eccentricity)
    apart = extra >= wide
    return replace(
        contact,
        near=contact.near & ~apart,
        gap=np.where(apart, wide, contact.gap + extra),
        gap_rate=np.where(apart, 0.0, contact.gap_rate + slope * np.sign(distance)),
    )
