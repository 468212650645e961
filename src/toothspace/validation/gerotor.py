"""Torque and contacts of a gerotor with cycloidal teeth, statement by statement."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace import api
from toothspace.results.ripple import low_pass, ripple_percent, spectrum, wave
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import ToothForces, tooth_forces
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    Effort,
    Evidence,
    ValidationSource,
    close,
    within,
)
from toothspace.validation.resources import shipped, solved

SOURCE = ValidationSource(
    "gerotor_torque",
    "Torque and contacts of a gerotor with 6/7 cycloidal teeth",
    "A numerical model for the evaluation of gerotor torque considering multiple contact points "
    "and fluid-structure interactions.",
    "Curves are normalised; size, pressure and clearances are those of "
    "cases/gerotor_cycloidal.toml, one set for all statements (767 rpm, 40 bar).",
)
CLOSED_FORMS = ValidationSource(
    "closed_forms",
    "Closed forms of the lumped preset against solved films",
    "The films preset of this version on the same machine: Reynolds equation on grids.",
)


_SAMPLES = 7200
"""Samples in a revolution: the blow with which a single contact is handed over lasts four of them.
[-]"""
_LOBES, _HIGHEST = 6, 10
"""Lobes of the shaft's rotor, and the highest of their orders that a torque meter shows. [-]"""
_PUMP = (
    "gerotor_cycloidal",
    "operating_point.outlet_load=fixed_pressure",
    f"run.samples_per_revolution={_SAMPLES}",
)
_FILMS = ("run.fidelity=films", "run.max_revolutions=200")


def _at(fidelity: str, speed: float = 767.0) -> tuple[str, ...]:
    """Case and overrides of a preset at a shaft speed. [rpm]."""
    films = _FILMS if fidelity == "films" else ()
    return (*_PUMP, f"operating_point.shaft_speed={speed} rpm", *films)


def _forces(*run: str) -> ToothForces:
    return tooth_forces(solved(*run).data, api.describe(shipped(*run)))


def _fidelities(effort: Effort) -> tuple[str, ...]:
    return ("lumped", "films") if effort == "full" else ("lumped",)


def _losses_of(solution: Solution) -> dict[str, float]:
    names = [str(name) for name in solution.data["mechanism"].values]
    means = np.asarray(solution.data["torque_loss"]).mean(axis=0)
    return dict(zip(names, map(float, means), strict=True))


def _summary(fidelity: str, speed: float = 767.0) -> dict[str, Any]:
    return dict(solved(*_at(fidelity, speed)).summary())


def _teeth(effort: Effort) -> Evidence:
    values, curves = [], []
    words = "at any angle at least two teeth carry, sometimes three"
    for name in _fidelities(effort):
        loaded = np.asarray(_forces(*_at(name)).loaded(), dtype=float)
        angle = np.degrees(solved(*_at(name)).data["shaft_angle"].values)
        for least, low, high in ((2, 0.95, 1.0), (3, 1e-3, 0.5)):
            text = f"{name}: part of the turn with {least} or more"
            values.append(within(text, np.mean(loaded >= least), "-", words, low, high))
        axes = "shaft angle (deg)", "teeth"
        curves.append(ComparedCurve(f"Loaded teeth, {name}", *axes, angle - angle[0], loaded))
    return Evidence(tuple(values), tuple(curves))


def _span(effort: Effort) -> Evidence:
    text, limits = "span over that of a single contact", (1.7, 2.2, 2.0, "nearly twice")
    spans = {name: _forces(*_at(name)).span() for name in _fidelities(effort)}
    return Evidence(tuple(ComparedValue(f"{n}: {text}", s, "-", *limits) for n, s in spans.items()))


