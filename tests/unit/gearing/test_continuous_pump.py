"""A pump of continuous contact: fillings of tooth spaces, conservation, ripple."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toothspace as ts
from toothspace import api
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.types import Array
from toothspace.gearing.meshing import displacement, flow_over_pitch
from toothspace.geometry.continuous_contact import FAMILIES
from toothspace.machines.external_gear.assembly import assemble
from toothspace.model.description import FlowPath, MachineDescription
from toothspace.numerics.periodic_table import smooth_table
from toothspace.run.solved_films import with_solved_films

CASE = Path(__file__).resolve().parents[3] / "cases" / "continuous_pump.toml"
GEARS = "machine.gears."


def family_case(family: str) -> ts.Case:
    """The pump with another outline of about the same height."""
    case = ts.load_case(CASE)
    keys: dict[str, Any] = {f"{GEARS}family": family}
    if family != "arc_involute_arc":
        keys[f"{GEARS}pressure_angle"] = None
        keys[f"{GEARS}tip_diameter"] = None if family == "cycloidal" else "40.5 mm"
    return case.replace(keys)


def machine(**changes: Any) -> MachineDescription:
    case = ts.load_case(CASE).replace({GEARS + k: v for k, v in changes.items()})
    return api.prepare(case).machine


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_displacement_is_that_of_the_contact(family: str) -> None:
    spec = family_case(family).machine_spec
    exact = spec.continuous.displacement_per_radian(spec.drive.face_width)
    assert displacement(assemble(spec)) == pytest.approx(exact, rel=2e-5)


@pytest.mark.parametrize("overlap", [0.5, 0.7, 1.0])
def test_harmonics_of_the_section_fall_by_sine_over_argument(overlap: float) -> None:
    assembly = assemble(ts.load_case(CASE).machine_spec)
    pitch = 2.0 * np.pi / 9
    section = smooth_table(pitch, flow_over_pitch(assembly))
    along = section.moving_mean(overlap * pitch).values[:, 0]
    before, after = (np.fft.rfft(v)[:7] for v in (section.values[:, 0], along))
    for k in (2, 4, 6):
        expected = np.sinc(k * overlap) * np.abs(before[2])
        assert (after[k] / before[k]).real * np.abs(before[2]) == pytest.approx(
            expected, abs=1e-6 * np.abs(before[2])
        )
    assert after[0] == pytest.approx(before[0], rel=1e-9)
    # both flanks in turn: only even orders of the tooth frequency
    assert np.abs(before[[1, 3, 5]]).max() < 1e-4 * np.abs(before[2])


def test_fillings_hold_what_the_spaces_hold() -> None:
    found = machine()
    angles = np.linspace(0.0, 2.0 * np.pi, 60)
    totals, motions = [], []
    for own in found.families:
        places = own.phases + angles[:, None]
        totals.append(own.volume(places)[..., 0].sum(axis=1))
        motions.append(own.volume_by_motion(places).sum(axis=1))
    sections = found.winding.section.families
    twist = found.winding.twist
    for own, total in zip(sections, totals, strict=True):
        mean = own.volume.moving_mean(twist)
        spaces = mean(own.phases + angles[:, None])[..., 0].sum(axis=1)
        rest = (total - spaces).mean()
        np.testing.assert_allclose(total - spaces, rest, atol=2e-4 * total.mean())
    np.testing.assert_allclose(sum(totals), np.mean(sum(totals)), rtol=1e-6)
    # equal pressure everywhere pushes nothing
    largest = max(np.abs(own.volume_by_motion.values).max() for own in found.families)
    assert np.abs(sum(motions)).max() < 2e-3 * largest


def test_no_filling_joins_both_ports() -> None:
    short = next(c for c in machine().checks if c.name.startswith("short circuit"))
    assert short.passed
    assert short.value < 0.2


def test_shares_of_slices_that_touch_carry_the_whole_load() -> None:
    contact = machine(face_width="24 mm").contacts[0]
    angles = np.linspace(0.0, 2.0 * np.pi, 50)
    places = contact.phases + contact.angle_ratio * angles[:, None]
    shares = [table(places[:, k])[:, 1] for k, table in enumerate(contact.own)]
    np.testing.assert_allclose(np.sum(shares, axis=0), 1.0, rtol=5e-3)


@pytest.mark.slow
def test_a_run_closes_and_is_steady() -> None:
    found = ts.simulate(CASE).summary()
    assert found["status"] == "done"
    assert found["mass_balance_error"] < 1e-7
    assert found["energy_balance_error"] < 1e-5
    assert 0.9 < found["volumetric_efficiency"] < 1.0
    assert found["flow_ripple_percent"] < 3.0
    assert found["max_chamber_pressure_bar"] < 130.0


@pytest.mark.slow
def test_elastic_teeth_touch_on_both_flanks() -> None:
    found = ts.simulate(CASE, run__mesh="elastic")
    assert found.summary()["energy_balance_error"] < 1e-5
    assert found.summary()["flow_ripple_percent"] < 3.0


def test_ideal_flow_does_not_pulsate_at_an_overlap_of_one() -> None:
    found = ts.simulate(CASE, run__fidelity="ideal").summary()
    assert found["flow_ripple_percent"] < 0.1


@pytest.mark.slow
def test_films_beside_the_gears_leak_as_those_of_the_section() -> None:
    """Fillings of a face have the conductance of its spaces: mean of both ends."""
    found = machine()
    assert found.winding is not None
    section, half = found.winding.section, 0.5 * found.winding.twist
    models = {"journal": "closed_form", "lateral": "reynolds"}
    along, across = (with_solved_films(m, models=models) for m in (found, section))
    angles, known = np.linspace(0.0, 2.0 * np.pi, 40), {path.name for path in section.paths}

    def conductance(path: FlowPath, lead: float) -> Array:
        table = path.geometry(path.phases + path.angle_ratio * (angles[:, None] + lead))
        return np.asarray((table[..., 1] / table[..., 2]).sum(axis=1))

    checked = 0
    for own in across.paths:
        if not own.name.startswith(("lateral", "drain")):
            continue
        parts = [p for p in along.paths if p.name in (own.name, f"{own.name}_cut")]
        wanted = 0.5 * (conductance(own, half) + conductance(own, -half))
        total = np.sum([conductance(part, 0.0) for part in parts], axis=0)
        np.testing.assert_allclose(total, wanted, rtol=0.03)
        checked += own.name not in known
    assert checked == 8


@pytest.mark.slow
def test_films_keep_the_balances() -> None:
    closed, solved = (ts.simulate(CASE, run__fidelity=f).summary() for f in ("lumped", "films"))
    assert solved["status"] == "done"
    assert solved["mass_balance_error"] < 1e-7
    assert solved["energy_balance_error"] < 1e-5
    efficiency = closed["volumetric_efficiency"]
    assert solved["volumetric_efficiency"] == pytest.approx(efficiency, abs=5e-3)
    assert solved["flow_ripple_percent"] < 3.0


@pytest.mark.slow
def test_rules_name_what_spoils_the_contact() -> None:
    def failed(**changes: Any) -> set[str]:
        return {check.name for check in machine(**changes).checks if not check.passed}

    assert not failed()
    assert "normal backlash" in failed(normal_backlash="0.1 mm")
    assert "encapsulated volume" in failed(root_clearance="0.3 mm")
    assert "overlap ratio" in failed(face_width="23 mm")
    assert "total contact ratio" in failed(face_width="8 mm")
    cycloid = api.prepare(family_case("cycloidal")).machine
    assert "smallest radius of curvature" in {c.name for c in cycloid.checks if not c.passed}


def test_tip_land_and_root_clearance_follow_the_transverse_module() -> None:
    """Eight hundredths of it, and five thousandths where arcs join the involute."""
    keys = ts.load_case(CASE).replace({f"{GEARS}tip_land": None, f"{GEARS}root_clearance": None})
    gears = keys.machine.gears
    gear = gears.continuous_gear()
    module = gears.module / np.cos(gears.helix_angle)
    assert gear.module == pytest.approx(module)
    assert gear.tip_land == pytest.approx(0.08 * module)
    assert gear.root_clearance == pytest.approx(0.005 * module)
    assert family_case("cycloidal").machine.gears.continuous_gear().root_clearance == 0.0


@pytest.mark.parametrize(
    ("key", "value"),
    [("tip_diameter", "40 mm"), ("profile_shift", 0.2), ("center_distance", "37 mm")],
)
def test_keys_that_the_family_does_not_have_are_refused(key: str, value: object) -> None:
    with pytest.raises(CaseError, match=key):
        ts.load_case(CASE).replace({GEARS + key: value})


def test_what_is_not_there_is_refused() -> None:
    with pytest.raises(CaseError, match="driven_gear"):
        ts.load_case(CASE, ("machine.driven_gear.tooth_count=11",)).machine_spec  # noqa: B018
    with pytest.raises(CaseError, match="tip_land"):
        ts.load_case(CASE.with_name("helical_pump.toml"), (f"{GEARS}tip_land=0.2 mm",))
    with pytest.raises((CaseError, GeometryError), match="tip_diameter"):
        api.prepare(
            ts.load_case(CASE).replace(
                {f"{GEARS}family": "sinusoidal", f"{GEARS}pressure_angle": None,
                 f"{GEARS}tip_diameter": "44 mm"}
            )
        )  # fmt: skip


@pytest.mark.slow
def test_two_flanks_take_three_quarters_off_the_pulsation_and_continuous_contact_the_rest() -> None:
    """Makers state about 75 % less by two-flank contact."""
    keys: dict[str, Any] = {
        "family": "involute", "helix_angle": "0 deg", "helix_hand": None, "tooth_count": 12,
        "module": "2.75 mm", "profile_shift": 0.30, "tip_diameter": "40.372 mm",
        "face_width": "33.42 mm", "normal_backlash": "0.11 mm",
    }  # fmt: skip
    spur = ts.load_case(CASE).replace({GEARS + k: v for k, v in keys.items()})
    grooves = {f"machine.relief_grooves.{k}_side_offset": "3.4 mm" for k in ("closing", "opening")}
    spur = spur.replace(grooves)
    both = spur.replace(
        {f"{GEARS}normal_backlash": "0 mm"} | dict.fromkeys(grooves, "1.9 mm")  # twice as often
    )
    one, two, none = (
        float(ts.simulate(case).summary()["pressure_ripple_bar"])
        for case in (spur, both, ts.load_case(CASE))
    )
    assert two / one == pytest.approx(0.25, abs=0.03)
    assert none < 0.06 * one


def test_flank_gaps_join_fillings_that_are_there_and_add_up_to_those_of_the_spaces() -> None:
    found = machine()
    section = {path.name: path for path in found.winding.section.paths}
    angles = np.linspace(0.0, 2.0 * np.pi, 40)
    volumes = np.hstack(
        [own.volume(own.phases + angles[:, None])[..., 0] for own in found.families]
    )
    widest = found.winding.section.paths[0].geometry.values[:, 1].max()
    for name in ("flank_leading", "flank_trailing"):
        total = np.zeros(angles.size)
        for path in found.paths:
            if not path.name.startswith(name):
                continue
            width = path.geometry(path.phases + angles[:, None])[..., 1]
            total += width.sum(axis=1)
            for ends in (path.nodes_a, path.nodes_b):
                joined = volumes[:, ends][width > 0.3 * widest]
                assert joined.min() > 1.05 * volumes.min()
        own = section[name]
        mean = own.geometry.moving_mean(found.winding.twist)
        expected = mean(own.phases + angles[:, None])[..., 1].sum(axis=1)
        np.testing.assert_allclose(total, expected, rtol=0.03)
