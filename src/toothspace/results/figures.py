"""Figures of a solution by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from toothspace.core.errors import CaseError
from toothspace.core.registry import view

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from toothspace.results.solution import Solution


@final
@dataclass(frozen=True, eq=False)
class Figures:
    """Figures of a solution; each is an object of Matplotlib.

    Raises
    ------
    CaseError
        If the result cannot give the figure: the names of those it can are in the message.
    """

    solution: Solution

    def __repr__(self) -> str:
        return f"<Figures: {', '.join(self.names())}>"

    @property
    def _entries(self) -> dict[str, Any]:
        found = view("figures")(self.solution, self.solution.description)
        return {entry.name: entry for entry in found}

    def names(self) -> list[str]:
        """Return the names of the figures that the result can give."""
        return list(self._entries)

    def figure(self, name: str) -> Figure:
        """Return the figure of a name."""
        entries = self._entries
        if name not in entries:
            allowed = ", ".join(entries)
            raise CaseError(f"figure: found {name!r}, allowed for this result {allowed}")
        figure: Figure = entries[name].draw(self.solution, self.solution.description)
        return figure

    def section(self) -> Figure:
        """Section of the machine, coloured by pressure."""
        return self.figure("gear_section")

    def pressures(self) -> Figure:
        """Pressure of a chamber on its way round; over time where a run has a circuit."""
        transient = "time" in self.solution.data.sizes
        return self.figure("time_history" if transient else "chamber_pressure")

    def ripple(self) -> Figure:
        """Flow, pressure and torque over a turn, with their spectra."""
        return self.figure("ripple")

    def orbits(self) -> Figure:
        """Path of the bodies inside their clearances."""
        return self.figure("journal_orbits")

    def forces(self) -> Figure:
        """Pressure force on the bodies over a turn."""
        return self.figure("force_polar")

    def contacts(self) -> Figure:
        """Contact forces of the teeth."""
        rotors = "tooth_contact_forces" in self.names()
        return self.figure("tooth_contact_forces" if rotors else "contact_forces")

    def losses(self) -> Figure:
        """Every loss of power."""
        return self.figure("loss_bars")

    def torques(self) -> Figure:
        """Friction torque by mechanism."""
        return self.figure("torque_breakdown")

    def leakage(self) -> Figure:
        """Leakage by path."""
        return self.figure("leakage_by_path")

    def wear(self) -> Figure:
        """Depth that the gears cut into the casing."""
        return self.figure("casing_wear")

    def films(self) -> Figure:
        """Lateral films: height, pressure and contact."""
        return self.figure("lateral_films")

    def volumes(self) -> Figure:
        """Chamber volume and its derivative over the angle."""
        return self.figure("volumes")

    def openings(self) -> Figure:
        """Open areas of a chamber over the angle."""
        return self.figure("openings")
