"""Files of the parts of a machine have the dimensions that its case gives them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from toothspace import api
from toothspace.core.registry import optional_function
from toothspace.core.types import Array
from toothspace.geometry.cad_import import load_closed_curves

CASES = Path(__file__).resolve().parents[3] / "cases"
MACHINES: dict[str, Any] = {
    "egm12_pump": lambda spec: {"drive": (0.5 * spec.drive.tooth.tip_diameter, None)},
    "crescent_pump": lambda spec: {
        "pinion": (0.5 * spec.pinion.tip_diameter, None),
        "ring": (0.5 * spec.ring.outer_diameter, 0.5 * spec.ring.tip_diameter),
    },
    "gerotor_trochoidal": lambda spec: {
        # lobes of the outer rotor stand at its generating radius, tips of the inner one reach them
        "outer": (
            0.5 * spec.housing.outer_rotor_diameter,
            spec.rotors.generating_radius - spec.rotors.lobe_radius,
        ),
    },
}
"""Outside radius of the parts of a machine and the least radius of their holes, if any. [m]"""


def radii(curve: Array) -> Array:
    return np.asarray(np.hypot(*curve.T))


@pytest.mark.parametrize("name", MACHINES)
def test_parts_have_the_diameters_of_the_case(name: str, tmp_path: Path) -> None:
    case = api.load_case(CASES / f"{name}.toml")
    export = optional_function(case.machine_type, "export_profiles")
    assert export is not None
    paths = export(case.machine_spec, tmp_path / "part", "dxf")
    files = {path.stem.rpartition("_")[2]: load_closed_curves(path) for path in paths}
    for part, (outside, hole) in MACHINES[name](case.machine_spec).items():
        curves = files[part]
        assert radii(curves[0]).max() == pytest.approx(outside, rel=1e-5), part
        assert len(curves) == (1 if hole is None else 2), part
        if hole is not None:
            assert radii(curves[1]).min() == pytest.approx(hole, rel=1e-3), part


def test_rims_are_circles_that_close_once(tmp_path: Path) -> None:
    """Corners on a circle, evenly apart: the area of a polygon of as many."""
    for name, part in (("crescent_pump", "ring"), ("gerotor_trochoidal", "outer")):
        case = api.load_case(CASES / f"{name}.toml")
        export = optional_function(case.machine_type, "export_profiles")
        assert export is not None
        paths = export(case.machine_spec, tmp_path / name, "dxf")
        (path,) = (one for one in paths if one.stem.endswith(f"_{part}"))
        rim = load_closed_curves(path)[0]
        radius = radii(rim).max()
        count = len(np.unique(rim.round(9), axis=0))
        polygon = shapely.Polygon(rim)
        assert polygon.is_valid
        even = 0.5 * count * np.sin(2.0 * np.pi / count) * radius**2
        assert polygon.area == pytest.approx(even, rel=1e-6)
