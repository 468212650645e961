"""Gears of a case that come from files."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.frozen import Points
from toothspace.core.units import to_si
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_finder import FoundGear, find_gears
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.external_gear import parameter_tables as keys

_UNITS = ("mm", "m", "um", "in")
_MODULES = (0.1e-3, 50e-3)
_WIDTH_OVER_MODULE = (0.3, 100.0)
_ROOT_OVER_JOURNAL = (1.0, 8.0)


class _Source(NamedTuple):
    file: Path | Points
    modified: int
    unit: float
    request: SectionRequest
    layer: str | None
    tooth_count: int | None


def detected_gear(gear: keys.GearParameters, file: Path | Points, table: str) -> FoundGear:
    """Gear in the profile file of a table.

    Returns
    -------
    FoundGear
        The largest gear that the keys leave.

    Raises
    ------
    CaseError
        If the file holds no gear, or one with another tooth count.
    """
    request = SectionRequest(
        gear.profile_axis, gear.profile_plane, gear.profile_body, gear.profile_part
    )
    unit = to_si(1.0, gear.profile_unit)
    modified = file.stat().st_mtime_ns if isinstance(file, Path) else 0
    source = _Source(file, modified, unit, request, gear.profile_layer, gear.tooth_count)
    found = _found(source, f"{table}.profile")
    count = found.detected.tooth_count
    if gear.tooth_count not in (None, count):
        allowed = f"{count} teeth as in {file.name}, or no tooth_count"
        raise CaseError(f"{table}.tooth_count", str(gear.tooth_count), allowed)
    return found


@lru_cache(maxsize=8)
def _found(source: _Source, key: str) -> FoundGear:
    file = source.file
    try:
        contents = find_gears(file, source.unit, source.request, source.layer, source.tooth_count)
        return contents.gears[0]
    except GeometryError as error:
        raise error.read_for(key).naming(str(file), file.name) from error


def check_unit(
    machine: keys.ExternalGearTables, gear: keys.GearParameters, drawn: GearProfile, table: str
) -> None:
    """Refuse a profile whose size fits the machine in another unit only.

    Raises
    ------
    CaseError
        With the unit in which the gear fits.
    """
    if _fits(machine, gear, drawn):
        return
    own = to_si(1.0, gear.profile_unit)
    others = [
        unit
        for unit in _UNITS
        if unit != gear.profile_unit and _fits(machine, gear, drawn.scaled(to_si(1.0, unit) / own))
    ]
    if len(others) == 1:
        size = 2e3 * drawn.tip_radius
        raise CaseError(
            f"{table}.profile_unit",
            f"{gear.profile_unit!r}, with which the tip diameter is {size:.5g} mm",
            f"{others[0]!r}, with which it is {size * to_si(1.0, others[0]) / own:.5g} mm and fits "
            f"the machine",
        )


def _fits(
    machine: keys.ExternalGearTables, gear: keys.GearParameters, profile: GearProfile
) -> bool:
    data = gear_data(profile)
    module = 2.0 * profile.tip_radius / (profile.tooth_count + 2.0) if data is None else data.module
    ratios = [
        (module, _MODULES),
        ((gear.face_width or module) / module, _WIDTH_OVER_MODULE),
        (2.0 * profile.root_radius / machine.journal_bearings.diameter, _ROOT_OVER_JOURNAL),
    ]
    if gear.center_distance is not None:
        ratios.append((gear.center_distance / profile.tip_radius, (1.0, 10.0)))
    return all(low <= value <= high for value, (low, high) in ratios)
