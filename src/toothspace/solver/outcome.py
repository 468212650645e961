"""From the last revolution of a march to a :class:`Solution`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from toothspace.circuit.network import END_A, END_B, PORT_NODES
from toothspace.closures.aeration import gas_volume_fraction, vapour_fraction
from toothspace.closures.density import mixture_density, mixture_pressure
from toothspace.closures.enthalpy import partial_enthalpies
from toothspace.core.finding import Finding
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, node_places
from toothspace.model.contact_data import displaced_gap, loaded_contacts, relative_rotation
from toothspace.model.description import MachineDescription, categories_of
from toothspace.model.lateral_table import FORCE_SHARE, HEIGHT_RATIO, LOAD_SCALE, MOMENT_SHARE
from toothspace.model.ledger import FRICTION_MECHANISMS, LEDGER_NAMES
from toothspace.model.path_category import (
    CIRCUIT_ORIFICE,
    LEAKAGES,
    LOAD_ORIFICE,
    PathCategory,
)
from toothspace.model.paths import by_kind
from toothspace.results.ledger import Ledger, ledger_from
from toothspace.results.performance import collapse_power, lost_flow_of
from toothspace.results.ripple import PORTS
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import has_tooth_contacts, tooth_forces
from toothspace.results.variables import LABELS, WAVES, dataset_from
from toothspace.solver.compiled_model import (
    Observation,
    evaluate_state,
    moving_energy_of,
    observe,
    wall_energy_of,
)
from toothspace.solver.cyclic import DenseStates, History
from toothspace.solver.lost_flow import Look, looks_at, lost_flow_parts, path_leakage, shares

_REPEATS = (
    "The machine repeats itself every {0} revolutions: numbers, curves and spectra are of {0}."
)
_WANDERS = (
    "The machine never repeats itself: its parts move in another way in every revolution. Numbers "
    "and curves are of {0} revolutions, which leave {1:.1g} % of the flow of the displacement and "
    "{2:.1g} % of the torque open."
)
_MARGIN = 0.1
"""Part of the range of a table by which a load may lie outside. [-]"""
_SIDES = dict(zip(PORT_NODES, ("inlet", "outlet", "drain", "outlet", "inlet"), strict=True))
"""Port to which the mass in a node counts."""


def solution_from(
    history: History, provenance: Mapping[str, str], extra: Mapping[str, Any], title: str
) -> Solution:
    """Build the solution of one revolution.

    Parameters
    ----------
    provenance : mapping
        Where the result comes from, text by name.
    extra : mapping
        Further result variables, such as ``running_in_depth`` and ``fluid_temperature``.
    """
    system = history.system
    samples, close = looks_at(history)
    seen, kinds = samples.seen, leakage_categories(system)
    ports, own = port_values(history, seen), system.arrays.chambers
    bodies = body_values(history, seen)
    angle = own.phase + np.outer(history.states[:, 0], own.ratio)
    ledger = window_ledger(history)
    ledger = replace(ledger, energy={**ledger.energy, **close.trapped_losses()})
    constants = constants_of(system, ports)
    by_pressure, by_drag = path_leakage(samples, shares(samples))
    if not has_tooth_contacts(system.description):
        teeth = {}
    else:
        contacts = bodies["contact_force"], bodies["contact_gap"]
        force, place = tooth_forces(history.states[:, 0], *contacts, system.description)
        teeth = {"tooth_force": force, "tooth_place": place}
    # flow that would lose the same power from the high to the low port
    condition = system.condition
    span = abs(condition.inlet_pressure - condition.outlet_pressure)
    power = seen.path_flow * seen.path_drop / seen.density[:, [system.description.inlet_node]]
    flow = _into_drains(system, seen)
    leaking = [system.categories.index(category) for category in kinds]
    category = system.arrays.path_index[:, col.CATEGORY]
    of_kind = (category[:, None] == leaking).astype(float)
    values = {
        **ports,
        **constants,
        **_line_flow(history, seen),
        **chamber_values(system, seen),
        "chamber_volume": seen.volume[:, : system.arrays.size.chambers],
        "chamber_angle": np.mod(angle, 2.0 * np.pi),
        "opening_area": samples.openings,
        **bodies,
        **loss_values(history, seen),
        **lateral_values(history, seen),
        "path_label": np.array([category.label for category in kinds], dtype=str),
        "path_colour": np.array([category.colour for category in kinds], dtype=str),
        "leakage": (by_pressure + by_drag)[:, leaking]
        / seen.density[:, [system.description.inlet_node]],
        "equivalent_leakage": power @ of_kind / (span or np.inf),
        "drain_flow_rate": np.asarray(flow / seen.density[:, system.description.inlet_node]),
        # at the shaft, of walls that drag fluid to higher pressure
        "drag_torque": -(seen.path_drag * seen.path_drop) @ of_kind,
        **_dense_values(history, close),
        **teeth,
        **extra,
    }
    motor = system.description.mode == "motor"
    density, displacement = float(constants["inlet_density"]), system.description.displacement
    parts = lost_flow_parts(close, lost_flow_of(ledger, density, displacement, motor=motor))
    values["lost_flow"] = np.array(list(parts.values()))
    labels = {**labels_of(system), "flow_part": list(parts)}
    if "tooth_force" in values:
        labels["tooth"] = [f"tooth_{k}" for k in range(values["tooth_force"].shape[1])]
    data = dataset_from(values, labels, attributes=attributes_of(system.description, title))
    solution = Solution(
        status=history.status,
        data=data,
        ledger=ledger,
        statistics=history.statistics,
        provenance=provenance,
        events=history.events,
    )
    return solution if history.spanned == 1 else solution.with_note(*_of_several(history))


def _of_several(history: History) -> Iterator[Finding]:
    """What to say of a machine that does not repeat itself after one revolution."""
    if history.mean_errors is None:
        yield Finding("warning", _REPEATS.format(history.spanned), severity="note")
    else:
        flow, torque = history.mean_errors
        yield Finding("warning", _WANDERS.format(history.spanned, 100 * flow, 100 * torque))


def _dense_values(history: History, close: Look) -> dict[str, Array]:
    """Waves at the ports and extremes of a revolution, from states closer than its samples.

    Where these are those of one of its alike parts, every chamber and contact of a kind meets there
    what each of them meets in the revolution.
    """
    system, seen, times = history.system, close.seen, close.history.times
    waves = {**port_values(close.history, seen), **_line_flow(close.history, seen)}
    chambers = chamber_values(system, seen)
    found = {name: waves[name] for name in ("inlet_pressure", "outlet_pressure", "shaft_torque")}
    flows = {}
    for port in PORTS:
        # at all dense states, where the flow has narrow peaks
        node = node_places(system.description, system.condition)[port]
        dense = history.dense or DenseStates(history.times, history.states)
        stored = _stored_rate(system, dense.times, dense.states, port)
        going, density = _leaving(system, close.seen, node), close.seen.density[:, node]
        flow = (stored + np.interp(dense.times, times, going)) / np.interp(
            dense.times, times, density
        )
        flows[f"{port}_flow_rate"] = -flow if port == "inlet" else flow
    found |= flows
    found["chamber_pressure"] = chambers["chamber_pressure"]
    positions = _body_positions(close.history)
    names = [body.name for body in system.description.bodies]
    journals = _journal_values(system, positions, names, _block_position(close.history))
    if "journal_film_height" in journals:
        found["journal_film_height"] = journals["journal_film_height"]
    values, alike = {}, {"chamber_pressure": [f.count for f in system.description.families]}
    if system.arrays.size.contacts:
        found["contact_force"] = seen.contact_force
        carries = seen.contact_force[: max(times.size - 1, 1)] > 0.0
        pairs = loaded_contacts(system.description, system.condition)
        part = np.concatenate([np.full(pair.count, pair.part) for pair in pairs])
        alike["contact_force"] = [pair.count for pair in pairs]
        share = carries.mean(axis=0)
        if close.copies > 1:
            share = _of_kind(np.mean, share, alike["contact_force"])
        values["contact_loaded_share"] = part * share
    for name, signal in found.items():
        for which, extreme in (("minimum", np.min), ("maximum", np.max)):
            value = extreme(signal, axis=0)
            if close.copies > 1 and name in alike:
                value = _of_kind(extreme, value, alike[name])
            values[f"{name}_{which}"] = value
    tips = _tips(system)
    if tips:
        values["tip_gap_minimum"] = np.array([seen.raw_height[:, at].min() for at in tips.values()])
    waved = {"angle": close.history.states[:, 0]}
    waved |= {name: waves[name] for name in WAVES if name in waves}
    if close.copies > 1:
        steps = {"angle": system.description.pitch_angle}
        waved = {k: _repeated(v, close.copies, steps.get(k, 0.0)) for k, v in waved.items()}
    values |= {f"dense_{name}": wave for name, wave in waved.items()}
    volume = seen.volume[:, : system.arrays.size.chambers]
    high = max(float(waves[f"{port}_pressure"].mean()) for port in PORTS)
    power = collapse_power(chambers["chamber_vapour_fraction"], volume, times, high)
    return {**values, "vapour_collapse_power": np.asarray(power)}


def _of_kind(what: Callable[[Array], Any], values: Array, counts: Sequence[int]) -> Array:
    """Mean, least or most of the values of each kind, for all of its members."""
    ends = np.cumsum(counts)
    kinds = zip(np.split(values, ends[:-1]), counts, strict=True)
    return np.concatenate([np.full(count, what(own)) for own, count in kinds])


def _repeated(wave: Array, copies: int, step: float) -> Array:
    """Wave of a revolution from one of its parts, each a step higher; both ends included."""
    parts = wave[:-1] + step * np.arange(copies)[:, None]
    return np.append(parts.ravel(), wave[-1] + step * (copies - 1))


def _tips(system: System) -> dict[str, slice]:
    """Where the gaps of tips along a wall stand among all paths, by name."""
    found, first = {}, 0
    for path in by_kind(system.description.paths):
        if path.throat_speed != 0.0:
            found[path.name] = slice(first, first + path.count)
        first += path.count
    return found


def _into_drains(system: System, seen: Observation) -> Array:
    drains = np.array([category.role == "drain" for category in system.categories])
    return np.asarray(seen.path_flow @ drains[system.arrays.path_index[:, col.CATEGORY]])


def drain_of(history: History, ledger: Ledger) -> float:
    """Mean mass flow from the chambers to the drain, external or internal. [kg/s]."""
    outside = ledger.mass.get("drain", 0.0)
    if outside:
        return outside / ledger.duration
    return float(
        _into_drains(history.system, observe(history.system.arrays, history.states)).mean()
    )


def lateral_values(history: History, seen: Observation) -> dict[str, Array]:
    """Load and leakage of tabulated lateral films; empty without a table."""
    size, table = history.system.arrays.size, history.system.arrays.lateral
    if size.load == size.film:
        return {}
    beyond = np.zeros(len(history.states), dtype=bool)
    for k, column in enumerate((FORCE_SHARE, MOMENT_SHARE)):
        nodes = table.axes[k, : table.counts[k]]
        margin = _MARGIN * (nodes[-1] - nodes[0])
        asked = np.clip(seen.lateral[:, column], nodes[0] - margin, nodes[-1] + margin)
        beyond |= (asked != seen.lateral[:, column]) & (nodes.size > 1)
    return {
        "axial_load": history.states[:, size.film] * seen.lateral[:, LOAD_SCALE],
        "lateral_leakage_factor": seen.lateral[:, HEIGHT_RATIO] ** 3,
        "lateral_load_beyond": beyond.astype(float),
    }


def window_ledger(history: History) -> Ledger:
    """Masses and energies between the first and the last state.

    Of a circuit, ends of elements at tanks count to the inlet where they give fluid, and to the
    outlet where they take it.
    """
    system, size = history.system, history.system.arrays.size
    first, last = history.states[0], history.states[-1]
    names = (*LEDGER_NAMES, *(category.account for category in system.categories))
    change = last - first
    entries = dict(zip(names, change[size.core :], strict=False))
    orifice = entries.get(LOAD_ORIFICE.account, 0.0)
    load_work = entries.pop("shaft_load")
    valves = entries.pop("circuit") + entries.pop(CIRCUIT_ORIFICE.account, 0.0)
    beyond = 0.0 if system.condition.over_time else valves
    motor = system.description.mode == "motor"
    arrays = system.arrays
    sums: tuple[dict[str, float], ...] = tuple(
        dict.fromkeys(("inlet", "outlet", "drain"), 0.0) for _ in range(2)
    )
    for name, place in node_places(system.description, system.condition).items():
        if arrays.dynamic_index[place] >= 0:
            continue
        gained, gas = change[arrays.balance[place]]
        pressure, share = arrays.node[place, [col.PRESSURE, col.GAS]]
        of_liquid, of_gas = partial_enthalpies(pressure, share, arrays.fluid)
        port = _SIDES.get(name) or ("outlet" if gained > 0.0 else "inlet")
        sums[0][port] += float(gained)
        sums[1][port] += float((gained - gas) * of_liquid + gas * of_gas)
    mass, energy = sums[0], sums[1]
    before, after = held_in(system, first), held_in(system, last)
    held = {name: after[name] - before[name] for name in before}
    entries |= {
        "mass_inlet": -mass["inlet"],
        "mass_outlet": mass["outlet"],
        "mass_drain": mass["drain"],
        "mass_stored_change": held["mass"],
        "port_inlet": -energy["inlet"] - motor * beyond,
        "circuit": valves - beyond,
        "port_outlet": energy["outlet"] + orifice + (not motor) * beyond,
        "port_drain": energy["drain"],
        "stored_change": held["stored"],
        "kinetic_change": held["kinetic"],
        "elastic_change": held["elastic"],
    }
    if beyond:
        entries["load_orifice"] = orifice + beyond
    if system.condition.free_shaft:
        entries["shaft"] = -load_work
    return ledger_from(
        entries,
        float(history.times[-1] - history.times[0]),
        float(last[0] - first[0]),
        {c.account: c.account_label for c in categories_of(system.description.paths)},
    )


def held_in(system: System, state: Array) -> dict[str, float]:
    """What a state holds.

    ``mass`` [kg] and compression energy ``stored`` [J] of the fluid in all dynamic nodes, energy
    ``kinetic`` of bodies that move on their own, free shaft, load and fluid columns, and
    ``elastic`` of compliant contacts. [J]
    """
    arrays, size = system.arrays, system.arrays.size
    seen = observe(arrays, state[None])
    dynamic = arrays.dynamic_index >= 0
    mass = state[size.mass : size.gas]
    gas = state[size.gas : size.position]
    volume = seen.volume[0, dynamic]
    pressure, _, _ = mixture_pressure(volume / mass, gas / mass, arrays.fluid)
    of_liquid, of_gas = partial_enthalpies(pressure, gas / mass, arrays.fluid)
    stored = np.sum((mass - gas) * of_liquid + gas * of_gas - pressure * volume)
    motion, drive = arrays.motion, arrays.drive
    velocity = state[size.velocity : size.column] + motion[:, col.MOTION_RATIO] * state[1]
    shaft = drive[col.FREE] * drive[col.INERTIA] * state[1] ** 2
    bodies = 0.5 * (np.sum(motion[:, col.MOTION_MASS] * velocity**2) + shaft)
    found = {
        "mass": mass.sum(),
        "stored": stored + wall_energy_of(arrays, pressure),
        "kinetic": bodies + moving_energy_of(arrays, state),
    }
    evaluate_state(arrays, state)
    found["elastic"] = np.sum(arrays.contact[:, col.CONTACT_ENERGY])
    return {name: float(value) for name, value in found.items()}


def port_values(history: History, seen: Observation) -> dict[str, Array]:
    """Shaft, ports and flows through them, at every sample, by result variable. [SI]."""
    system = history.system
    inlet, outlet = system.description.inlet_node, system.description.outlet_node
    sign = -1.0 if system.description.mode == "motor" else 1.0
    # from masses and what goes on: wide ports turn pressure errors into noise of their own flow
    into = {}
    for port, node in (("inlet", inlet), ("outlet", outlet)):
        stored = _stored_rate(system, history.times, history.states, port)
        into[port] = (stored + _leaving(system, seen, node)) / seen.density[:, node]
    return {
        "shaft_angle": history.states[:, 0],
        "time": history.times,
        "shaft_speed": history.states[:, 1],
        "shaft_torque": sign * seen.torque[:, -1],
        "inlet_pressure": seen.pressure[:, inlet],
        "outlet_pressure": seen.pressure[:, outlet],
        "inlet_flow_rate": -into["inlet"],
        "outlet_flow_rate": into["outlet"],
    }


def constants_of(system: System, values: Mapping[str, Any]) -> dict[str, Array]:
    """Displacement and properties of the fluid at the mean pressures of the ports. [SI]."""
    fluid = system.arrays.fluid
    found = {
        f"{port}_density": mixture_density(
            float(values[f"{port}_pressure"].mean()), fluid.feed_gas_mass_fraction, fluid
        )
        for port in ("inlet", "outlet")
    }
    found["displacement"] = system.description.displacement
    found["specific_heat_capacity"] = fluid.specific_heat_capacity
    return {name: np.asarray(value) for name, value in found.items()}


def _line_flow(history: History, seen: Observation) -> dict[str, Array]:
    """Flow between the working port and its line or load, in the direction of the machine's."""
    condition = history.system.condition
    if condition.circuit is None and condition.load_area == 0.0:
        return {}
    motor = history.system.description.mode == "motor"
    port = "inlet" if motor else "outlet"
    node = node_places(history.system.description, condition)[port]
    flow = _leaving(history.system, seen, node) / seen.density[:, node]
    return {"line_flow_rate": -flow if motor else flow}


