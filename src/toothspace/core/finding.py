"""What is to be known of a result before it is trusted or a machine is built after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Literal, final

from toothspace.core.status import Status


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

    def __str__(self) -> str:
        return f"{self.kind.capitalize()}: {self.sentence}"

    @property
    def sentence(self) -> str:
        """What was found and what to do."""
        return f"{self.text} {self.advice}".rstrip()

    def to_dict(self) -> dict[str, str]:
        """All fields by name, as they stand in JSON."""
        return asdict(self)


def status_line(status: Status, findings: Sequence[Finding]) -> str:
    """How a run ended and how much there is to know of it, as ``done, 3 findings``."""
    count = len(findings)
    told = "no findings" if count == 0 else "1 finding" if count == 1 else f"{count} findings"
    line = f"{status.name.lower()}, {told}"
    return line if status.succeeded else f"{line}: {status.value}"
