from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import fake_description, fake_solution
from toothspace import api
from toothspace.core.status import Event
from toothspace.model.description import Winding
from toothspace.model.path_category import OUTLET_PORT
from toothspace.plotting.catalogue import FIGURES, FigureEntry, available_figures
from toothspace.plotting.geometry import one_chamber, opening_area, opening_windows
from toothspace.plotting.section import (
    HEIGHTS,
    fluid_cells,
    gear_section,
    section_at,
    turned_section,
)
from toothspace.plotting.style import figure_to_svg, save_figure
from toothspace.results.solution import Solution

CASES = Path(__file__).resolve().parents[3] / "cases"
OVER_TIME = ("transient", "start")
OF_GEARS = [e for e in FIGURES if not e.rotors and "film_radius" not in e.needs]
"""Figures of gear pumps; rotors and lateral films are drawn where they are solved."""


@pytest.fixture(scope="module")
def parts() -> tuple[object, object]:
    return fake_solution(), fake_description()


def test_every_figure_is_available_with_solution_and_machine(parts) -> None:
    steady = [entry for entry in OF_GEARS if entry.sampled not in OVER_TIME]
    assert available_figures(*parts) == steady


def test_figures_of_the_machine_need_the_machine(parts) -> None:
    names = {entry.name for entry in available_figures(parts[0], None)}
    assert names.isdisjoint({"gear_section", "volumes", "openings"})
    assert "ripple" in names


def test_figures_whose_variables_are_missing_are_left_out(parts) -> None:
    solution = replace(parts[0], data=parts[0].data.drop_vars("contact_force"))
    assert "contact_forces" not in {e.name for e in available_figures(solution, parts[1])}