def _stored_rate(system: System, times: Array, states: Array, port: str) -> Array:
    """Rate of the mass that a port has taken up, of its volume or of what was booked. [kg/s]."""
    node = node_places(system.description, system.condition)[port]
    if times.size < 2:
        return np.full(times.size, np.nan)
    return np.asarray(np.gradient(states[:, system.arrays.balance[node, 0]], times))


def _leaving(system: System, seen: Observation, node: int) -> Array:
    """Mass flow from a node into elements, orifices and the load beyond the machine. [kg/s]."""
    arrays = system.arrays
    flow = np.zeros(seen.path_flow.shape[0])
    for j, element in enumerate(arrays.elements):
        flow += seen.element_flow[:, j] * (element[END_A] == node)
        flow -= seen.element_flow[:, j] * (element[END_B] == node)
    for j, index in enumerate(arrays.path_index):
        if system.categories[index[col.CATEGORY]].role in ("circuit", "load"):
            flow += seen.path_flow[:, j] * (index[col.NODE_A] == node)
            flow -= seen.path_flow[:, j] * (index[col.NODE_B] == node)
    return flow


def chamber_values(system: System, seen: Observation) -> dict[str, Array]:
    """Pressures of the chambers [Pa], and what gas and vapour fill of them [-], at every sample."""
    chambers, fluid = slice(0, system.arrays.size.chambers), system.arrays.fluid
    pressure, gas = seen.pressure[:, chambers], seen.gas[:, chambers]
    specific = 1.0 / seen.density[:, chambers]
    return {
        "chamber_pressure": pressure,
        "chamber_gas_fraction": gas_volume_fraction(pressure, gas, fluid),
        "chamber_vapour_fraction": vapour_fraction(specific, pressure, gas, fluid),
    }


