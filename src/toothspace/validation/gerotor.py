"""Torque and contacts of a gerotor with cycloidal teeth, statement by statement."""

from __future__ import annotations

from functools import cache

import numpy as np

from toothspace import api
from toothspace.results.ripple import spectrum
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import ToothForces, tooth_forces
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    CurvePoints,
    Effort,
    Evidence,
    ValidationSource,
)
from toothspace.validation.resources import case_file

SOURCE = ValidationSource(
    "gerotor_torque",
    "Torque and contacts of a gerotor with 6/7 cycloidal teeth",
    "A numerical model for the evaluation of gerotor torque considering multiple contact points "
    "and fluid-structure interactions.",
    "Curves are normalised; size, pressure and clearances are those of "
    "cases/gerotor_cycloidal.toml, one set for all statements (767 rpm, 40 bar, lumped preset).",
)


@cache
def _solved(speed: float) -> tuple[Solution, ToothForces]:
    case = api.load_case(
        case_file("gerotor_cycloidal"),
        ("operating_point.outlet_load=fixed_pressure", f"operating_point.shaft_speed={speed} rpm"),
    )
    solution = api.simulate(case)
    return solution, tooth_forces(solution.data, api.describe(case))


def _teeth(effort: Effort) -> Evidence:
    solution, forces = _solved(767.0)
    loaded = np.asarray(forces.loaded(), dtype=float)
    angle = np.degrees(np.asarray(solution.data["shaft_angle"]))[: loaded.size]
    words = "at any angle at least two teeth carry, sometimes three"
    return Evidence(
        (
            ComparedValue(
                "part of the turn with two or more",
                float(np.mean(loaded >= 2)),
                "-",
                0.95,
                1.0,
                words=words,
            ),
            ComparedValue(
                "part of the turn with three or more",
                float(np.mean(loaded >= 3)),
                "-",
                1e-3,
                0.5,
                words=words,
            ),
        ),
        (
            ComparedCurve(
                "Loaded teeth", "shaft angle (deg)", "teeth", CurvePoints(angle - angle[0], loaded)
            ),
        ),
    )


def _span(effort: Effort) -> Evidence:
    return Evidence(
        (
            ComparedValue(
                "span over that of a single contact",
                float(_solved(767.0)[1].span()),
                "-",
                1.7,
                2.2,
                2.0,
                "nearly twice",
            ),
        )
    )


def _losses(effort: Effort) -> Evidence:
    solution, _ = _solved(767.0)
    names = [str(name) for name in solution.data["mechanism"].values]
    means = np.asarray(solution.data["torque_loss"]).mean(axis=0)
    loss = dict(zip(names, means, strict=True))
    contact = float(loss.pop("contact_friction"))
    gaps = float(sum(loss.values()))
    return Evidence(
        (
            ComparedValue(
                "contact friction over loss of the gaps",
                contact / gaps,
                "-",
                0.0,
                1.0,
                words="gaps dominate, contact friction follows",
            ),
            ComparedValue(
                "contact friction", contact, "N m", 1e-4, words="contact friction is present"
            ),
        )
    )


def _torque_over_speed(effort: Effort) -> Evidence:
    speeds = np.array([500.0, 1000.0, 2000.0] + ([4000.0] if effort == "full" else []))
    torque = np.array([float(_solved(n)[0].summary()["mean_torque_N_m"]) for n in speeds])
    values = tuple(
        ComparedValue(
            f"growth from {a:g} to {b:g} rpm",
            float(later - first),
            "N m",
            1e-3,
            words="mean torque increases with speed at one pressure drop",
        )
        for a, b, first, later in zip(speeds, speeds[1:], torque, torque[1:], strict=False)
    )
    return Evidence(
        values,
        (
            ComparedCurve(
                "Mean torque", "shaft speed (rpm)", "torque (N m)", CurvePoints(speeds, torque)
            ),
        ),
    )


def _orders(effort: Effort) -> Evidence:
    data = _solved(767.0)[0].data
    angle, torque = np.asarray(data["shaft_angle"]), np.asarray(data["shaft_torque"])
    found = spectrum(angle, torque)
    order = np.round(found.order).astype(int)
    teeth = (order > 0) & (order % 6 == 0)
    others = (order > 0) & (order < 60) & (order % 6 != 0)
    share = float(found.amplitude[others].max() / found.amplitude[teeth].max())
    turn = np.degrees(angle - angle[0])
    return Evidence(
        (
            ComparedValue(
                "largest other order over largest tooth order",
                share,
                "-",
                0.0,
                0.1,
                words="ripple of the teeth",
            ),
        ),
        (
            ComparedCurve(
                "Shaft torque", "shaft angle (deg)", "torque (N m)", CurvePoints(turn, torque)
            ),
        ),
    )


CLAIMS = (
    Claim(
        "gerotor_teeth",
        SOURCE,
        "Fig. 16: two teeth carry at any angle, sometimes three.",
        "A tooth is loaded above 1 % of the mean total force; 5 % of the turn for hand-over.",
        _teeth,
        0.3,
    ),
    Claim(
        "gerotor_span",
        SOURCE,
        "Fig. 15: contact spans nearly twice the angle of single-contact theory.",
        "15 %: read from words.",
        _span,
    ),
    Claim(
        "gerotor_losses",
        SOURCE,
        "Fig. 14: gaps dominate the loss of torque, contact friction follows.",
        "Order alone.",
        _losses,
    ),
    Claim(
        "gerotor_speed",
        SOURCE,
        "Fig. 17: mean torque rises with speed.",
        "Sign alone.",
        _torque_over_speed,
        0.5,
    ),
    Claim(
        "gerotor_orders",
        SOURCE,
        "Fig. 13: torque ripples with the teeth.",
        "A tenth of the largest amplitude.",
        _orders,
    ),
    Claim(
        "gerotor_measured",
        SOURCE,
        "Figs. 12, 13, 17: measured pressure, torque ripple and mean torque.",
        "Normalised; pump, pressure and viscosity are not published.",
        None,
    ),
)
