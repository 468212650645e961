"""Fidelity presets: named, tested sets of models, and the model of each interface.

An interface is where two surfaces run on each other with a film between them. A preset names the
models that it offers for each interface, the one that it uses first; ``[run.interfaces]`` of a
case chooses another.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from operator import attrgetter
from types import MappingProxyType
from typing import final

from toothspace.case import Case
from toothspace.core.errors import CaseError

INTERFACES: Mapping[str, str] = MappingProxyType(
    {
        "journal": "Journal bearings",
        "lateral": "Faces of gears and rotors, and the film round an outer rotor",
        "tip": "Tooth tips on the casing, tips on each other, gaps of the flanks",
        "contact": "Contacts of teeth, lobes and tips",
    }
)
"""Interfaces of a machine and what they are."""

MODELS: Mapping[str, str] = MappingProxyType(
    {
        "closed_form": "formula of a gap, a bearing or a contact",
        "table": "table of films that `toothspace reduce` solved",
        "reynolds": "Reynolds equation on a grid, rigid walls",
        "elastic": "Reynolds equation on a grid with deformation and asperity contact, in balance",
        "rigid": "kinematic contact, force from the balance of moments",
        "compliant": "force over the overlap of elastic teeth",
    }
)
"""Models of interfaces and what they solve."""


@final
@dataclass(frozen=True, kw_only=True)
class Preset:
    """Which models a run uses."""

    name: str
    """Value of ``run.fidelity``."""
    content: str
    """The set in one sentence, for reports."""
    interfaces: Mapping[str, tuple[str, ...]]
    """Models that it offers for each interface, its own choice first; empty without films."""
    unused: tuple[str, ...] = ()
    """Optional parts of a machine that this set does not use; the machine type says in
    ``part_tables`` which of its tables and keys describe them.
    """


_BALANCE = ("floating_part", "elastic_bodies", "startup")
_CONTACTS = {"tip": ("closed_form",), "contact": ("rigid", "compliant")}
_PRESETS = (
    Preset(
        name="ideal",
        content="Kinematic flow and torque, no leakage, rigid fluid.",
        interfaces={},
        unused=("running_in", "free_bodies", *_BALANCE),
    ),
    Preset(
        name="lumped",
        content="Chamber pressures with cavitation, all flow paths, body motion, contacts, "
        "closed-form films and friction.",
        interfaces={
            "journal": ("closed_form", "reynolds", "table"),
            "lateral": ("closed_form", "reynolds", "table"),
            **_CONTACTS,
        },
        unused=_BALANCE,
    ),
    Preset(
        name="films",
        content="Lumped, with journal and lateral films solved on grids.",
        interfaces={
            "journal": ("reynolds", "closed_form"),
            "lateral": ("reynolds", "closed_form"),
            **_CONTACTS,
        },
        unused=_BALANCE,
    ),
    Preset(
        name="elastic",
        content="Films, with elastic surfaces, asperity contact and floating parts in balance.",
        interfaces={"journal": ("reynolds", "closed_form"), "lateral": ("elastic",), **_CONTACTS},
        unused=("startup",),
    ),
)

PRESETS: Mapping[str, Preset] = {preset.name: preset for preset in _PRESETS}
"""Fidelity presets by name."""


def unused_tables(case: Case) -> dict[str, str]:
    """Tables and keys of a case that its run does not use, as they are written, with the reason."""
    run, tables = case.run, getattr(case.machine, "part_tables", {})
    reasons = dict.fromkeys(PRESETS[run.fidelity].unused, f"by a run with {run.fidelity!r}")
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
    preset = PRESETS[case.run.fidelity]
    models = {name: offered[0] for name, offered in preset.interfaces.items()}
    if models and (case.run.mesh == "elastic" or not rigid_mesh):
        models["contact"] = "compliant"
    for name in tables:
        models[name] = "table"
    chosen = case.run.interfaces
    for name, model in {} if chosen is None else chosen.given.items():
        offered = [m for m in preset.interfaces.get(name, ()) if m != "table"]
        if name in tables or model not in offered:
            found = f"{model!r} with {'tables of these films' if name in tables else preset.name!r}"
            allowed = "no choice" if name in tables else " or ".join(map(repr, offered)) or "none"
            raise CaseError(f"run.interfaces.{name}: found {found}, allowed {allowed}")
        models[name] = model
    return models


def models_of(text: str) -> dict[str, str]:
    """Models of interfaces from the text of :func:`interface_text`."""
    pairs = (item.partition(": ") for item in text.split(", "))
    return {name: model for name, separator, model in pairs if separator}


def interface_text(models: Mapping[str, str]) -> str:
    """Models of interfaces as one line of text, ``interface: model`` with commas between."""
    return ", ".join(f"{name}: {model}" for name, model in models.items()) or "none"
