"""Contacts of a description as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.contact_cylindrical import in_pereira_range, pereira_force
from toothspace.closures.contact_law import (
    hertz_scale,
    impact_damping,
    johnson_scale,
    logarithmic_law,
    series_level,
)
from toothspace.core.types import Array, BoolArray
from toothspace.model import arrays as col
from toothspace.model.contact_pair import CONTACT_CHANNELS, ContactPair, RigidMesh
from toothspace.model.description import MachineDescription, Motion
from toothspace.model.ledger import FRICTION_MECHANISMS
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.packed_tables import OPEN
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table

_FLATTEST = 100.0
"""Largest radius of relative curvature of a contact over its width. [-]"""
_LEAST_SCALE = 1e-4
"""Least length scale of the elastic law over the width of the contact. [-]"""
_DEPTHS = np.array([1e-3, 1e-5])
"""Depths over the width of the contact at which a power follows Hertz's law. [-]"""


@final
@dataclass(frozen=True)
class ContactParts:
    """Tables, members and constants of the contacts that carry load."""

    tables: list[PeriodicTable]
    pairs: list[ContactPair]
    gate: int
    data: Array
    counts: dict[str, int]


def rigid_mesh(description: MachineDescription, condition: OperatingCondition) -> RigidMesh | None:
    """Return the rigid mesh of a machine, or None where contacts are compliant."""
    return None if condition.compliant_mesh else description.mesh


def loaded_contacts(
    description: MachineDescription, condition: OperatingCondition
) -> list[ContactPair]:
    """List the pairs that carry load: the one of the rigid mesh, or else all."""
    mesh = rigid_mesh(description, condition)
    return [c for c in description.contacts if mesh is None or c.name == mesh.contact]


def held_by_contacts(description: MachineDescription, condition: OperatingCondition) -> BoolArray:
    """Which motions change the gap of a compliant contact."""
    held = np.zeros(len(description.motions), dtype=bool)
    if rigid_mesh(description, condition) is None:
        for contact in description.contacts:
            held |= np.any(contact.gap_by_motion.values != 0.0, axis=0)
    return held


def contact_parts(
    description: MachineDescription, condition: OperatingCondition, motion_map: Array
) -> ContactParts:
    """Collect the arrays of all contacts that carry load."""
    contacts = loaded_contacts(description, condition)
    compliant = rigid_mesh(description, condition) is None
    each = [
        replace(contact, geometry=geometry)
        for contact in contacts
        for geometry in contact.own or (contact.geometry,)
    ]
    if compliant:
        tables = [compliant_table(contact, motion_map) for contact in each]
    else:
        tables = [contact.geometry for contact in each]
    count = sum(contact.count for contact in contacts)
    turns = [relative_rotation(contact, description.motions) @ motion_map for contact in contacts]
    rows = []
    for contact, turn in zip(contacts, turns, strict=True):
        constants, speed = np.zeros(col.CONTACT_COLUMNS), contact.approach_speed
        constants[col.PAIR_MODULUS], constants[col.PAIR_ROUGHNESS] = (
            contact.effective_modulus,
            contact.roughness,
        )
        constants[col.PAIR_BOUNDARY], constants[col.PAIR_LIMIT] = (
            contact.boundary_friction,
            contact.limiting_shear,
        )
        constants[col.PAIR_WIDTH] = contact.width
        constants[col.PAIR_ONSET] = contact.roughness if contact.onset is None else contact.onset
        constants[col.PAIR_POWER_LAW] = contact.law in ("pereira", "linear")
        constants[col.PAIR_ACCOUNT] = FRICTION_MECHANISMS.index(contact.friction_account)
        constants[col.PAIR_SQUEEZE] = contact.squeeze_film
        if speed is None:
            constants[col.PAIR_LOSS] = impact_damping(contact.restitution, 1.0)
        else:
            constants[col.PAIR_DAMPING] = impact_damping(contact.restitution, speed)
        rows += [np.append(constants, turn)] * contact.count
    return ContactParts(
        tables=tables,
        pairs=contacts,
        gate=col.POSSIBLE if compliant else OPEN,
        data=np.array(rows, dtype=float).reshape(count, col.CONTACT_COLUMNS + motion_map.shape[1]),
        counts={"contacts": count, "compliant": count if compliant else 0},
    )


def relative_rotation(contact: ContactPair, motions: Sequence[Motion]) -> Array:
    """Rotation of body b relative to body a by every motion. Shape (motions,). [-]."""
    sign = {contact.body_a: -1.0, contact.body_b: 1.0}
    turns = [sign.get(m.body, 0.0) if m.axis == "rotation" else 0.0 for m in motions]
    return np.array(turns, dtype=float)


