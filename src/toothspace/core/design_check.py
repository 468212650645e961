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

    @property
    def shown_value(self) -> str:
        """Value with its unit."""
        unit = "" if self.unit in {"", "1", "-"} else f" {self.unit}"
        return f"{self.value:.4g}{unit}"

    @property
    def label(self) -> str:
        """Rule as the beginning of a sentence."""
        name = self.name.replace("_", " ")
        return f"{name[:1].upper()}{name[1:]}"


def warnings_of(checks: Iterable[DesignCheck]) -> list[str]:
    """One line for every check that failed."""
    return [
        f"{check.name}: {check.shown_value}, allowed {check.allowed}"
        for check in checks
        if not check.passed
    ]
