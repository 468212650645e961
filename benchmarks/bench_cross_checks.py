"""Independent programs on the same problem, one table: agreement and time.

    python -m benchmarks cross_checks                # prints the table
    python -m benchmarks.bench_cross_checks --store  # writes it into the page

Journal bearing coefficients against ROSS, real contact of a rough surface against tamaas, a body
under pressure against CalculiX (``ccx``), one revolution of a motor against SUNDIALS, a gear drawn
by py_gearworks, a unit of a pump run by FMPy. A program that is not installed is left out by name;
times are wall times of one run after a warm-up, of the package and of the other.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.elasticity import influence_matrix

Row = tuple[str, float, float, str]
"""Quantity, found by the package, by the other, and unit."""


def timed(run: Callable[[], Any]) -> tuple[float, Any]:
    """Wall time of a second run and what it returns. [s]."""
    run()
    started = time.perf_counter()
    found = run()
    return time.perf_counter() - started, found


def ross() -> Iterator[Row | tuple[float, float]]:
    """Short bearing of ROSS, and the film solved with a length of a twentieth of the diameter."""
    import ross as rs

    from toothspace.films import JournalBearing

    diameter, length, clearance, viscosity, speed, weight = 0.1, 0.005, 100e-6, 0.05, 100.0, 8.0
    bearing = JournalBearing(
        diameter=diameter,
        length=length,
        radial_clearance=clearance,
        dynamic_viscosity=viscosity,
        grid=(288, 21),
        cavitation="guembel",
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )
    own_time, own = timed(lambda: bearing.equilibrium(load=(weight, 0.0), shaft_speed=speed))
    other_time, other = timed(
        lambda: rs.CylindricalBearing(
            n=0,
            speed=[speed],
            weight=weight,
            bearing_length=length,
            journal_diameter=diameter,
            radial_clearance=clearance,
            oil_viscosity=viscosity,
        )
    )
    yield own_time, other_time
    yield "eccentricity ratio", own.eccentricity_ratio, float(other.eccentricity[0]), ""
    # ROSS loads along -y: its y is this x
    pairs = {"xx": "yy", "yy": "xx", "xy": "yx", "yx": "xy"}
    place = {"x": 0, "y": 1}
    for kind, values, scale in (("k", own.stiffness, 1e-6), ("c", own.damping, 1e-3)):
        for mine, theirs in pairs.items():
            found = abs(float(values[place[mine[0]], place[mine[1]]])) * scale
            reference = abs(float(getattr(other, kind + theirs)[0])) * scale
            yield f"{kind}{mine}", found, reference, "N/um" if kind == "k" else "N s/mm"


def tamaas() -> Iterator[Row | tuple[float, float]]:
    """Elastic contact of a Gaussian surface with a Gaussian correlation of 16 points."""
    import tamaas as tm

    from toothspace.closures.contact_rough import real_contact_share

    size, half_height, modulus, rms = 512, 16.0, 1.0, 0.01
    wave = 2.0 * np.pi * np.fft.fftfreq(size)
    square = wave[:, None] ** 2 + wave[None, :] ** 2
    spectrum = np.exp(-square * half_height**2 / (8.0 * np.log(2.0)))
    noise = np.fft.fft2(np.random.default_rng(1).standard_normal((size, size)))
    surface = np.ascontiguousarray(np.fft.ifft2(noise * spectrum).real)
    surface *= rms / surface.std()
    tm.initialize(1)
    tm.set_log_level(tm.LogLevel.warning)

    def solved(pressure: float) -> float:
        model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [size, size], [size, size])
        model.E, model.nu = modulus, 0.0
        tm.PolonskyKeerRey(model, surface, 1e-9).solve(pressure)
        return float(np.mean(model.traction > 0.0))

    def fitted(pressure: float) -> float:
        share = real_contact_share(np.array([pressure]), rms, half_height, 2.0 * modulus, 1e9)
        return float(share[0])

    for pressure in (2e-5, 5e-5, 1e-4):
        other_time, contact = timed(partial(solved, pressure))
        own_time, own = timed(partial(fitted, pressure))
        yield own_time, other_time
        yield f"real contact at p/E* = {pressure:.0e}", 100.0 * own, 100.0 * contact, "%"


def calculix() -> Iterator[Row | tuple[float, float]]:
    """Bushing on its cover, pressed on a part of its face, on the mesh of both programs."""
    from tests.verification import test_calculix as case

    body = case._body(5e-3)
    with tempfile.TemporaryDirectory() as folder:
        other_time, other = timed(lambda: case._calculix(body, Path(folder)))
    own_time, own = timed(lambda: influence_matrix(body, estimate_error=False, cache=False))
    yield own_time, other_time
    radius = np.hypot(*own.nodes.T)
    inner = (radius > 11e-3) & (radius < 24e-3)
    sunk = case.PRESSURE * own.load_cases["push"][inner]
    expected = case.griddata(other[:, :2], other[:, 2], own.nodes[inner])
    yield "largest deformation", 1e6 * float(sunk.max()), 1e6 * float(expected.max()), "um"
    yield "mean deformation", 1e6 * float(sunk.mean()), 1e6 * float(expected.mean()), "um"


def sundials() -> Iterator[Row | tuple[float, float]]:
    """One revolution of the 12-tooth motor on the same compiled equations, tolerance 1e-7."""
    from benchmarks.bench_lumped import Problem, run_cvode, run_package

    problem = Problem()
    run_cvode(problem, 1e-3)
    own, other = run_package(problem, 1e-7), run_cvode(problem, 1e-7)
    yield own[0], other[0]
    first, second = (problem.pressures(run[1]) / 1e5 for run in (own, other))
    yield "highest chamber pressure", float(first.max()), float(second.max()), "bar"
    yield "mean chamber pressure", float(first.mean()), float(second.mean()), "bar"


def py_gearworks() -> Iterator[Row | tuple[float, float]]:
    """Gear of 12 teeth drawn by py_gearworks, written as STEP and read back."""
    from tests.verification.test_cad_matrix import GEARS, written
    from toothspace.geometry.gear_finder import find_gears

    drawn = GEARS[1]
    with tempfile.TemporaryDirectory() as folder:
        other_time, part = timed(drawn.part)
        path = written(Path(folder), part, "step", "mm")
        own_time, contents = timed(lambda: find_gears(path, 1e-3))
    yield own_time, other_time
    flank = contents.gears[0].detected.involute.flank
    base = 0.5 * drawn.module_mm * drawn.tooth_count * np.cos(np.deg2rad(drawn.angle_deg))
    yield "base radius", 1e3 * flank.base_radius, float(base), "mm"


def fmpy() -> Iterator[Row | tuple[float, float]]:
    """A pump at 1500 rpm and 140 bar, run, and as a unit of four such runs by FMPy."""
    from fmpy import simulate_fmu
    from fmpy.validation import validate_fmu

    import toothspace as ts

    case = ts.load_case("egm12_pump").replace(
        {
            "run.samples_per_revolution": 360,
            "operating_point.outlet_load": "fixed_pressure",
            "operating_point.shaft_speed": "1500 rpm",
            "operating_point.outlet_pressure": "141 bar",
        }
    )
    own_time, solution = timed(lambda: ts.simulate(case))
    held = {"inlet_pressure": 1e5, "outlet_pressure": 141e5, "shaft_speed": 50.0 * np.pi}
    names = {"outlet_flow_rate": (6e4, "mean_flow_L_per_min", "L/min")}
    names |= {"shaft_torque": (1.0, "mean_torque_N_m", "N m")}
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/unit.fmu"
        ts.export_fmu(
            case,
            path,
            pressure_difference=[ts.Quantity(60.0, "bar"), ts.Quantity(140.0, "bar")],
            shaft_speed=[ts.Quantity(900.0, "rpm"), ts.Quantity(1500.0, "rpm")],
        )
        assert validate_fmu(path) == []
        run = partial(
            simulate_fmu,
            path,
            stop_time=1e-2,
            start_values=held | {"ripple": False},
            output=[*names],
        )
        other_time, found = timed(run)
    yield own_time, other_time
    for name, (scale, key, unit) in names.items():
        yield name.replace("_", " "), solution.summary()[key], scale * float(found[name][-1]), unit


PROGRAMS: dict[str, tuple[str, str, Callable[[], Iterator[Row | tuple[float, float]]]]] = {
    "ROSS": ("ross", "ross-rotordynamics", ross),
    "tamaas": ("tamaas", "tamaas", tamaas),
    "CalculiX": ("ccx", "", calculix),
    "SUNDIALS by scikit-sundae": ("sksundae", "scikit-sundae", sundials),
    "py_gearworks": ("py_gearworks", "py-gearworks", py_gearworks),
    "FMPy": ("fmpy", "fmpy", fmpy),
}
"""Module or command that has to be there, distribution that has the version, and the check."""

PAGE = Path(__file__).resolve().parents[1] / "docs" / "validation" / "cross_checks.md"
_TABLE = re.compile(r"(?<=<!-- table -->\n).*?(?=<!-- end of table -->)", re.DOTALL)


def _version(needed: str, distribution: str) -> str:
    if distribution:
        return version(distribution)
    told = subprocess.run([needed, "-v"], capture_output=True, text=True, check=False).stdout
    return told.split()[-1]


def lines() -> Iterator[str]:
    """Rows of a Markdown table for every program that is there, names of those that are not."""
    yield "| with | quantity | here | there | difference | time here, there |"
    yield "|---|---|---|---|---|---|"
    absent = []
    for name, (needed, distribution, check) in PROGRAMS.items():
        if find_spec(needed) is None and shutil.which(needed) is None:
            absent.append(name)
            continue
        shown, spent = f"{name} {_version(needed, distribution)}", ""
        for row in check():
            if len(row) == 2:
                spent = f"{row[0]:.2g} s, {row[1]:.2g} s"
                continue
            quantity, own, other, unit = row
            change = 100.0 * (own / other - 1.0)
            values = " | ".join(f"{value:.4g} {unit}".rstrip() for value in (own, other))
            yield f"| {shown} | {quantity} | {values} | {change:.2g} % | {spent} |"
            shown = spent = ""
    yield ""
    yield f"Not installed: {', '.join(absent)}." if absent else "All were installed."


def main() -> None:
    """Print the table line by line."""
    for line in lines():
        print(line, flush=True)


def store() -> None:
    """Write the table into the page."""
    table = "\n".join(lines()) + "\n"
    PAGE.write_text(_TABLE.sub(lambda _: table, PAGE.read_text("utf-8")), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser("python -m benchmarks.bench_cross_checks", description=__doc__)
    parser.add_argument("--store", action="store_true", help="write the table into the page")
    store() if parser.parse_args().store else main()