def displaced_gap(contact: ContactPair, angle: Array, turns: Array, motion: Array) -> Array:
    """Gap of a compliant contact where its bodies are. Shape (samples, contacts). [m].

    Parameters
    ----------
    angle : ndarray
        Table angles. Shape (samples, contacts). [rad]
    turns : ndarray
        :func:`relative_rotation` of the contact.
    motion : ndarray
        Micro-motions. Shape (samples, motions). [m], [rad]
    """
    gap = contact.geometry(angle)[..., 0]
    gap = gap + np.sum(contact.gap_by_motion(angle) * motion[:, None, :], axis=2)
    if contact.gap_by_shift_and_turn is None or contact.slip_by_motion is None:
        return np.asarray(gap, dtype=float)
    shift = np.sum(contact.slip_by_motion(angle) * motion[:, None, :], axis=2)
    turn = (motion @ turns)[:, None]
    by_shifts, mixed, by_turns = np.moveaxis(contact.gap_by_shift_and_turn(angle), -1, 0)
    gap += 0.5 * (by_shifts * shift**2 + 2.0 * mixed * shift * turn + by_turns * turn**2)
    return np.asarray(gap, dtype=float)


def compliant_table(contact: ContactPair, motion_map: Array) -> PeriodicTable:
    """Join what compiled code reads of a compliant contact, in the order of its columns."""
    geometry, motions = contact.geometry, motion_map.shape[1]
    values = np.zeros((geometry.values.shape[0], col.GAP_BY_MOTION + 2 * motions))
    slopes = np.zeros_like(values)
    places = {"gap": col.GAP, "sliding_speed": col.SLIDING, "rolling_speed_sum": col.ROLLING}
    for name, column in places.items():
        channel = CONTACT_CHANNELS.index(name)
        values[:, column] = geometry.values[:, channel]
        slopes[:, column] = geometry.slopes[:, channel]
    law = monotone_table(geometry.period, _law_columns(contact))
    columns = [col.CURVATURE, col.LAW_LEVEL, col.LAW_EXPONENT]
    values[:, columns], slopes[:, columns] = law.values, law.slopes
    values[:, col.POSSIBLE] = geometry.values[:, 0] < contact.facing_gap
    if contact.gap_by_shift_and_turn is not None:
        values[:, col.BY_SHIFTS : col.GAP_BY_MOTION] = contact.gap_by_shift_and_turn.values
        slopes[:, col.BY_SHIFTS : col.GAP_BY_MOTION] = contact.gap_by_shift_and_turn.slopes
    first = col.GAP_BY_MOTION
    for table in (contact.gap_by_motion, contact.slip_by_motion):
        if table is not None:
            values[:, first : first + motions] = table.values @ motion_map
            slopes[:, first : first + motions] = table.slopes @ motion_map
        first += motions
    return PeriodicTable(geometry.period, values, slopes)


def _law_columns(contact: ContactPair) -> Array:
    """Relative curvature, level and exponent of the elastic law at the table nodes."""
    geometry = contact.geometry.values
    first, second = (geometry[:, CONTACT_CHANNELS.index(f"radius_{side}")] for side in "ab")
    columns = np.zeros((geometry.shape[0], 3))
    flattest, least = 1.0 / (_FLATTEST * contact.width), _LEAST_SCALE * contact.width
    columns[:, 0] = np.maximum(np.abs(1.0 / first + 1.0 / second), flattest)
    contact_modulus = 0.5 * contact.effective_modulus
    if contact.law == "linear":
        columns[:, 1:] = np.log(contact.structure_stiffness / contact.width), 1.0
    elif contact.law == "pereira":
        facing = geometry[:, 0] < contact.facing_gap
        level = np.log(np.maximum(hertz_scale(first, second, contact.depth), least))
        depths = _DEPTHS * contact.width
        # outside the range of Pereira's law, as near an inflection, the power law follows Hertz
        level_and_power = np.zeros((first.size, 2))
        level_and_power[:, 1] = 1.0
        for i in np.flatnonzero(facing):
            difference = abs(first[i] + second[i])
            internal = bool(first[i] * second[i] < 0.0)
            if in_pereira_range(difference, internal):
                force = pereira_force(depths, difference, 1.0, contact_modulus, internal)
            else:
                force = [logarithmic_law(d, level[i], contact_modulus)[0] for d in depths]
            level_and_power[i, 1] = np.log(force[0] / force[1]) / np.log(depths[0] / depths[1])
            level_and_power[i, 0] = np.log(force[0]) - level_and_power[i, 1] * np.log(depths[0])
        columns[:, 1:] = level_and_power
    else:
        scale = johnson_scale(first, second)
        if contact.law == "hertz_line":
            scale = hertz_scale(first, second, contact.depth)
        stiffness = contact.structure_stiffness / contact.width
        columns[:, 1] = series_level(np.maximum(scale, least), contact_modulus, stiffness)
    return columns