@pytest.mark.parametrize("entry", OF_GEARS, ids=lambda entry: entry.name)
def test_figures_have_titles_and_labelled_axes(entry: FigureEntry, parts, tmp_path: Path) -> None:
    solution = transient_solution() if entry.sampled in OVER_TIME else parts[0]
    figure = entry.draw(solution, parts[1])
    assert save_figure(figure, tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
    titles = [axes.get_title(loc="left") + axes.get_title() for axes in figure.axes]
    assert any(titles) or figure.get_suptitle()
    for axes in figure.axes:
        if axes.name == "rectilinear" and axes.axison and axes.get_ylabel():
            assert "(" in axes.get_ylabel()  # every quantity says its unit


def transient_solution() -> Solution:
    """The same samples over time, with what a run in a circuit adds."""
    solution = fake_solution()
    data = solution.data.swap_dims(shaft_angle="time")
    drop = abs(data["inlet_pressure"] - data["outlet_pressure"])
    data = data.assign(
        supply_speed=data["shaft_speed"],
        load_torque=0.5 * data["shaft_torque"],
        drive_torque=data["shaft_torque"],
        electric_power=1.2 * data["shaft_torque"] * data["shaft_speed"],
        pressure_difference=drop,
        pressure_difference_lowest=0.9 * drop,
        pressure_difference_highest=1.1 * drop,
        shaft_speed_lowest=0.9 * data["shaft_speed"],
        shaft_speed_highest=1.1 * data["shaft_speed"],
    )
    released = Event(0.0, float(data["time"][2]), "shaft_released", "shaft")
    return replace(solution, data=data, events=(released,))


def test_transient_runs_are_shown_over_time(parts) -> None:
    names = {entry.name for entry in available_figures(transient_solution(), parts[1])}
    assert "time_history" in names
    assert names.isdisjoint({"ripple", "gear_section", "chamber_pressure"})


def test_half_a_turn_has_no_spectrum(parts) -> None:
    half = replace(parts[0], data=parts[0].data.isel(shaft_angle=slice(0, 180)))
    names = {entry.name for entry in available_figures(half, parts[1])}
    assert "ripple" not in names
    assert "gear_section" in names


def test_drawing_leaves_global_settings_alone(parts) -> None:
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    figure_to_svg(FIGURES[-1].draw(*parts))
    assert dict(mpl.rcParams) == before


def test_svg_is_reproducible(parts) -> None:
    first, second = (figure_to_svg(FIGURES[-1].draw(*parts)) for _ in range(2))
    assert first == second
    assert first.startswith("<svg")


@pytest.mark.slow
@pytest.mark.parametrize("shaft_angle", [0.0, 0.2, 3.0])
@pytest.mark.parametrize(
    "name", ["egm12_pump", "crescent_pump", "gerotor_trochoidal", "gerotor_cycloidal"]
)
def test_cells_fill_the_fluid_of_a_machine_once(name: str, shaft_angle: float) -> None:
    import shapely

    description = api.describe(api.load_case(CASES / f"{name}.toml"))
    cells = fluid_cells(description, shaft_angle)
    assert len(cells) == description.chamber_count
    total = sum(cell.area for cell in cells)
    assert shapely.union_all(cells).area == pytest.approx(total, rel=1e-4)
    solids = [turned_section(description, body, shaft_angle) for body in description.bodies]
    assert shapely.union_all(solids).intersection(shapely.union_all(cells)).area < 2e-3 * total
    volumes = np.concatenate(
        [f.volume(f.phases + f.angle_ratio * shaft_angle)[:, 0] for f in description.families]
    )
    areas = np.array([cell.area for cell in cells])
    width = volumes.sum() / areas.sum()
    # pockets are booked with the layers between their lobes as one constant volume
    assert areas * width == pytest.approx(volumes, abs=5e-3 * volumes.max())


@pytest.mark.parametrize("name", ["crescent_pump", "gerotor_cycloidal"])
def test_a_ring_is_drawn_with_its_hole_and_without_its_cut(name: str) -> None:
    description = api.describe(api.load_case(CASES / f"{name}.toml"))
    body = description.bodies[1]
    for angle in np.linspace(0.0, 2.0, 21):
        ring = turned_section(description, body, float(angle))
        assert ring.geom_type == "Polygon"
        assert len(ring.interiors) == 1
        outside = np.hypot(*(np.asarray(ring.exterior.coords) - body.center).T)
        assert np.ptp(outside) < 1e-9


def test_a_chamber_that_turns_slower_than_the_shaft_is_shown_over_its_whole_turn() -> None:
    description = api.describe(api.load_case(CASES / "crescent_pump.toml"))
    shaft_angle = np.linspace(0.0, 2.0 * np.pi, 721)
    data = xr.Dataset(coords={"shaft_angle": shaft_angle})
    own = [f.phases + f.angle_ratio * shaft_angle[:, None] for f in description.families]
    columns = np.mod(np.concatenate(own, axis=1), 2.0 * np.pi)
    for family in description.families:
        angle, sample, column = one_chamber(data, description, family)
        assert angle == pytest.approx(columns[sample, column])
        assert angle[0] < 0.01
        assert angle[-1] > 2.0 * np.pi - 0.02
        assert np.diff(angle).max() < 0.02


def test_opening_windows_enclose_the_open_area() -> None:
    description = fake_description()
    family = description.families[0]
    ((start, end),) = opening_windows(description, family, OUTLET_PORT)
    outside = np.array([start - 0.05, end + 0.05])
    assert np.all(opening_area(description, family, OUTLET_PORT, outside) < 1e-8)
    middle = np.array([0.5 * (start + end)])
    assert opening_area(description, family, OUTLET_PORT, middle)[0] > 1e-5


def test_section_of_a_cut_space_holds_the_chamber_that_passes_there() -> None:
    """Its chamber has the volume of the space in a section of that place, at every height."""
    found = api.describe(api.load_case(CASES / "continuous_pump.toml"))
    winding, angle = found.winding, 0.2
    for lead in (-0.5 * winding.twist, 0.0, 0.5 * winding.twist):
        spaces, first, before = found.chambers_in_section(angle, lead), 0, 0
        assert np.unique(spaces).size == spaces.size
        for own, section in zip(found.families, winding.section.families, strict=True):
            turned = angle + lead
            cut = winding.along.cut.family(section)
            chosen = spaces[first : first + section.count] - before
            np.testing.assert_allclose(
                cut.volume(cut.phases[chosen] + turned),
                section.volume(section.phases + turned),
                rtol=1e-6,
            )
            first, before = first + section.count, before + own.count


def test_a_section_of_slices_holds_those_at_its_height() -> None:
    case = api.load_case(CASES / "helical_pump.toml")
    found = api.describe(case.replace({"machine.gears.axial_slices": 3}))
    half = 0.5 * found.winding.twist
    for part, (height, lead) in enumerate(zip(HEIGHTS, (-half, 0.0, half), strict=True)):
        cut = section_at(found, 0.2, height)
        assert cut.shaft_angle == pytest.approx(0.2 + lead, abs=1e-12)
        assert {found.chamber_labels[k].split("_")[3] for k in cut.chambers} == {str(part)}
        assert len(cut.drawn.chamber_outlines(cut.shaft_angle)) == cut.chambers.size


def test_sections_of_a_helix_are_drawn_at_three_heights() -> None:
    solution = fake_solution()
    section = fake_description()
    helical = replace(section, winding=Winding(5.0, 0.1, section, lambda path: (path,)))
    titles = [axes.get_title(loc="left") for axes in gear_section(solution, helical).axes]
    assert titles[:3] == ["z = -10.0 mm", "z = +0.0 mm", "z = +10.0 mm"]
