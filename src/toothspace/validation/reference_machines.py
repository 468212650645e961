"""Reference machines within catalogue and published ranges, and service manuals."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from toothspace.results.ripple import working_side
from toothspace.results.solution import Solution
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    Effort,
    Evidence,
    ValidationSource,
    close,
    rows_of,
    solved,
    within,
)

SOURCE = ValidationSource(
    "service_manuals",
    "Lubricating gerotors and gear pumps of service manuals",
    "Makers' service manuals as in the column 'source' of "
    "src/toothspace/validation/data/service_manuals: teeth, outer rotor, clearances, least flow "
    "of a new pump at two points.",
    "Acceptance limits, so that they show consistency and no accuracy. Not printed: eccentricity, "
    "lobes, kidneys and grade of oil. Assumed: eccentricity 2.65 mm and 34.9 mm to the bottom of "
    "the cavities, the least that deliver the limits, lobes of 8 mm, kinematic kidneys; ISO VG 68, "
    "15 cSt at 80 degC, thinner than the SAE 30 grades of the manuals.",
)
CLEARANCES = ("min", "mid", "max")
"""Ends and middle of the range of a manual."""
_ECCENTRICITY, _CAVITY, _LOBE = 2.65, 34.9, 8.0
"""Eccentricity, largest radius of the pockets and lobe radius of all three pumps. [mm]"""


def pumps() -> dict[str, dict[str, str]]:
    """Rows of the lubricating gerotors by their key."""
    return {row["id"]: row for row in rows_of("service_manuals", "lubricating_gerotors.csv")}


def _between(row: dict[str, str], name: str, place: str) -> float:
    """Clearance at an end or in the middle of its range. [mm]."""
    low, high = (float(row[f"{name}_clearance_{end}_mm"]) for end in ("min", "max"))
    return {"min": low, "mid": 0.5 * (low + high), "max": high}[place]


def pump_overrides(row: dict[str, str], place: str, point: int) -> tuple[str, ...]:
    """Changes that make the trochoidal reference pump that of a manual.

    Feeler gauges find twice the gap of centred lobes, the play of the rotor on its diameter and
    that of both faces together.
    """
    tip, side, housing = (500.0 * _between(row, n, place) for n in ("tip", "side", "case"))
    inner, root = _CAVITY - _ECCENTRICITY, _CAVITY - 3.0 * _ECCENTRICITY
    rise = float(row[f"pressure_{point}_kPa"]) / 100.0
    return (
        f"machine.rotors.inner_tooth_count={row['inner_teeth']}",
        f"machine.rotors.eccentricity={_ECCENTRICITY} mm",
        f"machine.rotors.generating_radius={inner - _ECCENTRICITY + _LOBE} mm",
        f"machine.rotors.lobe_radius={_LOBE} mm",
        f"machine.rotors.face_width={row['thickness_mm']} mm",
        f"machine.rotors.tip_clearance={tip} um",
        f"machine.lateral.side_gap={side} um",
        f"machine.housing.radial_clearance={housing} um",
        f"machine.housing.outer_rotor_diameter={row['outer_rotor_diameter_mm']} mm",
        f"machine.ports.inner_radius={root + 0.5} mm",
        f"machine.ports.outer_radius={_CAVITY - 0.5} mm",
        "fluid.name=iso_vg_68",
        f"fluid.temperature={row['oil_temperature_C']} degC",
        f"operating_point.shaft_speed={row[f'speed_{point}_rpm']} rpm",
        f"operating_point.outlet_pressure={1.0 + rise} bar",
        "operating_point.outlet_load=fixed_pressure",
        "run.samples_per_revolution=360",
    )


def _pump(key: str, effort: Effort) -> Evidence:
    row, values = pumps()[key], []
    for place in CLEARANCES if effort == "full" else ("max",):
        for point in (1, 2):
            run = pump_overrides(row, place, point)
            numbers: dict[str, Any] = dict(solved("gerotor_trochoidal", *run).summary())
            least, speed = float(row[f"flow_{point}_min_L_per_min"]), row[f"speed_{point}_rpm"]
            name = f"{place} clearances, {speed} rpm: "
            words = f"{least:g} L/min or more"
            values += [
                within(name + "flow", numbers["mean_flow_L_per_min"], "L/min", words, least),
                within(name + "volumetric efficiency", numbers["volumetric_efficiency"], "-", ""),
            ]
    return Evidence(tuple(values))


SERVICE_MANUAL_CLAIMS = (
    *(
        Claim(
            f"manual_{key}",
            SOURCE,
            f"Pump {key}: least flow of a new pump at two points, with clearances from the least "
            "to the widest of its manual.",
            "One-sided: no run may deliver less. The limits themselves carry margins of up to 20 % "
            "at the slow point.",
            partial(_pump, key),
            0.5,
        )
        for key in ("S1", "S2", "S3")
    ),
    Claim(
        "manual_S6",
        SOURCE,
        "Pump S6: clearances and relief pressure.",
        "No flow is printed.",
        None,
    ),
    Claim(
        "manual_S7_S8",
        SOURCE,
        "Pumps S7 and S8: least flow at two points, 120 degC.",
        "No clearances are printed.",
        None,
    ),
    Claim(
        "manual_gear_pumps",
        SOURCE,
        "External gear pumps: clearances new and at the end of life, and least flow (K3: 14.1 of "
        "14.4 L/min new, 11.9 at the end).",
        "Teeth, speed or pressure are missing for each of them.",
        None,
    ),
)


GEAR_MACHINES = ValidationSource(
    "gear_machine_ranges",
    "Gear pump and motor of 5 cm3/rev",
    "Makers' performance curves of aluminium gear pumps and motors, groups 1 and 2 (Casappa "
    "Polaris, DCAT 033; Bosch Rexroth AZPB, AZPF, AZMF): hydromechanical efficiency 0.88 to 0.93, "
    "volumetric 0.93 to 0.99 at 1500 rpm, 200 bar, oil up to 80 degC. N. D. Manring, S. B. "
    "Kasaragadda, J. Dyn. Sys. Meas. Control 125 (2003) 396-404: kinematic flow ripple.",
    "Reconstruction from published main dimensions; backlash by ISO/TR 10064-2. Balanced areas, "
    "radial clearance and edge of the high-pressure port are free. The areas are chosen by the "
    "hydromechanical efficiency, so that agreement there is no prediction.",
)
AIMS = ValidationSource(
    "reference_machine_aims",
    "Own aims for the reference machines",
    "No publication: limits that a design should keep. Peak and continuous pressure of the series "
    "(Casappa Polaris, DCAT 033: 300 and 260 bar) leave 1.15.",
)
CRESCENT = ValidationSource(
    "crescent_2024",
    "Crescent pump of 100 cm3/rev",
    "Research and design of internal meshing gear pump separating crescent plate, Scientific "
    "Reports 14 (2024) 3519: displacement, pressure, speed, volumetric efficiency 94.6 %.",
    "No tooth data and no clearances are given. The side gap decides and is free: 33 um meets the "
    "measured number, so that agreement is no prediction.",
)
FUEL_PUMP = ValidationSource(
    "fuel_pump_ranges",
    "Fuel pump of 43 cm3/rev",
    "D. Thiagarajan, A. Vacca, S. Watkins, Mech. Syst. Signal Process. 129 (2019) 659-676 (main "
    "dimensions, conditions); N. D. Manring, S. B. Kasaragadda (2003): kinematic flow ripple.",
    "Reconstruction from published main dimensions. Backlash, from the least of ISO/TR 10064-2 to "
    "three times that, and relief grooves are free and chosen by flow and vapour, so that "
    "agreement there is no prediction.",
)
GEROTORS = ValidationSource(
    "gerotor_ranges",
    "Gerotor pumps of 5.6 and 6.2 cm3/rev",
    "J. S. Cundiff, Fluid Power Circuits and Controls, 2001, chapter 4: measured volumetric "
    "efficiency of a gerotor pump, 0.92 at 34 bar, 0.85 to 0.90 below 100 bar.",
    "Own designs.",
)
MEASURED = ValidationSource(
    "measured_machines",
    "Measured machines",
    "B. Zardin, E. Natali, M. Borghi, Energies 12 (2019) 2468. Actuators 15 (2026) 56. "
    "E. Frosina, A. Senatore, M. Rigosi, Energies 10 (2017) 1113. Processes 12 (2024) 261; "
    "A. Mitov, N. Nikolov, I. Kralov, Applied Sciences 15 (2025) 907. M. Rundo, A. Corvaglia, "
    "Energies 9 (2016) 876. P. Michael, H. Khalid, T. Wanke, SAE 2012-01-2041. J. S. Cundiff "
    "(2001), Fig. 4.21.",
    "docs/validation/measured_machines.md lists what each of them leaves out.",
)

HYDRECO_1919 = {
    1200: ((34.5, 172.4), (0.92, 0.78)),
    1800: ((34.5, 103.4, 172.4), (0.93, 0.887, 0.84)),
}
"""Speed, pressure differences and measured volumetric efficiencies (Cundiff, Fig. 4.21). [rpm],
[bar], [-]"""
_READING = 0.01
"""Reading error of makers' curves. [-]"""
_EFFICIENCIES = {"volumetric_efficiency": (0.93, 0.99), "hydromechanical_efficiency": (0.88, 0.93)}
PEAK_LIMIT = 1.5
DRAIN_LIMIT = 80.0
_VAPOUR = 0.1


