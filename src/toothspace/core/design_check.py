"""Lines of the design-rule report."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class DesignCheck:
    """One line of the design-rule report."""

    name: str
    """Rule."""
    value: float
    """Value found, in ``unit``."""
    unit: str
    """Unit of the value."""
    allowed: str
    """Allowed range in words."""
    passed: bool
    """Verdict."""
    reason: str
    """One sentence on why the rule matters."""
    of_drawing: bool = False
    """Whether it judges the file that the machine was read from rather than the design, so that
    every run reports it.
    """

    @property
    def shown_value(self) -> str:
        """Value with its unit."""
        unit = "" if self.unit in {"", "1", "-"} else f" {self.unit}"
        return f"{self.value:.4g}{unit}"

    @property
    def sentence(self) -> str:
        """What was found, what is allowed and why."""
        name = self.name.replace("_", " ")
        found = f"{name[:1].upper()}{name[1:]} is {self.shown_value}"
        return f"{found}, allowed {self.allowed}. {self.reason}"


def warnings_of(checks: Iterable[DesignCheck]) -> list[str]:
    """One line for every check that failed."""
    return [
        f"{check.name}: {check.shown_value}, allowed {check.allowed}"
        for check in checks
        if not check.passed
    ]
