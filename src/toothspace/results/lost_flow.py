"""Names of the parts of the lost flow, and their numbers in a summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

PRESSURE = "pressure_leakage_"
"""Before the name of a path: what pressure drives back through it."""
DRAG = "drag_leakage_"
"""Before the name of a path: what moving walls drag through it, negative where they deliver."""
COMPRESSION = "compression_flow"
GAS = "gas_flow"
PORT_VOLUMES = "port_volume_flow"
EXCHANGE = "mesh_exchange_flow"

LABELS: Mapping[str, str] = {
    COMPRESSION: "compression of the liquid in the chambers",
    GAS: "free gas and vapour in the chambers",
    PORT_VOLUMES: "kept in port volumes and lines",
    EXCHANGE: "timing, and exchange through ports, grooves and the mesh",
}
"""Parts of the lost flow besides the leakage of paths, with a readable name."""


def parts_of(data: xr.Dataset) -> dict[str, float]:
    """Parts of the lost flow of a result, empty if it has none. [m3/s]."""
    if "lost_flow" not in data:
        return {}
    return {
        str(name): float(value)
        for name, value in zip(data["flow_part"].values, data["lost_flow"].values, strict=True)
    }


def leakages_of(parts: Mapping[str, float]) -> dict[str, float]:
    """Leakage of every path, by pressure and drag together. [unit of the parts]."""
    found: dict[str, float] = {}
    for before in (PRESSURE, DRAG):
        for name, value in parts.items():
            if name.startswith(before):
                path = name.removeprefix(before)
                found[path] = found.get(path, 0.0) + value
    return found
