"""Data of fluids and materials, each value with its source.

=========== ===========================================================
folder      responsibility
=========== ===========================================================
fluids      density, stiffness, viscosity, vapour and air of liquids
materials   elasticity, hardness and boundary friction of solids
warmup      small cases that compile what runs need
=========== ===========================================================
"""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from toothspace.core.errors import CaseError


def shipped_folder(name: str) -> Path:
    """Return a folder that comes with the package, such as ``cases``.

    It lies within an installed package, and at the root of a checkout.
    """
    package = Path(__file__).resolve().parents[1]
    inside = package / "shipped" / name
    return inside if inside.is_dir() else package.parents[1] / name


def library_names(kind: str) -> list[str]:
    """Return the names in one folder of the library, ``fluids`` or ``materials``."""
    folder = files(__name__) / kind
    return sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".toml"))


@cache
def library_entry(kind: str, name: str, key: str) -> dict[str, Any]:
    """Return the table of one fluid or material.

    Raises CaseError if the library has no such entry.

    Parameters
    ----------
    kind : str
        ``fluids`` or ``materials``.
    name : str
        Name of the entry.
    key : str
        Key of the case file that asks, for the error message.
    """
    names = library_names(kind)
    if name not in names:
        raise CaseError(key, f"{name!r}", ", ".join(names))
    text = (files(__name__) / kind / f"{name}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def load_fluid(name: str) -> dict[str, Any]:
    """Return the table of a fluid, or raise :class:`CaseError` with the allowed names."""
    return library_entry("fluids", name, "fluid.name")


def load_material(name: str, key: str = "material") -> dict[str, Any]:
    """Return the table of a material, or raise :class:`CaseError` with the allowed names."""
    return library_entry("materials", name, key)


def fluids() -> dict[str, str]:
    """Return titles and temperature ranges of the fluids of the library by name."""
    found = {}
    for name in library_names("fluids"):
        entry = load_fluid(name)
        if "temperature_range_degC" in entry:
            low, high = (f"{end:g} degC" for end in entry["temperature_range_degC"])
        else:
            low, high = entry["lowest_temperature"], entry["highest_temperature"]
        found[name] = f"{entry['title']}, {low.removesuffix(' degC')} to {high}"
    return found
