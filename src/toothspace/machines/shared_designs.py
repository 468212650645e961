"""Kinematics of many designs of one machine type at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyRuleError
from toothspace.core.registry import machine_type, machine_type_names

if TYPE_CHECKING:
    from toothspace.case import Case
    from toothspace.core.types import Array
    from toothspace.geometry.evaluated_designs import EvaluatedDesigns


def evaluate_designs(
    case: Case,
    varied: Mapping[str, Array],
    addendum: float | None = None,
    displacement: float | None = None,
) -> EvaluatedDesigns:
    """Kinematics of the machine of a case with other values of some keys, many at once.

    Parameters
    ----------
    case : Case
        Everything that does not vary.
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
    evaluate = None
    if case.machine is not None:
        evaluate = machine_type(case.machine_type).evaluate_designs
    if evaluate is None:
        found = repr(case.machine_type) if case.machine_type else "no machine"
        able = [repr(name) for name in machine_type_names() if machine_type(name).evaluate_designs]
        raise CaseError(f"{case.label}: machine.type: found {found}, allowed {' or '.join(able)}")
    inner = {path.removeprefix("machine."): values for path, values in varied.items()}
    try:
        evaluated: EvaluatedDesigns = evaluate(case.machine, inner, addendum, displacement)
    except KeyRuleError as error:
        raise CaseError(f"{case.label}: machine.{error}") from error
    return evaluated
