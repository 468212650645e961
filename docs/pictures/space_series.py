"""Picture of a series for ParaView, drawn by VTK: python docs/pictures/space_series.py FILE.vtkhdf.

Needs the package ``vtk``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import vtkmodules.vtkRenderingFreeType
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  what draws
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkDataSetMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

BAR = 1e5


def main(source: Path, target: Path) -> None:
    """Draw gears, tooth spaces and the films beside the gears."""
    reader = vtkHDFReader()
    reader.SetFileName(str(source))
    reader.UpdateInformation()
    reader.SetStep(reader.GetNumberOfSteps() - 1)  # films are those of the last state
    reader.Update()
    found = reader.GetOutputDataObject(0)
    parts = {
        found.GetMetaData(i).Get(found.NAME()): found.GetPartition(i, 0)
        for i in range(found.GetNumberOfPartitionedDataSets())
    }
    renderer = vtkRenderer()
    renderer.SetBackground(1.0, 1.0, 1.0)
    high = vtk_to_numpy(parts["outlet"].GetCellData().GetArray("pressure"))[0]
    colours = _colours(high / BAR)
    for name, part in parts.items():
        shift = 0.0
        if name.startswith("film_"):
            shift = 24e-3 if "floating" in name else -24e-3
        actor = _actor(part, colours)
        actor.SetPosition(0.0, 0.0, shift)
        if name in ("drive_gear", "driven_gear"):
            actor.GetProperty().SetColor(0.78, 0.8, 0.83)
        if name == "casing":
            actor.GetProperty().SetColor(0.6, 0.6, 0.6)
            actor.GetProperty().SetOpacity(0.25)
        if name != "casing":
            actor.GetProperty().SetInterpolationToFlat()
        renderer.AddActor(actor)
    bar = vtkScalarBarActor()
    bar.SetLookupTable(colours)
    bar.SetTitle("bar")
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.0f")
    bar.SetUnconstrainedFontSize(True)
    bar.GetTitleTextProperty().SetFontSize(18)
    bar.GetLabelTextProperty().SetFontSize(16)
    bar.SetMaximumWidthInPixels(60)
    bar.SetMaximumHeightInPixels(260)
    bar.SetPosition(0.9, 0.3)
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        text.SetColor(0.1, 0.1, 0.1)
        text.ItalicOff()
        text.ShadowOff()
    renderer.AddViewProp(bar)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(1100, 700)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(0.16, 0.05, 0.11)
    camera.SetFocalPoint(0.0, 0.0173, 0.0038)
    camera.SetViewUp(0.0, 1.0, 0.0)
    renderer.ResetCamera()
    camera.Zoom(1.25)
    window.Render()
    picture = vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(str(target))
    writer.SetInputConnection(picture.GetOutputPort())
    writer.Write()


def _colours(high: float) -> Any:
    table = vtkLookupTable()
    table.SetHueRange(0.58, 0.02)
    table.SetSaturationRange(0.35, 0.85)
    table.SetValueRange(0.95, 0.8)
    table.SetRange(0.0, high)
    table.Build()
    return table


def _actor(part: Any, colours: Any) -> vtkActor:
    surface = vtkGeometryFilter()
    surface.SetInputData(part)
    surface.Update()
    drawn = surface.GetOutput()
    mapper = vtkDataSetMapper()
    mapper.SetInputData(drawn)
    pressure = drawn.GetCellData().GetArray("pressure")
    if pressure is None:
        mapper.ScalarVisibilityOff()
    else:
        vtk_to_numpy(pressure)[:] /= BAR
        drawn.GetCellData().SetActiveScalars("pressure")
        mapper.SetLookupTable(colours)
        mapper.UseLookupTableScalarRangeOn()
        mapper.SetScalarModeToUseCellData()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.45)
    actor.GetProperty().SetDiffuse(0.6)
    return actor


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(__file__).with_name("space_series.png"))
