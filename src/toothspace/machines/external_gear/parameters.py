"""``[machine]`` of external gear pumps and motors: its keys, and the machine that follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from toothspace.machines.external_gear.from_parameters import spec_from
from toothspace.machines.external_gear.parameter_tables import ExternalGearTables
from toothspace.machines.external_gear.spec import ExternalGearSpec


@final
@dataclass(frozen=True, kw_only=True)
class ExternalGearParameters(ExternalGearTables):
    """``[machine]`` with ``type = "external_gear"``."""

    def assemble(self) -> ExternalGearSpec:
        """Build profiles and contours: :class:`ExternalGearSpec`.

        Raises
        ------
        CaseError
            If a file, a material or the geometry of a tooth is impossible.
        """
        return spec_from(self)


PARAMETERS = ExternalGearParameters
"""Found by the case reader under this name, in the module next to the machine's entry point."""