def _walls(effort: Effort) -> Evidence:
    values = []
    for tip in (20, 40) if effort == "full" else (20,):
        clearance = f'machine.rotors.tip_clearance="{tip} um"'
        forces = _forces(*_PUMP, "machine.housing.end_condition=wall", clearance)
        two, words = np.mean(np.asarray(forces.loaded()) >= 2), "at any angle at least two teeth"
        turn, span = (0.95, 1.0), (1.7, 2.2)
        if tip != 20:
            turn = span = (-np.inf, np.inf)
        place, text = f"{tip} um at the tips:", "span over that of a single contact"
        values += [
            within(f"{place} part of the turn with 2 or more", two, "-", words, *turn),
            within(f"{place} {text}", forces.span(), "-", "nearly twice", *span),
        ]
    return Evidence(tuple(values))


def _losses(effort: Effort) -> Evidence:
    values = []
    for name in _fidelities(effort):
        loss = _losses_of(solved(*_at(name)))
        contact = loss.pop("contact_friction")
        share, words = contact / sum(loss.values()), "gaps dominate, contact friction follows"
        present = "contact friction is present"
        values += [
            within(f"{name}: contact friction over loss of the gaps", share, "-", words, 0.0, 1.0),
            within(f"{name}: contact friction", contact, "N m", present, 1e-4),
        ]
    return Evidence(tuple(values))


def _torque_over_speed(effort: Effort) -> Evidence:
    values, curves = [], []
    words = "mean torque increases with speed at one pressure drop"
    for name in _fidelities(effort):
        speeds = np.array([500.0, 1000.0, 2000.0] + ([4000.0] if effort == "full" else []))
        torque = np.array([_summary(name, speed)["mean_torque_N_m"] for speed in speeds])
        values += [
            within(f"{name}: growth from {a:g} to {b:g} rpm", growth, "N m", words, 1e-3)
            for a, b, growth in zip(speeds, speeds[1:], np.diff(torque), strict=False)
        ]
        axes = "shaft speed (rpm)", "torque (N m)"
        curves.append(ComparedCurve(f"Mean torque, {name}", *axes, speeds, torque))
    return Evidence(tuple(values), tuple(curves))


def _orders(effort: Effort) -> Evidence:
    values, curves = [], []
    for name in _fidelities(effort):
        data = solved(*_at(name)).data
        angle, torque = wave(data, "shaft_torque")
        found = spectrum(angle, torque)
        order = np.round(found.order).astype(int)
        teeth = (order > 0) & (order % 6 == 0)
        others = (order > 0) & (order < 60) & (order % 6 != 0)
        share = float(found.amplitude[others].max() / found.amplitude[teeth].max())
        text = f"{name}: largest other order over largest tooth order"
        values.append(within(text, share, "-", "ripple of the teeth", 0.0, 0.1))
        title, axes = f"Shaft torque, {name}", ("shaft angle (deg)", "torque (N m)")
        curves.append(ComparedCurve(title, *axes, np.degrees(angle - angle[0]), torque))
    return Evidence(tuple(values), tuple(curves))


def _steps(effort: Effort) -> Evidence:
    """Torque as contributions are added, and that of a single contact (Fig. 14)."""
    values = []
    for name in _fidelities(effort):
        loss, total = _losses_of(solved(*_at(name))), _summary(name)["mean_torque_N_m"]
        contact = loss.pop("contact_friction")
        gaps = sum(loss.values())
        words = "gaps have a huge impact on the torque, friction at contacts follows"
        values += [
            within(f"{name}: torque without losses", total - gaps - contact, "N m", ""),
            within(f"{name}: added by the gaps", gaps, "N m", words, 1e-3),
            within(f"{name}: added by contacts", contact, "N m", words, 0.0, gaps),
        ]
    ripples, curves = _ripples()
    words = "for the ripple all contacts must be taken into consideration"
    for part, found in ripples.items():
        values += [within(f"ripple {part}, {n}", r, "%", "") for n, r in found.items()]
        text = f"ripple {part}, single contact over all"
        values.append(within(text, found["single"] / found["all"], "-", words, 1.05))
    return Evidence(tuple(values), curves)