_COARSE = "run.samples_per_revolution=360"
_RATED = (
    "operating_point.shaft_speed=8000 rpm",
    "operating_point.inlet_pressure=9.7 bar",
    "operating_point.outlet_pressure=175 bar",
)
"""Limits of the fuel pump, with the inlet pressure of its second set of measurements."""
_WARM = "heat.model=coupled"
"""Films as warm as their own friction makes them, where the case leaves them cold."""


def _solution(case: str, effort: Effort) -> Solution:
    return solved(case, *((_COARSE,) if effort == "short" else ()))


def _machine(case: str, effort: Effort) -> dict[str, Any]:
    return dict(_solution(case, effort).summary())


def _over_angle(case: str, effort: Effort) -> tuple[ComparedCurve, ...]:
    """Pressure of one space and flow at the working port over the last turn."""
    data = _solution(case, effort).data
    angle = np.degrees(data["shaft_angle"].values - float(data["shaft_angle"][0]))
    port = working_side(data)
    rows = (
        ("Pressure of one space", "pressure (bar)", data["chamber_pressure"][:, 0].values / 1e5),
        (f"Flow at the {port}", "flow (L/min)", data[f"{port}_flow_rate"].values * 6e4),
    )
    return tuple(ComparedCurve(n, "shaft angle (deg)", y, angle, v) for n, y, v in rows)


