"""The outcome of one simulation."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

from toothspace.core.finding import Finding
from toothspace.core.status import Status
from toothspace.results import performance
from toothspace.results.events import Event
from toothspace.results.ledger import Ledger
from toothspace.results.startup import startup_numbers
from toothspace.results.tooth_contacts import ToothContacts, contact_numbers, tooth_contacts

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Solution:
    """Result of one run, complete or not.

    Parameters
    ----------
    status : Status
        Outcome; the data are kept if the run failed on its way.
    data : xarray.Dataset
        Samples over ``shaft_angle`` or ``time``, built by
        :func:`toothspace.results.variables.dataset_from`, with the attributes ``title``,
        ``machine`` and ``mode`` and the scalars ``displacement``, ``inlet_density``,
        ``outlet_density``, ``specific_heat_capacity`` and ``fluid_temperature``.
    ledger : Ledger
        Masses and energies over the evaluation window.
    statistics : mapping
        Counts and times of the solver: ``steps``, ``rhs``, ``jac``, ``lu``, ``revolutions``,
        ``wall_time`` without compilation [s], ``compile_time`` spent on compiling or loading
        compiled code [s], ...
    provenance : mapping of str to str
        ``package_version``, ``case_toml``, ``case_hash``, ``preset``, ``overrides`` (one
        ``key=value`` per line), ``python_version``, ``numba_version``, ``warnings`` (one per
        line, for readers of the file), ...
    events : tuple of Event
        What happened, in the order of time.
    warnings : tuple of Finding
        What the run itself has to tell, without limits and design rules of the machine.
    """

    status: Status
    data: xr.Dataset
    ledger: Ledger
    statistics: Mapping[str, float] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    warnings: tuple[Finding, ...] = ()

    def __repr__(self) -> str:
        return self._shown(self.status.name.lower())

    def _shown(self, status: str) -> str:
        axis = "time" if "time" in self.data.sizes else "shaft_angle"
        samples = f"{self.data.sizes.get(axis, 0)} samples over {axis}"
        title = self.provenance.get("title", "")
        return f"<Solution {title!r}: {status}; {samples}>"

    def __getstate__(self) -> dict[str, object]:
        """State for another process, which cannot read what this one keeps on disk."""
        kept = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        return {**kept, "data": self.data.compute()}

    def summary(self) -> dict[str, float | str]:
        """Return the summary numbers, with unit suffixes, status and wall time."""
        wall = float(self.statistics.get("wall_time", math.nan))
        if "time" in self.data.sizes:
            numbers = {
                **startup_numbers(self.data, self.breakaway_time),
                **performance.transient_numbers(self.data, self.ledger),
                "real_time_factor": self.ledger.duration / wall if wall else math.nan,
            }
        else:
            numbers = performance.summary_numbers(self.data, self.ledger)
            numbers |= performance.lateral_numbers(self.data, self.statistics)
            numbers |= contact_numbers(self.data)
        return {**numbers, "status": self.status.name.lower(), "wall_time_s": wall}

    def tooth_contacts(self) -> ToothContacts:
        """Contacts of the teeth of a gerotor: ``loaded`` at each sample, ``span`` in pitches.

        Raises
        ------
        ToothspaceError
            If the machine has no rotors, or the preset no contacts.
        """
        return tooth_contacts(self.data)

    @property
    def breakaway_time(self) -> float:
        """When the shaft begins to turn, NaN if it never does. [s]."""
        times = (event.time for event in self.events if event.kind == "shaft_released")
        return next(times, math.nan)

    def with_note(self, *warnings: Finding | str, **statistics: float) -> Solution:
        """Solution with more statistics and more warnings; texts that are empty are none."""
        told = tuple(Finding("warning", x) if isinstance(x, str) else x for x in warnings if x)
        found = tuple(dict.fromkeys((*self.warnings, *told)))
        provenance = dict(self.provenance)
        if found:
            provenance["warnings"] = "\n".join(finding.sentence for finding in found)
        return replace(
            self,
            provenance=provenance,
            statistics={**self.statistics, **statistics},
            warnings=found,
        )

    def save(self, path: str | Path) -> Path:
        """Write one NetCDF file; an interrupted write leaves no half file behind.

        Parameters
        ----------
        path : str or Path
            File to write, by custom ``*.nc``.

        Returns
        -------
        Path
            The file written.
        """
        from toothspace.results.file_layout import FINDINGS, write_result

        told = json.dumps([finding.to_dict() for finding in self.warnings])
        attributes = {"status": self.status.name, FINDINGS: told}
        return write_result(
            path, self.data, self.ledger, self.events, attributes, self.statistics, self.provenance
        )
