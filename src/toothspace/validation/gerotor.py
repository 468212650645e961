"""Torque and contacts of a gerotor with cycloidal teeth, statement by statement."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np

from toothspace.results.ripple import low_pass, ripple_percent, spectrum, wave
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import ToothContacts
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    Effort,
    Evidence,
    ValidationSource,
    close,
    solved,
    within,
)

Fidelity = Literal["lumped", "films"]

SOURCE = ValidationSource(
    "gerotor_torque",
    "Torque and contacts of a gerotor with 6/7 cycloidal teeth",
    "A numerical model for the evaluation of gerotor torque considering multiple contact points "
    "and fluid-structure interactions.",
    "Curves are normalised; size, pressure, highest speed and oil are those of "
    "cases/gerotor_cycloidal.toml. Clearances are free and chosen so that contacts carry as the "
    "source says; one set for all statements (767 rpm, 40 bar).",
)
OWN = ValidationSource(
    "gerotor_own_aims",
    "Own aims for the same gerotor",
    "No publication: what this version asks of itself.",
)


_SAMPLES = 7200
"""Samples in a revolution: the blow with which a single contact is handed over lasts four of them.
[-]"""
_LOBES, _HIGHEST = 6, 10
"""Lobes of the shaft's rotor, and the highest of their orders that a torque meter shows. [-]"""
_TORQUE_READ = 0.02
"""Least growth of the mean torque that counts. [N m]"""
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


def _fidelities(effort: Effort) -> tuple[str, ...]:
    return ("lumped", "films") if effort == "full" else ("lumped",)


def _losses_of(solution: Solution) -> dict[str, float]:
    names = [str(name) for name in solution.data["mechanism"].values]
    means = np.asarray(solution.data["torque_loss"]).mean(axis=0)
    return dict(zip(names, map(float, means), strict=True))


def _summary(fidelity: str, speed: float = 767.0) -> dict[str, Any]:
    return dict(solved(*_at(fidelity, speed)).summary())


def _two(name: str, found: ToothContacts) -> ComparedValue:
    part, words = np.mean(found.loaded >= 2), "at any shaft angle at least two different teeth"
    return within(f"{name}: part of the turn with 2 or more", part, "-", words, 0.95, 1.0)


def _span_value(name: str, found: ToothContacts) -> ComparedValue:
    text, limits = "span over that of a single contact", (1.7, 2.2, 2.0, "nearly twice")
    return ComparedValue(f"{name}: {text}", found.span, "-", *limits)


def _teeth(effort: Effort) -> Evidence:
    values, curves = [], []
    for name in _fidelities(effort):
        solution = solved(*_at(name))
        found = solution.tooth_contacts()
        values.append(_two(name, found))
        angle = np.degrees(solution.data["shaft_angle"].values)
        axes, loaded = ("shaft angle (deg)", "teeth"), np.asarray(found.loaded, dtype=float)
        curves.append(ComparedCurve(f"Loaded teeth, {name}", *axes, angle - angle[0], loaded))
    return Evidence(tuple(values), tuple(curves))


def _three(effort: Effort) -> Evidence:
    """Third tooth of the pump, and with clearances at which there is one."""
    values, words = [], "and sometimes three"
    for name in _fidelities(effort):
        part = np.mean(solved(*_at(name)).tooth_contacts().loaded >= 3)
        text = f"{name}: part of the turn with 3 or more"
        values.append(within(text, part, "-", words, 1e-3, 0.5))
    closer = "machine.rotors.tip_clearance=12 um", "machine.lateral.side_gap=15 um"
    solution = solved(*_at("lumped"), *closer)
    loss = _losses_of(solution)
    share = loss.pop("contact_friction") / sum(loss.values())
    beside = "12 um at the tips, 15 um beside the faces, lumped: "
    part = np.mean(solution.tooth_contacts().loaded >= 3)
    values += [
        within(beside + "part of the turn with 3 or more", part, "-", ""),
        within(beside + "contact friction over that of the gaps", share, "-", ""),
    ]
    return Evidence(tuple(values))


