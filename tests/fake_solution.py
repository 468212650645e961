"""A made-up but plausible result of a 12-tooth gear motor, for tests of results and plots."""

from __future__ import annotations

import numpy as np

from toothspace.core.status import Event, Status
from toothspace.core.types import Array
from toothspace.model.description import (
    Body,
    ChamberFamily,
    DesignCheck,
    FlowPath,
    LumpedJournalBearing,
    MachineDescription,
    Motion,
)
from toothspace.model.path_category import (
    DRAIN,
    INLET_GROOVE,
    INLET_PORT,
    LATERAL,
    OUTLET_GROOVE,
    OUTLET_PORT,
    PathCategory,
)
from toothspace.numerics.periodic_table import monotone_table, smooth_table
from toothspace.results.ledger import Ledger, ledger_from
from toothspace.results.solution import Solution
from toothspace.results.variables import dataset_from

TEETH = 12
TURN = 2.0 * np.pi
SPEED = 1500.0 * TURN / 60.0
CENTER_DISTANCE = 34.465e-3
TIP_RADIUS = 20.186e-3
ROOT_RADIUS = 14.0e-3
DISPLACEMENT = 4.949e-6 / TURN
HIGH, LOW = 200e5, 1e5
DENSITY_HIGH, DENSITY_LOW = 870.0, 860.0
MECHANISMS = ["journal_viscous", "lateral_viscous", "tip_shear", "mesh_friction", "shaft_seal"]
TORQUE_LOSSES = [0.35, 0.28, 0.05, 0.22, 0.15]
CATEGORIES = (
    PathCategory("tooth_tip", "tooth tips", "#0072B2", "gap"),
    PathCategory("flank", "flanks", "#56B4E9", "mesh"),
    LATERAL,
    DRAIN,
)
PATHS = [category.name for category in CATEGORIES]
LEAKAGES = [0.9e-6, 0.15e-6, 0.8e-6, 1.1e-6]


def _sectors(shaft_angle: float) -> list[Array]:
    """Sectors between the teeth of both gears, out to the tip circle."""
    found = []
    for center, sense in ((0.0, 1.0), (CENTER_DISTANCE, -1.0)):
        for k in range(TEETH):
            middle = sense * (shaft_angle + TURN * k / TEETH)
            angle = middle + np.linspace(-0.5, 0.5, 9) * TURN / TEETH
            arc = np.column_stack([np.cos(angle), np.sin(angle)])
            ring = np.vstack([ROOT_RADIUS * arc, TIP_RADIUS * arc[::-1]])
            found.append(ring + np.array([0.0, center]))
    return found


def fake_description() -> MachineDescription:
    """Two gears with rounded teeth, ports as window functions."""
    nodes = TURN * np.arange(360) / 360
    volume = 4.0e-7 - 2.0e-7 * np.exp(4.0 * (np.cos(nodes - np.pi / 2) - 1.0))
    window_in = np.clip(np.cos(nodes + np.pi / 2 - 1.6) * 2e-4 - 1.2e-4, 0.0, None)
    window_out = np.clip(np.cos(nodes - np.pi / 2 - 1.6) * 2e-4 - 1.2e-4, 0.0, None)
    phases = TURN * np.arange(TEETH) / TEETH
    no_motion = smooth_table(TURN, np.zeros((360, 4)))
    names = ("drive_gear", "driven_gear")
    families = tuple(
        ChamberFamily(name, 1.0, phases, smooth_table(TURN, volume), no_motion) for name in names
    )
    paths = tuple(
        _port(f"{kind.name}_{name}", kind, window, k, node)
        for k, name in enumerate(names)
        for kind, window, node in (
            (INLET_PORT, window_in, 2 * TEETH),
            (OUTLET_PORT, window_out, 2 * TEETH + 1),
            (INLET_GROOVE, np.roll(window_in, 20) * 0.1, 2 * TEETH),
            (OUTLET_GROOVE, np.roll(window_out, -20) * 0.1, 2 * TEETH + 1),
        )
    )
    return MachineDescription(
        name="external_gear",
        mode="motor",
        displacement=DISPLACEMENT,
        bodies=(
            Body("drive_gear", (0.0, 0.0), 1.0, 0.12, 1.5e-5, "shaft"),
            Body("driven_gear", (0.0, CENTER_DISTANCE), -1.0, 0.12, 1.5e-5, "driven"),
        ),
        motions=tuple(Motion(n, a) for n in names for a in ("x", "y")),
        families=families,
        paths=paths,
        journals=tuple(
            LumpedJournalBearing(n, 2, 18e-3, 19e-3, 8e-6, 3e-7, 1e-5, 2e11, 1e9, 0.05)
            for n in names
        ),
        drain="outlet",
        outlines={
            "drive_gear": _gear(0.0),
            "driven_gear": _gear(np.pi / TEETH),
            "casing": _casing(),
            "groove_outlet": np.array([[3.6, 12], [10, 12], [10, 22], [3.6, 22]]) * 1e-3,
        },
        chamber_outlines=_sectors,
        geometry_summary={
            "displacement_cm3_per_rev": 4.949,
            "contact_ratio": 1.31,
            "tip_land_mm": 0.9,
            "undercut": False,
            "center_distance_mm": 34.465,
            "warnings": ["the tip land is thin"],
        },
        checks=(
            DesignCheck("contact_ratio", 1.31, "1", ">= 1.1", True, "Teeth must overlap."),
            DesignCheck("tip_land", 0.9, "mm", ">= 1.0 mm", False, "A thin land leaks & chips."),
        ),
    )