def _efficiencies(
    numbers: dict[str, Any], ranges: dict[str, tuple[float, float]], reading: float = 0.0
) -> list[ComparedValue]:
    values = []
    for name, (low, high) in ranges.items():
        words = f"{low} to {high}" + (f", read within {reading:g}" if reading else "")
        text = name.replace("_", " ")
        values.append(within(text, numbers[name], "-", words, low - reading, high + reading))
    return values


def _pressures(numbers: dict[str, Any], *, fed: bool) -> list[ComparedValue]:
    peak = numbers["max_chamber_pressure_bar"]
    peak /= max(numbers["inlet_pressure_bar"], numbers["outlet_pressure_bar"])
    words = "relieved trapped volume"
    found = [within("highest over working pressure", peak, "-", words, 0.0, PEAK_LIMIT)]
    if fed:
        lowest, words = numbers["min_chamber_pressure_bar"], "no vapour where the inlet is fed"
        found.append(within("lowest pressure of a space", lowest, "bar", words, _VAPOUR))
    return found


def _temperature(numbers: dict[str, Any]) -> ComparedValue:
    drain, words = numbers["drain_temperature_degC"], "oil up to 80 degC"
    return within("drain temperature", drain, "degC", words, 0.0, DRAIN_LIMIT)


def _ripple(numbers: dict[str, Any], kinematic: float) -> tuple[ComparedValue, ...]:
    flow = close("flow ripple", numbers["flow_ripple_percent"], kinematic, "%", rel=0.5)
    flow = replace(flow, words="kinematic ripple of single-flank sealing")
    pressure = float(numbers["pressure_ripple_bar"])
    if not pressure:
        return (flow,)
    words = "peak to peak before an orifice; nothing published to hold it against"
    return flow, within("pressure ripple", pressure, "bar", words)


