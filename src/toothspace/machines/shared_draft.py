"""First case files of machines whose parts are drawn in CAD files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from toothspace.core.errors import CaseError
from toothspace.core.registry import machine_type_names, optional_part

if TYPE_CHECKING:
    # reading solids loads most of SciPy, which a run does without
    from toothspace.geometry.body_section import SectionRequest


def draft_case(files: Sequence[Path], unit: str, request: SectionRequest, folder: Path) -> str:
    """First case file of the machine whose parts are in CAD files of one frame.

    Parameters
    ----------
    files : sequence of Path
        Files.
    unit : str
        Length unit of those that have none of their own.
    request : SectionRequest
        Axis and plane of the gears, None to find them.
    folder : Path
        Where the case file will be.

    Returns
    -------
    str
        TOML of the machine type that uses most of the parts, with comments on what is assumed.

    Raises
    ------
    CaseError
        If no machine type finds its parts.
    """
    parts = [optional_part(name, "case_draft") for name in machine_type_names()]
    drafts = [part.draft_case(files, unit, request, folder) for part in parts if part is not None]
    found = [draft for draft in drafts if draft is not None]
    if not found:
        raise CaseError(f"{files[0]}: --case", "no machine", "gears or rotors of one")
    return max(found, key=lambda draft: draft.parts).text
