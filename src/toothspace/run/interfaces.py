"""Which model each interface of a machine has in a run, and what of a case a run leaves unused."""

from __future__ import annotations

from operator import attrgetter

from toothspace.case import Case
from toothspace.case.conditions import RunSettings
from toothspace.case.presets import PRESETS
from toothspace.core.errors import CaseError


def unused_tables(case: Case) -> dict[str, str]:
    """Tables and keys of a case that its run does not use, as they are written, with the reason."""
    run, tables = case.run, getattr(case.machine, "part_tables", {})
    reasons = dict.fromkeys(run.preset.unused, f"by a run with {run.fidelity!r}")
    if case.circuit is not None:
        reasons.pop("startup", None)  # a circuit lets the shaft turn freely
    if run.film_tables is not None:
        reasons.pop("floating_part", None)
    if run.deformation != "bodies":
        reasons.setdefault("elastic_bodies", f"with run.deformation = {run.deformation!r}")
    if interface_models(case).get("lateral") != "reynolds":
        reasons.setdefault("free_bodies", "without run.interfaces.lateral = 'reynolds'")
    given: dict[str, str] = {}
    for part in filter(tables.__contains__, reasons):
        path, value = f"machine.{tables[part]}", attrgetter(tables[part])(case.machine)
        if value not in (None, "given"):
            given[path if isinstance(value, str) else f"[{path}]"] = reasons[part]
    if case.heat.model == "coupled" and (case.circuit is not None or not run.preset.has_losses):
        where = "over time" if case.circuit is not None else f"with {run.fidelity!r}"
        given["heat.model"] = f"by a run {where}"
    for key in (name for preset in PRESETS.values() for name in preset.own_keys):
        if not run.preset.reads(key) and getattr(run, key) != getattr(RunSettings, key):
            given[f"run.{key}"] = f"by a run with {run.fidelity!r}"
    return given


def interface_models(
    case: Case, tables: tuple[str, ...] = (), *, rigid_mesh: bool = True
) -> dict[str, str]:
    """Model of each interface in a run of a case.

    Parameters
    ----------
    tables : tuple of str
        Interfaces whose films come from the tables of the case.
    rigid_mesh : bool
        Whether the machine offers a rigid mesh.

    Raises
    ------
    CaseError
        If the case chooses a model that its preset does not offer.
    """
    preset = case.run.preset
    models = {name: offered[0] for name, offered in preset.interfaces.items()}
    if models and (case.run.mesh == "elastic" or not rigid_mesh):
        models["contact"] = "compliant"
    if "elastic" in models.values() and getattr(case.machine, "covers_rest", False):
        models["lateral"] = "reynolds"
    for name in tables:
        models[name] = "table"
    chosen = case.run.interfaces
    for name, model in {} if chosen is None else chosen.given.items():
        offered = [m for m in preset.interfaces.get(name, ()) if m != "table"]
        if name in tables or model not in offered:
            found = f"{model!r} with {'tables of these films' if name in tables else preset.name!r}"
            allowed = "no choice" if name in tables else " or ".join(map(repr, offered)) or "none"
            raise CaseError(f"run.interfaces.{name}", found, allowed)
        models[name] = model
    return models
