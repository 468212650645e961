"""Areas behind a floating bearing from drawn outlines."""

from __future__ import annotations

from pathlib import Path

import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.core.errors import ToothspaceError
from toothspace.model.floating_bearing import FloatingBearing, LateralBalance

CASE = Path(__file__).parents[3] / "cases" / "hysteresis_055.toml"
SEAL = 6.45
BEHIND_THE_SEAL = [(SEAL, -60.0), (60.0, -60.0), (60.0, 120.0), (SEAL, 120.0)]
SQUARE = [(-30.0, 21.53), (-10.0, 21.53), (-10.0, 41.53), (-30.0, 41.53)]
TRIANGLE = [(-30.0, 20.0), (0.0, 20.0), (-30.0, 50.0)]


def _drawn(folder: Path, name: str, *polygons: list[tuple[float, float]]) -> str:
    """Write polygons [mm] to a file; return the value of its key."""
    path = folder / name
    blocks = ["\n".join(f"{x},{y}" for x, y in points) for points in polygons]
    path.write_text("\n\n".join(blocks) + "\n", encoding="utf-8")
    return f'{{contour="{path}"}}'


def _balance(*changes: str) -> LateralBalance:
    given = [f"machine.floating_bearing.{change}" for change in changes]
    balance = api.describe(load_case(CASE, given)).lateral_balance
    assert balance is not None
    return balance


def _bearing(*changes: str) -> FloatingBearing:
    return _balance(*changes).floating


def test_outlines_give_the_areas_of_seal_line_and_square(tmp_path: Path) -> None:
    plain = _bearing('high_pressure_area={seal_line_x="6.45 mm"}')
    high = _drawn(tmp_path, "high.csv", BEHIND_THE_SEAL)
    nose = _drawn(tmp_path, "nose.csv", SQUARE)
    drawn = _bearing(f"high_pressure_area={high}", f"nose={nose}")
    for name in ("high_pressure", "nose"):
        found, wanted = getattr(drawn, name), getattr(plain, name)
        assert found.moments == pytest.approx(wanted.moments, rel=1e-9)


def test_nose_of_any_shape_has_its_area_and_centroid(tmp_path: Path) -> None:
    balance = _balance(f"nose={_drawn(tmp_path, 'nose.csv', TRIANGLE)}")
    nose = balance.floating.nose
    assert nose.area == pytest.approx(450e-6)
    assert nose.center == pytest.approx((-20e-3, 30e-3))
    assert balance.elastic_bodies is not None
    loads = [x for x in balance.elastic_bodies.loads(0.0) if x.load == "nose"]
    assert [x.factor for x in loads] == pytest.approx([nose.area])


def test_halves_share_a_drawn_nose(tmp_path: Path) -> None:
    nose = f"nose={_drawn(tmp_path, 'nose.csv', TRIANGLE)}"
    halves = [half.nose for half in _balance(nose, "split=true").halves]
    assert sum(half.area for half in halves) == pytest.approx(450e-6)
    assert halves[0].center[1] < 31.53e-3 < halves[1].center[1]


@pytest.mark.parametrize(
    ("key", "polygons", "wanted"),
    [
        ("high_pressure_area", [[(x + 200.0, y) for x, y in SQUARE]], "on its back face"),
        ("high_pressure_area", [SQUARE, TRIANGLE], "one polygon"),
        ("nose", [[(x + 35.0, y) for x, y in SQUARE]], "mm^2 in the high-pressure area"),
        ("nose", [[(x - 90.0, y) for x, y in SQUARE]], "within the bearing"),
    ],
)
def test_outline_at_a_wrong_place_is_refused(
    tmp_path: Path, key: str, polygons: list[list[tuple[float, float]]], wanted: str
) -> None:
    with pytest.raises(ToothspaceError) as refused:
        _bearing(f"{key}={_drawn(tmp_path, 'drawn.csv', *polygons)}")
    assert f"machine.floating_bearing.{key}." in str(refused.value)
    assert wanted in str(refused.value)


@pytest.mark.parametrize("given", ['{contour="a.csv",area="4 mm^2"}', '{area="4 mm^2"}'])
def test_nose_is_drawn_or_a_square(given: str) -> None:
    with pytest.raises(ToothspaceError) as refused:
        _bearing(f"nose={given}")
    assert "machine.floating_bearing.nose." in str(refused.value)


def test_wall_holds_by_the_compression_of_the_bearing() -> None:
    """E A L^2 / (12 t): 205 GPa, 900 mm2, 38 mm, half of the width of 72.12 mm as layer."""
    wanted = 205e9 * 900e-6 * 38e-3**2 / (12.0 * 36.06e-3)
    assert _bearing().wall_stiffness == pytest.approx(wanted, rel=1e-4)
    assert _bearing('wall_stiffness="0 N m/rad"').wall_stiffness == 0.0
    none = 'housing_contact={area = "0 mm^2", friction_coefficient = 0.008}'
    assert _bearing(none).wall_stiffness == 0.0
