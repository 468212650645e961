"""Relief grooves that differ between the faces of helical gears."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toothspace as ts
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.types import Array
from toothspace.films.plane.conductance import FaceResolution
from toothspace.geometry.curve import turned
from toothspace.machines.external_gear.describe import describe
from toothspace.model.description import MachineDescription
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.run.solved_films import with_solved_films

CASES = Path(__file__).resolve().parents[3] / "cases"
GROOVES = "machine.relief_grooves."
ANGLES = np.linspace(0.0, 2.0 * np.pi, 181)


def opening(machine: MachineDescription, gear: str, port: str) -> Array:
    """Area of the grooves of a port towards the spaces of a gear, both faces. [m2]."""
    total = np.zeros((ANGLES.size, 1))
    for path in machine.paths:
        if path.name.startswith(f"groove_{port}") and f"_{gear}" in path.name:
            areas = path.geometry(path.phases + path.angle_ratio * ANGLES[:, None])[..., 0]
            total = total + path.multiplicity * areas
    return total


def write(path: Path, outlines: list[Array]) -> str:
    text = ["\n".join(f"{x:.9f} {y:.9f}" for x, y in 1e3 * np.vstack([o, o[:1]])) for o in outlines]
    path.write_text("\n\n".join(text))
    return str(path)


def patch(first: float, last: float) -> Array:
    """Part of a ring about the drive gear, between angles from the centre line [deg]. [m]."""
    angles = np.deg2rad(90.0 - np.linspace(first, last, 40))
    rays = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.vstack([15e-3 * rays, 18e-3 * rays[::-1]])


@pytest.mark.parametrize("hand", ["right", "left"])
def test_grooves_turned_by_the_lead_of_their_face_open_as_those_of_spur_teeth(
    tmp_path: Path, hand: str
) -> None:
    """Exactly so beside the mesh, where no tooth of the other gear stands in the spaces."""
    # so deep that the overlap of space and groove alone counts, in any direction
    keys = {"machine.gears.helix_hand": hand, GROOVES + "depth": "100 mm"}
    keys |= {f"{GROOVES}{side}_side_offset": None for side in ("closing", "opening")}
    outlines = [patch(32.0, 50.0), patch(-50.0, -32.0)]
    case = ts.load_case(CASES / "helical_pump.toml")
    case = case.replace(keys | {GROOVES + "contour": write(tmp_path / "equal.txt", outlines)})
    spec = case.machine_spec
    half = 0.5 * spec.helix.twist
    leading, lagging = (
        write(tmp_path / f"{name}.txt", [turned(o, lead) for o in outlines])
        for name, lead in (("leading", half), ("lagging", -half))
    )
    equal = describe(spec, 960)
    faces = {GROOVES + "contour": leading, GROOVES + "lagging_face": {"contour": lagging}}
    own = describe(case.replace(faces).machine_spec, 960)
    for port in ("outlet", "inlet"):
        wanted = opening(equal.winding.section, "drive", port)
        atol = 2e-3 * wanted.max()
        np.testing.assert_allclose(opening(own, "drive", port), wanted, atol=atol)
        assert np.abs(opening(equal, "drive", port) - wanted).max() > 10.0 * atol


def test_equal_faces_are_those_without_the_table() -> None:
    case = ts.load_case(CASES / "helical_pump.toml")
    same = {"closing_side_offset": "3.90 mm"}
    one, two = (
        describe(c.machine_spec, 720)
        for c in (case, case.replace({GROOVES + "lagging_face": same}))
    )
    for gear in ("drive", "driven"):
        first, second = (opening(machine, gear, "outlet") for machine in (one, two))
        np.testing.assert_allclose(second, first, atol=2e-3 * first.max())


LEADING = {f"{GROOVES}closing_side_offset": "2.21 mm", f"{GROOVES}opening_side_offset": "4.39 mm"}
LAGGING = {"closing_side_offset": "4.39 mm", "opening_side_offset": "2.21 mm"}


def conductances(machine: MachineDescription) -> dict[tuple[int, int], Array]:
    """Cube of the height times width over length of all face paths between two nodes. [m3]."""
    found: dict[tuple[int, int], Array] = {}
    for path in machine.paths:
        if path.category in LATERAL_PATHS:
            height, width, length = np.moveaxis(
                path.geometry(path.phases + path.angle_ratio * ANGLES[:, None]), -1, 0
            )[:3]
            leaks = path.multiplicity * height**3 * width / length
            pairs = np.broadcast(path.nodes_a, path.nodes_b)
            for column, (a, b) in zip(leaks.T, pairs, strict=True):
                pair = min(a, b), max(a, b)
                found[pair] = found.get(pair, 0.0) + column
    return found


def test_solved_films_meet_the_grooves_of_their_face(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films beside equal faces leak as those of both together; the faces swapped, they swap."""
    coarse = FaceResolution(rows=24, lanes=16, angles=3)
    monkeypatch.setattr("toothspace.run.solved_films._RESOLUTION", coarse)
    case = ts.load_case(CASES / "helical_pump.toml").replace(
        {"machine.gears.helix_angle": "3 deg", **LEADING}
    )
    same = {key.removeprefix(GROOVES): value for key, value in LEADING.items()}
    swapped = {GROOVES + key: value for key, value in LAGGING.items()}
    both, ends, own, other = (
        with_solved_films(
            describe(case.replace(keys).machine_spec, 240),
            models={"lateral": "reynolds", "journal": "closed_form"},
        )
        for keys in (
            {},
            {GROOVES + "lagging_face": same | {"depth": "1.99 mm"}},
            {GROOVES + "lagging_face": LAGGING},
            swapped | {GROOVES + "lagging_face": same},
        )
    )
    together, apart = conductances(both), conductances(ends)
    assert together.keys() == apart.keys()
    most = max(leak.max() for leak in together.values())
    for pair, leak in together.items():
        assert apart[pair].mean() == pytest.approx(leak.mean(), rel=3e-2, abs=3e-3 * most)
    first, second = ({p.name: p.geometry.values for p in m.paths} for m in (own, other))
    names = [name for name in first if name.endswith("_leading") and "recess" in name]
    assert names
    for name in names:
        lagging = name.replace("_leading", "_lagging")
        np.testing.assert_array_equal(first[name], second[lagging])
        assert not np.array_equal(first[name], first[lagging])


