"""Journal bearings and pads of the literature: each as its source has it, and what it claims."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from toothspace.closures.journal_friction import PUBLISHED_CURVE
from toothspace.core.types import Array
from toothspace.films import Groove, JournalBearing, Lobes, RoughSurfaces, sweep_friction
from toothspace.films.journal.mixed_lubrication import FrictionSweep
from toothspace.films.journal.solution import JournalBearingSolution
from toothspace.films.plane.pad import Pad, Pocket
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    Effort,
    Evidence,
    ValidationSource,
    close,
    columns,
    rows_of,
    within,
)

RAIMONDI = ValidationSource(
    "raimondi_boyd_1958",
    "Full journal bearing",
    "A. A. Raimondi, J. Boyd, A solution for the finite journal bearing, part III, ASLE Trans. 1 "
    "(1958) 194-209; grid-converged finite differences (720 x 60) of the case that they tabulate.",
)
BUTENSCHOEN = ValidationSource(
    "butenschoen_1976",
    "Journal bearing of finite length, rotation and squeeze",
    "H.-J. Butenschoen, dissertation, Karlsruhe 1976, "
    "as tabulated in the tests of mboct-mbdyn-pkg.",
)
LUND = ValidationSource(
    "lund_thomsen_1978",
    "Bearing with two axial grooves, and two lobes: equilibrium and dynamic coefficients",
    "J. W. Lund, K. K. Thomsen, in: Topics in Fluid Film Bearing and Rotor Bearing System Design, "
    "ASME 1978, 1-28, as tabulated in the tests of petrobras/ross.",
    "The attitude angle printed as 83.29 degrees is read as 85.29: it breaks the run of the row.",
)
ELROD = ValidationSource(
    "elrod_1981",
    "Mass-conserving journal bearing with one pressurised groove",
    "H. G. Elrod, J. Lubr. Technol. 103 (1981) 350-354; runs of the public finite-volume program "
    "fvm_elrod (simonpfeil).",
)
BERTOCCHI = ValidationSource(
    "bertocchi_2013",
    "Pad with a square pocket, compressible and piezoviscous",
    "L. Bertocchi et al., Tribol. Int. 67 (2013) 61-71, digitised pressure along the centre line.",
)
COMSOL = ValidationSource(
    "comsol_journal",
    "Heavily loaded journal bearing at 10 000 rpm",
    "COMSOL Multiphysics application library, elastohydrodynamic lubrication in a cylindrical "
    "journal bearing, digitised mid-plane pressure.",
    "Two supply grooves at 0 and 180 degrees, 10 degrees wide, where the published curve begins.",
)
PAWAR = ValidationSource(
    "pawar_friction",
    "Friction of the motor's journal bearing over the Sommerfeld number",
    "A. Pawar, A. Vacca, M. Rigosi, Modelling and experimental validation of the dynamic startup "
    "behavior of external spur gear motor, equation 2.7.",
    "Load of Table 2. Roughness, hardness, clearance and boundary friction are not given and free: "
    "0.13/0.27 um, 0.3 GPa, c/r 1.0e-3, 0.05.",
)


SPEED = 100.0
"""Shaft speed of the bearings whose source has numbers without dimension. [rad/s]"""


def raimondi_bearing(
    length_over_diameter: float,
    grid: tuple[int, int] = (240, 31),
    cavitation: str = "reynolds",
) -> JournalBearing:
    """Full bearing of Raimondi and Boyd; its numbers have no dimension."""
    return JournalBearing(
        diameter=0.02,
        length=0.02 * length_over_diameter,
        radial_clearance=10e-6,
        dynamic_viscosity=0.03,
        grid=grid,
        cavitation=cavitation,
    )


def butenschoen_bearing(
    length_over_diameter: float, grid: tuple[int, int] = (240, 31)
) -> JournalBearing:
    """Full bearing of Butenschoen; its numbers have no dimension."""
    return JournalBearing(
        diameter=0.1,
        length=0.1 * length_over_diameter,
        radial_clearance=50e-6,
        dynamic_viscosity=0.01,
        grid=grid,
        cavitation="reynolds",
    )


def lund_thomsen_bearing(
    length_over_diameter: float, elliptical: bool, cavitation: str = "reynolds"
) -> JournalBearing:
    """Bearing with two axial grooves of 20 degrees, cylindrical or of two lobes."""
    length = 0.1 * length_over_diameter
    return JournalBearing(
        diameter=0.1,
        length=length,
        radial_clearance=100e-6,
        dynamic_viscosity=0.01,
        grid=(144, 21),
        cavitation=cavitation,
        grooves=tuple(
            Groove(side * np.pi / 2, np.radians(20.0), length, 0.0) for side in (1.0, -1.0)
        ),
        lobes=Lobes(2, 0.5) if elliptical else None,
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )


def lund_thomsen_load(bearing: JournalBearing, sommerfeld_number: float) -> float:
    """Load at their Sommerfeld number ``mu N L D (R / c)^2 / W``. [N]."""
    stiff = (0.5 * bearing.diameter / bearing.radial_clearance) ** 2
    rate = SPEED / (2.0 * np.pi)
    area = bearing.diameter * bearing.length
    return float(bearing.dynamic_viscosity * rate * area * stiff / sommerfeld_number)


def elrod_film(row: Mapping[str, float]) -> JournalBearingSolution:
    """Film of the bearing with one groove of 15 degrees, for a row of the table."""
    length = float(row["l_b_m"])
    bearing = JournalBearing(
        diameter=float(row["d_b_m"]),
        length=length,
        radial_clearance=float(row["c_m"]),
        dynamic_viscosity=float(row["mu_Pas"]),
        grid=(int(row["n_x"]), int(row["n_y"])),
        cavitation="guembel" if row["guembel"] else "jfo",
        grooves=(Groove(np.pi / 2, np.radians(15.0), 0.75 * length, float(row["p_groove_Pa"])),),
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )
    return bearing.solve(
        eccentricity=(float(row["eps_h"]), float(row["eps_v"])),
        shaft_speed=float(row["rpm"]) * np.pi / 30.0,
    )


def bertocchi_pad(grid: tuple[int, int] = (160, 80)) -> Pad:
    """Pad with the small pocket; it slides at 1 m/s."""
    return Pad(
        length=20e-3,
        width=10e-3,
        inlet_height=1.1e-6,
        outlet_height=1.0e-6,
        fluid=FilmFluid(0.01, pressure_viscosity=1.2e-8, compressible=True),
        pocket=Pocket(0.4e-6, 4e-3, 6e-3, 7e-3),
        grid=grid,
        ambient_pressure=1e5,
    )


def comsol_film(
    grid: tuple[int, int] = (180, 21), cavitation: str = "jfo"
) -> JournalBearingSolution:
    """Bearing under 40 kN at 10 000 rpm; 11th lane: the mid plane."""
    bearing = JournalBearing(
        diameter=0.2,
        length=0.067,
        radial_clearance=200e-6,
        dynamic_viscosity=0.075,
        pressure_viscosity=25e-9,
        grid=grid,
        cavitation=cavitation,
        grooves=tuple(Groove(angle, np.radians(10.0), 0.067, 0.0) for angle in (0.0, np.pi)),
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )
    return bearing.equilibrium(load=(0.0, -40e3), shaft_speed=10000.0 * np.pi / 30.0)


def pawar_sweep(
    sommerfeld_numbers: ArrayLike,
    grid: tuple[int, int] = (144, 15),
    cavitation: str = "jfo",
    roughness: tuple[float, float] = (0.13e-6, 0.27e-6),
) -> FrictionSweep:
    """Friction of the motor's journal bearing at the load of Table 2.

    Parameters
    ----------
    sommerfeld_numbers : array
        Where. [-]
    grid, cavitation
        Of the film.
    roughness : tuple
        Of journal and bush, root mean square; the source does not give it. [m]
    """
    bearing = JournalBearing(
        diameter=18e-3,
        length=19e-3,
        radial_clearance=1e-3 * 9e-3,
        dynamic_viscosity=0.026,
        grid=grid,
        cavitation=cavitation,
        surfaces=RoughSurfaces(
            moving_roughness=roughness[0],
            resting_roughness=roughness[1],
            correlation_length=15e-6,
            effective_modulus=50e9,
            hardness=0.3e9,
            boundary_friction=0.05,
        ),
    )
    numbers = [float(s) for s in np.ravel(sommerfeld_numbers)]
    return sweep_friction(bearing, load=5500.0, sommerfeld_numbers=numbers)


def _raimondi(effort: Effort) -> Evidence:
    rows = columns("raimondi_boyd_1958")
    keep = rows["length_over_diameter"] == 1.0
    ratio, published = rows["eccentricity_ratio"][keep], rows["sommerfeld_number"][keep]
    grid, rel, margin = ((240, 31), 0.007, 0.1) if effort == "full" else ((120, 21), 0.02, 0.4)
    bearing = raimondi_bearing(1.0, grid)
    films = [bearing.solve(eccentricity=(float(e), 0.0), shaft_speed=200.0) for e in ratio]
    found = np.array([film.sommerfeld_number for film in films])
    angles = np.degrees([film.attitude_angle for film in films])
    values = [
        close(f"Sommerfeld number at eps = {e:g}", s, p, "-", rel=rel)
        for e, s, p in zip(ratio, found, published, strict=True)
    ]
    values += [
        close(f"attitude angle at eps = {e:g}", a, p, "deg", margin=margin)
        for e, a, p in zip(ratio, angles, rows["attitude_angle_deg"][keep], strict=True)
    ]
    title = "Sommerfeld number, L/D = 1"
    curve = ComparedCurve(title, "eccentricity ratio", "S", ratio, found, published)
    return Evidence(tuple(values), (curve,))


def _butenschoen(effort: Effort) -> Evidence:
    rows = columns("butenschoen_1976", "rotation.csv")
    keep = (rows["B_over_D"] == 0.5) & (rows["eps"] <= 0.9)
    if effort == "short":
        keep &= np.arange(keep.size) % 2 == 0
    grid, rel = ((240, 31), 0.007) if effort == "full" else ((120, 21), 0.02)
    bearing = butenschoen_bearing(0.5, grid)
    eps = rows["eps"][keep]
    unit_flow = (0.5 * bearing.diameter) ** 2 * bearing.radial_clearance * SPEED
    films = [bearing.solve(eccentricity=(float(e), 0.0), shaft_speed=SPEED) for e in eps]
    loads = np.array([film.sommerfeld_number_din for film in films])
    flows = [film.side_flow / unit_flow for film in films]
    values = [
        close(f"So at eps = {e:g}", s, p, "-", rel=rel)
        for e, s, p in zip(eps, loads, rows["So"][keep], strict=True)
    ]
    values += [
        close(f"side flow at eps = {e:g}", q, p, "-", rel=rel)
        for e, q, p in zip(eps, flows, rows["Q"][keep], strict=True)
    ]
    title = "Load in pure rotation, B/D = 0.5"
    curve = ComparedCurve(title, "eccentricity ratio", "So", eps, loads, rows["So"][keep])
    return Evidence(tuple(values), (curve,))


def _lund(effort: Effort) -> Evidence:
    rows = columns("lund_thomsen_1978")
    names = [row["bearing"] for row in rows_of("lund_thomsen_1978")]
    worst, eccentricities = 0.0, []
    picked = range(0, len(names), 1 if effort == "full" else 6)
    for k in picked:
        bearing = lund_thomsen_bearing(float(rows["L_over_D"][k]), "elliptical" in names[k])
        load = lund_thomsen_load(bearing, float(rows["S"][k]))
        film = bearing.equilibrium(load=(load, 0.0), shaft_speed=SPEED)
        eccentricities.append(film.eccentricity_ratio)
        scale = bearing.radial_clearance / load
        found = scale * np.stack([film.stiffness, SPEED * film.damping]).ravel()
        headings = ("Kxx", "Kxy", "Kyx", "Kyy", "Bxx", "Bxy", "Bxy", "Byy")
        table = np.array([rows[name][k] for name in headings])
        error = np.abs(found - table) / np.maximum(0.06 * np.abs(table), 0.02)
        worst = max(worst, float(error.max()))
    published, ours = rows["eps"][list(picked)], np.array(eccentricities)
    largest = np.abs(ours - published).max()
    text = "largest error of K and B over max(6 % of itself, 0.02)"
    axes = "published eccentricity ratio", "eccentricity ratio"
    curve = ComparedCurve("Equilibrium", *axes, published, ours, published, tolerance=0.01)
    values = (
        within("largest error of the eccentricity ratio", largest, "-", "table", 0.0, 0.01),
        within(text, worst, "-", "table", 0.0, 1.0),
    )
    return Evidence(values, (curve,))


def _elrod(effort: Effort) -> Evidence:
    rows = columns("elrod_1981")
    largest = 200 if effort == "short" else 400
    values = []
    for k in np.flatnonzero((rows["n_x"] <= largest) & (rows["n_x"] >= 200)):
        film = elrod_film({name: float(column[k]) for name, column in rows.items()})
        name = f"eps {rows['eps_h'][k]:g}, {int(rows['n_x'][k])} cells"
        name += ", linear" if rows["guembel"][k] else ""
        load = float(np.hypot(rows["F_h_N"][k], rows["F_v_N"][k]))
        torque, flow = rows["M_fr_Nm"][k], -rows["V_dot_m3ps"][k] * 6e4
        values += [
            close(f"force, {name}", film.load, load, "N", rel=0.01),
            close(f"friction, {name}", film.bush_friction_torque, torque, "N m", rel=0.005),
            close(f"side flow, {name}", film.side_flow * 6e4, flow, "L/min", rel=0.04),
        ]
    return Evidence(tuple(values))


def _bertocchi(effort: Effort) -> Evidence:
    rows = columns("bertocchi_2013")
    place, published = rows["x"], rows["p_small_pocket"]
    pad = bertocchi_pad((160, 80) if effort == "full" else (120, 60))
    film = pad.solve(speed=1.0)
    along = film.pressure_centerline / 1e6
    found = np.interp(place * pad.length, film.x, along)
    peak = float(published.max())
    rms = float(np.sqrt(np.mean((found - published) ** 2)))
    title, axes = "Pressure along the centre line", ("place over length", "pressure (MPa)")
    curve = ComparedCurve(title, *axes, film.x / pad.length, along, published, place)
    values = (
        close("peak pressure", along.max(), peak, "MPa", rel=0.03),
        within("root mean square deviation over the peak", rms / peak, "-", "curve", 0.0, 0.03),
    )
    return Evidence(values, (curve,))


def _comsol(effort: Effort) -> Evidence:
    rows = columns("comsol_journal")
    film = comsol_film((180, 21) if effort == "full" else (120, 21))
    pressure = film.pressure[:, 10] / 1e5
    published, peak = rows["p_bar"], float(rows["p_bar"].max())
    title, axes = "Pressure in the mid plane", ("angle (deg)", "pressure (bar)")
    found, known = (np.degrees(film.angle) % 360.0, pressure), (published, rows["phi_deg"])
    curve = ComparedCurve(title, *axes, *found, *known, tolerance=0.07 * peak)
    return Evidence((close("peak pressure", pressure.max(), peak, "bar", rel=0.05),), (curve,))


def _friction(effort: Effort) -> Evidence:
    numbers = np.geomspace(0.001, 0.2, 16 if effort == "full" else 9)
    sweep = pawar_sweep(numbers, (144, 15) if effort == "full" else (96, 11))
    found: Array = np.asarray(sweep.friction_coefficient)
    published = np.array([PUBLISHED_CURVE(s) for s in numbers]).ravel()
    rows = [
        (f"friction coefficient at S = {s:.2g}", ours, p)
        for s, ours, p in zip(numbers, found, published, strict=True)
    ]
    name, axis = "Friction coefficient", "Sommerfeld number"
    curve = ComparedCurve(name, axis, name.lower(), numbers, found, published, logarithmic=True)
    return Evidence(tuple(close(n, ours, p, "-", rel=0.2) for n, ours, p in rows), (curve,))


CLAIMS = (
    Claim(
        "raimondi_boyd_load",
        RAIMONDI,
        "Load and attitude angle over the eccentricity.",
        "0.7 % and 0.1 degrees on 240 x 31 cells, the discretisation error of that grid with the "
        "rounding of the reference; short: 2 % and 0.4 degrees on 120 x 21.",
        _raimondi,
    ),
    Claim(
        "butenschoen_rotation",
        BUTENSCHOEN,
        "Load and side flow in pure rotation.",
        "0.7 % on 240 x 31 cells; short: 2 % on 120 x 21.",
        _butenschoen,
    ),
    Claim(
        "lund_thomsen_coefficients",
        LUND,
        "Eccentricity and eight dynamic coefficients.",
        "Tables of three digits; 0.01 and 6 % plus 0.02 near zero.",
        _lund,
        1.0,
    ),
    Claim(
        "elrod_groove",
        ELROD,
        "Force, friction and flow of a film that conserves mass.",
        "1 % (a groove begins at grid nodes there, at its edges here), 0.5 %, 4 % (the reference "
        "moves by 4.5 % between its grids).",
        _elrod,
        0.5,
    ),
    Claim(
        "bertocchi_pocket",
        BERTOCCHI,
        "Pressure along the middle of a pocketed pad.",
        "3 % of the peak; single digitised points are off by more.",
        _bertocchi,
    ),
    Claim(
        "comsol_pressure",
        COMSOL,
        "Pressure in the mid plane at 40 kN.",
        "7 % of the peak, that of the digitisation.",
        _comsol,
    ),
    Claim(
        "pawar_eq_2_7",
        PAWAR,
        "Equation 2.7: mu = 0.04486 exp(-S/0.002681) + 0.01897 tanh(S/1.085) + 0.0006507 for "
        "S from 0.001 to 0.2 (Table 2).",
        "20 % at every point: the source fits its own points by five terms and prints no scatter.",
        _friction,
        1.0,
    ),
)
