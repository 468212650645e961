"""Names and order of the integrated quantities (ledger states) of every run.

The work of the shaft on the machine, one entry for every way in which mechanical energy is lost,
flow paths by their categories, then mass and undissolved gas *into* each node of held pressure:
ports, and every end of a circuit element at a tank. The energy there follows from the masses,
which close to round-off.
"""

from __future__ import annotations

FRICTION_MECHANISMS = (
    "journal_viscous",
    "journal_asperity",
    "lateral_viscous",
    "lateral_asperity",
    "tip_shear",
    "mesh_friction",
    "shaft_seal",
    "contact_friction",
    "startup",
)
"""Friction that the shaft has to overcome."""

LEDGER_NAMES = (
    "shaft",
    *FRICTION_MECHANISMS,
    "gas_relaxation",
    "radial_load",
    "contact_damping",
    "supply",
    "circuit",
    "shaft_load",
    "coupling",
)
"""Order of the ledger states that every machine has; the losses of its flow paths follow, then the
masses of held nodes.
"""

SHAFT = 0
FRICTION = SHAFT + 1
GAS_RELAXATION = FRICTION + len(FRICTION_MECHANISMS)
RADIAL_LOAD = GAS_RELAXATION + 1
CONTACT_LOSS = RADIAL_LOAD + 1
SUPPLY = CONTACT_LOSS + 1
CIRCUIT = SUPPLY + 1
SHAFT_LOAD = CIRCUIT + 1
COUPLING = SHAFT_LOAD + 1
THROTTLING = COUPLING + 1
"""First of the losses of flow paths, one for each category of the system."""

(
    JOURNAL_VISCOUS, JOURNAL_ASPERITY, LATERAL_VISCOUS, LATERAL_ASPERITY, TIP_SHEAR,
    MESH_FRICTION, SHAFT_SEAL, CONTACT_FRICTION_LOSS, STARTUP,
) = range(len(FRICTION_MECHANISMS))  # fmt: skip
