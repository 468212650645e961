"""Kinematics of many designs of a machine at once, for machine types with closed forms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from toothspace.core.errors import CaseError
from toothspace.core.registry import machine_type_names, optional_part

if TYPE_CHECKING:
    from toothspace.core.types import Array
    from toothspace.geometry.evaluated_designs import EvaluatedDesigns


def evaluate_designs(
    label: str,
    name: str,
    machine: Any,
    varied: Mapping[str, Array],
    addendum: float | None = None,
    displacement: float | None = None,
) -> EvaluatedDesigns:
    """Kinematics of a machine with other values of some keys, many at once.

    Parameters
    ----------
    label : str
        Name of the case in messages.
    name : str
        Machine type, empty for a case without machine.
    machine : object
        Keys of ``[machine]``: everything that does not vary.
    varied : mapping of str to ndarray
        Values by key path, arrays of one shape (n,). [SI unit]
    addendum : float or None
        Height of the teeth above the shifted reference line, from which tip diameters follow;
        None for those given. [module]
    displacement : float or None
        Geometric displacement for which face widths are chosen; None for those given. [m3/rad]

    Raises
    ------
    CaseError
        If the machine has no closed form, or a key does not act on its kinematics.
    """
    part = optional_part(name, "designs") if name else None
    if part is None:
        able = [repr(one) for one in machine_type_names() if optional_part(one, "designs")]
        found = repr(name) if name else "no machine"
        raise CaseError("machine.type", found, " or ".join(able)).in_file(label)
    inner = {path.removeprefix("machine."): values for path, values in varied.items()}
    try:
        evaluated: EvaluatedDesigns = part.evaluate_designs(machine, inner, addendum, displacement)
    except CaseError as error:
        raise error.under("machine").in_file(label) from error
    return evaluated
