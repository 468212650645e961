"""Pumps of service manuals: least flows and clearances, held one-sided."""

from __future__ import annotations

import csv
from functools import partial
from typing import Any

from toothspace.validation.claim import Claim, Effort, Evidence, ValidationSource, within
from toothspace.validation.resources import data_file, solved

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
    text = data_file("service_manuals", "lubricating_gerotors.csv").read_text(encoding="utf-8")
    return {row["id"]: row for row in csv.DictReader(text.splitlines())}


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


CLAIMS = (
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