def body_values(history: History, seen: Observation) -> dict[str, Array]:
    """Motions of the bodies, forces on them and in their contacts, at every sample. [SI]."""
    system, size = history.system, history.system.arrays.size
    names = [body.name for body in system.description.bodies]
    shape = (history.times.size, len(names), 3)
    values = {name: np.zeros(shape) for name in ("body_velocity", "body_force", "journal_force")}
    values["body_position"] = _body_positions(history)
    values |= {name: np.zeros(shape[:2]) for name in ("body_rotation", "body_moment")}
    for k, motion in enumerate(system.free_motions):
        entry = system.description.motions[motion]
        body = names.index(entry.body)
        if entry.axis == "rotation":
            values["body_rotation"][:, body] = history.states[:, size.position + k]
            values["body_moment"][:, body] = seen.pressure_force[:, k]
            continue
        where = (slice(None), body, "xyz".index(entry.axis))
        values["body_velocity"][where] = history.states[:, size.velocity + k]
        values["body_force"][where] = seen.pressure_force[:, k]
        values["journal_force"][where] = seen.film_force[:, k]
    places = system.description.face_places
    if places is not None:
        found = places.at(history.states[:, 0])
        rows = [names.index(body) for body in places.bodies]
        values |= {"body_tilt": np.zeros(shape), "face_film_height": np.full(shape[:2], np.nan)}
        values["body_position"][:, rows, 2] = found[..., 0]
        values["body_tilt"][:, rows, :2] = found[..., 1:3]
        values["face_film_height"][:, rows] = found[..., 3]
    moving = _block_position(history)
    values |= _journal_values(system, values["body_position"], names, moving)
    if moving is not None:
        values["block_position"] = moving
    if system.arrays.size.contacts:
        values["contact_force"] = seen.contact_force
        shaft_angle = history.states[:, :1]
        moved = history.states[:, size.position : size.velocity] @ system.motion_map.T
        gaps = []
        for contact in loaded_contacts(system.description, system.condition):
            angles = contact.phases + contact.angle_ratio * shaft_angle
            turns = relative_rotation(contact, system.description.motions)
            rigid = contact.geometry(angles)[..., 0]
            gaps.append(displaced_gap(contact, angles, turns, moved) if size.compliant else rigid)
        values["contact_gap"] = np.hstack(gaps)
    winding = system.description.winding
    if winding is not None:
        moments = _tooth_moments(history, seen, values["body_moment"])
        ratios = np.array([body.speed_ratio for body in system.description.bodies])
        values["axial_force"] = -winding.turn_per_length * ratios * moments
    return values


