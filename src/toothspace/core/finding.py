"""What is to be known of a result before it is trusted or a machine is built after it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Literal, final

from toothspace.core.status import Status

SLIGHT = 1e-3
"""Part of a limit, or of all losses, below which nothing is to be changed for it first. [-]"""


@final
@dataclass(frozen=True)
class Finding:
    """One thing that a reader of a result should know."""

    kind: Literal["warning", "limit", "rule"]
    """``warning``: of the run and its models; ``limit``: of a quantity of the run that the machine
    should not exceed; ``rule``: of the design, whatever the run.
    """
    text: str
    """What was found, one sentence."""
    quantity: str = ""
    """What it is about; empty if no quantity was judged."""
    found: str = ""
    """Value of the quantity with its unit."""
    allowed: str = ""
    """Allowed values of the quantity in words."""
    severity: Literal["serious", "caution", "note"] = "caution"
    """``serious``: numbers of the run are not to be trusted; ``caution``: look before building;
    ``note``: good to know.
    """
    advice: str = ""
    """What to do, or why it matters; empty if the text says it."""
    weight: float = 1.0
    """How much it matters: for a limit the part by which it is missed, for cavitation its share of
    all losses; 1 where neither is known. [-]
    """

    @property
    def slight(self) -> bool:
        """Whether it is too small to be what to change first."""
        return self.weight < SLIGHT

    def __str__(self) -> str:
        return f"{self.kind.capitalize()}: {self.sentence}"

    @property
    def sentence(self) -> str:
        """What was found and what to do."""
        return f"{self.text} {self.advice}".rstrip()

    def to_dict(self) -> dict[str, str | float]:
        """All fields by name, as they stand in JSON."""
        return asdict(self)


def beyond_too(places: Iterable[str], worst: str) -> str:
    """Tail of a sentence on the worst place: in which others the same range is left."""
    others = ", ".join(place for place in places if place != worst)
    return f", and beyond it in: {others}" if others else ""


def status_line(status: Status, findings: Sequence[Finding]) -> str:
    """How a run ended and how much there is to know of it, as ``done, 3 findings``."""
    count = len(findings)
    told = "no findings" if count == 0 else "1 finding" if count == 1 else f"{count} findings"
    line = f"{status.name.lower()}, {told}"
    return line if status.succeeded else f"{line}: {status.value}"


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