_ELASTIC = (
    "run.fidelity=elastic",
    "run.samples_per_revolution=180",
    "run.film_grid=[84, 12]",
    "run.film_steps_per_revolution=36",
)


def _egm12(case: str, effort: Effort) -> Evidence:
    """Bushings in balance, films as warm as the heat network makes them; beside the closed form."""
    numbers = dict(solved(case, *_ELASTIC).summary())
    closed, words = _machine(case, effort), "for comparison: closed-form films, warm as well"
    beside = [
        within(f"{name.replace('_', ' ')}, lumped preset", closed[name], "-", words)
        for name in _EFFICIENCIES
    ]
    parts = _efficiencies(numbers, _EFFICIENCIES, _READING)
    values = (*parts, *_ripple(closed, 15.7), _temperature(numbers), *beside)
    return Evidence(values, _over_angle(case, effort))


def _aims(effort: Effort) -> Evidence:
    # a motor's return line feeds its spaces; the pump draws from a tank at 1 bar
    values = _pressures(_machine("egm12_motor", effort), fed=True)
    values += [
        replace(value, name=f"{value.name}, pump")
        for value in _pressures(_machine("egm12_pump", effort), fed=False)
    ]
    return Evidence(tuple(values))


def _tabulated(effort: Effort) -> Evidence:
    numbers = _machine("egm12_motor_reduced", effort)
    parts = _efficiencies(numbers, _EFFICIENCIES, _READING)
    elastic, words = solved("egm12_motor", *_ELASTIC).summary(), "that of the elastic preset"
    name = "hydromechanical_efficiency"
    value = close(
        "efficiency of the solved films", numbers[name], float(elastic[name]), "-", margin=0.01
    )
    return Evidence((*parts, replace(value, words=words), _temperature(numbers)))


def _crescent(effort: Effort) -> Evidence:
    numbers = _machine("crescent_pump", effort)
    name, gaps = "volumetric_efficiency", (20.0, 25.0, 40.0) if effort == "full" else ()
    values = [close(name.replace("_", " "), numbers[name], 0.946, "-", margin=0.005)]
    for gap in gaps:
        other = solved("crescent_pump", _COARSE, f'machine.lateral.side_gap="{gap:g} um"').summary()
        text = f"the same with side gaps of {gap:g} um"
        values.append(
            within(text, float(other[name]), "-", "for comparison: the dimension that decides")
        )
    return Evidence(tuple(values))


def _rated_fuel_pump(effort: Effort) -> dict[str, Any]:
    coarse = (_COARSE,) if effort == "short" else ()
    return dict(solved("fuel14_pump", *_RATED, _WARM, *coarse).summary())


def _fuel(effort: Effort) -> Evidence:
    numbers = _rated_fuel_pump(effort)
    parts = _efficiencies(numbers, {"hydromechanical_efficiency": (0.88, 0.94)})
    values = (*parts, *_ripple(numbers, 14.0), _temperature(numbers))
    return Evidence(values, _over_angle("fuel14_pump", effort))


def _fuel_flow(effort: Effort) -> Evidence:
    numbers = _rated_fuel_pump(effort)
    shown = [
        within(f"leakage, {path}", numbers[f"leakage_{path}_L_per_min"], "L/min", "")
        for path in ("tooth_tip", "lateral", "drain")
    ]
    return Evidence((*_efficiencies(numbers, {"volumetric_efficiency": (0.92, 0.98)}), *shown))


def _fuel_aims(effort: Effort) -> Evidence:
    return Evidence(tuple(_pressures(_rated_fuel_pump(effort), fed=True)))


