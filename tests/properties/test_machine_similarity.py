"""Real machines enlarged, turning the other way, and drawn turned or mirrored: what must not
change, does not.

Enlarged: with lengths, times and viscosities times a factor and pressures and densities as before,
every number of a run is that of the first times the power of the factor that its unit says. A
length or time that is written into the code and not into the case breaks it.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.iteration_matrices import all_rates_of
from tests.tank_circuit import pump_between_tanks
from toothspace import api
from toothspace.case import Case
from toothspace.core import units
from toothspace.core.keys import QuantityKey
from toothspace.core.registry import machine_type
from toothspace.core.types import Array
from toothspace.geometry.curve import signed_area
from toothspace.model.arrays import CLEARANCE, GAP, KIND, ORIFICE, POSSIBLE
from toothspace.model.assembly import System, assemble
from toothspace.model.contact_data import compliant_table
from toothspace.model.description import MachineDescription
from toothspace.results.performance import means_by_label
from toothspace.results.solution import Solution
from toothspace.solver.compiled_model import observe
from toothspace.solver.initial import start_state

CASES = Path(__file__).resolve().parents[2] / "cases"
OIL = {
    "temperature [degC]": [50, 50, 50],
    "pressure [bar]": [1, 100, 300],
    "density [kg/m3]": [860, 866, 875],
}
VISCOSITY = np.array([0.030, 0.036, 0.052])


def power_of(unit: str) -> int:
    """Power of the factor of a unit, with lengths and times as the factor, mass as its cube."""
    known = units._unit(re.sub(r"(?<=[A-Za-z])(\d)", r"^\1", unit)).dimensionality
    return int(sum(many * known.get(f"[{name}]", 0) for name, many in BASE_POWERS.items()))


BASE_POWERS = {"length": 1, "time": 1, "mass": 3}


def enlarged(keys: Any, factor: float) -> Any:
    """Keys with every quantity, defaults too, times its power of the factor."""
    changes: dict[str, Any] = {}
    for field in dataclasses.fields(keys):
        value, key = getattr(keys, field.name), field.metadata.get("toothspace.key")
        if isinstance(key, QuantityKey) and isinstance(value, float):
            changes[field.name] = value * factor ** power_of(key.unit)
        elif dataclasses.is_dataclass(value):
            changes[field.name] = enlarged(value, factor)
    return dataclasses.replace(keys, **changes)


def sized(name: str, factor: float, **run: Any) -> Case:
    """A shipped case of so many times its size, with an oil of so many times the viscosity."""

    def with_oil(case: Case, viscosity: Array) -> Case:
        tables = case.to_dict()
        tables["fluid"].pop("name", None)
        tables.pop("heat", None)  # walls and bodies conduct heat by laws of other powers
        columns = {**OIL, "dynamic_viscosity [Pa s]": viscosity.tolist()}
        return Case.from_dict({**tables, "fluid": tables["fluid"] | {"table": columns}}, CASES)

    case = with_oil(api.load_case(CASES / f"{name}.toml"), VISCOSITY)
    if run:
        case = dataclasses.replace(case, run=dataclasses.replace(case.run, **run))
        # the search for an orifice leaves its tolerance in a single revolution
        case = case.replace({"operating_point.outlet_load": "fixed_pressure"})
    return with_oil(enlarged(case, factor), factor * VISCOSITY)


def compare(one: Solution, other: Solution, factor: float, tolerance: float) -> None:
    """Hold means over the angle of all variables against those of the machine enlarged."""
    for name, values in one.data.data_vars.items():
        # angles go on round the circle, temperatures of bodies hang on conduction
        if values.dtype.kind != "f" or values.attrs["units"] in ("rad", "K"):
            continue
        if name == "tip_gap_minimum":
            continue  # a casing that is cut leaves the least gap of a formula, of one length
        expected = values * factor ** power_of(values.attrs["units"])
        # angles agree to round-off only
        error = expected.copy(data=other.data[name].values - expected.values)
        error = error.mean([dim for dim in ("shaft_angle", "dense_angle") if dim in error.dims])
        if "flow_part" in error.dims:
            error = error.sum("flow_part")  # what a short run stores moves between the parts
        allowed = tolerance * float(np.abs(expected).max())
        if name.endswith(("_minimum", "_maximum")):
            allowed *= 30.0  # extremes hang on single steps: up to 16 times what means do
        if name.endswith("_share"):
            allowed = max(allowed, 2.0 / one.data.sizes["dense_angle"])  # shares of samples
        assert float(np.abs(error).max()) <= allowed, (name, error.values, allowed)


SHORT: dict[str, Any] = {
    "until": None, "revolutions": 1, "samples_per_revolution": 180, "relative_tolerance": 1e-7,
}  # fmt: skip
TOLERANCES = {"egm12_pump": 2e-4, "gerotor_trochoidal": 2e-3, "crescent_pump": 1e-3}
"""Largest differences of means are 5e-5 of the first (1.3e-4 before the integration is tightened);
3e-5 or 9e-4 of the mean velocity of the rotor, by the round-off of the processor."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "egm12_pump",
        pytest.param("gerotor_trochoidal", marks=pytest.mark.slow),
        pytest.param("crescent_pump", marks=pytest.mark.slow),
    ],
)
def test_a_machine_of_twice_the_size_runs_alike(name: str) -> None:
    """One revolution is enough to find a length that is written into the code."""
    one, two = (api.simulate(sized(name, factor, **SHORT)) for factor in (1.0, 2.0))
    compare(one, two, 2.0, TOLERANCES[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["egm12_pump", "crescent_pump"])
def test_similar_machines_have_similar_cycles(name: str) -> None:
    one, other = (api.simulate(sized(name, factor)) for factor in (1.0, 2.0))
    compare(one, other, 2.0, TOLERANCES[name])
    for key in ("volumetric_efficiency", "overall_efficiency"):
        assert other.summary()[key] == pytest.approx(one.summary()[key], rel=1e-4), key


def test_pairs_of_teeth_share_load_alike_at_every_size() -> None:
    """Flanks without a closed path of contact count as touching by a gap that grows with them."""
    one, two = (
        api.prepare(sized("crescent_pump", factor)).machine.contacts[0].geometry.values[:, 1]
        for factor in (1.0, 2.0)
    )
    np.testing.assert_allclose(two, one, atol=1e-9)


def test_flanks_may_touch_at_every_size() -> None:
    """Backlash wider than 0.3 mm: micro-motion closes the gap of the coast flank too."""
    small, large = (api.prepare(sized("egm12_pump", factor)).machine for factor in (1.0, 6.0))
    for one, two in zip(small.contacts, large.contacts, strict=True):
        tables = [
            compliant_table(contact, np.eye(len(small.motions))).values for contact in (one, two)
        ]
        np.testing.assert_array_equal(tables[1][:, POSSIBLE], tables[0][:, POSSIBLE])
        least = tables[1][:, GAP].min()
        assert tables[1][tables[1][:, GAP] < least + 1e-3, POSSIBLE].all(), two.name


CHANNELS = {"orifice": (2, 1), "parallel_gap": (1, 1, 1), "curved_gap": (1, 1, 1)}
"""Powers of the size with which the channels of a path grow."""
BY_MOTION = {"x": 0, "y": 0, "z": 0, "rotation": 1}
"""Powers of a length over a micro-motion."""
OWN_SCALE = {
    "": ("trapped pressure, estimate", "short circuit through the chambers"),
    "gerotor_trochoidal": (
        "contact_ratio", "sealed_shaft_angle_deg", "trapped_volume_mm3",
        "volume change of a sealed pocket over the largest pocket",
    ),
}  # fmt: skip
"""What has an oil and a speed of its own, or counts up to a gap of so many micrometres."""


def sizes(machine: MachineDescription) -> Iterator[tuple[str, Any, Any]]:
    """Numbers of a machine by name, and the powers with which they grow with its size."""
    motions = np.array([BY_MOTION[motion.axis] for motion in machine.motions])
    yield "displacement", machine.displacement, 3
    yield "port volumes", machine.port_volumes, 3
    yield "seal torque", machine.seal_torque, 3
    for part, powers in (
        *(
            (body, {"center": 1, "mass": 3, "inertia": 5, "wetted_area": 2})
            for body in machine.bodies
        ),
        *(
            (journal, dict.fromkeys(("diameter", "length", "radial_clearance", "roughness"), 1))
            for journal in machine.journals
        ),
        *(
            (film, dict.fromkeys(("height", "inner_radius", "root_radius", "outer_radius"), 1))
            for film in machine.laterals
        ),
    ):
        label = getattr(part, "name", getattr(part, "body", ""))
        for name, power in powers.items():
            yield f"{label}: {name}", getattr(part, name), power
    for film in machine.laterals:
        yield f"{film.body}: tooth area", film.tooth_area_fraction, 0
        yield f"{film.body}: drag", film.drag or 0.0, 3
    for family in machine.families:
        yield f"{family.name}: volume", family.volume.values, 3
        yield f"{family.name}: phases", family.phases, 0
        yield f"{family.name}: force", family.volume_by_motion.values, 2 + motions
    for path in machine.paths:
        yield f"{path.name}: geometry", path.geometry.values, CHANNELS[path.kind]
        yield f"{path.name}: phases", path.phases, 0
        yield f"{path.name}: throat speed", path.throat_speed, 1
        for name, power in (("height_by_motion", motions), ("drag_speed", 1), ("shear_speed", 1)):
            if (table := getattr(path, name)) is not None:
                yield f"{path.name}: {name}", table.values, power
    for contact in machine.contacts:
        yield f"{contact.name}: geometry", contact.geometry.values, (1, 0, 1, 1, 1, 1)
        yield f"{contact.name}: gap", contact.gap_by_motion.values, motions
        yield f"{contact.name}: width", contact.width, 1
        if contact.slip_by_motion is not None:
            yield f"{contact.name}: slip", contact.slip_by_motion.values, motions
        if contact.gap_by_shift_and_turn is not None:
            yield f"{contact.name}: bend", contact.gap_by_shift_and_turn.values, (-1, 0, 1)
    if machine.mesh is not None:
        yield "mesh: lever", machine.mesh.lever, 1
        yield "mesh: ties", machine.mesh.coefficients, motions - 1
    for name, value in machine.geometry_summary.items():
        unit = re.search(r"_(mm|um|mm2|mm3|cm3)(_per_rev)?$", name)
        if isinstance(value, float):
            yield name, value, power_of(unit[1]) if unit else 0
    for check in machine.checks:
        yield check.name, check.value, power_of(check.unit) if check.unit.strip("1%") else 0
    for name, outline in machine.outlines.items():
        yield f"area within {name}", signed_area(outline), 2


PAIRS = {"egm12_pump": 6.0, "crescent_pump": 2.0, "gerotor_trochoidal": 2.0}
TIGHT = {"egm12_pump": 1e-5, "crescent_pump": 1e-5, "gerotor_trochoidal": 2e-2}
"""Agreement of rates; stiff contacts of lobes feel the last digits of their gaps."""


@pytest.fixture(scope="module", params=PAIRS)
def name(request: pytest.FixtureRequest) -> str:
    """A case that is enlarged: one after the other, as machines are kept."""
    return str(request.param)


def test_all_that_is_known_of_a_machine_grows_with_its_size(name: str) -> None:
    """Lengths as the factor, areas, volumes, masses and moments with their powers of it.

    Tables agree but for 2 % of their entries: points where flanks face away.
    """
    found: list[dict[str, Any]] = []
    for scale in (1.0, PAIRS[name]):
        known = sizes(api.describe(sized(name, scale)))
        found.append(
            {
                label: np.asarray(value, float) / scale ** np.asarray(p, float)
                for label, value, p in known
            }
        )
    small, large = found
    assert list(small) == list(large)
    for label in small.keys() - {*OWN_SCALE[""], *OWN_SCALE.get(name, ())}:
        error = np.abs(large[label] - small[label])
        size = np.abs(small[label])
        allowed = np.maximum(1e-3 * size.max(axis=0), 1e-6 * size.max())  # zero but for round-off
        assert np.mean(error > allowed) <= 0.02, label


OBSERVED = {
    "pressure": 0, "density": 0, "volume": 3, "gas": 0, "path_flow": 2, "path_drop": 0,
    "path_loss": 2, "torque": 3, "contact_force": 2, "raw_height": 1, "path_drag": 3,
    "path_carried": 3,
}  # fmt: skip
"""Powers with which what a state is made of grows with the size."""


def stirred(name: str, factor: float) -> tuple[System, Array, Array]:
    """A machine off its start, and the powers with which its states grow.

    Places and velocities within a fifth of the clearances, pressures up to some ten bar away.
    """
    run = api.prepare(sized(name, factor))
    system = assemble(run.machine, run.fluid, run.condition)
    state, size, random = start_state(system), system.arrays.size, np.random.default_rng(5)
    moved = system.arrays.motion[:, CLEARANCE]
    turning = [system.description.motions[k].axis == "rotation" for k in system.free_motions]
    lengths = np.where(turning, 0.0, 1.0)[: size.motions]
    state[size.position : size.velocity] += 0.2 * moved * random.uniform(-1.0, 1.0, moved.size)
    speed = 0.1 * moved * run.condition.shaft_speed
    state[size.velocity : size.column] = speed * random.uniform(-1.0, 1.0, moved.size)
    state[size.mass : size.gas] *= 1.0 + 5e-4 * random.uniform(0.0, 1.0, size.gas - size.mass)
    powers = np.full(size.total, 3.0)  # masses and energies
    powers[:2] = 0.0, -1.0
    powers[size.position : size.velocity], powers[size.velocity : size.column] = (
        lengths,
        lengths - 1.0,
    )
    return system, state, powers


def test_forces_flows_and_losses_of_a_state_grow_with_the_size(name: str) -> None:
    """Rates of all states, ledger included, with one power less than these: times grow as well."""
    found = []
    for scale in (1.0, PAIRS[name]):
        system, state, powers = stirred(name, scale)
        rates, size = all_rates_of(system, state) / scale ** (powers - 1.0), system.arrays.size
        ends = [2, size.gas, size.position, size.velocity, size.column]
        seen = observe(system.arrays, state[None])
        known = {key: getattr(seen, key)[0] / scale**power for key, power in OBSERVED.items()}
        gaps = system.arrays.path_index[:, KIND] != ORIFICE
        known["raw_height"] = known["raw_height"][gaps]
        motions = powers[size.position : size.velocity]
        for force in ("pressure_force", "film_force"):
            known[force] = getattr(seen, force)[0] / scale ** (3.0 - motions)
        known |= {f"rates {k}": part for k, part in enumerate(np.split(rates, ends))}
        found.append(known)
    small, large = found
    for label, value in small.items():
        value = np.where(np.isfinite(value), value, 0.0)  # closed ones have no height
        allowed = TIGHT[name] * np.abs(value).max(initial=1e-30)
        other = np.where(np.isfinite(large[label]), large[label], 0.0)
        np.testing.assert_allclose(other, value, 2e-3, allowed, err_msg=label)


QUICK: dict[str, Any] = SHORT | {"samples_per_revolution": 72, "relative_tolerance": 1e-5}
NUMBER = re.compile(r"_(L_per_min|N_m|um|W|N|rpm|mm)$")
UNITS = {"L_per_min": 2, "N_m": 3, "um": 1, "W": 2, "N": 2, "rpm": -1, "mm": 1}


QUICKLY = {"egm12_pump": 5e-3, "gerotor_trochoidal": 2e-2}
"""Agreement of short runs, of which contacts are loaded at single samples."""


@pytest.mark.parametrize("name", QUICKLY, indirect=True)
def test_a_short_run_grows_with_its_machine(name: str) -> None:
    """Variables on average, sums of the ledger and numbers of the summary, all but extremes."""
    factor, tolerance = PAIRS[name], QUICKLY[name]
    one, other = (api.simulate(sized(name, scale, **QUICK)) for scale in (1.0, factor))
    for label, values in one.data.data_vars.items():
        unit = values.attrs.get("units", "")
        if (
            values.dtype.kind != "f"
            or unit in ("rad", "K")
            or label.endswith(("mum", "collapse_power"))
        ):
            continue
        expected = values.values * factor ** power_of(unit)
        error = np.mean(np.abs(other.data[label].values - expected))
        assert error <= tolerance * np.abs(expected).max(), label
    # what paths lose is what they leak from port to port, and what walls drag against pressure
    span = abs(float(one.data["outlet_pressure"].mean() - one.data["inlet_pressure"].mean()))
    speed, duration = float(one.data["shaft_speed"].mean()), one.ledger.duration
    lost = means_by_label(one.data, "equivalent_leakage"), means_by_label(one.data, "drag_torque")
    for path, leaking in lost[0].items():
        power = one.ledger.energy[path] / duration
        allowed = 0.03 * one.ledger.loss_energy / duration
        assert span * leaking + speed * lost[1][path] == pytest.approx(power, abs=allowed), path
    scale = abs(one.ledger.shaft_energy), max(one.ledger.mass.values())
    for kept, found, size in zip(
        (one.ledger.energy, one.ledger.mass),
        (other.ledger.energy, other.ledger.mass),
        scale,
        strict=True,
    ):
        for account, value in kept.items():
            assert found[account] / factor**3 == pytest.approx(value, abs=tolerance * size), account
    numbers, larger = one.summary(), other.summary()
    for label, value in numbers.items():
        unit = NUMBER.search(label)
        if unit and abs(value) > 0.02 * abs(numbers.get("shaft_power_W", 0.0)):
            wanted = value * factor ** UNITS[unit[1]]
            assert larger[label] == pytest.approx(wanted, rel=5.0 * tolerance), label


def pump_that_turns(sense: int, backlash: str) -> Case:
    """A pump between two tanks that turns forwards, or its mirror image that turns backwards.

    Ports, their angles and the port that the drain leads to change places. Grooves are open on
    both sides of the centre line: enclosed fluid would measure the flank gaps to the micrometre.
    """
    suction, delivery = ("inlet", "outlet")[::sense]
    tables = pump_between_tanks(f"{1500 * sense} rpm", "60 ms", high=delivery)
    machine = tables["machine"]
    machine["drain"] = suction
    machine["gears"]["normal_backlash"] = backlash
    machine["casing"] = {
        "radial_clearance": "20 um", f"{suction}_angle": "70 deg", f"{delivery}_angle": "55 deg",
    }  # fmt: skip
    machine["relief_grooves"] |= {"closing_side_offset": "1 mm", "opening_side_offset": "1 mm"}
    tables["run"] = {"mesh": "elastic", "time_samples": 600, "relative_tolerance": 1e-6}
    return Case.from_dict(tables, CASES)


MIRRORED = np.array([-1.0, 1.0, 1.0])


@pytest.mark.parametrize("backlash", ["1 um", "110 um"])
def test_a_pump_that_turns_backwards_is_its_mirror_image(backlash: str) -> None:
    """Loaded on the other flanks; the driven gear lags by the backlash and gap tables do not.

    Differences found: 1.2e-3 of forces, 1.6e-3 of torque with 110 um.
    """
    forwards, backwards = (api.simulate(pump_that_turns(s, backlash)).data for s in (1, -1))
    turn = forwards["time"].values > 0.02
    for name, sign in (
        ("shaft_torque", -1.0),
        ("body_force", MIRRORED),
        ("journal_force", MIRRORED),
    ):
        expected, found = (d[name].values[turn].mean(axis=0) for d in (forwards, backwards))
        np.testing.assert_allclose(
            sign * found, expected, rtol=0.0, atol=3e-3 * np.abs(expected).max(), err_msg=name
        )
    one, other = (float(d["chamber_pressure"].values[turn].mean()) for d in (forwards, backwards))
    assert other == pytest.approx(one, rel=3e-3)


@cache
def points() -> Array:
    return np.loadtxt(CASES / "profiles" / "egm12_drive.txt", comments="#")


def mirrored(outline: Array) -> Array:
    return np.asarray(outline * np.array([-1.0, 1.0]))


def turned(outline: Array, angle: float) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.asarray(outline @ np.array([[cosine, sine], [-sine, cosine]]))


def described(folder: Path, outline: Array) -> MachineDescription:
    path = folder / "gear.txt"
    np.savetxt(path, outline)
    tables = api.load_case(CASES / "egm12_motor_profile.toml").to_dict()
    tables["machine"]["gears"] |= {"profile": str(path)}
    case = Case.from_dict(tables, CASES)
    return machine_type("external_gear").describe(case.machine_spec)  # type: ignore[no-any-return]


ANGLES = np.linspace(0.0, 2.0 * np.pi, 49)[:-1]


def chambers(machine: MachineDescription) -> Mapping[str, Array]:
    return {family.name: family.volume(ANGLES) for family in machine.families}


@pytest.fixture(scope="module")
def as_it_lies(tmp_path_factory: pytest.TempPathFactory) -> MachineDescription:
    return described(tmp_path_factory.mktemp("drawn"), points())


@pytest.mark.parametrize(
    "change",
    [
        lambda p: turned(p, 0.37),
        mirrored,
        lambda p: np.roll(p[:-1], 101, axis=0),
        lambda p: p[::-1],
    ],
    ids=["turned", "mirrored", "other start", "other sense"],
)
def test_a_drawing_may_lie_anyhow(
    change: Any, as_it_lies: MachineDescription, tmp_path: Path
) -> None:
    """Teeth alike on both sides: the machine is the same, however its outline is drawn."""
    other = described(tmp_path, change(points()))
    assert other.displacement == pytest.approx(as_it_lies.displacement, rel=1e-6)
    expected = chambers(as_it_lies)
    for name, volume in chambers(other).items():
        assert volume == pytest.approx(expected[name], rel=1e-5), name
