"""Fidelity presets: named, tested sets of models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, final

from toothspace.core.errors import CaseError


@final
@dataclass(frozen=True, kw_only=True)
class Preset:
    """Which models a run uses.

    Parameters
    ----------
    name : str
        Value of ``run.fidelity``.
    content : str
        The set in one sentence, for reports.
    compressible : bool
        Whether chambers have a pressure state of their own; otherwise the flow is kinematic.
    leakage : bool
        Whether gaps leak.
    body_motion : bool
        Whether bodies move in their bearings.
    friction : bool
        Whether films, meshes and seals resist.
    films : str
        ``none``, ``closed_form`` or ``reynolds``.
    deformation : bool
        Whether film surfaces deform.
    solved : bool
        Whether this version can run it; otherwise its keys are only checked.
    unused_tables : tuple of str
        Optional tables of a case that this set does not use.
    """

    name: str
    content: str
    compressible: bool
    leakage: bool
    body_motion: bool
    friction: bool
    films: Literal["none", "closed_form", "reynolds"]
    deformation: bool
    solved: bool = False
    unused_tables: tuple[str, ...] = ()

    def require_solved(self) -> None:
        """Refuse a set that this version cannot run.

        Raises
        ------
        CaseError
            With the sets that can be run.
        """
        if not self.solved:
            allowed = " or ".join(repr(p.name) for p in _PRESETS if p.solved)
            raise CaseError(f"run.fidelity: found {self.name!r}, allowed {allowed} in this version")


_BALANCE_TABLES = (
    "machine.floating_bearing",
    "machine.elastic_bodies",
    "machine.startup",
    "study",
)
_PRESETS = (
    Preset(
        name="ideal",
        content="Kinematic flow and torque, no leakage, rigid fluid.",
        compressible=False,
        leakage=False,
        body_motion=False,
        friction=False,
        films="none",
        deformation=False,
        solved=True,
        unused_tables=("machine.casing.wear_in", *_BALANCE_TABLES),
    ),
    Preset(
        name="lumped",
        content="Chamber pressures with cavitation, all flow paths, body motion, contacts, "
        "closed-form films and friction.",
        compressible=True,
        leakage=True,
        body_motion=True,
        friction=True,
        films="closed_form",
        deformation=False,
        solved=True,
        unused_tables=_BALANCE_TABLES,
    ),
    Preset(
        name="films",
        content="Lumped, with journal and lateral films solved on grids.",
        compressible=True,
        leakage=True,
        body_motion=True,
        friction=True,
        films="reynolds",
        deformation=False,
        solved=True,
        unused_tables=_BALANCE_TABLES,
    ),
    Preset(
        name="elastic",
        content="Films, with elastic surfaces, asperity contact and floating parts in balance.",
        compressible=True,
        leakage=True,
        body_motion=True,
        friction=True,
        films="reynolds",
        deformation=True,
        solved=True,
        unused_tables=("machine.startup",),
    ),
)

PRESETS: Mapping[str, Preset] = {preset.name: preset for preset in _PRESETS}
"""Fidelity presets by name."""