def test_films_of_a_floating_bearing_meet_the_grooves_of_their_end() -> None:
    case = ts.load_case(CASES / "helical_thrust.toml").replace({GROOVES + "lagging_face": LAGGING})
    spec = case.machine_spec
    floating = describe(spec, 240).floating
    assert floating is not None
    for interface in floating.value.interfaces:
        wanted = spec.grooves if interface.lead > 0.0 else spec.lagging_grooves
        assert interface.face.face_map.assembly.spec.grooves is wanted


def test_equal_sides_share_their_faces() -> None:
    """One mask of tooth spaces and grooves then serves the films on both sides of a gear."""
    for name in ("hysteresis_055", "helical_thrust"):
        floating = describe(ts.load_case(CASES / f"{name}.toml").machine_spec, 240).floating
        assert floating is not None
        assert len({interface.face.face_map for interface in floating.value.interfaces}) == 2


@pytest.mark.slow
def test_slices_and_continuous_contact_have_a_groove_at_each_end() -> None:
    """The balances close, and both ends see their own groove."""
    face = {"closing_side_offset": "4.39 mm", "opening_side_offset": "2.21 mm"}
    given: tuple[tuple[str, dict[str, Any]], ...] = (
        ("helical_grooves", {"machine.gears.axial_slices": 3}),
        ("continuous_pump", {GROOVES + "lagging_face": face}),
    )
    for name, keys in given:
        found = ts.simulate(ts.load_case(CASES / f"{name}.toml").replace(keys)).summary()
        assert found["status"] == "done"
        assert found["mass_balance_error"] < 1e-6
        assert found["energy_balance_error"] < 1e-4


@pytest.mark.slow
def test_grooves_that_follow_the_helix_part_the_ports() -> None:
    """Spur grooves short-circuit a helix unless each face has its own timing."""
    case = ts.load_case(CASES / "helical_grooves.toml")
    spur = {f"{GROOVES}{side}_side_offset": "3.30 mm" for side in ("closing", "opening")}
    equal = case.replace(spur | {GROOVES + "lagging_face": None})
    own, same = (ts.simulate(one).summary() for one in (case, equal))
    assert own["volumetric_efficiency"] > same["volumetric_efficiency"] + 0.01
    assert own["flow_ripple_percent"] < 0.7 * same["flow_ripple_percent"]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"machine.gears.helix_angle": "0 deg", "machine.gears.helix_hand": None,
          GROOVES + "lagging_face": {"depth": "1 mm"}}, "lagging_face: .* a helix_angle"),
        ({GROOVES + "lagging_face": {"closing_side_angle": "60 deg", "width": "1 mm"}},
         "lagging_face.closing_side_angle"),
        ({GROOVES + "contour": "profiles/egm12_drive.txt",
          GROOVES + "lagging_face": {"depth": "1 mm"}}, "lagging_face.contour"),
    ],
)  # fmt: skip
def test_what_a_face_cannot_have_is_refused(keys: dict[str, Any], message: str) -> None:
    with pytest.raises((CaseError, GeometryError), match=message):
        ts.load_case(CASES / "helical_pump.toml").replace(keys).machine_spec  # noqa: B018