def _span(effort: Effort) -> Evidence:
    found = {name: solved(*_at(name)).tooth_contacts() for name in _fidelities(effort)}
    return Evidence(tuple(_span_value(name, contacts) for name, contacts in found.items()))


def _walls(effort: Effort) -> Evidence:
    found = solved(*_PUMP, "machine.housing.end_condition=wall").tooth_contacts()
    return Evidence((_two("walls", found), _span_value("walls", found)))


def _losses(effort: Effort) -> Evidence:
    values = []
    for name in _fidelities(effort):
        loss, total = _losses_of(solved(*_at(name))), _summary(name)["mean_torque_N_m"]
        contact = loss.pop("contact_friction")
        gaps = sum(loss.values())
        words = "gaps have a huge impact on the overall torque"
        follows = "followed by the effects at the contact location"
        values += [
            within(f"{name}: torque without losses", total - gaps - contact, "N m", ""),
            within(f"{name}: added by the gaps, over all", gaps / total, "-", words, 0.03),
            within(f"{name}: added by contacts, over all", contact / total, "-", follows, 0.01),
            within(f"{name}: contacts over gaps", contact / gaps, "-", follows, 0.0, 1.0),
        ]
    return Evidence(tuple(values))


def _torque_over_speed(name: Fidelity, effort: Effort) -> Evidence:
    speeds = np.array([500.0, 1000.0] + ([2000.0, 4000.0] if effort == "full" else []))
    torque = np.array([_summary(name, speed)["mean_torque_N_m"] for speed in speeds])
    words = "an increase in rotational speed at the same pressure drop increases the mean torque"
    values = [
        within(f"growth from {a:g} to {b:g} rpm", growth, "N m", words, _TORQUE_READ)
        for a, b, growth in zip(speeds, speeds[1:], np.diff(torque), strict=False)
    ]
    for speed in speeds:
        found = solved(*_at(name, speed))
        friction = _losses_of(found)["contact_friction"]
        force = found.tooth_contacts().mean_total
        values += [
            within(f"contact friction at {speed:g} rpm", friction, "N m", ""),
            within(f"forces of all lobes at {speed:g} rpm", force, "N", ""),
        ]
    axes = "shaft speed (rpm)", "torque (N m)"
    curve = ComparedCurve(f"Mean torque, {name}", *axes, speeds, torque)
    return Evidence(tuple(values), (curve,))


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