def _gerotor(case: str, low: float, high: float, effort: Effort) -> Evidence:
    numbers = _warm_gerotor(case, effort)
    parts = _efficiencies(numbers, {"volumetric_efficiency": (low, high)})
    if effort != "full":
        return Evidence((*parts, _temperature(numbers)), _over_angle(case, effort))
    # at the points of the measured pump, whose size forbids a verdict
    curves = []
    for speed, (pressures, measured) in HYDRECO_1919.items():
        held = case, "operating_point.outlet_load=fixed_pressure", _COARSE
        at_speed = *held, f'operating_point.shaft_speed="{speed} rpm"'
        outlets = [f'operating_point.outlet_pressure="{p + 1.0} bar"' for p in pressures]
        found = [solved(*at_speed, p).summary()["volumetric_efficiency"] for p in outlets]
        title = f"Volumetric efficiency at {speed} rpm beside a far larger pump"
        axes = "pressure difference (bar)", "volumetric efficiency"
        points = np.array(pressures), np.array(found, dtype=float), np.array(measured)
        curves.append(ComparedCurve(title, *axes, *points))
    return Evidence((*parts, _temperature(numbers)), tuple(curves))


def _gerotor_aims(effort: Effort) -> Evidence:
    values: list[ComparedValue] = []
    for case in ("gerotor_trochoidal", "gerotor_cycloidal"):
        found = _pressures(_warm_gerotor(case, effort), fed=False)
        values += [replace(v, name=f"{v.name}, {case.replace('_', ' ')}") for v in found]
    return Evidence(tuple(values))


def _warm_gerotor(case: str, effort: Effort) -> dict[str, Any]:
    coarse = (_COARSE,) if effort == "short" else ()
    return dict(solved(case, _WARM, *coarse).summary())


def _map(effort: Effort) -> Evidence:
    """Overall efficiency of the motor with tables of solved, warm films over speed and pressure."""
    pressures = (20.0, 60.0, 140.0, 250.0) if effort == "full" else (60.0, 250.0)
    speeds = (500.0, 1500.0, 3000.0) if effort == "full" else (500.0, 1500.0)
    curves, rows = [], []
    for speed in speeds:
        at_speed = "egm12_motor_reduced", f'operating_point.shaft_speed="{speed} rpm"', _COARSE
        inlets = [f'operating_point.inlet_pressure="{p + 1.0} bar"' for p in pressures]
        found = [float(solved(*at_speed, p).summary()["overall_efficiency"]) for p in inlets]
        rows.append(found)
        axes = "pressure difference (bar)", "efficiency"
        title = f"Overall efficiency at {speed:g} rpm"
        curves.append(ComparedCurve(title, *axes, np.array(pressures), np.array(found)))
    map_, highest = np.array(rows), 0.93 * 0.99
    best = np.unravel_index(int(np.argmax(map_)), map_.shape)
    words = f"at most {highest:.2f}, the product of both ranges, read within {_READING:g}"
    values = (
        within("highest overall efficiency", map_.max(), "-", words, 0.0, highest + _READING),
        within("where: speed", speeds[best[0]], "rpm", "not at the lowest speed", speeds[0] + 1.0),
        within("where: pressure", pressures[best[1]], "bar", "not at the lowest", pressures[0] + 1),
        within("lowest overall efficiency", map_.min(), "-", "the motor turns its load", 1e-3),
    )
    return Evidence(values, tuple(curves))