def _ripples() -> tuple[dict[str, dict[str, float]], tuple[ComparedCurve, ...]]:
    """Ripple of the shaft torque with all contacts and with a single one, whole and low orders."""
    low, whole = f"up to lobe order {_HIGHEST}", "of all orders"
    found: dict[str, dict[str, float]] = {low: {}, whole: {}}
    curves = []
    for theory in ("all", "single"):
        more = ("machine.contact.theory=single",) if theory == "single" else ()
        data = solved(*_PUMP, *more).data
        angle, torque = np.asarray(data["shaft_angle"]), np.asarray(data["shaft_torque"])
        places, smooth = low_pass(angle, torque, _HIGHEST * _LOBES)
        found[low][theory], found[whole][theory] = ripple_percent(smooth), ripple_percent(torque)
        pitch = places - places[0] <= 2.0 * np.pi / _LOBES
        title, axes = f"Contacts: {theory}, {low}", ("shaft angle (deg)", "torque (N m)")
        turned = np.degrees(places[pitch] - places[0])
        curves.append(ComparedCurve(title, *axes, turned, smooth[pitch]))
    return found, tuple(curves)


def _closed_forms(effort: Effort) -> Evidence:
    numbers = [_summary(name) for name in ("lumped", "films")]
    losses = [_losses_of(solved(*_at(name))) for name in ("lumped", "films")]
    rows = (
        ("mean torque", "N m", 0.02, [n["mean_torque_N_m"] for n in numbers]),
        ("volumetric efficiency", "-", 0.05, [n["volumetric_efficiency"] for n in numbers]),
        ("leakage at the tips", "L/min", 0.25, [n["leakage_tip_L_per_min"] for n in numbers]),
        ("friction round the rotor", "N m", 0.25, [n["journal_viscous"] for n in losses]),
        ("friction at the faces", "N m", 0.25, [n["lateral_viscous"] for n in losses]),
        ("contact friction", "N m", 0.25, [n["contact_friction"] for n in losses]),
    )
    return Evidence(tuple(close(name, a, b, unit, rel=rel) for name, unit, rel, (a, b) in rows))


CLAIMS = (
    Claim(
        "gerotor_teeth",
        SOURCE,
        "Fig. 16: two teeth carry at any angle, sometimes three.",
        "A tooth is loaded above 1 % of the mean total force; 5 % of the turn for hand-over.",
        _teeth,
        0.3,
        reason=(
            "The film round the rotor holds it, and with 40 um at the tips one tooth "
            "at a time is enough to turn it."
        ),
    ),
    Claim(
        "gerotor_span",
        SOURCE,
        "Fig. 15: contact spans nearly twice the angle of single-contact theory.",
        "15 %: read from words.",
        _span,
        reason=(
            "The film round the rotor holds it, and with 40 um at the tips one tooth "
            "at a time is enough to turn it."
        ),
    ),
    Claim(
        "gerotor_walls",
        SOURCE,
        "Figs. 15 and 16 with the film of the source, walls through which nothing passes at its "
        "ends, and 20 um at the tips.",
        "As for gerotor_teeth and gerotor_span, beside which it stands: the clearance of the "
        "published pump is not given; values at 40 um are shown, not judged.",
        _walls,
        0.3,
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
        "gerotor_steps",
        SOURCE,
        "Fig. 14: torque without losses, with gaps, with contacts, and with a single contact.",
        "Signs and order alone. No band is published, so the ripple with a single contact must be "
        "larger by 5 % both up to the tenth order of the lobes, which a torque meter behind a "
        "shaft shows, and over all orders, with 7200 samples in a revolution.",
        _steps,
        0.5,
    ),
    Claim(
        "gerotor_closed_forms",
        CLOSED_FORMS,
        "Closed forms give torque, efficiency and the parts of leakage and friction.",
        "2 % of the torque, 5 % of the efficiency; a quarter of each part, which are a few percent "
        "of torque and flow.",
        _closed_forms,
        1.0,
    ),
    Claim(
        "gerotor_measured",
        SOURCE,
        "Figs. 12, 13, 17: measured pressure, torque ripple and mean torque.",
        "Normalised; pump, pressure and viscosity are not published.",
        None,
    ),
)
