"""Kinematic numbers of many designs, and why some of them are impossible or break a rule."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntFlag
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.types import Array, BoolArray, IntArray

if TYPE_CHECKING:
    import xarray as xr


class DesignReason(IntFlag):
    """Reasons as bits, a design may have several; those of rules leave it possible."""

    OUT_OF_RANGE = 1 << 0
    TOOL_TIP = 1 << 1
    ROOT_CIRCLE = 1 << 2
    FILLET = 1 << 3
    TIP = 1 << 4
    NO_INVOLUTE = 1 << 5
    BASE_PITCH = 1 << 6
    NO_MESH = 1 << 7
    OVERLAP = 1 << 8
    ROOT_CLEARANCE = 1 << 9
    INTERFERENCE = 1 << 10
    CONTACT_RATIO = 1 << 11
    CONTINUOUS = 1 << 12
    CONTACT_RATIO_RULE = 1 << 16
    TIP_LAND_RULE = 1 << 17
    UNDERCUT_RULE = 1 << 18
    INTERFERENCE_RULE = 1 << 19
    ROOT_CLEARANCE_RULE = 1 << 20
    BACKLASH_RULE = 1 << 21
    TRAPPED_VOLUME_RULE = 1 << 22
    OVERLAP_RULE = 1 << 23
    CURVATURE_RULE = 1 << 24


REASON_TEXTS: Mapping[DesignReason, str] = {
    DesignReason.OUT_OF_RANGE: "a value is outside the range of its key",
    DesignReason.TOOL_TIP: "the rack tooth is pointed, or its tip radius does not fit",
    DesignReason.ROOT_CIRCLE: "no root circle is left",
    DesignReason.FILLET: "the root fillet folds back, or undercut leaves a thin tooth neck",
    DesignReason.TIP: "the tooth is pointed, or its tip rounding does not fit",
    DesignReason.NO_INVOLUTE: "no involute is left between fillet and tip",
    DesignReason.BASE_PITCH: "the base pitches of both gears differ",
    DesignReason.NO_MESH: "no centre distance has this backlash, or the tips do not meet",
    DesignReason.OVERLAP: "the flanks overlap",
    DesignReason.ROOT_CLEARANCE: "a tip reaches the mating root circle",
    DesignReason.INTERFERENCE: "a tip cuts into the mating root fillet",
    DesignReason.CONTACT_RATIO: "the contact ratio is below 1, so the mesh does not seal",
    DesignReason.CONTINUOUS: "no outline of continuous contact: undercut, or most of a tip ground",
    DesignReason.CONTACT_RATIO_RULE: "design rule: contact ratio",
    DesignReason.TIP_LAND_RULE: "design rule: tip land",
    DesignReason.UNDERCUT_RULE: "design rule: undercut",
    DesignReason.INTERFERENCE_RULE: "design rule: fillet interference",
    DesignReason.ROOT_CLEARANCE_RULE: "design rule: root clearance",
    DesignReason.BACKLASH_RULE: "design rule: normal backlash",
    DesignReason.TRAPPED_VOLUME_RULE: "design rule: trapped volume change",
    DesignReason.OVERLAP_RULE: "design rule: overlap ratio",
    DesignReason.CURVATURE_RULE: "design rule: smallest radius of curvature",
}
"""What each reason says."""

IMPOSSIBLE = (1 << 16) - 1
"""Bits of the reasons for which gears cannot be made or do not turn."""


def marked(shape: tuple[int, ...], cases: Mapping[DesignReason, BoolArray]) -> IntArray:
    """Return the bits of reasons where each of them holds."""
    found = np.zeros(shape, dtype=np.int64)
    for reason, where in cases.items():
        found |= np.where(where, int(reason), 0)
    return found


@final
@dataclass(frozen=True)
class EvaluatedDesigns:
    """Kinematics of many designs.

    Parameters
    ----------
    numbers : mapping of str to ndarray
        Numbers by name, the name carries the unit; NaN of designs that are impossible.
    reasons : ndarray
        Bits of :class:`DesignReason`.
    """

    numbers: Mapping[str, Array]
    reasons: IntArray

    def __getitem__(self, name: str) -> Array:
        """Return the numbers of a name."""
        return self.numbers[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self.numbers)

    @property
    def valid(self) -> BoolArray:
        """Whether the gears can be made and turn."""
        return np.asarray(self.reasons & IMPOSSIBLE == 0)

    @property
    def keeps_rules(self) -> BoolArray:
        """Whether they also keep the design rules of the geometry report."""
        return np.asarray(self.reasons == 0)

    def shaped(self, shape: tuple[int, ...]) -> EvaluatedDesigns:
        """Return the designs as arrays of another shape."""
        numbers = {name: values.reshape(shape) for name, values in self.numbers.items()}
        return EvaluatedDesigns(numbers, self.reasons.reshape(shape))

    def chosen(self, index: IntArray) -> EvaluatedDesigns:
        """Return the designs of these places in their order."""
        numbers = {name: values[index] for name, values in self.numbers.items()}
        return EvaluatedDesigns(numbers, self.reasons[index])

    def refused(self, reasons: IntArray) -> EvaluatedDesigns:
        """Return the designs with further reasons against them."""
        possible = reasons & IMPOSSIBLE == 0
        numbers = {name: np.where(possible, x, np.nan) for name, x in self.numbers.items()}
        return EvaluatedDesigns(numbers, self.reasons | reasons)

    def why(self, index: int | tuple[int, ...]) -> tuple[str, ...]:
        """Return in words what is against one design."""
        found = int(self.reasons[index])
        return tuple(text for reason, text in REASON_TEXTS.items() if found & reason)

    def counts(self) -> dict[str, int]:
        """Return how many designs each reason concerns, by its text."""
        found = {
            text: int(np.count_nonzero(self.reasons & int(reason)))
            for reason, text in REASON_TEXTS.items()
        }
        return {text: count for text, count in found.items() if count}

    def to_dataset(self) -> xr.Dataset:
        """Return the numbers and reasons as a dataset, over ``design`` if they are in a row."""
        import xarray as xr

        axes = range(self.reasons.ndim)
        dims = ("design",) if len(axes) == 1 else tuple(f"axis_{axis}" for axis in axes)
        named = {**self.numbers, "reasons": self.reasons}
        return xr.Dataset({name: (dims, values) for name, values in named.items()})


def joined(parts: Sequence[EvaluatedDesigns]) -> EvaluatedDesigns:
    """Return the designs of several parts in a row; NaN where a part has no number of a name."""
    none = [np.full(part.reasons.shape, np.nan) for part in parts]
    numbers = {
        name: np.concatenate([p.numbers.get(name, n) for p, n in zip(parts, none, strict=True)])
        for name in dict.fromkeys(name for part in parts for name in part)
    }
    return EvaluatedDesigns(numbers, np.concatenate([part.reasons for part in parts]))