def _tooth_moments(history: History, seen: Observation, moment: Array) -> Array:
    r"""Moments of pressures and contacts about the axes of the bodies. [N m].

    Notes
    -----
    Teeth that turn by :math:`\kappa_b` per length act on a body that shifts by z as if it had
    turned by :math:`-\kappa_b z`, so that :math:`F_b = -\kappa_b M_b` is their axial force.
    Together these moments do the work of the pressures over the shaft angle:
    :math:`\sum_b i_b M_b = \sum_i p_i\,dV_i/d\varphi` with the speed ratios :math:`i_b`.
    """
    system, angle = history.system, history.states[:, 0]
    description = system.description
    names = [body.name for body in description.bodies]
    moments = moment.copy()
    for motion in system.free_motions:
        entry = description.motions[motion]
        if entry.axis == "rotation":
            own, first = names.index(entry.body), 0
            for pair in loaded_contacts(description, system.condition):
                force = seen.contact_force[:, first : first + pair.count]
                places = pair.phases + pair.angle_ratio * angle[:, None]
                moments[:, own] += np.sum(force * pair.gap_by_motion(places)[..., motion], axis=1)
                first += pair.count
    rates = [
        family.angle_ratio
        * family.volume.derivative(family.phases + family.angle_ratio * angle[:, None])[..., 0]
        for family in description.families
    ]
    work = np.sum(seen.pressure[:, : description.chamber_count] * np.hstack(rates), axis=1)
    ratios = np.array([body.speed_ratio for body in description.bodies])
    shaft = [body.role for body in description.bodies].index("shaft")
    moments[:, shaft] = 0.0
    moments[:, shaft] = work - moments @ ratios
    return moments