_RANGES = (
    "Ranges as published; kinematic ripple within a half of itself, as trapping and leakage add "
    "to it."
)
_MOTOR_RANGES = (
    "0.01 of an efficiency, with which curves are read; kinematic ripple within a half of itself, "
    "as trapping and leakage add to it."
)
CLAIMS = (
    Claim(
        "egm12_motor",
        GEAR_MACHINES,
        "Makers' curves at 1500 rpm, 200 bar: efficiencies; kinematic flow ripple; oil up to 80 "
        "degC.",
        _MOTOR_RANGES,
        partial(_egm12, "egm12_motor"),
        0.6,
    ),
    Claim(
        "egm12_pump",
        GEAR_MACHINES,
        "The same of the pump.",
        _MOTOR_RANGES,
        partial(_egm12, "egm12_pump"),
        0.6,
    ),
    Claim(
        "egm12_motor_reduced",
        GEAR_MACHINES,
        "The same of the motor with tables of solved lateral films.",
        "As above; tables within 0.01 of the solved films that they stand for.",
        _tabulated,
        0.6,
    ),
    Claim(
        "egm12_map",
        GEAR_MACHINES,
        "No map of this motor is published; makers' curves of its size peak at middle speeds and "
        "stay within the product of both ranges.",
        "Reading error of the curves, 0.01.",
        _map,
        1.5,
    ),
    Claim(
        "egm12_aims",
        AIMS,
        "Peak of the trapped volume below 1.5 times the working pressure; no vapour where the "
        "inlet is fed.",
        "Own limits.",
        _aims,
        0.2,
    ),
    Claim(
        "crescent_pump",
        CRESCENT,
        "Abstract: volumetric efficiency 94.6 % at rated pressure and speed.",
        "0.005: the digits given; the side gap is chosen by this number.",
        _crescent,
        0.5,
    ),
    Claim(
        "fuel14_pump",
        FUEL_PUMP,
        "Hydromechanical efficiency, ripple and temperature at the limits of Table 1, 8000 rpm "
        "and 175 bar, from 9.7 bar.",
        _RANGES,
        _fuel,
        0.5,
    ),
    Claim(
        "fuel14_pump_flow",
        FUEL_PUMP,
        "Volumetric efficiency at the same point.",
        "0.92 to 0.98 of external gear machines at rated pressure; nothing is published of this "
        "pump.",
        _fuel_flow,
        0.1,
    ),
    Claim(
        "fuel14_aims",
        AIMS,
        "Peak of the trapped volume below 1.5 times the working pressure and no vapour at the "
        "same point.",
        "Own limits; vapour begins below 0.1 bar, above the vapour pressure of the fuel.",
        _fuel_aims,
        0.1,
    ),
    Claim(
        "gerotor_trochoidal",
        GEROTORS,
        "Volumetric efficiency and temperature at 2000 rpm, 20 bar.",
        "0.92 measured at 34 bar on a larger pump; the width round it is own judgement.",
        partial(_gerotor, "gerotor_trochoidal", 0.90, 0.97),
    ),
    Claim(
        "gerotor_cycloidal",
        GEROTORS,
        "The same at 767 rpm, 40 bar.",
        "0.85 to 0.90 published below 100 bar; the upper end is own judgement.",
        partial(_gerotor, "gerotor_cycloidal", 0.85, 0.93),
    ),
    Claim(
        "gerotor_aims",
        AIMS,
        "Peak of a pocket below 1.5 times the working pressure, both gerotors at these points.",
        "Own limit, as for the external gears.",
        _gerotor_aims,
        0.1,
    ),
    *(
        Claim(key, MEASURED, statement, missing, None)
        for key, statement, missing in (
            (
                "zardin_2019",
                "Hydromechanical efficiency of commercial pumps; mean deviation of the authors' "
                "model about 2 %.",
                "Tooth data, clearances, bearings and measured points could not be had.",
            ),
            (
                "actuators_2026",
                "Volumetric efficiency at 800 rpm with measured clearances; mean error 1.98 %.",
                "Tooth data, port timing, clearance formulas and measured points could not be had.",
            ),
            (
                "frosina_2017",
                "Volumetric efficiency, torque and pressure ripple of a pump of Casappa.",
                "Gears, grooves, clearances and measured points could not be had.",
            ),
            (
                "mitov_2025",
                "Flow of a pump at 42 points, 950 to 1450 rpm and 5 to 150 bar, and over the "
                "radial gap; deviation of the authors' flow model -6.4 to 2.5 %.",
                "Gears, side gaps, bearings and measured points could not be had.",
            ),
            (
                "rundo_2016",
                "Flow and pressure ripple of a crescent pump.",
                "Gears, clearances, stiffness of the cover and measured points could not be had.",
            ),
            (
                "michael_2012",
                "Efficiencies of pumps over the Stribeck number.",
                "The pumps are not described; measured points could not be had.",
            ),
            (
                "cundiff_2001",
                "Volumetric efficiency of a gerotor pump of 74 cm3/rev at five points.",
                "Points are public, of the pump only its displacement; they are drawn beside "
                "the own designs in gerotor_trochoidal and gerotor_cycloidal.",
            ),
        )
    ),
)