def _single(effort: Effort) -> Evidence:
    """Ripple of the torque with a single contact beside that with all (Figs. 13 and 14)."""
    low, whole = f"up to lobe order {_HIGHEST}", "of all orders"
    ripples: dict[str, dict[str, float]] = {low: {}, whole: {}}
    over_angle = []
    for theory in ("all", "single"):
        more = ("machine.contact.theory=single",) if theory == "single" else ()
        data = solved(*_PUMP, *more).data
        angle, torque = np.asarray(data["shaft_angle"]), np.asarray(data["shaft_torque"])
        places, smooth = low_pass(angle, torque, _HIGHEST * _LOBES)
        ripples[low][theory], ripples[whole][theory] = (
            ripple_percent(smooth),
            ripple_percent(torque),
        )
        pitch = places - places[0] <= 2.0 * np.pi / _LOBES
        title, axes = f"Contacts: {theory}, {low}", ("shaft angle (deg)", "torque (N m)")
        turned = np.degrees(places[pitch] - places[0])
        over_angle.append(ComparedCurve(title, *axes, turned, smooth[pitch]))
    curves = tuple(over_angle)
    values = []
    words = "when evaluating torque ripple multiple contact points must be taken into consideration"
    for part, found in ripples.items():
        values += [within(f"ripple {part}, {n}", r, "%", "") for n, r in found.items()]
        text = f"ripple {part}, single contact over all"
        values.append(within(text, found["single"] / found["all"], "-", words, 1.05))
    return Evidence(tuple(values), curves)


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
        "Text to Fig. 16: 'at any shaft angle the contact force is applied by at least two "
        "different teeth'.",
        "A tooth is loaded where it touches, with more than 1 % of the mean total force. Read from "
        "words: 95 % of the turn for 'any'.",
        _teeth,
        0.5,
    ),
    Claim(
        "gerotor_three",
        SOURCE,
        "The same sentence: '... and sometimes three'.",
        "Read from words: 0.1 to 50 % of the turn for 'sometimes'.",
        _three,
        0.5,
        reason=(
            "A third lobe touches where tips are closer or lobes carry more, and there the "
            "friction of contacts exceeds that of the gaps, against the text to Fig. 14."
        ),
    ),
    Claim(
        "gerotor_span",
        SOURCE,
        "Text to Fig. 15: the angular region of contact 'is nearly twice as that of the single "
        "contact point theory'.",
        "Read from words: 1.7 to 2.2.",
        _span,
        0.5,
    ),
    Claim(
        "gerotor_walls",
        SOURCE,
        "Both with the ends of the film round the rotor as in section 2.3, where 'wall boundary "
        "conditions are applied', on the same clearances.",
        "As for gerotor_teeth and gerotor_span.",
        _walls,
        0.3,
    ),
    Claim(
        "gerotor_losses",
        SOURCE,
        "Text to Fig. 14: 'the Gaps have a huge impact on the overall torque followed by the EHL "
        "effects at the contact location'.",
        "Read from words and a normalised figure: gaps from 3 % of the torque on, contacts from "
        "1 %, the least that lines of such a figure are told apart by, and less than the gaps.",
        _losses,
        0.5,
    ),
    Claim(
        "gerotor_speed",
        SOURCE,
        "Text to Fig. 17: 'an increase in rotational speed keeping the same pressure drop "
        "increases the mean torque', by lumped.",
        f"Speeds of the figure are not given: 500 to 4000 rpm. Growth from {_TORQUE_READ} N m on, "
        "0.5 % of the torque, half the least that points of such a figure are told apart by.",
        partial(_torque_over_speed, "lumped"),
        0.5,
    ),
    Claim(
        "gerotor_speed_films",
        SOURCE,
        "The same by films.",
        "As for gerotor_speed.",
        partial(_torque_over_speed, "films"),
        2.0,
        reason=(
            "Between 600 and 1000 rpm the film round the rotor takes the load off the lobes, 900 N "
            "to 130 N, and their boundary friction falls by more than the drag of the films grows."
        ),
    ),
    Claim(
        "gerotor_steps",
        SOURCE,
        "Text to Fig. 14: the final torque beside the single contact point assumption 'ascertains "
        "that when evaluating torque ripple multiple contact points must be taken into "
        "consideration'.",
        "No band is published, so the ripple with a single contact must be larger by 5 %, what a "
        "figure shows, both up to the tenth order of the lobes, which a torque meter behind a "
        "shaft sees, and over all orders, with 7200 samples in a revolution.",
        _single,
        0.5,
    ),
    Claim(
        "gerotor_measured",
        SOURCE,
        "Figs. 12, 13, 17: measured pressure, torque ripple and mean torque.",
        "Normalised; pump, pressure and viscosity are not published.",
        None,
    ),
    Claim(
        "gerotor_orders",
        OWN,
        "The torque ripples with the teeth, as the measured one of Fig. 13 seems to.",
        "Other orders reach a tenth of the largest amplitude at most.",
        _orders,
        0.5,
    ),
    Claim(
        "gerotor_closed_forms",
        OWN,
        "Closed forms of lumped give torque, efficiency and the parts of leakage and friction that "
        "films finds by the Reynolds equation on grids.",
        "2 % of the torque, 5 % of the efficiency; a quarter of each part, which are a few percent "
        "of torque and flow.",
        _closed_forms,
        0.5,
        reason=(
            "The closed form of the film round the rotor leaves it at an eccentricity ratio of "
            "0.63 where films hold it at 0.45: friction of 0.065 N m against 0.045 N m."
        ),
    ),
)