def _body_positions(history: History) -> Array:
    """Displacement of every body from its nominal centre. [m]."""
    system, first = history.system, history.system.arrays.size.position
    names = [body.name for body in system.description.bodies]
    found = np.zeros((history.times.size, len(names), 3))
    for k, motion in enumerate(system.free_motions):
        entry = system.description.motions[motion]
        if entry.axis != "rotation":
            place = (slice(None), names.index(entry.body), "xyz".index(entry.axis))
            found[place] = history.states[:, first + k]
    return found


def _block_position(history: History) -> Array | None:
    """Displacement of bearing blocks that move, the last two free motions. [m]."""
    free, size = len(history.system.free_motions), history.system.arrays.size
    if free == size.motions:
        return None
    found = np.zeros((history.times.size, 3))
    found[:, :2] = history.states[:, size.position + free : size.velocity]
    return found


def _journal_values(
    system: System, position: Array, names: list[str], moving: Array | None = None
) -> dict[str, Array]:
    ratio = np.zeros(position.shape[:2])
    heights = []
    seat = np.zeros((len(names), 3))
    for body, journal in zip(journal_bodies(system), system.arrays.journal, strict=False):
        b, clearance = names.index(body), journal[col.JOURNAL_CLEARANCE]
        seat[b, :2] = journal[col.BUSH_X], journal[col.BUSH_Y]
        middle = seat[b, :2] if moving is None else moving[:, :2]
        eccentricity = np.hypot(*(position[:, b, :2] - middle).T)
        ratio[:, b] = eccentricity / clearance
        heights.append(clearance - eccentricity)
    values = {"journal_eccentricity_ratio": ratio, "seat_position": seat}
    return values | ({"journal_film_height": np.stack(heights, axis=1)} if heights else {})


