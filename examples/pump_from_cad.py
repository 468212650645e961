"""A whole pump from one STEP assembly: gears on their shafts, housing with ports, bearing block.

The assembly is drawn here with the CAD kernel, as a program would export it: axis along y,
away from the origin, named parts, shafts, a keyway. ``toothspace`` then finds teeth, centre
distance, bores, port edges and relief grooves in it. Needs ``pip install "toothspace[cad]"``.

    python examples/pump_from_cad.py pump.step
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import toothspace as ts
from toothspace.geometry.cad_export import gear_section, step_face
from toothspace.geometry.involute import InvoluteGear, generate_profile

CASE = """
schema = 1
title = "Pump from a CAD assembly"

[machine]
type = "external_gear"
mode = "pump"
outlet_toward = "+x"

[machine.gears]
profile = "{file}"
profile_part = "drive gear"

[machine.driven_gear]
profile_part = "driven gear"

[machine.casing]
contour = "{file}"
contour_part = "housing"
radial_clearance = "20 um"

[machine.relief_grooves]
contour = "{file}"
contour_part = "bearing block"

[machine.journal_bearings]
diameter = "18 mm"
length = "19 mm"
radial_clearance = "8 um"

[machine.lateral]
side_gap = "8 um"

[machine.seals]
shaft_seal_torque = "0.15 N m"

[fluid]
name = "iso_vg_46"
temperature = "50 degC"

[operating_point]
shaft_speed = "1500 rpm"
inlet_pressure = "1 bar"
outlet_pressure = "200 bar"

[run]
fidelity = "{fidelity}"
until = "cyclic"
"""


@dataclass(frozen=True)
class Pump:
    """What is drawn, in mm and degrees; gears and grooves of ``cases/egm12_pump.toml``."""

    width: float = 7.63
    distance: float = 34.56747
    bore: float = 20.206
    inlet_edge: float = 70.0
    outlet_edge: float = 55.0
    groove_edge: float = 3.4
    groove_depth: float = 1.5
    shaft: float = 9.0

    @property
    def gear(self) -> InvoluteGear:
        angle = math.radians(20.0)
        return InvoluteGear(12, 2.75e-3, angle, 0.3, 40.372e-3, tip_rounding=1e-4)


def cylinder(radius: float, x: float, y: float, low: float, high: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    place = gp_Ax2(gp_Pnt(x, y, low), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeCylinder(place, radius, high - low).Shape()


def box(*ends: tuple[float, float]) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    low, high = ([end[k] for end in ends] for k in (0, 1))
    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def joined(first: Any, *others: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    for other in others:
        first = BRepAlgoAPI_Fuse(first, other).Shape()
    return first


def without(body: Any, *tools: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    for tool in tools:
        body = BRepAlgoAPI_Cut(body, tool).Shape()
    return body


def gear_on_shaft(pump: Pump, y: float, low: float, high: float) -> Any:
    """Teeth from z = 0 to the width, shaft from low to high with a keyway at its end."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Trsf, gp_Vec

    face = step_face(gear_section(generate_profile(pump.gear, 200)))
    teeth = BRepPrimAPI_MakePrism(face, gp_Vec(0.0, 0.0, pump.width)).Shape()
    shaft = without(
        cylinder(pump.shaft, 0.0, 0.0, low, high), box((-2.5, 2.5), (6.0, 12.0), (high - 15, high))
    )
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0.0, y, 0.0))
    return BRepBuilderAPI_Transform(joined(teeth, shaft), move, True).Shape()


def housing(pump: Pump) -> Any:
    """Block with both bores; the ports cut them at their edges over the whole face width."""
    across = (-34.0, 34.0), (-30.0, pump.distance + 30.0)
    body = box(*across, (-22.0, pump.width + 22.0))
    bores = [cylinder(pump.bore, 0.0, y, -22.0, pump.width + 22.0) for y in (0.0, pump.distance)]
    ports = []
    for side, edge in ((-1.0, pump.inlet_edge), (1.0, pump.outlet_edge)):
        low = pump.bore * math.cos(math.radians(edge))
        ends = sorted([side * 2.0, side * 40.0])
        ports.append(box((ends[0], ends[1]), (low, pump.distance - low), (0.0, pump.width)))
    return without(body, *bores, *ports)


def bearing_block(pump: Pump) -> Any:
    """Figure of eight beside the gears with two shaft bores and a groove on each side."""
    ends = pump.width, pump.width + 20.0
    outer = [cylinder(pump.bore - 0.03, 0.0, y, *ends) for y in (0.0, pump.distance)]
    bores = [cylinder(pump.shaft + 0.008, 0.0, y, *ends) for y in (0.0, pump.distance)]
    middle = 0.5 * pump.distance
    across, depth = (middle - 5.0, middle + 5.0), (ends[0], ends[0] + pump.groove_depth)
    grooves = [
        box(
            tuple(sorted([side * pump.groove_edge, side * (pump.groove_edge + 10.0)])),
            across,
            depth,
        )
        for side in (-1.0, 1.0)
    ]
    return without(joined(*outer), *bores, *grooves)


def write_assembly(path: Path, pump: Pump) -> None:
    """Write the parts with their names; the axis lies along y of the file."""
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    from toothspace.geometry.ocp import silence_ocp

    silence_ocp()
    turn, move = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(1.0, 0.0, 0.0)), -0.5 * math.pi)
    move.SetTranslation(gp_Vec(12.0, -7.0, 30.0))
    parts = {
        "drive gear": gear_on_shaft(pump, 0.0, -20.0, pump.width + 60.0),
        "driven gear": gear_on_shaft(pump, pump.distance, -20.0, pump.width + 20.0),
        "housing": housing(pump),
        "bearing block": bearing_block(pump),
    }
    document = TDocStd_Document(TCollection_ExtendedString("pump"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    for name, shape in parts.items():
        label = shapes.AddShape(shape.Moved(TopLoc_Location(move.Multiplied(turn))), False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    writer = STEPCAFControl_Writer()
    writer.Transfer(document)
    writer.Write(str(path))


def case_of(path: Path, fidelity: str = "lumped") -> ts.Case:
    """Case that takes the whole machine from the assembly."""
    toml = path.with_suffix(".toml")
    toml.write_text(CASE.format(file=path.name, fidelity=fidelity))
    return ts.load_case(toml)


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "pump.step")
    write_assembly(target, Pump())
    solution = ts.simulate(case_of(target))
    for name, value in solution.summary().items():
        print(f"{name:32s} {value}")