def _port(name: str, category: PathCategory, area: Array, family: int, node: int) -> FlowPath:
    chambers = np.arange(TEETH) + family * TEETH
    return FlowPath(
        name,
        category,
        "orifice",
        chambers,
        np.full(TEETH, node),
        1.0,
        TURN * np.arange(TEETH) / TEETH,
        monotone_table(TURN, np.column_stack([area, np.sqrt(area)])),
    )


def _gear(turn: float) -> Array:
    angle = TURN * np.arange(720) / 720
    wave = np.tanh(2.2 * np.cos(TEETH * (angle - np.pi / 2 - turn))) / np.tanh(2.2)
    middle, half = 0.5 * (TIP_RADIUS + ROOT_RADIUS), 0.5 * (TIP_RADIUS - ROOT_RADIUS)
    radius = middle + half * wave
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def _casing() -> Array:
    radius = TIP_RADIUS + 20e-6
    cut = np.arcsin(0.5 * CENTER_DISTANCE / radius)
    lower = np.linspace(-np.pi - cut, cut, 200)
    upper = np.linspace(-cut, np.pi + cut, 200)
    return np.vstack(
        [
            radius * np.column_stack([np.cos(lower), np.sin(lower)]),
            radius * np.column_stack([np.cos(upper), np.sin(upper)]) + [0.0, CENTER_DISTANCE],
        ]
    )


def fake_ledger(duration: float, turned: float) -> Ledger:
    """Closed by construction: shaft work is what remains of the port energy."""
    mass_inlet = DENSITY_HIGH * DISPLACEMENT * turned / 0.96
    losses = {
        "tooth_tip": 18.0,
        "lateral": 16.0,
        "flank": 3.0,
        "drain": 22.0,
        "throttle_inlet_port": 2.0,
        "throttle_outlet_port": 1.5,
        "throttle_outlet_groove": 1.0,
        **{m: t * SPEED for m, t in zip(MECHANISMS, TORQUE_LOSSES, strict=True)},
    }
    energies = {name: power * duration for name, power in losses.items()}
    port_inlet = mass_inlet * (HIGH - LOW) / DENSITY_HIGH
    shaft = sum(energies.values()) - port_inlet
    quantities = {
        "mass_inlet": mass_inlet,
        "mass_outlet": mass_inlet,
        "shaft": shaft,
        "port_inlet": port_inlet,
        "port_outlet": 0.0,
        **energies,
    }
    accounts = (*CATEGORIES, INLET_PORT, OUTLET_PORT, OUTLET_GROOVE)
    labels = {category.account: category.account_label for category in accounts}
    return ledger_from(quantities, duration, turned, labels)