def journal_bodies(system: System) -> list[str]:
    """Bodies in journal bearings, in the order of the bearings."""
    free, motions = system.free_motions, system.description.motions
    places = [int(row[col.MOTION_X]) for row in system.arrays.journal]
    return [motions[free[place]].body for place in places if place < len(free)]


def loss_values(history: History, seen: Observation) -> dict[str, Array]:
    """Friction torque [N m] and power [W] by mechanism, at every sample."""
    present = history.system.description.friction_mechanisms
    torque = seen.torque[:, [FRICTION_MECHANISMS.index(name) for name in present]]
    return {"torque_loss": torque, "power_loss": torque * history.states[:, 1:2]}


def leakage_categories(system: System) -> list[PathCategory]:
    """Categories of the paths of a machine that leak, in the order of the dimension ``path``."""
    return [category for category in system.categories if category.role in LEAKAGES]


def attributes_of(description: MachineDescription, title: str) -> dict[str, str]:
    """What every result says of its machine besides the title of its case."""
    return {"title": title, "machine": description.name, "mode": description.mode}


def labels_of(system: System) -> dict[str, list[str]]:
    """Labels of all dimensions of a result."""
    description = system.description
    return {
        "chamber": description.chamber_labels,
        "body": [body.name for body in description.bodies],
        "journal": journal_bodies(system),
        "axis": list(LABELS["axis"]),
        "contact": system.contact_labels,
        "path": [category.name for category in leakage_categories(system)],
        "mechanism": list(description.friction_mechanisms),
        "tip": list(_tips(system)),
        "port": list(LABELS["port"]),
    }