def fake_solution(samples: int = 360) -> Solution:
    """One revolution of a cyclic run."""
    angle = 8.0 * TURN + TURN * np.arange(samples) / samples
    data = dataset_from(
        _values(angle),
        {
            "chamber": fake_description().chamber_labels,
            "journal": ["drive_gear", "driven_gear"],
            "body": ["drive_gear", "driven_gear"],
            "axis": ["x", "y"],
            "contact": [f"drive_flank_{k}" for k in range(TEETH)],
            "path": PATHS,
            "mechanism": MECHANISMS,
        },
        attributes={"title": "Fake 12-tooth motor", "machine": "external_gear", "mode": "motor"},
    )
    return Solution(
        status=Status.DONE,
        data=data,
        ledger=fake_ledger(TURN / SPEED, TURN),
        statistics={"steps": 2400.0, "rhs": 9100.0, "wall_time": 0.8},
        provenance={
            "title": "Fake 12-tooth motor",
            "package_version": "0.1.0",
            "case_toml": 'title = "Fake <motor>"\n[machine]\ntype = "external_gear"\n',
            "case_hash": "0123abcd",
            "preset": "lumped",
            "overrides": "",
        },
        events=(
            Event(50.2, 0.32, "cavitation_onset", "driven_gear_3"),
            Event(50.9, 0.324, "contact_change", "drive_flank_4"),
        ),
    )


def _values(angle: Array) -> dict[str, object]:
    ripple = np.abs(np.sin(0.5 * TEETH * angle)) - 2.0 / np.pi
    one = np.ones_like(angle)
    flow = DISPLACEMENT * SPEED / 0.96 * (1.0 + 0.15 * ripple)
    return {
        "shaft_angle": angle,
        "time": angle / SPEED,
        "shaft_speed": SPEED * one,
        "shaft_torque": 14.5 * (1.0 + 0.14 * ripple),
        "inlet_flow_rate": flow,
        "outlet_flow_rate": flow * 1.01,
        "inlet_pressure": HIGH * (1.0 + 0.002 * ripple),
        "outlet_pressure": LOW * one,
        **_chambers(angle),
        **_bodies(angle),
        "leakage": one[:, None] * LEAKAGES,
        "drain_flow_rate": one * LEAKAGES[-1],
        "torque_loss": (1.0 + 0.1 * ripple)[:, None] * TORQUE_LOSSES,
        "power_loss": SPEED * (1.0 + 0.1 * ripple)[:, None] * TORQUE_LOSSES,
        "displacement": DISPLACEMENT,
        "inlet_density": DENSITY_HIGH,
        "outlet_density": DENSITY_LOW,
        "specific_heat_capacity": 1960.0,
        "fluid_temperature": 323.15,
    }


def _chambers(angle: Array) -> dict[str, Array]:
    own = (angle[:, None] + np.tile(TURN * np.arange(TEETH) / TEETH, 2)) % TURN
    # Full pressure after the inlet, falling step by step around the outside.
    level = np.clip((4.6 - own) / 3.0, 0.0, 1.0)
    pressure = LOW + (HIGH - LOW) * level**2 * (3.0 - 2.0 * level)
    return {
        "chamber_pressure": pressure + 10e5 * np.exp(-(((own - 1.2) / 0.1) ** 2)),
        "chamber_volume": 4.0e-7 - 2.0e-7 * np.exp(4.0 * (np.cos(own - np.pi / 2) - 1.0)),
        "chamber_gas_fraction": 0.002 * (LOW / pressure),
    }


def _bodies(angle: Array) -> dict[str, Array]:
    wave = TEETH * angle
    orbit = np.stack([-6.0 + 0.4 * np.cos(wave), 3.0 + 0.3 * np.sin(wave)], axis=-1) * 1e-6
    force = np.stack([-5200.0 + 300.0 * np.cos(wave), 900.0 + 250.0 * np.sin(wave)], axis=-1)
    contact = np.clip(np.cos(angle[:, None] + TURN * np.arange(TEETH) / TEETH) - 0.8, 0.0, None)
    casing = TURN * np.arange(180) / 180
    depth = 8e-6 * np.clip(np.cos(casing - np.pi) - 0.3, 0.0, None)
    mirror = np.array([1.0, -1.0])
    return {
        "body_position": np.stack([orbit, orbit * mirror], axis=1),
        "body_force": np.stack([force, force * mirror], axis=1),
        "journal_force": -np.stack([force, force * mirror], axis=1),
        "axial_force": 0.1 * force,
        "journal_film_height": np.full((angle.size, 2), 2e-6),
        "contact_force": 4000.0 * contact,
        "contact_gap": 5e-5 * (0.2 - contact).clip(0.0),
        "casing_angle": casing,
        "running_in_depth": np.stack([depth, 0.8 * depth]),
    }
